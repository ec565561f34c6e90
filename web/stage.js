// The canvas: the page under a view that zooms to single pixels.
//
//   base     the whole page, in as many pixels as the view has                  asked for when the drawing changes
//   details  what the view shows, where that needs more pixels than the base    asked for when the view rests
//   light    one shape over all that, while it is pointed at
//
// A detail is a slice of lines; of each line only the columns that are seen are kept. So a page of any size costs what a few views hold.

import { reduced } from "./size.js";
import { MOST_PIXELS, Pane } from "./pane.js";
import { drawRaster } from "./drawing.js";
import { listen } from "./hands.js";
import { paint } from "./paint.js";

/**
 * What is drawn: a page, and how a part of it is asked for.
 * @typedef {{
 *   page: import("./size.js").Rendering,
 *   drawing: import("./size.js").Page,
 *   request: (query: Record<string, string | number>) => import("./worker.js").Request,
 *   light?: (id: string, query: Record<string, string | number>) => import("./worker.js").Request,
 *   whole?: boolean,
 * }} Content `whole`: it comes in one stream, from which the view picks
 *
 * @typedef {{ y: number, n: number, how: string }[]} Kinds
 */

/** Details that are kept besides the one that is shown. */
const MOST_DETAILS = 3;

/** The view rests when it has not moved for so long, in ms. */
const REST = 90;

const MOST_ZOOM = 64;
const PAD = 16;

export class Stage extends EventTarget {
  /** @param {HTMLCanvasElement} canvas */
  constructor(canvas) {
    super();
    this.canvas = canvas;
    this.context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
    /** @type {Content | undefined} */
    this.content = undefined;
    /** Device pixels to one of the page, and the page's pixel at the canvas's corner. */
    this.view = { zoom: 1, x: 0, y: 0 };
    this.fits = true;
    /** @type {Pane | undefined} */
    this.base = undefined;
    /** @type {Pane | undefined} the picture before, until the new one has replaced it */
    this.before = undefined;
    /** @type {Pane[]} */
    this.details = [];
    /** @type {Pane | undefined} */
    this.lit = undefined;
    /** @type {number[] | undefined} */
    this.box = undefined;
    /** @type {{ kinds: Kinds, scale: number } | undefined} */
    this.kinds = undefined;
    this.tint = false;
    /** The pixel that is looked at. */
    this.probe = { x: 0, y: 0 };
    this.dirty = false;
    this.rest = 0;
    this.ratio = devicePixelRatio;
    new ResizeObserver(() => this.#resize()).observe(canvas);
    listen(this);
  }

  /**
   * Shows something else, from the first line on. The view stays if the page is as large as before.
   * @param {Content | undefined} content
   */
  show(content) {
    const same = content && this.content && content.page.width === this.content.page.width && content.page.height === this.content.page.height;
    this.content = content;
    for (const pane of [this.base, ...this.details, this.lit]) pane?.stop();
    this.before = same ? (this.base?.front ? this.base : this.before) : undefined;
    this.details = [];
    this.lit = undefined;
    this.base = undefined;
    this.kinds = undefined;
    if (!content) return this.redraw();
    if (!same) this.fits = true;
    if (this.fits) this.#fitView();
    this.probe = same ? this.probe : { x: Math.floor(content.page.width / 2), y: Math.floor(content.page.height * 0.4) };
    this.#drawBase();
    if (!this.fits) this.#detail();
    this.#moved();
  }

  /** The resolution of the base: that of the fitted view. */
  get baseRendering() {
    const { drawing, page } = /** @type {Content} */ (this.content);
    return reduced(drawing, page, this.#fitZoom());
  }

  #fitZoom() {
    const { page } = /** @type {Content} */ (this.content);
    const pad = 2 * PAD * this.ratio;
    const zoom = Math.min((this.canvas.width - pad) / page.width, (this.canvas.height - pad) / page.height);
    return zoom >= 1 ? Math.min(Math.floor(zoom), MOST_ZOOM) : Math.max(zoom, 1 / page.width, 1 / page.height);
  }

  #drawBase() {
    const content = /** @type {Content} */ (this.content);
    const { page } = content;
    const base = this.baseRendering;
    const rect = { x0: 0, y0: 0, x1: page.width, y1: page.height, width: base.width, height: base.height };
    const pane = (this.base = new Pane(rect, base.width, base.height));
    const target = content.whole ? rect : { ...rect, x1: base.width, y1: base.height };
    this.#fill(pane, content.request(content.whole ? {} : base.query), target, true);
  }

  /**
   * Streams the page at its full size, every line of it, into the base.
   */
  drawAll() {
    const content = this.content;
    if (!content || !this.base) return;
    this.base.stop();
    this.before = this.base;
    const { page } = content;
    const pane = (this.base = new Pane(this.base.rect, this.base.canvas.width, this.base.canvas.height));
    this.#fill(pane, content.request(page.query), pane.rect, true);
  }

  /**
   * @param {Pane} pane
   * @param {import("./worker.js").Request} request
   * @param {import("./worker.js").Target} target
   * @param {boolean} told whether its progress is that of the stage
   * @param {number[]} [tint]
   */
  #fill(pane, request, target, told, tint) {
    const tell = (/** @type {string} */ name, /** @type {object} */ detail) => told && this.dispatchEvent(new CustomEvent(name, { detail }));
    const began = performance.now();
    pane.stop = drawRaster(
      request,
      {
        header: (header) => tell("header", header),
        strip: (strip) => {
          const first = pane.front === 0;
          pane.put(strip);
          if (first) tell("first", { ms: performance.now() - began });
          this.redraw();
        },
        progress: (progress) => tell("progress", { progress, done: false }),
        done: (progress, summed) => {
          pane.done = true;
          if (pane === this.base) this.before = undefined;
          this.redraw();
          tell("progress", { progress, done: true, summed });
        },
        problem: (problem) => tell("problem", problem),
        broken: (what) => tell("broken", { what }),
      },
      { target, tint },
    );
    tell("begun", {});
  }

  /** Asks for what the view shows, if the base has too few pixels for it and no detail has it. */
  #detail() {
    const { content, base } = this;
    if (!content || !base || content.whole) return;
    const { page, drawing } = content;
    if (this.view.zoom <= base.scale * 1.02 || base.scale >= 1) return;
    let level = this.view.zoom >= 1 ? page : reduced(drawing, page, 2 ** -Math.floor(Math.log2(1 / this.view.zoom)));
    const seen = this.seen();
    const area = (/** @type {number} */ scale) => (seen.x1 - seen.x0) * (seen.y1 - seen.y0) * scale * scale;
    if (area(level.width / page.width) > MOST_PIXELS) level = reduced(drawing, page, Math.sqrt(MOST_PIXELS / area(1)));
    const across = level.width / page.width;
    const down = level.height / page.height;
    const enough = (/** @type {Pane} */ pane) => pane.scale >= across * 0.99 && pane.covers(seen);
    const found = this.details.find(enough);
    if (found) {
      found.used = performance.now();
      return;
    }
    // As much again around it as there is room for.
    const margin = Math.max(0, Math.min(0.3, (Math.sqrt(MOST_PIXELS / area(across)) - 1) / 2));
    const [mx, my] = [(seen.x1 - seen.x0) * margin, (seen.y1 - seen.y0) * margin];
    const x0 = Math.max(0, Math.floor((seen.x0 - mx) * across));
    const x1 = Math.min(level.width, Math.ceil((seen.x1 + mx) * across));
    const y0 = Math.max(0, Math.floor((seen.y0 - my) * down));
    const y1 = Math.min(level.height, Math.ceil((seen.y1 + my) * down));
    if (x0 >= x1 || y0 >= y1) return;
    const [width, height] = [x1 - x0, y1 - y0];
    const pane = new Pane({ x0: x0 / across, y0: y0 / down, x1: x1 / across, y1: y1 / down, width, height }, width, height);
    pane.used = performance.now();
    for (const other of this.details) if (!other.done) other.stop();
    this.details = this.details.filter((other) => other.done).sort((a, b) => b.used - a.used).slice(0, MOST_DETAILS);
    this.details.push(pane);
    this.#fill(pane, content.request({ ...level.query, lines: `${y0}..${y1}` }), { x0, y0, x1, y1, width, height }, false);
  }

  /** The first line in the view, and the one behind the last. */
  get linesSeen() {
    const { y0, y1 } = this.seen();
    return [Math.floor(y0), Math.ceil(y1)];
  }

  /** The part of the page in the view. */
  seen() {
    const { page } = /** @type {Content} */ (this.content);
    const { zoom, x, y } = this.view;
    const [x0, y0] = [Math.max(0, x), Math.max(0, y)];
    const x1 = Math.min(page.width, x + this.canvas.width / zoom);
    const y1 = Math.min(page.height, y + this.canvas.height / zoom);
    return { x0, y0, x1, y1, width: 0, height: 0 };
  }

  /**
   * Lights a shape: its bounds, in pixels of the page, and its fill.
   * @param {string} id
   * @param {number[] | undefined} box
   */
  light(id, box) {
    this.dark();
    const { content } = this;
    if (!content?.light) return;
    this.box = box;
    const base = this.baseRendering;
    const rect = { x0: 0, y0: 0, x1: content.page.width, y1: content.page.height, width: base.width, height: base.height };
    const pane = (this.lit = new Pane(rect, base.width, base.height));
    this.#fill(pane, content.light(id, base.query), { ...rect, x1: base.width, y1: base.height }, false, [255, 96, 64, 170]);
    this.redraw();
  }

  dark() {
    this.lit?.stop();
    this.lit = this.box = undefined;
    this.redraw();
  }

  fit() {
    this.fits = true;
    this.#fitView();
    this.#moved();
  }

  #fitView() {
    const { page } = /** @type {Content} */ (this.content);
    const zoom = this.#fitZoom();
    const base = this.baseRendering;
    // Whole device pixels: the base is then shown as it is.
    const scale = zoom >= 1 ? zoom : page.width >= page.height ? base.width / page.width : base.height / page.height;
    const left = Math.floor((this.canvas.width - page.width * scale) / 2);
    const top = Math.floor((this.canvas.height - page.height * scale) / 2);
    this.view = { zoom: scale, x: -left / scale, y: -top / scale };
  }

  /**
   * @param {number} factor
   * @param {number} [x] a place on the canvas that stays where it is, in device pixels
   * @param {number} [y]
   */
  zoomBy(factor, x = this.canvas.width / 2, y = this.canvas.height / 2) {
    if (!this.content) return;
    const least = this.#fitZoom() / 2;
    const { view } = this;
    const zoom = Math.min(MOST_ZOOM * this.ratio, Math.max(least, view.zoom * factor));
    const at = { x: view.x + x / view.zoom, y: view.y + y / view.zoom };
    this.view = { zoom, x: at.x - x / zoom, y: at.y - y / zoom };
    this.fits = false;
    this.#moved();
  }

  /** One pixel of the page in a few of the screen, around the one that is looked at. */
  pixels() {
    if (!this.content) return;
    const zoom = 12 * this.ratio;
    this.view = { zoom, x: this.probe.x + 0.5 - this.canvas.width / 2 / zoom, y: this.probe.y + 0.5 - this.canvas.height / 2 / zoom };
    this.fits = false;
    this.#moved();
  }

  /** @param {number} dx in device pixels @param {number} dy */
  pan(dx, dy) {
    const { zoom, x, y } = this.view;
    this.view = { zoom, x: x - dx / zoom, y: y - dy / zoom };
    this.fits = false;
    this.#moved();
  }

  #moved() {
    const { content, view } = this;
    if (!content) return;
    // Some of the page stays in sight.
    const [w, h] = [this.canvas.width / view.zoom, this.canvas.height / view.zoom];
    view.x = Math.min(Math.max(view.x, -w * 0.8), content.page.width - w * 0.2);
    view.y = Math.min(Math.max(view.y, -h * 0.8), content.page.height - h * 0.2);
    this.canvas.style.touchAction = this.fits ? "pan-y" : "none";
    clearTimeout(this.rest);
    this.rest = setTimeout(() => this.#detail(), REST);
    this.redraw();
    this.dispatchEvent(new Event("view"));
  }

  #resize() {
    this.ratio = devicePixelRatio;
    const { clientWidth, clientHeight } = this.canvas;
    const [width, height] = [Math.round(clientWidth * this.ratio), Math.round(clientHeight * this.ratio)];
    if (!width || !height || (width === this.canvas.width && height === this.canvas.height)) return;
    this.canvas.width = width;
    this.canvas.height = height;
    if (!this.content) return;
    if (this.fits) this.show(this.content);
    else this.#moved();
  }

  /**
   * Looks at a pixel of the page.
   * @param {number} x
   * @param {number} y
   * @param {boolean} [follow] whether the view goes with it
   */
  look(x, y, follow = false) {
    if (!this.content) return;
    const { page } = this.content;
    this.probe = { x: Math.min(Math.max(Math.floor(x), 0), page.width - 1), y: Math.min(Math.max(Math.floor(y), 0), page.height - 1) };
    if (follow) {
      const { zoom } = this.view;
      const [left, top] = [(this.probe.x - this.view.x) * zoom, (this.probe.y - this.view.y) * zoom];
      const over = (/** @type {number} */ at, /** @type {number} */ size) => (at < 0 ? at : at + zoom > size ? at + zoom - size : 0);
      const [dx, dy] = [over(left, this.canvas.width), over(top, this.canvas.height)];
      if (dx || dy) this.pan(-dx, -dy);
    }
    this.redraw();
    this.dispatchEvent(new Event("probe"));
  }

  /** Where a column of the page stands on the canvas, in CSS pixels. */
  left(/** @type {number} */ column) {
    return ((column - this.view.x) * this.view.zoom) / this.ratio;
  }

  redraw() {
    if (this.dirty) return;
    this.dirty = true;
    requestAnimationFrame(() => {
      this.dirty = false;
      paint(this);
    });
  }
}
