// The jobs of the service: how they get on, their rasters, and what is there of them.

import { at, bytes, make, number, problem, say } from "./dom.js";
import { address, call, withToken } from "./api.js";
import { Printing } from "./print.js";
import { forget, save, saved } from "./save.js";

/**
 * @typedef {{ id: string, kind: "fill" | "solid", state: "ready" | "reading" | "done" | "failed" | "cancelled", format: string, width: number, height: number, lines: number,
 *   lines_delivered: number, bytes: number | null, created: string, error: string | null, warnings: string[], print?: import("./print.js").Print | null }} Job
 *
 * A job in the list.
 * @typedef {{ job: Job, element: HTMLLIElement, have: number, stop?: () => void, follow?: AbortController, failed: string, printing?: Printing }} Item
 */

/** A browser opens six connections to a service: event streams must not take them all. */
const MOST_FOLLOWED = 2;

/** Jobs that are asked for at once. */
const AT_ONCE = 1000;

/** How often the list is asked for while jobs are read that are not followed, in ms. */
const LOOK = 4000;

/** Jobs that are shown, until more are wanted. */
const PAGE = 10;

/** Tells of `show`, with a job. */
export class Jobs extends EventTarget {
  constructor() {
    super();
    /** @type {Map<string, Item>} */
    this.items = new Map();
    this.current = "";
    this.shown = PAGE;
    at("jobs-more").addEventListener("click", () => {
      this.shown += PAGE;
      this.#order();
    });
    setInterval(() => {
      const unseen = [...this.items.values()].some((item) => item.job.state === "reading" && !item.follow);
      if (unseen && !document.hidden) void this.refresh();
    }, LOOK);
  }

  /** Asks for all of them: the service tells the oldest first. */
  async refresh() {
    try {
      /** @type {Job[]} */
      const jobs = [];
      /** @type {string | undefined} */
      let after;
      do {
        const list = await (await call("v1/jobs", { query: { limit: AT_ONCE, after } })).json();
        jobs.push(...list.jobs);
        after = list.next ?? undefined;
      } while (after);
      const ids = new Set(jobs.map((job) => job.id));
      for (const id of this.items.keys()) if (!ids.has(id)) this.#drop(id);
      for (const job of jobs) this.#put(job);
      problem("jobs-problem");
      this.#order();
      await forget((file) => ids.has(file.replace("job-", "")));
    } catch (error) {
      problem("jobs-problem", /** @type {Error} */ (error).message);
    }
  }

  /** @param {string} id */
  #drop(id) {
    const item = this.items.get(id);
    if (!item) return;
    item.stop?.();
    item.follow?.abort();
    item.element.remove();
    this.items.delete(id);
  }

  #order() {
    const list = [...this.items.values()].sort((a, b) => (a.job.id < b.job.id ? 1 : -1));
    // Elements that stand where they belong are left there, and keep the focus.
    list.forEach(({ element, job }, i) => {
      if (i >= this.shown && job.id !== this.current) return element.remove();
      if (at("jobs").children[i] !== element) at("jobs").insertBefore(element, at("jobs").children[i] ?? null);
    });
    at("jobs-count").textContent = list.length ? String(list.length) : "";
    at("jobs-more").hidden = list.length <= this.shown;
    at("jobs-note").hidden = list.length > 0;
  }

  /** @param {Job} job */
  #put(job) {
    let item = this.items.get(job.id);
    if (!item) {
      item = { job, element: make("li", { class: "job", "data-job": job.id }), have: 0, failed: "" };
      this.items.set(job.id, item);
      const fresh = item;
      void saved(`job-${job.id}`).then((have) => {
        fresh.have = have;
        this.#render(fresh);
      });
    }
    item.job = job;
    this.#render(item);
    return item;
  }

  /**
   * Keeps a drawing as a job, and follows it.
   * @param {Blob} body @param {Record<string, string | number | undefined>} query @param {Record<string, string>} headers
   */
  async keep(body, query, headers) {
    const response = await call("v1/jobs", { method: "POST", query, body, headers: { ...headers, "Idempotency-Key": key() } });
    const job = /** @type {Job} */ (await response.json());
    const item = this.#put(job);
    this.#order();
    void this.#follow(item);
    say(`Kept as a job, ${job.format}, ${job.width} by ${job.height} pixels`);
    return job;
  }

  /** The job of that id, also if it is not among the newest. @param {string} id */
  async find(id) {
    this.current = id;
    const item = this.#put(await (await call(`v1/jobs/${encodeURIComponent(id)}`)).json());
    this.#order();
    void this.#follow(item);
    return item.job;
  }

  /** Follows a job's events. @param {Item} item */
  async #follow(item) {
    if (item.follow) return;
    const followed = [...this.items.values()].filter((other) => other.follow);
    if (followed.length >= MOST_FOLLOWED) followed[0].follow?.abort();
    const control = (item.follow = new AbortController());
    try {
      const response = await call(`v1/jobs/${item.job.id}/events`, { headers: { Accept: "text/event-stream" }, signal: control.signal });
      for await (const data of events(/** @type {ReadableStream<Uint8Array<ArrayBuffer>>} */ (response.body))) this.#put(JSON.parse(data));
    } catch {
      // The list is asked for instead.
    } finally {
      if (item.follow === control) item.follow = undefined;
    }
  }

  /** @param {Item} item */
  #download(item) {
    const { job } = item;
    const request = { url: address(`v1/jobs/${job.id}/raster`), method: "GET", headers: withToken() };
    item.failed = "";
    void this.#follow(item);
    item.stop = save(request, `job-${job.id}`, `${job.id}.${job.format}`, true, {
      begun: (from) => this.#got(item, from),
      at: (have) => this.#got(item, have),
      done: (have) => {
        item.stop = undefined;
        this.#got(item, have);
        say("The raster is saved");
      },
      stopped: () => {
        item.stop = undefined;
        this.#render(item);
      },
      failed: (what) => {
        item.stop = undefined;
        item.failed = what;
        this.#render(item);
      },
    });
    this.#render(item);
  }

  /** @param {Item} item @param {number} have */
  #got(item, have) {
    item.have = have;
    this.#render(item);
  }

  /** @param {Item} item */
  async #delete(item) {
    item.stop?.();
    try {
      await call(`v1/jobs/${item.job.id}`, { method: "DELETE" });
      this.#drop(item.job.id);
      await forget((file) => file !== `job-${item.job.id}`);
      this.#order();
      at("jobs-title").scrollIntoView({ block: "nearest" });
      say("The job is deleted");
    } catch (error) {
      item.failed = /** @type {Error} */ (error).message;
      this.#render(item);
    }
  }

  /** @param {Item} item */
  #render(item) {
    const { job, element, have, stop, failed } = item;
    if (!element.firstChild) this.#build(item);
    const get = (/** @type {string} */ name) => /** @type {HTMLElement} */ (element.querySelector(`.${name}`));
    element.classList.toggle("current", job.id === this.current);
    element.dataset.state = job.state;
    get("state").textContent = stop ? "saving" : job.state;
    const progress = /** @type {HTMLProgressElement} */ (get("progress"));
    const whole = job.bytes !== null && have >= job.bytes;
    progress.max = stop || have ? job.bytes ?? 0 : job.lines;
    if (progress.max === 0) progress.removeAttribute("value");
    else progress.value = stop || have ? have : job.lines_delivered;
    const size = job.bytes === null ? "length unknown yet" : bytes(job.bytes);
    get("about").textContent = `${job.width} × ${job.height} · ${size}`;
    get("far").textContent = failed || job.error || (stop || have ? `${bytes(have)} here` : `${number(job.lines_delivered)} of ${number(job.lines)} lines read`);
    get("far").classList.toggle("wrong", Boolean(failed || job.error));
    const download = /** @type {HTMLButtonElement} */ (get("download"));
    download.textContent = stop ? "Pause" : whole ? "Save again" : have ? "Resume" : "Download";
    download.disabled = job.state === "failed";
    /** @type {HTMLButtonElement} */ (get("show")).hidden = job.format !== "rls";
    item.printing?.show(job.print);
  }

  /** @param {Item} item */
  #build(item) {
    const { job, element } = item;
    const button = (/** @type {string} */ name, /** @type {string} */ text, /** @type {() => void} */ act) => {
      const made = make("button", { type: "button", class: name, "aria-describedby": `job-${job.id}` }, text);
      made.addEventListener("click", act);
      return made;
    };
    const when = new Date(job.created);
    // Models are not printed.
    if (job.kind === "fill") item.printing = new Printing(job.id);
    element.append(
      make("div", { class: "row" },
        make("span", { class: "format", id: `job-${job.id}` }, `${job.kind === "solid" ? "model, " : ""}${job.format} `, make("time", { datetime: job.created }, when.toLocaleString(undefined, { dateStyle: "medium", timeStyle: "short" }))),
        make("span", { class: "state" })),
      make("progress", { class: "progress", "aria-labelledby": `job-${job.id}` }),
      make("div", { class: "row note" }, make("span", { class: "about" }), make("span", { class: "far" })),
      ...(item.printing ? [item.printing.element] : []),
      make("div", { class: "row" },
        button("show", "Show", () => {
          this.current = job.id;
          this.items.forEach((other) => this.#render(other));
          void this.#follow(item);
          this.dispatchEvent(new CustomEvent("show", { detail: item.job }));
        }),
        button("download", "Download", () => (item.stop ? item.stop() : this.#download(item))),
        button("delete quiet", "Delete", () => void this.#delete(item))),
    );
  }
}

/** Names a request, so that it is not taken twice. */
const key = () => Array.from(crypto.getRandomValues(new Uint8Array(16)), (byte) => byte.toString(16).padStart(2, "0")).join("");

/** The data of server-sent events. @param {ReadableStream<Uint8Array<ArrayBuffer>>} body */
async function* events(body) {
  let text = "";
  for (const reader = body.pipeThrough(new TextDecoderStream()).getReader(); ; ) {
    const { done, value } = await reader.read();
    if (done) return;
    text += value;
    const whole = text.split(/\r?\n\r?\n/);
    text = whole.pop() ?? "";
    for (const event of whole) {
      const data = event.split(/\r?\n/).flatMap((line) => (line.startsWith("data:") ? [line.slice(5).trimStart()] : []));
      if (data.length) yield data.join("\n");
    }
  }
}
