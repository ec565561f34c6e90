// What the page shows, in its address: a sample, a model or a job, the expression, the size. It stands behind #, so it is not sent anywhere.

/**
 * @typedef {{ sample: string, model: string, job: string, expr: string, size: import("./size.js").Size | undefined, format: string }} State
 */

const MODES = /** @type {const} */ (["width", "height", "dpi", "scale"]);

/** @returns {State} */
export function read() {
  const given = new URLSearchParams(location.hash.slice(1));
  /** @type {State["size"]} */
  let size;
  const [width, height] = [Number(given.get("width")), Number(given.get("height"))];
  if (width > 0 && height > 0) size = { mode: "box", first: width, second: height };
  else {
    const mode = MODES.find((mode) => Number(given.get(mode)) > 0);
    if (mode) size = { mode, first: Number(given.get(mode)), second: 0 };
  }
  return { sample: given.get("sample") ?? "", model: given.get("model") ?? "", job: given.get("job") ?? "", expr: given.get("expr") ?? "", size, format: given.get("format") ?? "" };
}

/** @param {Partial<State>} state @returns {string} the address */
export function written({ sample, model, job, expr, size, format }) {
  const given = new URLSearchParams();
  if (job) given.set("job", job);
  if (model) given.set("model", model);
  if (sample) given.set("sample", sample);
  if (expr) given.set("expr", expr);
  if (size?.mode === "box") {
    given.set("width", String(size.first));
    given.set("height", String(size.second));
  } else if (size) {
    given.set(size.mode, String(size.first));
  }
  if (format) given.set("format", format);
  const url = new URL(location.href);
  url.hash = given.toString();
  return url.href;
}
