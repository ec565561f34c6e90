// The expression: what is typed, where it is wrong, and names that complete it.

import { at, make, problem } from "./dom.js";
import { offset } from "./places.js";

/** Names that are offered at once. */
const MOST_OFFERED = 6;

const BUILT_IN = ["art", "page"];
const FUNCTIONS = ["all(", "any(", "odd(", "atleast("];
const WORD = /"?[A-Za-z_][\w.:-]*$/;

/** An id as an expression names it. @param {string} id */
export const named = (id) =>
  /^[A-Za-z_][\w.:]*$/.test(id) && !BUILT_IN.includes(id) ? id : `"${id.replaceAll("\\", "\\\\").replaceAll('"', '\\"')}"`;

/** Tells of `edit`. */
export class Expression extends EventTarget {
  constructor() {
    super();
    this.input = /** @type {HTMLTextAreaElement} */ (at("expression"));
    this.list = at("completions");
    this.mirror = at("mirror");
    /** @type {string[]} */
    this.words = [];
    /** @type {string[]} */
    this.offered = [];
    this.chosen = 0;
    this.input.addEventListener("input", () => this.#edited(true));
    this.input.addEventListener("keydown", (event) => this.#key(event));
    this.input.addEventListener("blur", () => this.#close());
    this.input.addEventListener("scroll", () => (this.mirror.scrollTop = this.input.scrollTop));
    this.list.addEventListener("pointerdown", (event) => {
      event.preventDefault();
      const option = /** @type {HTMLElement} */ (event.target).closest("li");
      if (option) this.#take(Number(option.dataset.index));
    });
  }

  get text() {
    return this.input.value.trim();
  }

  set text(text) {
    this.input.value = text;
    this.#edited(false);
  }

  /** @param {string[]} ids */
  set names(ids) {
    this.words = [...ids.map(named), ...BUILT_IN, ...FUNCTIONS];
  }

  /** Puts a name where the caret is. @param {string} id */
  insert(id) {
    const { value, selectionStart: start, selectionEnd: end } = this.input;
    const before = value.slice(0, start);
    // Behind a finished operand a name needs an operator.
    const joined = /[\w")\]]\s*$/.test(before) ? `${/\s$/.test(before) ? "" : " "}| ${named(id)}` : named(id);
    this.input.focus();
    this.input.setRangeText(joined, start, end, "end");
    this.#edited(true);
    this.#close();
  }

  #edited(/** @type {boolean} */ typed) {
    problem("expression-problem");
    this.input.removeAttribute("aria-invalid");
    this.mirror.replaceChildren();
    if (typed) {
      this.#offer(false);
      this.dispatchEvent(new Event("edit"));
    }
  }

  /**
   * Shows what is wrong, and where.
   * @param {string} what
   * @param {number} [line] from 1
   * @param {number} [column] in characters, from 1
   */
  wrong(what, line, column) {
    problem("expression-problem", what);
    this.input.setAttribute("aria-invalid", "true");
    if (!line || !column) return;
    this.mirror.style.height = `${this.input.clientHeight}px`;
    // The service was given the text without the space around it.
    const text = this.input.value;
    const lead = text.length - text.trimStart().length;
    const start = lead + offset(text.slice(lead), line, column);
    const rest = text.slice(start);
    const token = /^(?:"[^"]*"?|[\w.:]+|[^\s])/u.exec(rest)?.[0] ?? "";
    this.mirror.replaceChildren(text.slice(0, start), make("mark", {}, token || " "), rest.slice(token.length));
    this.mirror.scrollTop = this.input.scrollTop;
  }

  #word() {
    const before = this.input.value.slice(0, this.input.selectionStart);
    return WORD.exec(before)?.[0] ?? "";
  }

  #offer(/** @type {boolean} */ all) {
    const word = this.#word();
    const bare = word.replace(/^"/, "").toLowerCase();
    const rank = (/** @type {string} */ name) => name.replace(/^"/, "").toLowerCase().indexOf(bare);
    const fits = this.words.filter((name) => rank(name) >= 0 && name !== word).sort((a, b) => Number(rank(a) > 0) - Number(rank(b) > 0));
    this.offered = word || all ? fits.slice(0, MOST_OFFERED) : [];
    this.chosen = 0;
    this.#render();
  }

  #render() {
    this.list.hidden = this.offered.length === 0;
    this.list.replaceChildren(
      ...this.offered.map((name, i) => make("li", { role: "option", id: `completion-${i}`, "data-index": String(i), "aria-selected": String(i === this.chosen) }, name)),
    );
    if (this.list.hidden) this.input.removeAttribute("aria-activedescendant");
    else this.input.setAttribute("aria-activedescendant", `completion-${this.chosen}`);
  }

  #close() {
    this.offered = [];
    this.#render();
  }

  #take(/** @type {number} */ i) {
    const word = this.#word();
    const end = this.input.selectionStart;
    this.input.setRangeText(this.offered[i], end - word.length, end, "end");
    this.#close();
    this.#edited(true);
    this.#close();
  }

  #key(/** @type {KeyboardEvent} */ event) {
    if (event.key === " " && event.ctrlKey) {
      event.preventDefault();
      this.#offer(true);
    }
    if (this.offered.length === 0) return;
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (step) {
      this.chosen = (this.chosen + step + this.offered.length) % this.offered.length;
      this.#render();
    } else if (event.key === "Enter" || (event.key === "Tab" && !event.shiftKey)) {
      this.#take(this.chosen);
    } else if (event.key === "Escape") {
      this.#close();
    } else {
      return;
    }
    event.preventDefault();
  }
}
