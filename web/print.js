// Printing a job on one of the printers that the service prints on.

import { bytes, make, say } from "./dom.js";
import { call } from "./api.js";

/**
 * @typedef {{ printer: string, state: "waiting" | "sending" | "printing" | "printed" | "failed" | "cancelled", told: string | null, choice: string | null,
 *   job: string | null, sent: number, impressions: number | null, error: string | null }} Print
 */

/** How often a print is asked for that goes on, in ms. */
const LOOK = 1000;

/** @type {Promise<string[]> | undefined} */
let known;

/** The addresses of the printers, asked for once; none if they are not told. */
const printers = () =>
  (known ??= call("v1/printers").then(
    async (answer) => (await answer.json()).printers.map((/** @type {{ uri: string }} */ printer) => printer.uri),
    () => {
      known = undefined;
      return [];
    },
  ));

/** An address as people call it. @param {string} uri */
const short = (uri) => uri.replace(/^ipp:\/\//, "").replace(/\/ipp\/print$/, "");

/** @param {Print} print */
function told(print) {
  switch (print.state) {
    case "waiting": return print.told ? `waiting: ${print.told}` : "waiting";
    case "sending": return `sending, ${bytes(print.sent)}`;
    case "printing": return print.told ? `printing: ${print.told}` : "printing";
    case "printed": return `printed on ${short(print.printer)}`;
    default: return `${print.state}: ${print.error ?? ""}`;
  }
}

/** What prints a job: a choice of printers, how it gets on, and what cancels it. Hidden where there is no printer. */
export class Printing {
  /** @param {string} id of the job */
  constructor(id) {
    this.path = `v1/jobs/${id}/print`;
    this.printer = make("select", { class: "printer", "aria-label": "Printer" });
    this.start = make("button", { type: "button", class: "print", "aria-describedby": `job-${id}` }, "Print");
    this.stop = make("button", { type: "button", class: "stop quiet", "aria-describedby": `job-${id}` }, "Cancel print");
    this.told = make("span", { class: "note told" });
    this.element = make("div", { class: "row printing" }, this.printer, this.start, this.stop, this.told);
    this.element.hidden = true;
    this.stop.hidden = true;
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    this.timer = undefined;
    this.state = "";
    this.start.addEventListener("click", () => void this.#begin());
    this.stop.addEventListener("click", () => void this.#act("DELETE"));
    void printers().then((/** @type {string[]} */ all) => {
      this.printer.replaceChildren(...all.map((uri) => make("option", { value: uri }, short(uri))));
      this.element.hidden = all.length === 0;
    });
  }

  /** Shows a print as the service tells it; none if there was none. @param {Print | null | undefined} print */
  show(print) {
    const active = print?.state === "waiting" || print?.state === "sending" || print?.state === "printing";
    this.start.hidden = active;
    this.printer.disabled = active;
    this.stop.hidden = !active;
    this.told.textContent = print ? told(print) : "";
    this.told.title = print?.choice ?? "";
    this.told.classList.toggle("wrong", print?.state === "failed");
    this.element.dataset.print = print?.state ?? "";
    if (this.state && print && print.state !== this.state && !active) say(`The job is ${told(print)}`);
    this.state = print?.state ?? "";
    clearTimeout(this.timer);
    if (active && this.element.isConnected) this.timer = setTimeout(() => void this.#look(), LOOK);
  }

  async #begin() {
    this.start.disabled = true;
    await this.#act("POST", new Blob([JSON.stringify({ printer: this.printer.value })]));
    this.start.disabled = false;
  }

  /** @param {string} method @param {Blob} [body] */
  async #act(method, body) {
    try {
      const headers = body ? { "Content-Type": "application/json" } : undefined;
      const answer = await call(this.path, { method, body, headers });
      this.show(answer.status === 204 ? null : await answer.json());
    } catch (error) {
      this.#wrong(error);
    }
  }

  async #look() {
    try {
      this.show(await (await call(this.path)).json());
    } catch (error) {
      this.#wrong(error);
      // The service may be back later.
      if (this.element.isConnected) this.timer = setTimeout(() => void this.#look(), 5 * LOOK);
    }
  }

  /** @param {unknown} error */
  #wrong(error) {
    this.told.textContent = /** @type {Error} */ (error).message;
    this.told.classList.add("wrong");
  }
}
