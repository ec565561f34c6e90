// What the stream and the service tell of the lines: figures, how they came about, and the one that is looked at.

import { at, bytes, make, number, problem, time } from "./dom.js";
import { askForToken, call } from "./api.js";
import { desk, drawn, expression, scanline, stage } from "./desk.js";
import { named } from "./expression.js";

/** Lines whose history is asked for at once. */
const MOST_TOLD = 8192;

/** The pointer rests when it has not moved for so long, in ms. */
const REST = 25;

/** @type {Map<string, HTMLElement>} */
const figures = new Map();
for (const name of ["Lines", "Lines a second", "Runs", "Bytes", "First line", "Counted", "Carried", "Repeated", "Checksum"]) {
  const value = make("dd", {}, "\u2013");
  figures.set(name, value);
  at("stats").append(make("div", { class: name.toLowerCase().replaceAll(" ", "-") }, make("dt", {}, name), value));
}
/** @param {string} name @param {string} value */
const figure = (name, value) => {
  const element = /** @type {HTMLElement} */ (figures.get(name));
  if (element.textContent !== value) element.textContent = value;
};

let lines = 0;

stage.addEventListener("begun", () => {
  problem("stream-problem");
  figures.forEach((_, name) => figure(name, "\u2013"));
  at("view").classList.add("busy");
});
stage.addEventListener("header", (event) => {
  const { from, to, warnings } = /** @type {CustomEvent} */ (event).detail;
  lines = to - from;
  // What the document itself is warned of stands beside it already.
  const fresh = (desk.drawing?.warnings ?? []).reduce((text, known) => text.replace(known, ""), warnings).replace(/^[,\s]+/, "");
  if (fresh && !desk.job) problem("stream-problem", fresh);
});
stage.addEventListener("first", (event) => {
  const { ms } = /** @type {CustomEvent} */ (event).detail;
  figure("First line", time(ms));
  at("canvas").dataset.firstLine = String(Math.round(ms));
});
stage.addEventListener("progress", (event) => {
  const { progress, done, summed } = /** @type {CustomEvent} */ (event).detail;
  figure("Lines", done ? number(lines) : `${number(progress.lines)} of ${number(lines)}`);
  figure("Lines a second", number(Math.round(progress.lines / Math.max(progress.ms / 1000, 0.001))));
  figure("Runs", number(progress.runs));
  figure("Bytes", bytes(progress.bytes));
  if (!done) return;
  at("view").classList.remove("busy");
  at("canvas").dataset.done = String(Number(at("canvas").dataset.done ?? 0) + 1);
  figure("Checksum", summed ? "right" : "not summed");
  if (!desk.job) void tellKinds();
});
stage.addEventListener("problem", (event) => {
  const { status, detail, line, column } = /** @type {CustomEvent<import("./worker.js").Details>} */ (event).detail;
  at("view").classList.remove("busy");
  if (status === 401) return askForToken();
  if (detail.startsWith("expr: ")) expression.wrong(detail.slice(6), line, column);
  else problem("stream-problem", desk.drawing && line ? `${desk.drawing.name}:${line}:${column}: ${detail}` : detail);
});
stage.addEventListener("broken", (event) => {
  at("view").classList.remove("busy");
  problem("stream-problem", `Broken: ${/** @type {CustomEvent} */ (event).detail.what}.`);
});

// --- how lines came about

/** @type {AbortController | undefined} */
let asking;
let resting = 0;

/** Asks about the scanline that is looked at, when the pointer rests. */
export function explain() {
  clearTimeout(resting);
  resting = setTimeout(async () => {
    asking?.abort();
    const control = (asking = new AbortController());
    const page = drawn();
    if (!desk.drawing || !page || !stage.content) return;
    const { y } = stage.probe;
    const { blob: body, media } = desk.drawing;
    const { followed } = desk;
    const ask = async (/** @type {string} */ expr) => {
      const query = { ...page.query, expr, lines: `${y}..${y + 1}` };
      return (await call("v1/explain", { method: "POST", query, body, headers: { "Content-Type": media }, signal: control.signal })).json();
    };
    try {
      const [told, other] = await Promise.all([ask(expression.text), followed ? ask(named(followed)) : undefined]);
      if (!control.signal.aborted) scanline.show(told, other && { id: followed, told: other });
    } catch {
      // The stream says what is wrong.
      if (!control.signal.aborted) scanline.show(undefined);
    }
  }, REST);
}
stage.addEventListener("probe", explain);

/** @type {AbortController | undefined} */
let telling;
/** @type {{ content: import("./stage.js").Content, kinds: import("./stage.js").Kinds, scale: number } | undefined} those of the fitted view */
let fitted;

/**
 * Asks how the lines of a rendering came about, all of them or some.
 * @param {import("./size.js").Rendering} of @param {string} [lines]
 * @returns {Promise<import("./stage.js").Kinds | undefined>} nothing if something else is shown by now
 */
async function kindsOf(of, lines) {
  const { content } = stage;
  const { drawing } = desk;
  if (!content || !drawing) return undefined;
  telling?.abort();
  const { signal } = (telling = new AbortController());
  try {
    const query = { ...of.query, expr: expression.text, lines };
    const told = await (await call("v1/explain", { method: "POST", query, body: drawing.blob, headers: { "Content-Type": drawing.media }, signal })).json();
    if (stage.content !== content) return undefined;
    return told.lines.map((/** @type {[number, number, string]} */ [y, n, how]) => ({ y, n, how }));
  } catch {
    // Only a tint is missing.
    return undefined;
  }
}

/** Tells of the lines of the fitted view. */
async function tellKinds() {
  const { content } = stage;
  if (!content || !desk.drawing) return;
  const base = stage.baseRendering;
  const kinds = base.height > MOST_TOLD ? undefined : await kindsOf(base);
  if (!kinds) return;
  fitted = { content, kinds, scale: base.height / content.page.height };
  stage.kinds = fitted;
  const sum = (/** @type {string[]} */ ...hows) => kinds.reduce((all, { n, how }) => all + (hows.includes(how) ? n : 0), 0);
  figure("Counted", number(sum("counted", "unordered")));
  figure("Carried", number(sum("carried")));
  figure("Repeated", number(sum("repeated")));
  stage.redraw();
}

let moving = 0;
// Where single pixels are seen, the lines are those of the whole page.
stage.addEventListener("view", () => {
  clearTimeout(moving);
  moving = setTimeout(async () => {
    const { content, view } = stage;
    if (!content || content.whole || fitted?.content !== content || fitted.scale >= 1) return;
    const [from, to] = stage.linesSeen;
    const close = view.zoom >= 1 && to - from <= MOST_TOLD && to > from;
    const kinds = close ? await kindsOf(content.page, `${from}..${to}`) : undefined;
    if (close && !kinds) return;
    stage.kinds = kinds ? { kinds, scale: 1 } : fitted;
    stage.redraw();
  }, 150);
});
