// What a move writes into the text of a model: a matrix around the statement that was moved.

/** @typedef {import("./camera.js").Vector} Vector */

/**
 * The end of what is skipped from an index on: a string or a comment; the index itself if neither begins there.
 * @param {string} text @param {number} at
 */
function skipped(text, at) {
  const rest = text.slice(at, at + 2);
  const past = (/** @type {string} */ end) => {
    const found = text.indexOf(end, at + 2);
    return found < 0 ? text.length : found + end.length;
  };
  if (rest === "//") return past("\n");
  if (rest === "/*") return past("*/");
  if (text[at] !== '"') return at;
  let end = at + 1;
  while (end < text.length && text[end] !== '"') end += text[end] === "\\" ? 2 : 1;
  return end + 1;
}

/**
 * The index behind the statement that begins at one: behind its semicolon or its block.
 * @param {string} text @param {number} start
 */
export function statementEnd(text, start) {
  let depth = 0;
  for (let at = start; at < text.length; at++) {
    const past = skipped(text, at);
    if (past > at) {
      at = past - 1;
      continue;
    }
    if ("([{".includes(text[at])) depth++;
    if (")]}".includes(text[at])) depth--;
    if (depth < 0) return at;
    if (depth === 0 && (text[at] === ";" || text[at] === "}")) return at + 1;
  }
  return text.length;
}

const NUMBER = "(-?[\\d.]+(?:e[-+]?\\d+)?)";
const shift = (/** @type {string[]} */ [x, y, z]) => `multmatrix([[1, 0, 0, ${x}], [0, 1, 0, ${y}], [0, 0, 1, ${z}], [0, 0, 0, 1]]) { `;
const WRAPPED = new RegExp(`${shift(["X", "X", "X"]).replace(/[[\](){}]/g, "\\$&").replaceAll("X", NUMBER)}$`);

/** The vector that a matrix takes to a given one, if there is one. @param {number[][]} m @param {Vector} v @returns {Vector | undefined} */
export function before(m, v) {
  const [a, b, c] = [0, 1, 2].map((j) => [m[0][j], m[1][j], m[2][j]]);
  const cross = (/** @type {number[]} */ p, /** @type {number[]} */ q) => [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
  const times = (/** @type {number[]} */ p, /** @type {number[]} */ q) => p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
  const rows = [cross(b, c), cross(c, a), cross(a, b)];
  const volume = times(a, rows[0]);
  const found = /** @type {Vector} */ (rows.map((row) => times(row, v) / volume));
  return found.every(Number.isFinite) ? found : undefined;
}

/** A number as it is written: no longer than it takes. @param {number} x */
const written = (x) => String(Number(x.toPrecision(14)) + 0);

/**
 * What is written where, so that a statement's shape is moved: into the matrix of the move before, or into a new one.
 * @param {string} text
 * @param {number} start where the statement begins
 * @param {number[][]} matrix from the shape's own coordinates to the model's
 * @param {Vector} by in the model's coordinates
 * @returns {{ start: number, end: number, text: string } | undefined} none where no move within the matrices around it does that
 */
export function move(text, start, matrix, by) {
  const own = before(matrix, by);
  if (!own) return undefined;
  const end = statementEnd(text, start);
  const wrapped = WRAPPED.exec(text.slice(0, start));
  if (wrapped && /^ \}/.test(text.slice(end))) {
    const sum = own.map((x, i) => written(x + Number(wrapped[i + 1])));
    return { start: wrapped.index, end: start, text: shift(sum) };
  }
  return { start, end, text: `${shift(own.map(written))}${text.slice(start, end)} }` };
}
