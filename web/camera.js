// Where a model is seen from, as the service has its cameras: around a point, turned and tilted, at a distance.

/** @typedef {[number, number, number]} Vector */

/** Half of the vertical field of view, as the service has it. */
const HALF = ((22.5 / 2) * Math.PI) / 180;

/** @param {Vector} a @param {Vector} b @param {number} by @returns {Vector} a and so many times b */
export const plus = (a, b, by = 1) => [a[0] + b[0] * by, a[1] + b[1] * by, a[2] + b[2] * by];

/** @param {Vector} a @param {Vector} b */
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

export class Camera {
  constructor() {
    /** @type {Vector} the point that is looked at */
    this.target = [0, 0, 0];
    this.turn = 25;
    this.tilt = 55;
    this.far = 140;
    this.orthographic = false;
    /** The size of what is seen. */
    this.size = 1;
  }

  /**
   * Goes to where all of a model is seen; without bounds it is empty.
   * @param {[number[], number[]] | null} bounds @param {{ width: number, height: number }} page
   */
  fit(bounds, { width, height }) {
    const [least, most] = bounds ?? [[0, 0, 0], [1, 1, 1]];
    this.size = Math.max(Math.hypot(...most.map((x, i) => x - least[i])), 1e-300);
    this.target = /** @type {Vector} */ (least.map((x, i) => (x + most[i]) / 2));
    // The field of view is that of the height: a page that is higher than wide sees less across.
    this.far = (this.size / 2 / Math.sin(HALF)) * Math.max(height / width, 1);
  }

  /** As a query gives it. */
  get text() {
    return [...this.target, this.tilt, 0, this.turn, this.far].join(",");
  }

  /** Unit vectors to the right, down and forward. @returns {[Vector, Vector, Vector]} */
  get axes() {
    const [t, u] = [(this.tilt * Math.PI) / 180, (this.turn * Math.PI) / 180];
    const turned = (/** @type {number} */ x, /** @type {number} */ y, /** @type {number} */ z) =>
      /** @type {Vector} */ ([x * Math.cos(u) - y * Math.sin(u), x * Math.sin(u) + y * Math.cos(u), z]);
    return [turned(1, 0, 0), turned(0, -Math.cos(t), -Math.sin(t)), turned(0, Math.sin(t), -Math.cos(t))];
  }

  /** How far apart pixels of a page of that height are, in the model's units, so far along the view. @param {number} height */
  pixel(height, depth = this.far) {
    return ((this.orthographic ? this.far : depth) * 2 * Math.tan(HALF)) / height;
  }

  /** Around and around; over the poles it does not go. @param {number} turn in degrees @param {number} tilt */
  orbit(turn, tilt) {
    this.turn = ((((this.turn + turn + 180) % 360) + 360) % 360) - 180;
    this.tilt = Math.min(Math.max(this.tilt + tilt, 0), 180);
  }

  /** Shifts what is seen by so many pixels of a page of that height. @param {number} dx @param {number} dy @param {number} height */
  pan(dx, dy, height) {
    const [right, down] = this.axes;
    const pixel = this.pixel(height);
    this.target = plus(plus(this.target, right, -dx * pixel), down, -dy * pixel);
  }

  /**
   * Goes nearer, or away; what is seen there, so many pixels from the middle of a page of that height, stays there.
   * @param {number} factor @param {number} dx @param {number} dy @param {number} height
   */
  zoom(factor, dx, dy, height) {
    const before = this.pixel(height);
    this.far = Math.min(Math.max(this.far / factor, this.size * 1e-3), this.size * 1e3);
    const by = before - this.pixel(height);
    const [right, down] = this.axes;
    this.target = plus(plus(this.target, right, dx * by), down, dy * by);
  }

  /**
   * How far something goes that is dragged by so many pixels at a depth: in the plane of the screen, or along the axis that lies nearest to it.
   * @param {number} dx @param {number} dy @param {number} height @param {number} depth @param {boolean} axis
   * @returns {Vector}
   */
  dragged(dx, dy, height, depth, axis) {
    const [right, down] = this.axes;
    const pixel = this.pixel(height, depth);
    const round = (/** @type {Vector} */ v) => /** @type {Vector} */ (v.map((x) => rounded(x, pixel)));
    const free = plus(plus([0, 0, 0], right, dx * pixel), down, dy * pixel);
    if (!axis) return round(free);
    const seen = [0, 1, 2].map((i) => Math.hypot(right[i], down[i]));
    const along = [0, 1, 2].map((i) => (seen[i] > 0.05 ? Math.abs(free[i]) / seen[i] : 0));
    const best = along.indexOf(Math.max(...along));
    return round(/** @type {Vector} */ ([0, 1, 2].map((i) => (i === best && seen[i] ? free[i] / seen[i] ** 2 : 0))));
  }
}

/** A number that is short in decimals, and off by less than a tenth of a pixel. @param {number} x @param {number} pixel */
function rounded(x, pixel) {
  const digits = Math.min(Math.max(1 - Math.floor(Math.log10(pixel)), 0), 20);
  return Number(x.toFixed(digits)) + 0;
}
