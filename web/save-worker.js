// Fetches a raster into a file of this page's own (the origin private file system), so that what has come survives a reload, and memory stays small. Where
// there is no such file system it is gathered in memory, up to a limit.

/**
 * @typedef {{ kind: "save", id: number, request: import("./worker.js").Request, file: string, tag: string, resume: boolean } | { kind: "stop", id: number }} Order
 *
 * @typedef {{ id: number } & (
 *   | { kind: "begun", tag: string, from: number, total: number }
 *   | { kind: "at", bytes: number }
 *   | { kind: "done", bytes: number, blob?: Blob }
 *   | { kind: "stopped" }
 *   | { kind: "failed", what: string, status: number }
 * )} Answer
 *
 * What a worker can do with a file.
 * @typedef {{ getSize(): number, truncate(size: number): void, write(data: Uint8Array, at: { at: number }): number, flush(): void, close(): void }} Access
 */

export {};

/** Bytes that are gathered in memory at most. */
const MOST_MEMORY = 256_000_000;

/** How often a raster is asked for whose length is still measured. */
const MOST_WAITS = 120;

/** @type {Map<number, AbortController>} */
const underWay = new Map();

/** @param {Answer} answer */
const say = (answer) => self.postMessage(answer);

self.onmessage = ({ data }) => {
  const order = /** @type {Order} */ (data);
  if (order.kind === "stop") underWay.get(order.id)?.abort();
  else void save(order);
};

/** @param {string} name @returns {Promise<Access | undefined>} */
async function open(name) {
  try {
    const root = await navigator.storage.getDirectory();
    const handle = /** @type {any} */ (await root.getFileHandle(name, { create: true }));
    return await handle.createSyncAccessHandle();
  } catch {
    return undefined;
  }
}

/** @param {Extract<Order, { kind: "save" }>} order */
async function save({ id, request, file, tag, resume }) {
  const control = new AbortController();
  underWay.set(id, control);
  const { signal } = control;
  const access = await open(file);
  try {
    let from = resume && access && tag ? access.getSize() : 0;
    const response = await ask(request, from, tag, signal);
    const length = Number(response.headers.get("content-length") ?? 0);
    const range = /^bytes (?:(\d+)-\d+|\*)\/(\d+)$/.exec(response.headers.get("content-range") ?? "");
    if (response.status === 416 && range && Number(range[2]) === from) {
      say({ id, kind: "done", bytes: from });
      return;
    }
    if (!response.ok || !response.body) {
      const detail = await response.json().then((problem) => problem.detail, () => response.statusText);
      say({ id, kind: "failed", what: String(detail), status: response.status });
      return;
    }
    if (response.status !== 206) from = 0;
    access?.truncate(from);
    say({ id, kind: "begun", tag: response.headers.get("etag") ?? "", from, total: length && from + length });
    /** @type {Uint8Array<ArrayBuffer>[]} */
    const gathered = [];
    let at = from;
    let told = 0;
    for (const body = response.body.getReader(); ; ) {
      const { done, value } = await body.read();
      if (done) break;
      if (access) access.write(value, { at });
      else if (at + value.length > MOST_MEMORY) throw new RangeError();
      else gathered.push(value);
      at += value.length;
      if (performance.now() - told > 100) {
        told = performance.now();
        say({ id, kind: "at", bytes: at });
      }
    }
    access?.flush();
    say({ id, kind: "done", bytes: at, ...(access ? {} : { blob: new Blob(gathered) }) });
  } catch (error) {
    if (signal.aborted) say({ id, kind: "stopped" });
    else if (error instanceof RangeError) say({ id, kind: "failed", what: "it is too large for this browser's memory: use the command below", status: 0 });
    else if (error instanceof DOMException && error.name === "QuotaExceededError") say({ id, kind: "failed", what: "this browser gives the page no more room: use the command below", status: 0 });
    else say({ id, kind: "failed", what: "the connection broke off", status: 0 });
  } finally {
    control.abort();
    access?.close();
    underWay.delete(id);
  }
}

/**
 * @param {import("./worker.js").Request} request @param {number} from @param {string} tag @param {AbortSignal} signal
 */
async function ask(request, from, tag, signal) {
  const headers = from ? { ...request.headers, Range: `bytes=${from}-`, "If-Range": tag } : request.headers;
  for (let waits = 0; ; waits++) {
    const response = await fetch(request.url, { ...request, headers, signal });
    const seconds = Number(response.headers.get("retry-after") ?? 0);
    if (response.status !== 503 || !seconds || waits === MOST_WAITS) return response;
    await new Promise((go) => setTimeout(go, 1000 * Math.min(seconds, 10)));
    signal.throwIfAborted();
  }
}
