// The worker as the page uses it: an order with those who are told of it.

/** @typedef {import("./worker.js").Answer} Answer */

/**
 * @typedef {{
 *   header?: (header: Extract<Answer, { kind: "header" }>) => void,
 *   strip?: (strip: Extract<Answer, { kind: "strip" }>) => void,
 *   progress?: (progress: import("./worker.js").Progress) => void,
 *   done?: (progress: import("./worker.js").Progress, summed: boolean) => void,
 *   problem?: (problem: import("./worker.js").Details) => void,
 *   broken?: (what: string) => void,
 * }} Told
 */

const worker = new Worker(new URL("./worker.js", import.meta.url), { type: "module" });
/** @type {Map<number, Told>} */
const orders = new Map();
let last = 0;

worker.onmessage = ({ data }) => {
  const answer = /** @type {Answer} */ (data);
  const told = orders.get(answer.id);
  if (!told) return;
  if (answer.kind === "done" || answer.kind === "problem" || answer.kind === "broken") orders.delete(answer.id);
  if (answer.kind === "header") told.header?.(answer);
  if (answer.kind === "strip") told.strip?.(answer);
  if (answer.kind === "progress") told.progress?.(answer.progress);
  if (answer.kind === "done") told.done?.(answer.progress, answer.summed);
  if (answer.kind === "problem") told.problem?.(answer.problem);
  if (answer.kind === "broken") told.broken?.(answer.what);
};

/**
 * Has a raster drawn, strip by strip. What is given back stops it: nothing is told any more, and the connection is closed.
 * @param {import("./worker.js").Request} request
 * @param {Told} told
 * @param {{ target?: import("./worker.js").Target, tint?: number[] }} [options]
 */
export function drawRaster(request, told, { target, tint } = {}) {
  const id = ++last;
  orders.set(id, told);
  worker.postMessage({ kind: "draw", id, request, target, tint });
  return () => {
    if (orders.delete(id)) worker.postMessage({ kind: "cancel", id });
  };
}
