// The page: what is drawn, where it comes from, and who is told when it changes.

import { at, bytes, make, number, problem, say, time } from "./dom.js";
import { access, address, askForToken, call, setToken, token, withToken } from "./api.js";
import * as commands from "./commands.js";
import * as state from "./address.js";
import { Expression, named } from "./expression.js";
import { Jobs } from "./jobs.js";
import { list } from "./names.js";
import { SAMPLES } from "./samples.js";
import { save } from "./save.js";
import { Scanline } from "./scanline.js";
import { fault, rendering } from "./size.js";
import { Stage } from "./stage.js";

/** Lines whose history is asked for at once. */
const MOST_TOLD = 8192;

/** The pointer rests when it has not moved for so long, in ms. */
const REST = 25;

/**
 * A drawing that is there.
 * @typedef {{ name: string, file: string, sample: string, blob: Blob, media: string, warnings: string[], info: { width: number, height: number, ids: import("./names.js").Entry[] } }} Drawing
 */

const stage = new Stage(/** @type {HTMLCanvasElement} */ (at("canvas")));
const scanline = new Scanline(stage);
const expression = new Expression();
const jobs = new Jobs();
const select = (/** @type {string} */ id) => /** @type {HTMLSelectElement} */ (at(id));
const input = (/** @type {string} */ id) => /** @type {HTMLInputElement} */ (at(id));

/** @type {Drawing | undefined} */
let drawing;
/** @type {import("./jobs.js").Job | undefined} the job that is shown instead of a drawing */
let job;
let followed = "";

// --- drawings

/** Tells which of several loads was asked for last. */
let loads = 0;

/** @param {string} name @param {Partial<import("./address.js").State>} [wanted] */
async function loadSample(name, wanted) {
  const sample = SAMPLES.find((sample) => sample.name === name) ?? SAMPLES[0];
  const load = ++loads;
  try {
    const blob = await (await call(`samples/${sample.name}`)).blob();
    if (load === loads) await open({ name: sample.name, file: `examples/art/${sample.name}`, sample: sample.name, blob }, { ...wanted, size: wanted?.size ?? sample.size });
  } catch (error) {
    problem("drawing-problem", /** @type {Error} */ (error).message);
  }
}

/** @param {File} file */
async function loadFile(file) {
  loads++;
  await open({ name: file.name, file: file.name, sample: "", blob: file }, {});
}

/**
 * @param {{ name: string, file: string, sample: string, blob: Blob }} found
 * @param {Partial<import("./address.js").State>} wanted
 */
async function open(found, { expr = "", size }) {
  const load = loads;
  problem("drawing-problem");
  const start = new TextDecoder().decode(await found.blob.slice(0, 64).arrayBuffer()).trimStart();
  const media = start.startsWith("{") || /\.json$/i.test(found.name) ? "application/json" : "image/svg+xml";
  at("drawing-note").textContent = `${found.name}, ${bytes(found.blob.size)}: reading\u2026`;
  let info;
  try {
    info = await (await call("v1/info", { method: "POST", body: found.blob, headers: { "Content-Type": media } })).json();
  } catch (error) {
    const { message, line, column, status } = /** @type {import("./api.js").Problem} */ (error);
    at("drawing-note").textContent = drawing ? `Still showing ${drawing.name}.` : "";
    if (status !== 401) problem("drawing-problem", `${found.name}${line ? `:${line}:${column}` : ""}: ${message}`);
    return;
  }
  if (load !== loads) return;
  job = undefined;
  drawing = { ...found, media, info, warnings: info.warnings };
  const warnings = info.warnings.length ? ` ${info.warnings.length === 1 ? "A warning" : `${info.warnings.length} warnings`}: ${info.warnings.slice(0, 3).join("; ")}` : "";
  at("drawing-note").textContent = `${found.name}, ${bytes(found.blob.size)}, ${number(info.width)} × ${number(info.height)} user units.${warnings}`;
  select("sample").value = found.sample;
  expression.names = info.ids.map((/** @type {{ id: string }} */ { id }) => id);
  expression.text = expr;
  followed = "";
  list(info.ids, {
    light: (entry) => light(entry),
    dark: () => {
      clearTimeout(lighting);
      stage.dark();
    },
    insert: (id) => expression.insert(id),
    follow: (id) => {
      followed = id;
      explain();
    },
  });
  showTries(SAMPLES.find((sample) => sample.name === found.sample)?.tries ?? []);
  showSize(size ?? { mode: "width", first: Math.max(1, Math.round(info.width)), second: 0 });
  show();
}

/** @param {string[]} tries */
function showTries(tries) {
  const chips = ["", ...tries].map((text) => {
    const chip = make("button", { type: "button", class: "chip" }, text || "its own inks");
    chip.addEventListener("click", () => {
      expression.text = text;
      show();
    });
    return chip;
  });
  at("tries").replaceChildren(...(tries.length ? chips : []));
}

let lighting = 0;

/** @param {import("./names.js").Entry} entry */
function light(entry) {
  clearTimeout(lighting);
  const page = drawn();
  if (!drawing || !page) return;
  const scale = Math.min(page.width / drawing.info.width, page.height / drawing.info.height);
  const [dx, dy] = [(page.width - drawing.info.width * scale) / 2, (page.height - drawing.info.height * scale) / 2];
  const centred = page.query.width && page.query.height ? [dx, dy] : [0, 0];
  const box = entry.bounds?.map((at, i) => at * scale + centred[i % 2]);
  lighting = setTimeout(() => stage.light(entry.id, box), 60);
}

// --- size

/** @param {import("./size.js").Size} size */
function showSize({ mode, first, second }) {
  select("size-mode").value = mode;
  input("size-first").value = String(first);
  input("size-second").value = second ? String(second) : "";
  sized();
}

/** @returns {import("./size.js").Size} */
const size = () => ({
  mode: /** @type {import("./size.js").Size["mode"]} */ (select("size-mode").value),
  first: Number(input("size-first").value),
  second: Number(input("size-second").value),
});

/** The page that is asked for, if it can be had. */
function drawn() {
  if (!drawing || fault(size())) return undefined;
  return rendering(drawing.info, size());
}

function sized() {
  const box = select("size-mode").value === "box";
  at("size-second-label").hidden = !box;
  at("size-label").textContent = select("size-mode").selectedOptions[0].textContent;
  problem("size-problem", drawing ? fault(size()) : "");
  const page = drawn();
  at("size-result").textContent = page ? `${page.width} × ${page.height} px, ${number(page.width * page.height)} pixels` : "";
}

select("size-mode").addEventListener("change", () => {
  // The same page in other words.
  const page = stage.content?.page;
  const { mode } = size();
  if (page && drawing) {
    const scale = page.width / drawing.info.width;
    const first = { width: page.width, height: page.height, dpi: Math.round(scale * 96), scale: Number(scale.toPrecision(4)), box: page.width }[mode];
    input("size-first").value = String(first);
    input("size-second").value = String(page.height);
  }
  sized();
  show();
});
for (const id of ["size-first", "size-second"]) {
  at(id).addEventListener("input", () => {
    sized();
    show();
  });
}

// --- what is shown

function show() {
  const page = drawn();
  if (job || !drawing || !page) return;
  const { blob, media, info } = drawing;
  const expr = expression.text;
  const request = (/** @type {Record<string, string | number>} */ query, text = expr) => ({
    url: address("v1/fill", { ...query, expr: text, format: "rls" }),
    method: "POST",
    headers: withToken({ "Content-Type": media }),
    body: blob,
  });
  stage.show({ page, drawing: info, request, light: (id, query) => request(query, named(id)) });
  at("empty").hidden = true;
  remember();
  explain();
}

/** @param {import("./jobs.js").Job} shown */
function showJob(shown) {
  loads++;
  job = shown;
  drawing = undefined;
  select("sample").value = "";
  at("drawing-note").textContent = `The raster of a job: ${shown.width} × ${shown.height} px, ${shown.format}. Choose a drawing to go on with one.`;
  problem("drawing-problem");
  list([], { light: () => {}, dark: () => {}, insert: () => {}, follow: () => {} });
  showTries([]);
  scanline.show(undefined);
  remember();
  if (shown.format !== "rls") {
    stage.show(undefined);
    at("empty").hidden = false;
    return;
  }
  at("empty").hidden = true;
  const page = { width: shown.width, height: shown.height, query: {} };
  stage.show({ page, drawing: page, whole: true, request: () => ({ url: address(`v1/jobs/${shown.id}/raster`), method: "GET", headers: withToken() }) });
}

function remember() {
  const format = select("format").value;
  const about = { sample: drawing?.sample, job: job?.id, expr: drawing ? expression.text : "", size: drawing && size(), format: format === "png" ? "" : format };
  const url = state.written(about);
  if (url !== location.href) history.replaceState(null, "", url);
  document.title = job ? "Job, runset" : drawing ? `${drawing.name}, runset` : "runset";
  showCommands();
}

function showCommands() {
  const page = drawn();
  for (const id of ["download", "keep"]) /** @type {HTMLButtonElement} */ (at(id)).disabled = !page;
  if (!drawing || !page) {
    for (const id of ["command-runset", "command-curl"]) at(id).textContent = "";
    return;
  }
  const format = select("format").value;
  const asked = { file: drawing.file, media: drawing.media, expr: expression.text, query: page.query, format };
  at("command-runset").textContent = commands.runset(asked);
  at("command-curl").textContent = commands.curl(asked, address("v1/fill", { ...page.query, expr: expression.text, format }), Boolean(token()));
}

expression.addEventListener("edit", show);

// --- the stream

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
  // What the drawing itself is warned of stands beside it already.
  const fresh = (drawing?.warnings ?? []).reduce((text, known) => text.replace(known, ""), warnings).replace(/^[,\s]+/, "");
  if (fresh && !job) problem("stream-problem", fresh);
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
  if (!job) void tellKinds();
});
stage.addEventListener("problem", (event) => {
  const { status, detail, line, column } = /** @type {CustomEvent<import("./worker.js").Details>} */ (event).detail;
  at("view").classList.remove("busy");
  if (status === 401) return askForToken();
  if (detail.startsWith("expr: ")) expression.wrong(detail.slice(6), line, column);
  else problem("stream-problem", drawing && line ? `${drawing.name}:${line}:${column}: ${detail}` : detail);
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
function explain() {
  clearTimeout(resting);
  resting = setTimeout(async () => {
    asking?.abort();
    const control = (asking = new AbortController());
    const page = drawn();
    if (!drawing || !page || !stage.content) return;
    const { y } = stage.probe;
    const { blob: body, media } = drawing;
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
  if (!content || !drawing) return;
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

// --- view

at("zoom-in").addEventListener("click", () => stage.zoomBy(1.5));
at("zoom-out").addEventListener("click", () => stage.zoomBy(1 / 1.5));
at("fit").addEventListener("click", () => stage.content && stage.fit());
at("pixels").addEventListener("click", () => stage.pixels());
at("tint").addEventListener("change", () => {
  stage.tint = input("tint").checked;
  stage.redraw();
});
at("all-lines").addEventListener("click", () => stage.drawAll());
stage.addEventListener("view", () => {
  const { content, view } = stage;
  if (!content) return;
  const zoom = view.zoom * 100;
  at("zoom").textContent = `${zoom >= 10 ? Math.round(zoom) : zoom.toPrecision(2)} %`;
  const base = stage.baseRendering;
  const exact = base.width === content.page.width;
  at("level").textContent = exact || content.whole ? `${content.page.width} × ${content.page.height}` : `${base.width} × ${base.height} of ${content.page.width} × ${content.page.height}`;
  at("all-lines").hidden = exact || Boolean(content.whole);
});

// --- taking it away

select("format").addEventListener("change", remember);
at("link").addEventListener("click", () => void commands.copy(location.href).then(() => say("The link is copied")));
document.querySelectorAll("[data-copy]").forEach((button) => {
  button.addEventListener("click", () => {
    void commands.copy(at(/** @type {HTMLElement} */ (button).dataset.copy ?? "").textContent ?? "").then(() => {
      say("Copied");
      button.textContent = "Copied";
      setTimeout(() => (button.textContent = "Copy"), 1500);
    });
  });
});

/** @type {(() => void) | undefined} */
let saving;
at("download").addEventListener("click", () => {
  if (saving) return saving();
  const page = drawn();
  if (!drawing || !page) return;
  const format = select("format").value;
  const name = `${commands.stem(drawing.file)}.${format}`;
  const request = {
    url: address("v1/fill", { ...page.query, expr: expression.text, format }),
    method: "POST",
    headers: withToken({ "Content-Type": drawing.media }),
    body: drawing.blob,
  };
  const end = (/** @type {string} */ note, wrong = "") => {
    saving = undefined;
    at("download").textContent = "Download";
    at("take-note").textContent = note;
    problem("take-problem", wrong);
  };
  problem("take-problem");
  at("download").textContent = "Stop";
  saving = save(request, "fill", name, false, {
    at: (have) => (at("take-note").textContent = `${name}: ${bytes(have)}`),
    done: (have) => end(`${name} is saved, ${bytes(have)}.`),
    stopped: () => end("Stopped."),
    failed: (what, status) => {
      end("", what);
      if (status === 401) askForToken();
    },
  });
});
at("keep").addEventListener("click", async () => {
  const page = drawn();
  if (!drawing || !page) return;
  problem("take-problem");
  try {
    await jobs.keep(drawing.blob, { ...page.query, expr: expression.text, format: select("format").value }, { "Content-Type": drawing.media });
    at("take-note").textContent = "Kept: it stands among the jobs.";
  } catch (error) {
    problem("take-problem", /** @type {Error} */ (error).message);
  }
});
jobs.addEventListener("show", (event) => showJob(/** @type {CustomEvent} */ (event).detail));

async function formats() {
  const api = await (await call("openapi.json")).json();
  const found = api.paths["/v1/fill"].post.parameters.find((/** @type {{ name: string }} */ { name }) => name === "format").schema.enum;
  select("format").replaceChildren(...found.map((/** @type {string} */ name) => make("option", { value: name }, name)));
  select("format").value = found.includes(state.read().format) ? state.read().format : "png";
}

// --- dropping and choosing files

select("sample").append(make("option", { value: "", disabled: "", hidden: "" }, "your own"), ...SAMPLES.map(({ name, title }) => make("option", { value: name }, title)));
select("sample").addEventListener("change", () => void loadSample(select("sample").value));
at("open").addEventListener("click", () => input("file").click());
input("file").addEventListener("change", () => {
  const file = input("file").files?.[0];
  input("file").value = "";
  if (file) void loadFile(file);
});
let over = 0;
const dropping = (/** @type {boolean} */ on) => document.body.classList.toggle("dropping", on);
document.addEventListener("dragenter", (event) => {
  event.preventDefault();
  dropping(++over > 0);
});
document.addEventListener("dragleave", () => dropping(--over > 0));
document.addEventListener("dragover", (event) => event.preventDefault());
document.addEventListener("drop", (event) => {
  event.preventDefault();
  over = 0;
  dropping(false);
  const file = event.dataTransfer?.files[0];
  if (file) void loadFile(file);
});

// --- token

const dialog = /** @type {HTMLDialogElement} */ (at("token-dialog"));
const askToken = () => {
  if (!dialog.open) dialog.showModal();
  input("token").value = token();
};
access.addEventListener("wanted", askToken);
at("token-open").addEventListener("click", askToken);
at("token-cancel").addEventListener("click", () => dialog.close("cancel"));
dialog.addEventListener("close", () => {
  if (dialog.returnValue !== "ok") return;
  setToken(input("token").value.trim());
  void start();
});

// --- start

async function start() {
  at("token-open").hidden = !token();
  const wanted = state.read();
  void jobs.refresh();
  if (wanted.job) {
    try {
      showJob(await jobs.find(wanted.job));
      return;
    } catch (error) {
      problem("jobs-problem", /** @type {Error} */ (error).message);
    }
  }
  await loadSample(wanted.sample, wanted);
}

addEventListener("hashchange", () => void start());
await formats();
await start();
