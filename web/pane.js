// A pane: a rectangle of the page, drawn at some resolution, line by line as it arrives.

/** Pixels of a pane at most; 4 bytes each. */
export const MOST_PIXELS = 6_000_000;

export class Pane {
  /**
   * @param {import("./worker.js").Target} rect the part of the page, in its pixels, that the pane shows
   * @param {number} width in pixels of the pane
   * @param {number} height
   */
  constructor(rect, width, height) {
    this.rect = rect;
    this.canvas = new OffscreenCanvas(width, height);
    this.context = /** @type {OffscreenCanvasRenderingContext2D} */ (this.canvas.getContext("2d"));
    /** Rows that are there. */
    this.front = 0;
    this.done = false;
    /** When it was shown last. */
    this.used = 0;
    /** @type {() => void} */
    this.stop = () => {};
  }

  /** Pixels of the pane to one of the page. */
  get scale() {
    return this.canvas.width / (this.rect.x1 - this.rect.x0);
  }

  /** @param {{ y: number, rows: number, pixels: Uint8ClampedArray<ArrayBuffer> }} strip */
  put({ y, rows, pixels }) {
    this.context.putImageData(new ImageData(pixels, this.canvas.width, rows), 0, y);
    this.front = y + rows;
  }

  /** @param {import("./worker.js").Target} seen */
  covers({ x0, y0, x1, y1 }) {
    const near = 1 / this.scale;
    return this.rect.x0 <= x0 + near && this.rect.y0 <= y0 + near && this.rect.x1 >= x1 - near && this.rect.y1 >= y1 - near;
  }
}
