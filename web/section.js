// The plane that cuts a model: across an axis, at a place, from one side or the other.

import { at } from "./dom.js";
import { input, select } from "./desk.js";

/** Steps from one side of the model to the other. */
const STEPS = 400;

/** Tells of `change`. */
export class Section extends EventTarget {
  constructor() {
    super();
    this.axis = select("section-axis");
    this.place = input("section-at");
    this.other = input("section-other");
    /** @type {[number[], number[]] | null} */
    this.box = null;
    this.place.max = String(STEPS);
    this.place.value = String(STEPS / 2);
    for (const element of [this.axis, this.place, this.other]) {
      element.addEventListener("input", () => this.#changed());
    }
    this.#tell();
  }

  /** The bounds of what is cut. @param {[number[], number[]] | null} bounds */
  set bounds(bounds) {
    this.box = bounds;
    this.#tell();
  }

  /** Where it cuts, in the model's units. */
  get at() {
    const i = ["x", "y", "z"].indexOf(this.axis.value);
    const [least, most] = this.box ?? [[0, 0, 0], [1, 1, 1]];
    return least[i] + ((most[i] - least[i]) * Number(this.place.value)) / STEPS;
  }

  /** As a query gives it: nothing if it is off. @returns {Record<string, string>} */
  get query() {
    const i = ["x", "y", "z"].indexOf(this.axis.value);
    if (i < 0) return {};
    const sign = this.other.checked ? -1 : 1;
    return { section: [...[0, 1, 2].map((j) => (j === i ? sign : 0)), sign * this.at].join(",") };
  }

  /** On across that axis, or off if it is. @param {string} axis */
  toggle(axis) {
    this.axis.value = this.axis.value === axis ? "" : axis;
    this.#changed();
  }

  /** @param {number} steps */
  slide(steps) {
    this.place.value = String(Number(this.place.value) + (steps * STEPS) / 40);
    this.#changed();
  }

  #changed() {
    this.#tell();
    this.dispatchEvent(new Event("change"));
  }

  #tell() {
    const on = this.axis.value !== "";
    this.place.disabled = this.other.disabled = !on;
    at("section-value").textContent = on ? String(Number(this.at.toPrecision(4))) : "off";
  }
}
