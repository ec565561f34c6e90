// Two tabs: plane drawings, and models.

import { at } from "./dom.js";

/** @typedef {"plane" | "solid"} Tab */

const TABS = /** @type {const} */ (["plane", "solid"]);

/** Tells of `show`, behind which the tab is there. */
export const tabs = new EventTarget();

/** @type {Tab} */
let shown = "plane";

/** The tab that is shown. */
export const tab = () => shown;

/** @param {Tab} wanted */
export function show(wanted) {
  shown = wanted;
  for (const name of TABS) {
    const on = name === wanted;
    at(`tab-${name}`).setAttribute("aria-selected", String(on));
    at(`tab-${name}`).tabIndex = on ? 0 : -1;
    at(name).hidden = !on;
  }
  tabs.dispatchEvent(new Event("show"));
}

for (const name of TABS) {
  at(`tab-${name}`).addEventListener("click", () => show(name));
  at(`tab-${name}`).addEventListener("keydown", (event) => {
    if (!["ArrowLeft", "ArrowRight"].includes(event.key)) return;
    event.preventDefault();
    const other = TABS[(TABS.indexOf(name) + 1) % TABS.length];
    show(other);
    at(`tab-${other}`).focus();
  });
}
