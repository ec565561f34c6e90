// How large the page becomes: what src/job/size.rs does, to know it before anything is drawn.

/**
 * What is asked: the mode is the name of the query's parameter, `box` stands for width and height.
 * @typedef {{ mode: "width" | "height" | "dpi" | "scale" | "box", first: number, second: number }} Size
 *
 * A page in pixels.
 * @typedef {{ width: number, height: number }} Page
 *
 * A page and the query that asks for it.
 * @typedef {Page & { query: Record<string, number> }} Rendering
 */

const UNITS_PER_INCH = 96;
const MOST_WIDTH = 1_048_576;
const MOST_HEIGHT = 8_388_608;

const whole = (/** @type {number} */ size) => Math.max(1, Math.floor(size * (1 + 8 * Number.EPSILON) + 0.5));

/**
 * The page that a size makes of a drawing of so many user units.
 * @param {Page} drawing
 * @param {Size} size
 * @returns {Rendering}
 */
export function rendering(drawing, { mode, first, second }) {
  if (mode === "box") return { width: first, height: second, query: { width: first, height: second } };
  const scale = { width: first / drawing.width, height: first / drawing.height, dpi: first / UNITS_PER_INCH, scale: first }[mode];
  const page = { width: whole(drawing.width * scale), height: whole(drawing.height * scale), query: { [mode]: first } };
  if (mode === "width") page.width = first;
  if (mode === "height") page.height = first;
  return page;
}

/**
 * What is wrong with a size, if anything is.
 * @param {Page} drawing
 * @param {Size} size
 * @returns {string | undefined}
 */
export function fault(drawing, size) {
  const wrong = outOfBounds(size);
  if (wrong) return wrong;
  const { width, height } = rendering(drawing, size);
  if (width <= MOST_WIDTH && height <= MOST_HEIGHT) return undefined;
  return `The page would have ${width} × ${height} px, at most ${MOST_WIDTH} × ${MOST_HEIGHT} are possible.`;
}

/** @param {Size} size */
function outOfBounds({ mode, first, second }) {
  const pixels = (/** @type {number} */ n, /** @type {number} */ most) => Number.isInteger(n) && n >= 1 && n <= most;
  if (mode === "width" && !pixels(first, MOST_WIDTH)) return `Give a whole number of pixels from 1 to ${MOST_WIDTH}.`;
  if (mode === "height" && !pixels(first, MOST_HEIGHT)) return `Give a whole number of pixels from 1 to ${MOST_HEIGHT}.`;
  if (mode === "box" && !(pixels(first, MOST_WIDTH) && pixels(second, MOST_HEIGHT))) {
    return `Give whole numbers of pixels, up to ${MOST_WIDTH} and ${MOST_HEIGHT}.`;
  }
  return first > 0 && Number.isFinite(first) ? undefined : "Give a number above 0.";
}

/**
 * The same page with fewer pixels: about `factor` times as many a side.
 * @param {Page} drawing
 * @param {Rendering} page
 * @param {number} factor up to 1; at 1 it is the page itself
 * @returns {Rendering}
 */
export function reduced(drawing, page, factor) {
  if (factor >= 1) return page;
  const width = Math.max(1, Math.round(page.width * factor));
  const height = Math.max(1, Math.round(page.height * factor));
  if (page.query.width && page.query.height) return { width, height, query: { width, height } };
  const by = page.width >= page.height ? /** @type {const} */ ("width") : /** @type {const} */ ("height");
  return rendering(drawing, { mode: by, first: by === "width" ? width : height, second: 0 });
}
