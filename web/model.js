// A model: kept by the service, and shown from wherever the camera is turned to.

import { at, bytes, number, problem } from "./dom.js";
import { address, call, withToken } from "./api.js";
import { desk, input, select, stage } from "./desk.js";

/**
 * A model that is there.
 * @typedef {{ name: string, blob: Blob, media: string, kept: { id: string, parts: number, faces: number, bounds: [number[], number[]] | null, warnings: string[] } }} Model
 */

/** The page in pixels, at most: the view has as many as the canvas, or a part of these. */
const PAGE = { width: 4096, height: 3072 };

/** Half of the vertical field of view, as the service has it. */
const HALF = ((22.5 / 2) * Math.PI) / 180;

/** Whether a file is a model's, by its name. @param {string} name */
export const isModel = (name) => /\.(csg|stl)$/i.test(name);

/** Has a model kept by the service. @param {string} name @param {Blob} blob @returns {Promise<Model>} */
export async function keep(name, blob) {
  const media = /\.stl$/i.test(name) ? "model/stl" : "text/plain";
  const answer = await call("v1/models", { method: "PUT", body: blob, headers: { "Content-Type": media } });
  return { name, blob, media, kept: await answer.json() };
}

/** What is told of it beside its name. @param {Model} model */
export function told({ name, blob, kept }) {
  const warnings = kept.warnings.length ? ` ${kept.warnings.length === 1 ? "A warning" : `${kept.warnings.length} warnings`}: ${kept.warnings.slice(0, 3).join("; ")}` : "";
  return `${name}, ${bytes(blob.size)}, ${number(kept.parts)} parts, ${number(kept.faces)} faces.${warnings}`;
}

/** The camera that is set, in OpenSCAD's seven numbers: around the middle of the model, at 1 from where all of it is seen. */
function camera(/** @type {Model} */ { kept }) {
  const [least, most] = kept.bounds ?? [[0, 0, 0], [1, 1, 1]];
  const middle = least.map((x, i) => (x + most[i]) / 2);
  const distance = (Math.hypot(...most.map((x, i) => x - least[i])) / 2 / Math.sin(HALF)) * 2 ** Number(input("camera-far").value);
  return [...middle, Number(input("camera-tilt").value), 0, Number(input("camera-turn").value), Math.max(distance, Number.MIN_VALUE)].join(",");
}

/** Shows the model from where the camera is. */
export function show() {
  const { model } = desk;
  if (!model) return;
  const asked = { camera: camera(model), projection: select("camera-projection").value, colorscheme: select("camera-scheme").value };
  for (const name of ["turn", "tilt"]) at(`camera-${name}-value`).textContent = `${input(`camera-${name}`).value}°`;
  at("camera-far-value").textContent = `${(2 ** Number(input("camera-far").value)).toPrecision(2)}`;
  stage.show({
    page: { ...PAGE, query: { ...PAGE } },
    drawing: PAGE,
    turn,
    request: ({ width, height, ...slice }) => ({
      url: address(`v1/models/${model.kept.id}/view`, { ...asked, ...slice, imgsize: `${width},${height}`, format: "rls" }),
      method: "GET",
      headers: withToken(),
    }),
  });
}

/** Whether a model is shown: it has other controls than a drawing. @param {boolean} on */
export function wear(on) {
  document.body.classList.toggle("model", on);
  at("canvas").setAttribute("aria-label", on ? "The model. Arrow keys turn it, plus and minus zoom, 0 fits." : LABEL);
}

const LABEL = at("canvas").getAttribute("aria-label") ?? "";

/** Degrees for a CSS pixel that the model is dragged. */
const TURN = 0.5;

/** @param {number} dx @param {number} dy */
function turn(dx, dy) {
  const [turned, tilted] = [input("camera-turn"), input("camera-tilt")];
  // Around and around; over the poles it does not go.
  turned.value = String(((((Number(turned.value) - TURN * dx + 180) % 360) + 360) % 360) - 180);
  tilted.value = String(Number(tilted.value) - TURN * dy);
  soon();
}

// Several moves before the next picture are one.
let moving = 0;
const soon = () => {
  cancelAnimationFrame(moving);
  moving = requestAnimationFrame(show);
};
for (const name of ["turn", "tilt", "far", "projection", "scheme"]) {
  at(`camera-${name}`).addEventListener("input", soon);
}

// A model that had to make room for others is sent again, once.
let again = "";
stage.addEventListener("problem", async (event) => {
  const { model } = desk;
  const { status } = /** @type {CustomEvent<import("./worker.js").Details>} */ (event).detail;
  if (!model || status !== 404 || again === model.kept.id) return;
  again = model.kept.id;
  try {
    await keep(model.name, model.blob);
    if (desk.model === model) show();
  } catch (error) {
    problem("drawing-problem", /** @type {Error} */ (error).message);
  }
});
stage.addEventListener("first", () => (again = ""));
