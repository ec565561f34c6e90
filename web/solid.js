// The tab of models: text, picture, and what joins them. A click shows a primitive in the text; a primitive that is dragged is moved in the text.

import { at, bytes, make, problem } from "./dom.js";
import { askForToken, call, description } from "./api.js";
import * as state from "./address.js";
import { Camera } from "./camera.js";
import { input, select } from "./desk.js";
import { Editor } from "./editor.js";
import * as models from "./model.js";
import { move } from "./moves.js";
import { offset } from "./places.js";
import { MODELS } from "./samples.js";
import { Section } from "./section.js";
import { Sight } from "./sight.js";
import { listen } from "./solid-hands.js";
import { tab, tabs } from "./tabs.js";

/** The text is read when nothing was typed for so long, in ms. */
const TYPED = 250;
/** Keys that move a primitive are one move until they rest for so long, in ms. */
const NUDGED = 500;

const editor = new Editor();
const camera = new Camera();
const section = new Section();
const sight = new Sight(/** @type {HTMLCanvasElement} */ (at("solid-canvas")));

/** @type {models.Model | undefined} */
let model;
let loads = 0;
/** A sample's name, for the address. */
let sample = "";

/**
 * What is dragged: the primitive, once the service has told it, and how far.
 * @type {{ picked?: models.Picked, dx: number, dy: number, axis: boolean, by: import("./camera.js").Vector } | undefined}
 */
let held;
/** @type {models.Picked | null} the primitive that was pointed at last */
let chosen = null;

// --- pictures

/** What the view is, but for its size and for moves. @returns {Record<string, string>} */
function view() {
  return { camera: camera.text, projection: camera.orthographic ? "o" : "p", colorscheme: select("solid-scheme").value, ...section.query };
}

/** @param {boolean} moving */
function show(moving) {
  const shown = model;
  if (!shown) return sight.show(undefined, false);
  const moves = held?.picked && held.by.some((x) => x !== 0) ? [[held.picked.primitive, ...held.by].join(",")] : [];
  sight.show({ model: shown.kept.id, view: view(), moves, fine: fine(), request: (query) => models.picture(shown, query) }, moving);
}

/** What the picture has more when it rests. @returns {Record<string, string>} */
function fine() {
  /** @type {Record<string, string>} */
  const more = {};
  for (const field of at("solid-fine").querySelectorAll("select")) if (field.value) more[field.name] = field.value;
  return more;
}

// --- models

/** @param {string} name @param {Blob} blob */
export async function open(name, blob) {
  const load = ++loads;
  sample = "";
  select("solid-sample").value = "";
  await take(name, blob, load);
}

/** @param {string} name */
export async function openSample(name) {
  const load = ++loads;
  const found = MODELS.find((model) => model.name === name) ?? MODELS[0];
  try {
    const blob = await (await call(`samples/${found.name}`)).blob();
    if (load !== loads) return;
    sample = select("solid-sample").value = found.name;
    await take(found.name, blob, load);
  } catch (error) {
    problem("solid-problem", /** @type {Error} */ (error).message);
  }
}

/** @param {string} name @param {Blob} blob @param {number} load */
async function take(name, blob, load) {
  const text = models.isStl(name) ? "" : await blob.text();
  if (load !== loads) return;
  editor.text = text;
  editor.input.disabled = models.isStl(name);
  at("solid-note").textContent = `${name}, ${bytes(blob.size)}: reading\u2026`;
  model = undefined;
  choose(null);
  await read(name, blob, load, true);
}

/** Has the text read, and shown. @param {string} name @param {Blob} blob @param {number} load @param {boolean} fits */
async function read(name, blob, load, fits) {
  try {
    const kept = await models.keep(name, blob);
    if (load !== loads) return;
    model = kept;
    problem("solid-problem");
    if (editor.input.hasAttribute("aria-invalid")) editor.mark(0);
    at("solid-note").textContent = models.told(kept);
    section.bounds = kept.kept.bounds;
    if (fits) camera.fit(kept.kept.bounds, sight.size);
    held = undefined;
    remember();
    show(false);
  } catch (error) {
    if (load !== loads) return;
    const { status, message, line, column } = /** @type {import("./api.js").Problem} */ (error);
    held = undefined;
    if (model) show(false);
    if (status === 401) return;
    at("solid-note").textContent = model ? `The picture is of the text before.` : "";
    problem("solid-problem", `${name}${line ? `:${line}:${column}` : ""}: ${message}`);
    if (line) editor.mark(line, true);
  }
}

let typing = 0;
/** Reads the text as it is. */
function reread() {
  clearTimeout(typing);
  const name = model?.name ?? (sample || "model.csg");
  void read(name, new Blob([editor.text], { type: "text/plain" }), ++loads, !model);
}
editor.addEventListener("edit", () => {
  clearTimeout(typing);
  typing = setTimeout(reread, TYPED);
});

/** The address says which sample is shown. */
function remember() {
  if (tab() !== "solid") return;
  history.replaceState(null, "", state.written({ model: sample || "own" }));
  document.title = `${model?.name ?? "3-D"}, runset`;
}

// --- pointing and dragging

/** What pixel is at that place, as of a picture of all pixels of the canvas. @param {number} x @param {number} y @returns {Promise<models.Picked | null>} */
async function picked(x, y) {
  const { width, height } = sight.size;
  if (!model || x < 0 || y < 0 || x >= width || y >= height) return null;
  return models.pick(model, [["x", String(Math.floor(x))], ["y", String(Math.floor(y))], ["imgsize", `${width},${height}`], ...Object.entries(view())]);
}

/** @param {models.Picked | null} found */
function choose(found) {
  chosen = found;
  if (!found) {
    at("picked").textContent = model ? "The background. Click a part to see where it stands in the text." : "";
    if (!editor.input.hasAttribute("aria-invalid")) editor.mark(0);
    return;
  }
  const { kind, primitive, line, inside, point } = found;
  const where = point.map((x) => Number(x.toPrecision(5))).join(", ");
  at("picked").textContent = `${kind}${line ? `, line ${line}` : ""}: primitive ${primitive}, ${inside ? "taken away here, " : ""}at ${where}`;
  if (line && found.column) editor.select(line, found.column);
}

/** What goes wrong beside a picture. @param {unknown} error */
const failed = (error) => problem("sight-problem", /** @type {Error} */ (error).message);

function dragged() {
  if (!held?.picked) return;
  held.by = camera.dragged(held.dx, held.dy, sight.size.height, held.picked.depth, held.axis);
  show(true);
}

/** Writes a move into the text, and has it read. */
function commit() {
  const { picked: found, by } = /** @type {NonNullable<typeof held>} */ (held);
  if (!found?.line || !found.column || by.every((x) => x === 0)) return release();
  const change = move(editor.text, offset(editor.text, found.line, found.column), found.matrix, by);
  if (!change) {
    problem("sight-problem", "The matrices around this primitive flatten it: no move within them does that.");
    return release();
  }
  editor.write(change);
  // Where the statement stands by now.
  const start = change.text.indexOf(") { ") + 4 + change.start;
  const before = editor.text.slice(0, start).split("\n");
  chosen = { ...found, line: before.length, column: [...before[before.length - 1]].length + 1, point: /** @type {import("./camera.js").Vector} */ (found.point.map((x, i) => x + by[i])) };
  choose(chosen);
  reread();
}

function release() {
  held = undefined;
  show(false);
}

let nudging = 0;

listen(sight.canvas, () => sight.ratio, {
  orbit: (turn, tilt) => (camera.orbit(turn, tilt), show(true)),
  pan: (dx, dy) => (camera.pan(dx, dy, sight.size.height), show(true)),
  zoom: (factor, x, y) => {
    const { width, height } = sight.size;
    camera.zoom(factor, x - width / 2, y - height / 2, height);
    show(true);
  },
  fit,
  point: (x, y) => void picked(x, y).then(choose, failed),
  grab: (x, y) => {
    /** @type {NonNullable<typeof held>} */
    const own = (held = { dx: 0, dy: 0, axis: false, by: [0, 0, 0] });
    picked(x, y).then((found) => {
      if (found && !found.line) return problem("sight-problem", "An STL has no text in which a part could be moved.");
      own.picked = found ?? undefined;
      if (held !== own) return;
      if (found) choose(found);
      dragged();
    }, failed);
  },
  drag: (dx, dy, axis) => {
    if (!held) return;
    Object.assign(held, { dx, dy, axis });
    dragged();
  },
  drop: (keep) => {
    if (!held) return;
    clearTimeout(nudging);
    if (keep && held.picked) commit();
    else release();
  },
  nudge: (dx, dy, axis) => {
    if (!chosen?.line) return void (at("picked").textContent = "Point at a part first: Enter takes the one in the middle.");
    held ??= { picked: chosen, dx: 0, dy: 0, axis, by: [0, 0, 0] };
    Object.assign(held, { dx: held.dx + dx, dy: held.dy + dy, axis });
    dragged();
    clearTimeout(nudging);
    nudging = setTimeout(() => held && commit(), NUDGED);
  },
  section: (axis) => section.toggle(axis),
  slide: (by) => section.slide(by),
  mode: () => at("solid-move").click(),
  undo: (which) => editor.take(which),
  moves: () => at("solid-move").getAttribute("aria-pressed") === "true",
});

// --- controls

function fit() {
  camera.fit(model?.kept.bounds ?? null, sight.size);
  show(false);
}

const middle = (/** @type {number} */ factor) => {
  camera.zoom(factor, 0, 0, sight.size.height);
  show(true);
};
at("solid-zoom-in").addEventListener("click", () => middle(1.25));
at("solid-zoom-out").addEventListener("click", () => middle(1 / 1.25));
at("solid-fit").addEventListener("click", fit);
at("solid-move").addEventListener("click", () => {
  const on = at("solid-move").getAttribute("aria-pressed") !== "true";
  at("solid-move").setAttribute("aria-pressed", String(on));
  sight.canvas.classList.toggle("moves", on);
});
select("solid-projection").addEventListener("change", () => {
  camera.orthographic = select("solid-projection").value === "o";
  show(false);
});
select("solid-scheme").addEventListener("change", () => show(false));
section.addEventListener("change", () => show(true));
at("solid-fine").addEventListener("change", () => {
  sight.finer = undefined;
  show(false);
});

select("solid-sample").append(make("option", { value: "", disabled: "", hidden: "" }, "your own"), ...MODELS.map(({ name, title }) => make("option", { value: name }, title)));
select("solid-sample").addEventListener("change", () => void openSample(select("solid-sample").value));
at("solid-open").addEventListener("click", () => input("file").click());

// --- what the picture tells

sight.addEventListener("frame", (event) => {
  const frame = /** @type {CustomEvent<import("./sight.js").Frame>} */ (event).detail;
  problem("sight-problem");
  again = "";
  const { ms, lines, width, height, patch } = frame;
  at("solid-level").textContent = `${width} × ${height}, ${patch ? `${lines} lines, ` : ""}${ms < 10 ? ms.toFixed(1) : Math.round(ms)} ms`;
  sight.canvas.dispatchEvent(new CustomEvent("frame", { detail: frame }));
});
sight.addEventListener("rest", () => {
  sight.canvas.dataset.done = String(Number(sight.canvas.dataset.done ?? 0) + 1);
});
sight.addEventListener("broken", (event) => problem("sight-problem", `Broken: ${/** @type {CustomEvent} */ (event).detail}.`));

// A model that had to make room for others is sent again, once.
let again = "";
sight.addEventListener("problem", async (event) => {
  const { status, detail } = /** @type {CustomEvent<import("./worker.js").Details>} */ (event).detail;
  if (status === 401) return askForToken();
  if (!model || status !== 404 || again === model.kept.id) return problem("sight-problem", detail);
  again = model.kept.id;
  const { name, blob } = model;
  try {
    await models.keep(name, blob);
    show(false);
  } catch (error) {
    failed(error);
  }
});

// --- start

/** Lists what the service has: colours, and what makes a picture finer. */
async function offers() {
  const api = await description();
  /** @type {{ name: string, schema: { enum?: string[], maximum?: number, type?: string | string[] } }[]} */
  const parameters = api.paths["/v1/models/{id}/view"].get.parameters;
  const schemes = parameters.find(({ name }) => name === "colorscheme")?.schema.enum ?? [];
  select("solid-scheme").replaceChildren(...schemes.map((name) => make("option", { value: name }, name)));
  const known = new Set(parameters.map(({ name }) => name));
  for (const field of at("solid-fine").querySelectorAll("select")) {
    const offered = known.has(field.name);
    /** @type {HTMLElement} */ (field.parentElement).hidden = !offered;
    if (!offered) field.value = "";
  }
  at("solid-fine").hidden = ![...at("solid-fine").querySelectorAll("select")].some((field) => known.has(field.name));
}
let offered = false;

tabs.addEventListener("show", async () => {
  if (tab() !== "solid") return;
  if (!offered) {
    offered = true;
    await offers().catch(failed);
  }
  if (loads === 0) await openSample(state.read().model);
  else remember();
});
