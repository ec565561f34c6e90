// The page: where drawings come from, and what is shown.

import { at, bytes, make, number, problem } from "./dom.js";
import { access, address, call, setToken, token, withToken } from "./api.js";
import * as state from "./address.js";
import { desk, drawn, expression, input, jobs, scanline, select, size, stage } from "./desk.js";
import { named } from "./expression.js";
import { isModel } from "./model.js";
import { list } from "./names.js";
import { SAMPLES } from "./samples.js";
import * as solid from "./solid.js";
import { fault } from "./size.js";
import { show as showTab, tab, tabs } from "./tabs.js";
import { formats, remember } from "./take.js";
import { explain } from "./told.js";

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
  if (isModel(file.name)) {
    const opened = solid.open(file.name, file);
    showTab("solid");
    return opened;
  }
  loads++;
  showTab("plane");
  await open({ name: file.name, file: file.name, sample: "", blob: file }, {});
}

/** Says why what was to be opened is not. @param {string} name @param {import("./api.js").Problem} error */
function refused(name, { message, line, column, status }) {
  const shown = desk.drawing;
  at("drawing-note").textContent = shown ? `Still showing ${shown.name}.` : "";
  if (status !== 401) problem("drawing-problem", `${name}${line ? `:${line}:${column}` : ""}: ${message}`);
}

/** Takes away all that belongs to what was shown. */
function clear() {
  desk.job = desk.drawing = undefined;
  select("sample").value = "";
  problem("drawing-problem");
  list([], { light: () => {}, dark: () => {}, insert: () => {}, follow: () => {} });
  showTries([]);
  scanline.show(undefined);
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
    return refused(found.name, /** @type {import("./api.js").Problem} */ (error));
  }
  if (load !== loads) return;
  desk.job = undefined;
  desk.drawing = { ...found, media, info, warnings: info.warnings };
  const warnings = info.warnings.length ? ` ${info.warnings.length === 1 ? "A warning" : `${info.warnings.length} warnings`}: ${info.warnings.slice(0, 3).join("; ")}` : "";
  at("drawing-note").textContent = `${found.name}, ${bytes(found.blob.size)}, ${number(info.width)} × ${number(info.height)} user units.${warnings}`;
  select("sample").value = found.sample;
  expression.names = info.ids.map((/** @type {{ id: string }} */ { id }) => id);
  expression.text = expr;
  desk.followed = "";
  list(info.ids, {
    light: (entry) => light(entry),
    dark: () => {
      clearTimeout(lighting);
      stage.dark();
    },
    insert: (id) => expression.insert(id),
    follow: (id) => {
      desk.followed = id;
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
  if (!desk.drawing || !page) return;
  const scale = Math.min(page.width / desk.drawing.info.width, page.height / desk.drawing.info.height);
  const [dx, dy] = [(page.width - desk.drawing.info.width * scale) / 2, (page.height - desk.drawing.info.height * scale) / 2];
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

function sized() {
  const box = select("size-mode").value === "box";
  at("size-second-label").hidden = !box;
  at("size-label").textContent = select("size-mode").selectedOptions[0].textContent;
  problem("size-problem", desk.drawing && fault(desk.drawing.info, size()));
  const page = drawn();
  at("size-result").textContent = page ? `${page.width} × ${page.height} px, ${number(page.width * page.height)} pixels` : "";
}

select("size-mode").addEventListener("change", () => {
  // The same page in other words.
  const page = stage.content?.page;
  const { mode } = size();
  if (page && desk.drawing) {
    const scale = page.width / desk.drawing.info.width;
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
  if (desk.job || !desk.drawing || !page) return;
  const { blob, media, info } = desk.drawing;
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
  clear();
  desk.job = shown;
  at("drawing-note").textContent = `The raster of a job: ${shown.width} × ${shown.height} px, ${shown.format}. Choose a drawing to go on with one.`;
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

expression.addEventListener("edit", show);

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

jobs.addEventListener("show", (event) => showJob(/** @type {CustomEvent} */ (event).detail));

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
  if (wanted.model) {
    if (wanted.model !== "own") void solid.openSample(wanted.model);
    return showTab("solid");
  }
  showTab("plane");
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

tabs.addEventListener("show", () => {
  if (tab() !== "plane") return;
  if (loads === 0) void loadSample(state.read().sample);
  else remember();
});
addEventListener("hashchange", () => void start());
await formats();
await start();
