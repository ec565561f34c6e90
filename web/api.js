// The service as the page calls it: addresses, the token, and problems as errors.

/** A problem that the service answers (RFC 9457), or that keeps it from answering (`status` 0). */
export class Problem extends Error {
  /** @param {import("./worker.js").Details} details */
  constructor({ status, detail, line, column }) {
    super(detail);
    this.status = status;
    this.line = line;
    this.column = column;
  }
}

const KEY = "runset-token";

/** Tells of `token`: one is asked for, or another one is there. */
export const access = new EventTarget();

export const token = () => sessionStorage.getItem(KEY) ?? "";

/** @param {string} text */
export function setToken(text) {
  if (text) sessionStorage.setItem(KEY, text);
  else sessionStorage.removeItem(KEY);
  access.dispatchEvent(new Event("token"));
}

/** To be called where 401 is answered. */
export const askForToken = () => void access.dispatchEvent(new Event("wanted"));

/**
 * An absolute address of the service.
 * @param {string} path
 * @param {Record<string, string | number | undefined>} [query]
 */
export function address(path, query = {}) {
  const url = new URL(path, document.baseURI);
  url.hash = "";
  for (const [name, value] of Object.entries(query)) if (value !== undefined && value !== "") url.searchParams.set(name, String(value));
  return url.href;
}

/** @param {Record<string, string>} [headers] @returns {Record<string, string>} */
export const withToken = (headers = {}) => (token() ? { ...headers, Authorization: `Bearer ${token()}` } : headers);

/**
 * Calls the service. Anything but a success is thrown as a {@link Problem}.
 * @param {string} path
 * @param {{ method?: string, query?: Record<string, string | number | undefined>, headers?: Record<string, string>, body?: Blob, signal?: AbortSignal }} [options]
 */
export async function call(path, { method = "GET", query, headers, body, signal } = {}) {
  let response;
  try {
    response = await fetch(address(path, query), { method, headers: withToken(headers), body, signal });
  } catch (error) {
    if (signal?.aborted) throw error;
    throw new Problem({ status: 0, detail: "the service does not answer: is it running?" });
  }
  if (response.ok) return response;
  if (response.status === 401) askForToken();
  throw new Problem(
    await response.json().catch(() => ({ status: response.status, detail: `the service answered ${response.status} ${response.statusText}` })),
  );
}

/** @type {Promise<any> | undefined} */
let described;

/** What the service says of its calls (OpenAPI), asked for once. */
export const description = () =>
  (described ??= call("openapi.json").then(
    (answer) => answer.json(),
    (error) => {
      described = undefined;
      throw error;
    },
  ));
