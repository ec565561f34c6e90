// A model that is kept by the service, and what is asked of it.

import { bytes, number } from "./dom.js";
import { address, call, withToken } from "./api.js";

/**
 * A model that is there.
 * @typedef {{ name: string, blob: Blob, media: string, kept: { id: string, parts: number, faces: number, bounds: [number[], number[]] | null, warnings: string[] } }} Model
 *
 * What a pixel shows.
 * @typedef {{ primitive: number, kind: string, line: number | null, column: number | null, inside: boolean, point: import("./camera.js").Vector, depth: number, matrix: number[][] }} Picked
 */

/** Whether a file is a model's, by its name. @param {string} name */
export const isModel = (name) => /\.(csg|stl)$/i.test(name);

/** Whether it has no text, by its name. @param {string} name */
export const isStl = (name) => /\.stl$/i.test(name);

/** Has a model kept by the service. @param {string} name @param {Blob} blob @returns {Promise<Model>} */
export async function keep(name, blob) {
  const media = isStl(name) ? "model/stl" : "text/plain";
  const answer = await call("v1/models", { method: "PUT", body: blob, headers: { "Content-Type": media } });
  return { name, blob, media, kept: await answer.json() };
}

/** What is told of it beside its name. @param {Model} model */
export function told({ name, blob, kept }) {
  const warnings = kept.warnings.length ? ` ${kept.warnings.length === 1 ? "A warning" : `${kept.warnings.length} warnings`}: ${kept.warnings.slice(0, 3).join("; ")}` : "";
  return `${name}, ${bytes(blob.size)}, ${number(kept.parts)} parts, ${number(kept.faces)} faces.${warnings}`;
}

/** An address of the model, with a query in which names may stand again. @param {Model} model @param {string} what @param {[string, string][]} query */
const of = (model, what, query) => `${address(`v1/models/${model.kept.id}/${what}`)}?${new URLSearchParams(query)}`;

/** A request for a picture. @param {Model} model @param {[string, string][]} query @returns {import("./worker.js").Request} */
export const picture = (model, query) => ({ url: of(model, "view", query), method: "GET", headers: withToken() });

/** What a pixel shows; nothing if that is the background. @param {Model} model @param {[string, string][]} query @returns {Promise<Picked | null>} */
export const pick = async (model, query) => (await call(of(model, "pick", query))).json();
