// What the parts of the page share: the drawing that is there, what is asked of it, and those who show it.

import { at } from "./dom.js";
import { Expression } from "./expression.js";
import { Jobs } from "./jobs.js";
import { Scanline } from "./scanline.js";
import { fault, rendering } from "./size.js";
import { Stage } from "./stage.js";

/**
 * A drawing that is there.
 * @typedef {{ name: string, file: string, sample: string, blob: Blob, media: string, warnings: string[],
 *   info: { width: number, height: number, ids: import("./names.js").Entry[] } }} Drawing
 */

export const stage = new Stage(/** @type {HTMLCanvasElement} */ (at("canvas")));
export const scanline = new Scanline(stage);
export const expression = new Expression();
export const jobs = new Jobs();
export const select = (/** @type {string} */ id) => /** @type {HTMLSelectElement} */ (at(id));
export const input = (/** @type {string} */ id) => /** @type {HTMLInputElement} */ (at(id));

/**
 * `job`: what is shown instead of a drawing; `followed`: the id whose counter is followed along the scanline.
 * @type {{ drawing: Drawing | undefined, job: import("./jobs.js").Job | undefined, followed: string }}
 */
export const desk = { drawing: undefined, job: undefined, followed: "" };

/** @returns {import("./size.js").Size} */
export const size = () => ({
  mode: /** @type {import("./size.js").Size["mode"]} */ (select("size-mode").value),
  first: Number(input("size-first").value),
  second: Number(input("size-second").value),
});

/** The page that is asked for, if it can be had. */
export function drawn() {
  if (!desk.drawing || fault(desk.drawing.info, size())) return undefined;
  return rendering(desk.drawing.info, size());
}
