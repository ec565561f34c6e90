// Draws a raster as it arrives: fetches an rls stream, and hands its lines on as strips of pixels.
//
//   stream --rls--> records --those rows and columns that are shown--> strips --> the page
//
// What is shown may be a part of the lines' columns, or fewer pixels than there are: a pixel shows the one page pixel that its centre is in.
// So a stream of any size costs a strip and a record.

import { Broken, Reader } from "./rls.js";

/**
 * The part of the page that is shown, in its pixels, and the size at which.
 * @typedef {{ x0: number, y0: number, x1: number, y1: number, width: number, height: number }} Target
 *
 * @typedef {{ url: string, method: string, headers: Record<string, string>, body?: Blob }} Request
 *
 * What is asked. `tint`: one colour for all inks, and paper is left clear.
 * @typedef {{ kind: "draw", id: number, request: Request, target?: Target, tint?: number[] } | { kind: "cancel", id: number }} Order
 *
 * How far a stream has come.
 * @typedef {{ lines: number, repeated: number, runs: number, bytes: number, ms: number, firstMs: number }} Progress
 *
 * @typedef {{ status: number, detail: string, line?: number, column?: number }} Details
 *
 * What is answered.
 * @typedef {{ id: number } & (
 *   | ({ kind: "header", warnings: string } & import("./rls.js").Header)
 *   | { kind: "strip", y: number, rows: number, pixels: Uint8ClampedArray<ArrayBuffer> }
 *   | { kind: "progress", progress: Progress }
 *   | { kind: "done", progress: Progress, summed: boolean }
 *   | { kind: "problem", problem: Details }
 *   | { kind: "broken", what: string }
 * )} Answer
 */

/** Rows of a strip at most. */
const STRIP = 256;

/** @type {Map<number, AbortController>} */
const underWay = new Map();

/** @param {Answer} answer @param {Transferable[]} [transfer] */
const say = (answer, transfer = []) => self.postMessage(answer, { transfer });

self.onmessage = ({ data }) => {
  const order = /** @type {Order} */ (data);
  if (order.kind === "cancel") underWay.get(order.id)?.abort();
  else void draw(order);
};

/** @param {Extract<Order, { kind: "draw" }>} order */
async function draw({ id, request, target, tint }) {
  const control = new AbortController();
  underWay.set(id, control);
  const began = performance.now();
  let answered = false;
  try {
    const response = await fetch(request.url, { ...request, signal: control.signal });
    answered = true;
    if (!response.ok || !response.body) {
      say({ id, kind: "problem", problem: await problem(response) });
      return;
    }
    const warnings = response.headers.get("runset-warning") ?? "";
    /** @type {Painter | undefined} */
    let painter;
    let firstMs = 0;
    let bytes = 0;
    const reader = new Reader(
      (header) => {
        const whole = { x0: 0, y0: header.from, x1: header.width, y1: header.to, width: header.width, height: header.to - header.from };
        painter = new Painter(id, target ?? whole, header, tint);
        say({ id, kind: "header", ...header, warnings });
      },
      (lines) => {
        if (!firstMs) firstMs = performance.now() - began;
        painter?.paint(lines);
      },
    );
    const progress = () => ({
      lines: reader.lines,
      repeated: reader.repeated,
      runs: reader.runs,
      bytes,
      ms: performance.now() - began,
      firstMs,
    });
    let told = began;
    for (const body = response.body.getReader(); ; ) {
      const { done, value } = await body.read();
      if (done) break;
      bytes += value.length;
      reader.push(value);
      painter?.flush();
      if (performance.now() - told > 50) {
        told = performance.now();
        say({ id, kind: "progress", progress: progress() });
      }
    }
    reader.finish();
    painter?.flush();
    say({ id, kind: "done", progress: progress(), summed: reader.summed });
  } catch (error) {
    if (control.signal.aborted) return;
    if (answered) say({ id, kind: "broken", what: error instanceof Broken ? error.message : "the connection broke off before the stream's end" });
    else say({ id, kind: "problem", problem: { status: 0, detail: "the service does not answer: is it running?" } });
    control.abort();
  } finally {
    underWay.delete(id);
  }
}

/** @param {Response} response @returns {Promise<Details>} */
async function problem(response) {
  try {
    return await response.json();
  } catch {
    return { status: response.status, detail: `the service answered ${response.status} ${response.statusText}` };
  }
}

/** Turns records into strips of pixels. */
class Painter {
  /**
   * @param {number} id
   * @param {Target} target
   * @param {import("./rls.js").Header} header
   * @param {number[]} [tint]
   */
  constructor(id, target, { inks, paper }, tint) {
    this.id = id;
    this.target = target;
    const word = (/** @type {number[]} */ [r, g, b, a = 255]) => ((a << 24) | (b << 16) | (g << 8) | r) >>> 0;
    this.paper = tint ? 0 : word(paper);
    const listed = inks && Uint32Array.from(inks, (ink) => word(tint ?? ink));
    /** The word of an ink. @type {(ink: number) => number} */
    this.word = listed ? (ink) => listed[ink] : tint ? () => word(tint) : (ink) => word([ink >> 16, (ink >> 8) & 255, ink & 255]);
    this.across = target.width / (target.x1 - target.x0);
    this.down = target.height / (target.y1 - target.y0);
    this.y = 0;
    this.rows = 0;
    this.strip = new Uint32Array(0);
  }

  /** The first shown column, or row, whose page pixel is not before that one. */
  static first(/** @type {number} */ at, /** @type {number} */ scale, /** @type {number} */ most) {
    return Math.min(Math.max(Math.ceil(at * scale - 0.5), 0), most);
  }

  /** @param {import("./rls.js").Lines} lines */
  paint({ y, n, count, runs }) {
    const { x0, y0, width, height } = this.target;
    const top = Painter.first(y - y0, this.down, height);
    const bottom = Painter.first(y + n - y0, this.down, height);
    for (let row = top; row < bottom; ) {
      if (this.rows === STRIP) this.flush();
      if (this.rows === 0) {
        this.y = row;
        this.strip = new Uint32Array(width * Math.min(STRIP, height - row));
      }
      const start = this.rows * width;
      const same = Math.min(bottom - row, STRIP - this.rows);
      this.strip.fill(this.paper, start, start + width);
      for (let i = 0; i < 3 * count; i += 3) {
        const left = Painter.first(runs[i] - x0, this.across, width);
        const right = Painter.first(runs[i + 1] - x0, this.across, width);
        if (left < right) this.strip.fill(this.word(runs[i + 2]), start + left, start + right);
        if (right === width) break;
      }
      for (let i = 1; i < same; i++) this.strip.copyWithin(start + i * width, start, start + width);
      this.rows += same;
      row += same;
    }
  }

  /** Hands on what there is. */
  flush() {
    if (this.rows === 0) return;
    const pixels = new Uint8ClampedArray(this.strip.buffer, 0, this.strip.byteOffset + 4 * this.rows * this.target.width);
    say({ id: this.id, kind: "strip", y: this.y, rows: this.rows, pixels }, [pixels.buffer]);
    this.rows = 0;
  }
}
