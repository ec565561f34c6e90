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
    this.#pointers();
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
    const seen = this.#seen();
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
    const { y0, y1 } = this.#seen();
    return [Math.floor(y0), Math.ceil(y1)];
  }

  /** The part of the page in the view. */
  #seen() {
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

  #pointers() {
    const { canvas } = this;
    /** @type {Map<number, { x: number, y: number }>} */
    const down = new Map();
    const at = (/** @type {MouseEvent} */ event) => ({ x: event.offsetX * this.ratio, y: event.offsetY * this.ratio });
    const look = (/** @type {MouseEvent} */ event) => {
      const { x, y } = at(event);
      this.look(this.view.x + x / this.view.zoom, this.view.y + y / this.view.zoom);
    };
    canvas.addEventListener("pointerdown", (event) => {
      down.set(event.pointerId, at(event));
      canvas.setPointerCapture(event.pointerId);
      look(event);
    });
    canvas.addEventListener("pointermove", (event) => {
      const from = down.get(event.pointerId);
      const to = at(event);
      if (!from) return look(event);
      if (down.size === 2) {
        const other = [...down].find(([id]) => id !== event.pointerId)?.[1] ?? to;
        const apart = (/** @type {{ x: number, y: number }} */ p) => Math.hypot(p.x - other.x, p.y - other.y) || 1;
        this.zoomBy(apart(to) / apart(from), (to.x + other.x) / 2, (to.y + other.y) / 2);
      } else if (event.pointerType !== "touch" || !this.fits) {
        this.pan(to.x - from.x, to.y - from.y);
      } else {
        look(event);
      }
      down.set(event.pointerId, to);
    });
    for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, (event) => down.delete(/** @type {PointerEvent} */ (event).pointerId));
    canvas.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        const { x, y } = at(event);
        if (event.shiftKey) this.pan(-event.deltaY * this.ratio, 0);
        else this.zoomBy(Math.exp(-event.deltaY / (event.deltaMode ? 20 : 400)), x, y);
      },
      { passive: false },
    );
    canvas.addEventListener("keydown", (event) => {
      const step = event.shiftKey ? 10 : 1;
      const { x, y } = this.probe;
      const keys = {
        ArrowUp: () => this.look(x, y - step, true),
        ArrowDown: () => this.look(x, y + step, true),
        ArrowLeft: () => this.look(x - step, y, true),
        ArrowRight: () => this.look(x + step, y, true),
        "+": () => this.zoomBy(1.5),
        "=": () => this.zoomBy(1.5),
        "-": () => this.zoomBy(1 / 1.5),
        0: () => this.fit(),
        1: () => this.pixels(),
      };
      if (event.ctrlKey || event.metaKey || event.altKey || !(event.key in keys)) return;
      event.preventDefault();
      keys[/** @type {keyof typeof keys} */ (event.key)]();
    });
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
    const { context: c, canvas, content, view } = this;
    c.setTransform(1, 0, 0, 1, 0, 0);
    c.clearRect(0, 0, canvas.width, canvas.height);
    if (!content) return;
    const { page } = content;
    const X = (/** @type {number} */ x) => Math.round((x - view.x) * view.zoom);
    const Y = (/** @type {number} */ y) => Math.round((y - view.y) * view.zoom);
    const [left, top, width, height] = [X(0), Y(0), X(page.width) - X(0), Y(page.height) - Y(0)];
    c.fillStyle = "#fff";
    c.fillRect(left, top, width, height);
    const put = (/** @type {Pane} */ { rect, canvas: from, front, scale }) => {
      if (!front) return;
      c.imageSmoothingEnabled = scale > view.zoom * 1.01;
      const [w, h] = [X(rect.x1) - X(rect.x0), Y(rect.y1) - Y(rect.y0)];
      // A pane for this very zoom is shown pixel by pixel, although both of its sides were rounded.
      const own = Math.abs(w - from.width) <= 1 && Math.abs(h - from.height) <= 1;
      c.drawImage(from, X(rect.x0), Y(rect.y0), own ? from.width : w, own ? from.height : h);
    };
    if (this.before) put(this.before);
    if (this.base) put(this.base);
    for (const pane of [...this.details].sort((a, b) => a.scale - b.scale)) if (pane.scale <= view.zoom * 4.1) put(pane);
    this.#paintKinds(left, width, Y);
    if (this.lit) put(this.lit);
    if (this.box) {
      const [x0, y0, x1, y1] = this.box;
      c.lineWidth = this.ratio;
      c.strokeStyle = "#e4472f";
      c.setLineDash([4 * this.ratio, 3 * this.ratio]);
      c.strokeRect(X(x0) - 0.5, Y(y0) - 0.5, X(x1) - X(x0) + 1, Y(y1) - Y(y0) + 1);
      c.setLineDash([]);
    }
    if (view.zoom >= 10 * this.ratio) this.#paintGrid(X, Y);
    if (this.base && !this.base.done && this.base.front) {
      const y = Y((this.base.front / this.base.canvas.height) * page.height);
      c.fillStyle = "#e4472f";
      c.fillRect(left, y, width, Math.max(1, Math.round(this.ratio)));
    }
    this.#paintProbe(left, width, X, Y);
  }

  /**
   * How the lines came about: beside the page, and over it if that is wanted.
   * @param {number} left @param {number} width @param {(y: number) => number} Y
   */
  #paintKinds(left, width, Y) {
    if (!this.kinds) return;
    const { context: c } = this;
    const { kinds, scale } = this.kinds;
    const colours = { counted: "228 71 47", unordered: "150 60 160", carried: "31 128 136", repeated: "232 170 60" };
    const bar = Math.round(5 * this.ratio);
    for (const { y, n, how } of kinds) {
      const [y0, y1] = [Y(y / scale), Y((y + n) / scale)];
      if (y1 < 0 || y0 > this.canvas.height) continue;
      const colour = colours[/** @type {keyof typeof colours} */ (how)];
      c.fillStyle = `rgb(${colour})`;
      c.fillRect(left - 2 * bar, y0, bar, Math.max(y1 - y0, 1));
      if (this.tint) {
        c.fillStyle = `rgb(${colour} / 0.32)`;
        c.fillRect(left, y0, width, Math.max(y1 - y0, 1));
      }
    }
  }

  /** @param {(x: number) => number} X @param {(y: number) => number} Y */
  #paintGrid(X, Y) {
    const { context: c } = this;
    const { x0, y0, x1, y1 } = this.#seen();
    c.fillStyle = "rgb(20 33 61 / 0.14)";
    for (let x = Math.ceil(x0); x <= x1; x++) c.fillRect(X(x), Y(y0), 1, Y(y1) - Y(y0));
    for (let y = Math.ceil(y0); y <= y1; y++) c.fillRect(X(x0), Y(y), X(x1) - X(x0), 1);
  }

  /**
   * The scanline that is looked at, through the centres of its pixels.
   * @param {number} left @param {number} width @param {(x: number) => number} X @param {(y: number) => number} Y
   */
  #paintProbe(left, width, X, Y) {
    const { context: c, probe, ratio } = this;
    const thin = Math.max(1, Math.round(ratio));
    const y = Y(probe.y + 0.5);
    c.fillStyle = "rgb(255 255 255 / 0.6)";
    c.fillRect(left - 12 * ratio, y - thin, width + 24 * ratio, 3 * thin);
    c.fillStyle = "#c23a22";
    c.fillRect(left - 12 * ratio, y, width + 24 * ratio, thin);
    const x = X(probe.x + 0.5);
    c.beginPath();
    c.arc(x, y + thin / 2, 4 * ratio, 0, 7);
    c.fillStyle = "#c23a22";
    c.fill();
    c.lineWidth = 1.5 * ratio;
    c.strokeStyle = "#fff";
    c.stroke();
  }
}
