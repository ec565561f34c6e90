// The shapes of the drawing: their bounds and edges, lit while they are pointed at.

import { at, make, number } from "./dom.js";

/**
 * @typedef {{ id: string, kind: string, depth: number, bounds: number[] | null, bounds_mm: number[] | null, edges: number, ink: string | null }} Entry
 */

/** Names that are listed at most. */
const MOST_LISTED = 2000;

/**
 * Lists names.
 * @param {Entry[]} entries
 * @param {{ light: (entry: Entry) => void, dark: () => void, insert: (id: string) => void, follow: (id: string) => void }} act
 */
export function list(entries, { light, dark, insert, follow }) {
  at("names-count").textContent = entries.length ? String(entries.length) : "";
  const rows = entries.slice(0, MOST_LISTED).map((entry) => {
    const { id, kind, depth, bounds_mm: mm, edges, ink } = entry;
    const size = mm ? `${(mm[2] - mm[0]).toFixed(1)} × ${(mm[3] - mm[1]).toFixed(1)} mm at ${mm[0].toFixed(1)}, ${mm[1].toFixed(1)}` : "paints nothing";
    const swatch = make("span", { class: "swatch", "aria-hidden": "true" });
    if (ink) swatch.style.backgroundColor = ink;
    const name = make("button", { type: "button", class: "name", title: `Put ${id} into the expression` },
      swatch, make("span", { class: "id" }, id), make("span", { class: "note" }, `${kind}, ${number(edges)} edges`), make("span", { class: "note bounds" }, size));
    name.addEventListener("click", () => insert(id));
    const watch = make("button", { type: "button", class: "follow quiet", "aria-pressed": "false", "aria-label": `Follow the counter of ${id} along the scanline`, title: "Follow its counter along the scanline" }, "Σ");
    watch.addEventListener("click", () => {
      const on = watch.getAttribute("aria-pressed") !== "true";
      at("names").querySelectorAll(".follow").forEach((other) => other.setAttribute("aria-pressed", "false"));
      watch.setAttribute("aria-pressed", String(on));
      follow(on ? id : "");
    });
    const row = make("div", { class: "entry" }, name, watch);
    row.style.paddingInlineStart = `${Math.min(depth, 4) * 12}px`;
    for (const event of ["pointerenter", "focusin"]) row.addEventListener(event, () => light(entry));
    for (const event of ["pointerleave", "focusout"]) row.addEventListener(event, dark);
    return row;
  });
  if (entries.length > MOST_LISTED) rows.push(make("div", { class: "note" }, `and ${entries.length - MOST_LISTED} more`));
  at("names").replaceChildren(...rows);
}
