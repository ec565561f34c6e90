// What is taken away: the raster as a file or a job, commands that make the same, and an address that shows the same.

import { at, bytes, make, problem, say } from "./dom.js";
import { address, askForToken, description, token, withToken } from "./api.js";
import * as commands from "./commands.js";
import * as state from "./address.js";
import { desk, drawn, expression, jobs, select, size } from "./desk.js";
import { save } from "./save.js";
import { tab } from "./tabs.js";

/** Puts what is shown into the address and the commands. */
export function remember() {
  if (tab() !== "plane") return;
  const { drawing, job } = desk;
  const format = select("format").value;
  const about = { sample: drawing?.sample, job: job?.id, expr: drawing ? expression.text : "", size: drawing && size(), format: format === "png" ? "" : format };
  const url = state.written(about);
  if (url !== location.href) history.replaceState(null, "", url);
  document.title = job ? "Job, runset" : drawing ? `${drawing.name}, runset` : "runset";
  showCommands();
}

function showCommands() {
  const { drawing } = desk;
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
  const { drawing } = desk;
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
  const { drawing } = desk;
  if (!drawing || !page) return;
  problem("take-problem");
  try {
    await jobs.keep(drawing.blob, { ...page.query, expr: expression.text, format: select("format").value }, { "Content-Type": drawing.media });
    at("take-note").textContent = "Kept: it stands among the jobs.";
  } catch (error) {
    problem("take-problem", /** @type {Error} */ (error).message);
  }
});

/** Lists the formats that the service has. */
export async function formats() {
  const { parameters } = (await description()).paths["/v1/fill"].post;
  /** @type {string[]} */
  const found = parameters.find((/** @type {{ name: string }} */ { name }) => name === "format").schema.enum;
  select("format").replaceChildren(...found.map((name) => make("option", { value: name }, name)));
  select("format").value = found.includes(state.read().format) ? state.read().format : "png";
}
