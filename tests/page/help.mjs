// What the tests of the page share: a service, a browser, rasters from the command line.

import { spawn, execFileSync } from "node:child_process";
import { once } from "node:events";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { connect, createServer } from "node:net";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";

export const ROOT = fileURLToPath(new URL("../..", import.meta.url));
export const RUNSET = process.env.RUNSET_RELEASE ?? join(ROOT, "target/release/runset");
export const SCRATCH = mkdtempSync(join(tmpdir(), "runset-page-"));

const FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
  "--disable-component-update", "--disable-sync"];

/** Starts a service on a free port; gives its address and what ends it. */
export async function serve(env = {}, options = []) {
  const data = mkdtempSync(join(SCRATCH, "data-"));
  const child = spawn(RUNSET, ["serve", "--addr", "127.0.0.1:0", "--data", data, "--log", "warn", ...options], { env: { ...process.env, ...env }, stdio: ["ignore", "ignore", "pipe"] });
  let said = "";
  const address = await new Promise((found, failed) => {
    child.stderr.on("data", (text) => {
      said += text;
      const match = /listening on (http:\/\/[\d.:]+)/.exec(said);
      if (match) found(match[1]);
    });
    child.on("exit", () => failed(new Error(`the service ended: ${said}`)));
  });
  const end = async (signal = "SIGTERM") => {
    if (child.exitCode !== null || child.signalCode !== null) return;
    const ended = new Promise((ended) => child.on("exit", ended));
    child.kill(signal);
    // Streams that are under way are given time; the tests have none.
    const impatient = setTimeout(() => child.kill("SIGKILL"), 3000);
    await ended;
    clearTimeout(impatient);
  };
  return { address, end };
}

/** Starts a virtual printer (`ippeveprinter`) that takes some seconds for a document; none where there is none. */
export async function printer() {
  try {
    for (const tool of ["ippeveprinter", "dbus-daemon"]) execFileSync(tool, ["--version"], { stdio: "ignore" });
  } catch {
    if (process.env.CI === "true") throw new Error("must not be skipped here: printing: ippeveprinter or dbus-daemon is not installed");
    console.log("skipped: printing: ippeveprinter or dbus-daemon is not installed");
    return null;
  }
  const folder = mkdtempSync(join(SCRATCH, "printer-"));
  // It wants a system bus, although it does not speak on it: it gets one of its own.
  const bus = `unix:path=${folder}/bus`;
  const daemon = spawn("dbus-daemon", ["--session", "--nofork", "--nopidfile", "--address", bus], { stdio: "ignore" });
  writeFileSync(`${folder}/command`, "#!/bin/sh\nsleep 2\n", { mode: 0o755 });
  const free = createServer().listen(0, "127.0.0.1");
  await once(free, "listening");
  const { port } = free.address();
  free.close();
  const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
  await pause(300);
  const options = ["-n", "localhost", "-r", "off", "-d", folder, "-f", "image/png", "-p", String(port), "-c", `${folder}/command`, "virtual"];
  const device = spawn("ippeveprinter", options, { stdio: "ignore", env: { ...process.env, DBUS_SYSTEM_BUS_ADDRESS: bus } });
  const listens = () =>
    new Promise((resolve) => {
      const socket = connect(port, "127.0.0.1", () => (socket.destroy(), resolve(true)));
      socket.on("error", () => resolve(false));
    });
  for (let i = 0; i < 100 && !(await listens()); i++) await pause(100);
  return { uri: `ipp://127.0.0.1:${port}/ipp/print`, end: () => (device.kill(), daemon.kill()) };
}

export const browser = () => chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: FLAGS });

/**
 * A tab that notes all that goes wrong in it. `allow` are patterns of what may.
 */
export async function tab(browser, address, { width = 1280, height = 860, scheme = "light", hash = "", allow = [] } = {}) {
  const context = await browser.newContext({ viewport: { width, height }, colorScheme: scheme, acceptDownloads: true });
  const page = await context.newPage();
  const wrong = [];
  // The tests read the canvas, the page does not.
  page.allow = [/willReadFrequently/, ...allow];
  const note = (what) => void (page.allow.some((pattern) => pattern.test(what)) || wrong.push(what));
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && note(`${message.type()}: ${message.text()} ${message.location().url}`));
  page.on("pageerror", (error) => note(String(error)));
  // What the page itself breaks off is no failure.
  page.on("requestfailed", (request) => request.failure()?.errorText !== "net::ERR_ABORTED" && note(`failed: ${request.url()}`));
  page.on("response", (response) => response.status() >= 400 && note(`${response.status()} ${response.url()}`));
  page.on("request", (request) => !request.url().startsWith(address) && !request.url().startsWith("blob:") && note(`from elsewhere: ${request.url()}`));
  await page.goto(`${address}/${hash}`);
  return { page, wrong, close: () => context.close() };
}

/** Drops a file on the page. */
export const drop = (page, name, text) =>
  page.evaluate(([name, text]) => {
    const data = new DataTransfer();
    data.items.add(new File([text], name));
    for (const name of ["dragenter", "dragover", "drop"]) document.body.dispatchEvent(new DragEvent(name, { dataTransfer: data, bubbles: true, cancelable: true }));
  }, [name, text]);

/** Waits until a raster has been drawn to its end since `act`. */
export async function drawn(page, act, which = "#canvas") {
  const before = Number((await page.getAttribute(which, "data-done")) ?? 0);
  await act();
  await page.waitForFunction(([which, before]) => Number(document.querySelector(which).dataset.done ?? 0) > before, [which, before], { timeout: 60_000 });
  await page.waitForTimeout(150);
}

/** The raster of a drawing from the command line as RGB: width, height, bytes. */
export const raster = (...args) => picture("fill", ...args);

/** The same of a command that is named. */
export function picture(...args) {
  const out = execFileSync(RUNSET, [...args, "--format", "ppm", "-o", "-"], { cwd: ROOT, maxBuffer: 1 << 30 });
  const head = /^P6\n(\d+) (\d+)\n255\n/.exec(out.subarray(0, 64).toString("latin1"));
  return { width: Number(head[1]), height: Number(head[2]), rgb: out.subarray(head[0].length) };
}

/** A model in a file: a block with a hole, and a bar in colour. */
export function model() {
  const path = join(SCRATCH, "model.csg");
  writeFileSync(path, `difference() { cube(size = [10, 8, 6], center = true); cylinder(h = 20, r = 2, $fn = 24, center = true); }
color([1, 0, 0.5]) multmatrix([[0.8, -0.6, 0, -4], [0.6, 0.8, 0, -2], [0, 0, 1, 2], [0, 0, 0, 1]]) { cube(size = [12, 1, 1.5]); }
`);
  return path;
}

/** A canvas as RGBA. */
export async function canvas(page, which = "#canvas") {
  const { width, height, text } = await page.evaluate((which) => {
    const canvas = document.querySelector(which);
    const { data, width, height } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    let text = "";
    for (let i = 0; i < data.length; i += 32768) text += String.fromCharCode(...data.subarray(i, i + 32768));
    return { width, height, text: btoa(text) };
  }, which);
  return { width, height, rgba: Buffer.from(text, "base64") };
}

/**
 * Pixels of the canvas that differ from a raster whose pixel (0, 0) stands at `left`, `top`; those for which `skip` holds are not looked at. Also how
 * many were.
 */
export function compare(shown, expected, left, top, skip = () => false) {
  let [compared, different] = [0, 0];
  for (let y = 0; y < expected.height; y++) {
    for (let x = 0; x < expected.width; x++) {
      const [X, Y] = [left + x, top + y];
      if (X < 0 || Y < 0 || X >= shown.width || Y >= shown.height || skip(X, Y)) continue;
      compared++;
      const [a, b] = [4 * (Y * shown.width + X), 3 * (y * expected.width + x)];
      if (shown.rgba[a] !== expected.rgb[b] || shown.rgba[a + 1] !== expected.rgb[b + 1] || shown.rgba[a + 2] !== expected.rgb[b + 2]) different++;
    }
  }
  return { compared, different };
}

/**
 * Memory of the browser in MB, as proportional set sizes: of the largest process that shows a page, and of all its processes together.
 */
export function memory() {
  const found = new Map();
  for (const line of execFileSync("ps", ["-eo", "pid=,ppid=,args="]).toString().split("\n")) {
    const [, pid, parent, args] = /^\s*(\d+)\s+(\d+)\s(.*)/.exec(line) ?? [];
    if (pid) found.set(Number(pid), { parent: Number(parent), args });
  }
  const ours = (pid) => pid === process.pid || (found.has(pid) && ours(found.get(pid).parent));
  let [tab, all] = [0, 0];
  for (const [pid, { args }] of found) {
    if (!/chrom/.test(args) || !ours(pid)) continue;
    try {
      const mb = Number(/Pss:\s+(\d+)/.exec(readFileSync(`/proc/${pid}/smaps_rollup`, "latin1"))[1]) / 1000;
      all += mb;
      if (args.includes("--type=renderer")) tab = Math.max(tab, mb);
    } catch {
      // It has ended.
    }
  }
  return { tab, all };
}

export const clean = () => rmSync(SCRATCH, { recursive: true, force: true });
