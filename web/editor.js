// The text of a model: lines with numbers, one of them marked.

import { at } from "./dom.js";
import { offset } from "./places.js";

/** The height of a line in CSS pixels, as the style has it. */
const LINE = 20;
/** Space above the first line. */
const PAD = 8;

/** Tells of `edit`. */
export class Editor extends EventTarget {
  constructor() {
    super();
    this.input = /** @type {HTMLTextAreaElement} */ (at("csg"));
    this.numbers = at("csg-numbers");
    this.bar = at("csg-bar");
    /** The line that is marked, from 1; none at 0. */
    this.marked = 0;
    this.input.addEventListener("input", () => {
      this.mark(0);
      this.#number();
      this.dispatchEvent(new Event("edit"));
    });
    this.input.addEventListener("scroll", () => this.#scroll());
  }

  get text() {
    return this.input.value;
  }

  /** Another text; what was typed before cannot be taken back behind it. */
  set text(text) {
    this.input.value = text;
    this.mark(0);
    this.#number();
  }

  #number() {
    const lines = this.input.value.split("\n").length;
    this.numbers.textContent = Array.from({ length: lines }, (_, i) => i + 1).join("\n");
    this.#scroll();
  }

  #scroll() {
    this.numbers.scrollTop = this.input.scrollTop;
    this.bar.style.top = `${PAD + (this.marked - 1) * LINE - this.input.scrollTop}px`;
  }

  /** Marks a line, from 1, or none at 0. @param {number} line @param {boolean} [wrong] */
  mark(line, wrong = false) {
    this.marked = line;
    this.bar.hidden = line === 0;
    this.bar.classList.toggle("wrong", wrong);
    this.input.toggleAttribute("aria-invalid", wrong);
    if (line) {
      const { scrollTop, clientHeight } = this.input;
      const top = PAD + (line - 1) * LINE;
      if (top < scrollTop || top + LINE > scrollTop + clientHeight) this.input.scrollTop = top - clientHeight / 2;
    }
    this.#scroll();
  }

  /** Marks a line, and selects from a column of it to its end. @param {number} line @param {number} column */
  select(line, column) {
    const start = offset(this.text, line, column);
    const end = this.text.indexOf("\n", start);
    this.input.setSelectionRange(start, end < 0 ? this.text.length : end);
    this.mark(line);
    const { scrollLeft, clientWidth } = this.input;
    const left = this.#width(this.text.slice(this.text.lastIndexOf("\n", start - 1) + 1, start));
    if (left < scrollLeft || left > scrollLeft + 0.8 * clientWidth) this.input.scrollLeft = left - clientWidth / 3;
  }

  /** How wide the beginning of a line is, in CSS pixels. @param {string} text */
  #width(text) {
    const context = new OffscreenCanvas(1, 1).getContext("2d");
    if (!context) return 0;
    context.font = getComputedStyle(this.input).font;
    return context.measureText(text.replaceAll("\t", "  ")).width;
  }

  /**
   * Writes over a range, as if it were typed: it can be taken back.
   * @param {{ start: number, end: number, text: string }} change
   */
  write({ start, end, text }) {
    const focused = document.activeElement;
    this.input.focus({ preventScroll: true });
    this.input.setSelectionRange(start, end);
    // What else is typed for a text field leaves its list of what can be taken back alone.
    if (!document.execCommand("insertText", false, text)) {
      this.input.setRangeText(text, start, end, "end");
      this.input.dispatchEvent(new Event("input"));
    }
    if (focused instanceof HTMLElement) focused.focus({ preventScroll: true });
  }

  /** Takes the last edit back, or that again. @param {"undo" | "redo"} which */
  take(which) {
    const focused = document.activeElement;
    this.input.focus({ preventScroll: true });
    document.execCommand(which);
    if (focused instanceof HTMLElement) focused.focus({ preventScroll: true });
  }
}
