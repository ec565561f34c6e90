// The picture of a model, coarse while it moves, and fine when it rests.
//
//   moving   one request at a time, the last wish next      in as many pixels as were drawn in time before
//   resting  all pixels of the canvas                       then, if that is wished, those of finer means
//
// Where only primitives moved since the picture that is there, just the lines that differ are asked for and written over it. What is there stays until what is new has come whole, so the canvas is
// never empty.

import { drawRaster } from "./drawing.js";

/**
 * What is to be seen. `model` tells the model from others; `view` is the query of the view but for its size and moves, `fine` what it has more when it rests; `request` makes a request of a query.
 * @typedef {{
 *   model: string, view: Record<string, string>, moves: string[], fine: Record<string, string>,
 *   request: (query: [string, string][]) => import("./worker.js").Request,
 * }} Wish
 *
 * A picture that is there, or comes: of which model, view and level, with which moves.
 * @typedef {{ canvas: OffscreenCanvas, key: string, moves: string[], front: number }} Picture
 *
 * What is told of every picture: milliseconds from its request on, lines that came.
 * @typedef {{ ms: number, lines: number, width: number, height: number, moving: boolean, patch: boolean }} Frame
 */

/** A picture while it moves should not take longer, in ms: 15 of them a second are 66. */
const BUDGET = 45;
const LONGEST = 62;
/** After so long a request is given up for a newer one, in ms. */
const PATIENCE = 400;
/** It rests when it has not moved for so long, in ms. */
const REST = 140;
/** Parts of the canvas's pixels along a side in which it is drawn. */
const LEVELS = [1, 0.75, 0.5, 0.375, 0.25, 0.125];

const same = (/** @type {string[]} */ a, /** @type {string[]} */ b) => a.length === b.length && a.every((x, i) => x === b[i]);

/** Tells of `frame`, `rest`, `problem` and `broken`. */
export class Sight extends EventTarget {
  /** @param {HTMLCanvasElement} canvas */
  constructor(canvas) {
    super();
    this.canvas = canvas;
    this.context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
    this.ratio = devicePixelRatio;
    /** @type {Wish | undefined} */
    this.wish = undefined;
    /** @type {Picture | undefined} what is there */
    this.there = undefined;
    /** @type {OffscreenCanvas | undefined} the finer one over it */
    this.finer = undefined;
    /** @type {{ wish: Wish, moving: boolean, began: number, stop: () => void, coming?: Picture } | undefined} */
    this.flight = undefined;
    this.level = 2;
    this.rest = 0;
    this.dirty = false;
    new ResizeObserver(() => this.#resize()).observe(canvas);
  }

  /** Pixels of the canvas. */
  get size() {
    return { width: this.canvas.width, height: this.canvas.height };
  }

  /**
   * Shows something else.
   * @param {Wish | undefined} wish
   * @param {boolean} moving whether it is about to change again
   */
  show(wish, moving) {
    this.wish = wish;
    clearTimeout(this.rest);
    if (!wish) {
      this.flight?.stop();
      this.flight = this.there = this.finer = undefined;
      return this.redraw();
    }
    if (moving) {
      this.#move();
      this.rest = setTimeout(() => this.#settle(), REST);
    } else {
      this.#settle();
    }
  }

  /** The next picture of what moves, if none is under way that will be there soon. */
  #move() {
    const { flight, wish } = this;
    if (!wish) return;
    if (flight?.moving && performance.now() - flight.began < PATIENCE) return;
    this.#ask(wish, true, this.#levelOf(wish));
  }

  /** The level for what moves: that of the picture there if lines of it are enough. @param {Wish} wish */
  #levelOf(wish) {
    const { there } = this;
    const level = there ? LEVELS.findIndex((level) => this.#keyOf(wish, level) === there.key) : -1;
    return level >= 0 && (level >= this.level || !this.slow) ? level : this.level;
  }

  /** The whole picture, and then the fine one. */
  #settle() {
    const { wish } = this;
    if (!wish) return;
    if (this.there?.key !== this.#keyOf(wish, 0) || !same(this.there.moves, wish.moves)) return this.#ask(wish, false, 0);
    this.flight?.stop();
    this.flight = undefined;
    if (Object.keys(wish.fine).length && !this.finer) return this.#refine(wish);
    this.dispatchEvent(new Event("rest"));
  }

  /** What tells a picture from others but for moves. @param {Wish} wish @param {number} level */
  #keyOf({ model, view }, level) {
    return JSON.stringify([model, view, this.#sizeOf(level)]);
  }

  /** @param {number} level */
  #sizeOf(level) {
    return [this.canvas.width, this.canvas.height].map((side) => Math.max(1, Math.round(side * LEVELS[level])));
  }

  /** @param {Wish} wish @param {number} level @param {Record<string, string>} [more] @returns {[string, string][]} */
  #query(wish, level, more = {}) {
    const moves = wish.moves.map((move) => /** @type {[string, string]} */ (["move", move]));
    return [...Object.entries({ ...wish.view, ...more, imgsize: this.#sizeOf(level).join(","), format: "rls" }), ...moves];
  }

  /** @param {Wish} wish @param {boolean} moving @param {number} level */
  #ask(wish, moving, level) {
    this.flight?.stop();
    const key = this.#keyOf(wish, level);
    const [width, height] = this.#sizeOf(level);
    const patch = this.there?.key === key ? this.there : undefined;
    const query = this.#query(wish, level);
    if (patch) for (const move of patch.moves.length ? patch.moves : [""]) query.push(["from", move]);
    /** @type {Picture} */
    const coming = patch ?? { canvas: new OffscreenCanvas(width, height), key, moves: wish.moves, front: 0 };
    const context = /** @type {OffscreenCanvasRenderingContext2D} */ (coming.canvas.getContext("2d"));
    /** @type {{ y: number, image: ImageData }[]} */
    const strips = [];
    let [first, lines] = [0, 0];
    const began = performance.now();
    const stop = drawRaster(wish.request(query), {
      header: ({ from, to }) => ([first, lines] = [from, to - from]),
      strip: ({ y, rows, pixels }) => {
        const image = new ImageData(pixels, width, rows);
        // Lines of a patch are written together: half of them would be a picture of two models.
        if (patch) return void strips.push({ y: first + y, image });
        context.putImageData(image, 0, y);
        coming.front = y + rows;
        if (!moving) this.redraw();
      },
      done: () => {
        for (const { y, image } of strips) context.putImageData(image, 0, y);
        coming.moves = wish.moves;
        coming.front = height;
        this.there = coming;
        this.finer = this.flight = undefined;
        const ms = performance.now() - began;
        this.#learn(ms, level, Boolean(patch), moving);
        this.redraw();
        this.dispatchEvent(new CustomEvent("frame", { detail: /** @type {Frame} */ ({ ms, lines, width, height, moving, patch: Boolean(patch) }) }));
        if (!moving) this.#settle();
        else if (this.wish !== wish) this.#move();
      },
      problem: (problem) => this.#fail("problem", problem),
      broken: (what) => this.#fail("broken", what),
    });
    this.flight = { wish, moving, began, stop, coming: patch ? undefined : coming };
  }

  /** Finds the level at which what moves is there in time. @param {number} ms @param {number} level @param {boolean} patch @param {boolean} moving */
  #learn(ms, level, patch, moving) {
    if (!moving) {
      this.slow = false;
      return;
    }
    this.slow = ms > LONGEST;
    if (ms > LONGEST) this.level = Math.min(Math.max(level, this.level) + (ms > 2 * LONGEST ? 2 : 1), LEVELS.length - 1);
    else if (!patch && level > 0 && ms * (LEVELS[level - 1] / LEVELS[level]) ** 2 < BUDGET) this.level = level - 1;
  }

  /** @param {Wish} wish */
  #refine(wish) {
    const { width, height } = this.size;
    const finer = new OffscreenCanvas(width, height);
    const context = /** @type {OffscreenCanvasRenderingContext2D} */ (finer.getContext("2d"));
    const stop = drawRaster(wish.request(this.#query(wish, 0, wish.fine)), {
      strip: ({ y, rows, pixels }) => context.putImageData(new ImageData(pixels, width, rows), 0, y),
      done: () => {
        this.finer = finer;
        this.flight = undefined;
        this.redraw();
        this.dispatchEvent(new Event("rest"));
      },
      problem: (problem) => this.#fail("problem", problem),
      broken: (what) => this.#fail("broken", what),
    });
    this.flight = { wish, moving: false, began: performance.now(), stop };
  }

  /** @param {string} name @param {unknown} detail */
  #fail(name, detail) {
    this.flight = undefined;
    this.dispatchEvent(new CustomEvent(name, { detail }));
  }

  #resize() {
    this.ratio = devicePixelRatio;
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight].map((side) => Math.round(side * this.ratio));
    if (!width || !height || (width === this.canvas.width && height === this.canvas.height)) return;
    this.canvas.width = width;
    this.canvas.height = height;
    this.#paint();
    this.finer = undefined;
    this.show(this.wish, false);
  }

  redraw() {
    if (this.dirty) return;
    this.dirty = true;
    requestAnimationFrame(() => {
      this.dirty = false;
      this.#paint();
    });
  }

  #paint() {
    const { context: c, canvas, there, flight, finer } = this;
    const over = flight && !flight.moving ? flight.coming : undefined;
    if (!there && !over?.front) c.clearRect(0, 0, canvas.width, canvas.height);
    if (there) c.drawImage(finer ?? there.canvas, 0, 0, canvas.width, canvas.height);
    if (over?.front) c.drawImage(over.canvas, 0, 0, canvas.width, over.front, 0, 0, canvas.width, over.front);
  }
}
