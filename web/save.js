// Rasters as files: fetched into this page's own file system, then handed to the browser as a download.

import { make } from "./dom.js";

const TAG = "runset-tag-";

const worker = new Worker(new URL("./save-worker.js", import.meta.url), { type: "module" });
let last = 0;

/**
 * @typedef {{ begun?: (from: number, total: number) => void, at?: (bytes: number) => void, done: (bytes: number) => void, stopped?: () => void,
 *   failed: (what: string, status: number) => void }} Told
 *
 * @type {Map<number, { told: Told, file: string, name: string, resume: boolean }>}
 */
const orders = new Map();

worker.onmessage = ({ data }) => {
  const answer = /** @type {import("./save-worker.js").Answer} */ (data);
  const order = orders.get(answer.id);
  if (!order) return;
  const { told, file, name } = order;
  if (answer.kind === "begun") {
    if (order.resume) localStorage.setItem(TAG + file, answer.tag);
    told.begun?.(answer.from, answer.total);
    return;
  }
  if (answer.kind === "at") return told.at?.(answer.bytes);
  orders.delete(answer.id);
  if (answer.kind === "stopped") told.stopped?.();
  if (answer.kind === "failed") told.failed(answer.what, answer.status);
  if (answer.kind === "done") {
    void give(answer.blob, file, name).then(
      () => told.done(answer.bytes),
      () => told.failed("the file cannot be read back", 0),
    );
  }
};

/** @param {Blob | undefined} blob @param {string} file @param {string} name */
async function give(blob, file, name) {
  const from = blob ?? (await (await (await navigator.storage.getDirectory()).getFileHandle(file)).getFile());
  const url = URL.createObjectURL(from);
  const link = make("a", { href: url, download: name });
  link.click();
  // The browser reads it while it saves it.
  setTimeout(() => URL.revokeObjectURL(url), 600_000);
}

/**
 * Fetches a raster and saves it under `name`. With `resume` it goes on where an earlier try under the same `file` ended. What is given back stops it.
 * @param {import("./worker.js").Request} request @param {string} file @param {string} name @param {boolean} resume @param {Told} told
 */
export function save(request, file, name, resume, told) {
  const id = ++last;
  orders.set(id, { told, file, name, resume });
  worker.postMessage({ kind: "save", id, request, file, tag: localStorage.getItem(TAG + file) ?? "", resume });
  return () => worker.postMessage({ kind: "stop", id });
}

/** How many bytes are there of an earlier try. @param {string} file */
export async function saved(file) {
  if (!localStorage.getItem(TAG + file)) return 0;
  try {
    const root = await navigator.storage.getDirectory();
    return (await (await root.getFileHandle(file)).getFile()).size;
  } catch {
    return 0;
  }
}

/** Forgets what is there of any file that `wanted` does not want. @param {(file: string) => boolean} wanted */
export async function forget(wanted) {
  try {
    const root = await navigator.storage.getDirectory();
    for await (const file of /** @type {any} */ (root).keys()) {
      if (wanted(file)) continue;
      localStorage.removeItem(TAG + file);
      // One that is being written stays.
      await root.removeEntry(file).catch(() => {});
    }
  } catch {
    // No such file system: nothing is there.
  }
}
