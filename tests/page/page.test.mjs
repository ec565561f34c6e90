// The page, end to end: the service as it is built, in a real browser, beside the command line.
//
//   npm ci && node tests/page/page.test.mjs           with the release build in target/, or where RUNSET_RELEASE says

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import AxeBuilder from "./axe.mjs";
import { ROOT, RUNSET, SCRATCH, browser as launch, canvas, clean, compare, drawn, memory, model, picture, printer, raster, serve, tab } from "./help.mjs";

let service, browser;
before(async () => {
  [service, browser] = await Promise.all([serve(), launch()]);
});
after(async () => {
  await browser?.close();
  await service?.end();
  clean();
});

const POSTER = "examples/art/poster.svg";
/** The looked-at line lies over the picture. */
const line = (page) => page.evaluate(() => document.querySelector("#line-title").textContent.match(/\d+/)?.[0]).then(Number);

/** Compares the fitted canvas with the command line's raster of the same size. */
async function same(page, size, input, ...args) {
  const [width, height] = (await page.textContent("#level")).match(/\d+/g).map(Number);
  const expected = raster(input, ...args, size, String(size === "--width" ? width : height));
  assert.deepEqual([expected.width, expected.height], [width, height]);
  const shown = await canvas(page);
  const [left, top] = [Math.floor((shown.width - width) / 2), Math.floor((shown.height - height) / 2)];
  const total = (await page.textContent("#size-result")).match(/× (\d+)/)[1];
  const probe = Math.round(top + ((await line(page)) + 0.5) * (height / total));
  const { compared, different } = compare(shown, expected, left, top, (_, y) => Math.abs(y - probe) < 9);
  assert.ok(compared > 0.9 * width * height, `${compared} pixels compared`);
  assert.equal(different, 0, "pixels that differ");
}

test("what is served", async () => {
  const index = await fetch(`${service.address}/`);
  const policy = index.headers.get("content-security-policy");
  for (const part of ["default-src 'none'", "script-src 'self'", "style-src 'self'", "frame-ancestors 'none'", "base-uri 'none'", "form-action 'none'"]) {
    assert.ok(policy.includes(part), part);
  }
  assert.ok(!policy.includes("unsafe"));
  assert.equal(index.headers.get("x-content-type-options"), "nosniff");
  assert.doesNotMatch(await index.text(), /<script(?![^>]*src=)|<style|\sstyle=|\son\w+=/, "nothing within the document");
  for (const file of readdirSync(join(ROOT, "web"))) {
    const answer = await fetch(`${service.address}/web/${file}`);
    assert.deepEqual(Buffer.from(await answer.arrayBuffer()), readFileSync(join(ROOT, "web", file)), file);
    const again = await fetch(`${service.address}/web/${file}`, { headers: { "If-None-Match": answer.headers.get("etag") } });
    assert.equal(again.status, 304, file);
  }
  const sample = await fetch(`${service.address}/samples/poster.svg`);
  assert.equal(sample.headers.get("content-type"), "image/svg+xml");
  assert.equal((await fetch(`${service.address}/web/nothing.js`)).status, 404);
});

test("the reader of line streams", async () => {
  const { page, wrong, close } = await tab(browser, service.address);
  const read = (bytes, chunk) =>
    page.evaluate(async ({ text, chunk }) => {
      const { Reader } = await import("/web/rls.js");
      const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
      const lines = [];
      const reader = new Reader(() => {}, ({ y, n, count, runs }) => lines.push([y, n, [...runs.subarray(0, 3 * count)]]));
      try {
        for (let i = 0; i < bytes.length; i += chunk) reader.push(bytes.subarray(i, i + chunk));
        reader.finish();
      } catch (error) {
        return { broken: error.message };
      }
      return { lines, summed: reader.summed, runs: reader.runs };
    }, { text: bytes.toString("base64"), chunk });
  for (const args of [["fill", POSTER, "--expr", "sky - sun", "--width", "301"], ["fill", POSTER, "--width", "120"], ["fill", POSTER, "--lines", "4090..4100"], ["solid", model(), "--imgsize", "99,77"]]) {
    const out = (format) => execFileSync(RUNSET, [...args, "--format", format, "-o", "-"], { cwd: ROOT, maxBuffer: 1 << 28 });
    const records = out("ndjson").toString().trim().split("\n").map((text) => JSON.parse(text));
    const { inks } = records[0];
    const told = ([start, end, ink = 0]) => [start, end, inks === "rgb" ? parseInt(ink.slice(1), 16) : ink];
    const expected = records.slice(1, -1).map(({ y, n, runs }) => [y, n, runs.flatMap(told)]);
    const bytes = out("rls");
    for (const chunk of [1, 7, 65536]) {
      const got = await read(bytes, chunk);
      assert.deepEqual(got, { lines: expected, summed: true, runs: records.at(-1).runs }, `chunks of ${chunk}`);
    }
    for (const cut of [5, 20, bytes.length >> 1, bytes.length - 1]) assert.match((await read(bytes.subarray(0, cut), 65536)).broken, /breaks off/);
    const bent = Buffer.from(bytes);
    bent[bent.length - 2] ^= 1;
    assert.match((await read(bent, 65536)).broken, /checksum/);
    assert.match((await read(Buffer.concat([bytes, Buffer.from([0])]), 65536)).broken, /behind the end/);
  }
  assert.deepEqual(wrong, []);
  await close();
});

test("a sample, an expression, and what they look like to the pixel", async () => {
  const { page, wrong, close } = await tab(browser, service.address, { hash: "#sample=poster.svg&dpi=300" });
  await page.waitForFunction(() => document.querySelector("#canvas").dataset.done);
  await page.waitForTimeout(300);
  await same(page, "--height", POSTER);
  await drawn(page, () => page.fill("#expression", "art & frame - logo"));
  await same(page, "--height", POSTER, "--expr", "art & frame - logo");
  assert.ok(page.url().includes("expr=art+%26+frame+-+logo"), "the address says it");

  // A reload shows the same.
  await page.reload();
  await page.waitForFunction(() => document.querySelector("#canvas").dataset.done);
  assert.equal(await page.inputValue("#expression"), "art & frame - logo");
  assert.equal(await page.inputValue("#size-first"), "300");
  await page.waitForTimeout(300);
  await same(page, "--height", POSTER, "--expr", "art & frame - logo");

  // Zoomed to pixels: those of the whole page at 300 dpi, each a square of 12.
  await page.locator("#canvas").hover({ position: { x: 440, y: 200 } });
  await page.click("#pixels");
  await page.mouse.move(5, 5);
  await page.waitForTimeout(900);
  const { x, y } = await page.evaluate(() => document.querySelector("#told").textContent.match(/Pixel (\d+), (\d+)/).slice(1).map(Number)).then(([x, y]) => ({ x, y }));
  const shown = await canvas(page);
  const rows = 8;
  const expected = raster(POSTER, "--expr", "art & frame - logo", "--dpi", "300", "--lines", `${y - rows}..${y + rows}`);
  let inked = 0;
  for (let row = y - rows; row < y + rows; row++) {
    if (row === y) continue;
    for (let column = x - 30; column < x + 30; column++) {
      const at = [Math.round((column - (x + 0.5 - shown.width / 24)) * 12 + 6), Math.round((row - (y + 0.5 - shown.height / 24)) * 12 + 6)];
      const value = shown.rgba[4 * (at[1] * shown.width + at[0])];
      const wanted = expected.rgb[3 * ((row - y + rows) * expected.width + column)];
      assert.equal(value, wanted, `pixel ${column}, ${row}`);
      inked += wanted === 0;
    }
  }
  assert.ok(inked > 0, "there is something to compare");
  assert.deepEqual(wrong, []);
  await close();
});

test("the first line is there within 200 ms of a keystroke, and an edit ends the render before", async () => {
  const { page, wrong, close } = await tab(browser, service.address, { hash: "#sample=poster.svg&dpi=300&expr=sky" });
  await page.waitForFunction(() => document.querySelector("#canvas").dataset.done);
  await page.evaluate(() => {
    window.times = [];
    document.querySelector("#expression").addEventListener("keydown", () => (window.pressed = performance.now()));
    new MutationObserver(() => window.times.push(performance.now() - window.pressed)).observe(document.querySelector("#canvas"), { attributeFilter: ["data-first-line"] });
  });
  await page.focus("#expression");
  await page.keyboard.press("End");
  const times = [];
  // Most of these make an expression that holds, each another one.
  for (const key of [" ", "|", " ", "s", "e", "a", "Home", "!", "!", "!", "!", "!", "!", "!", "!"]) {
    const seen = await page.evaluate(() => window.times.length);
    page.allow.push(/422|400/);
    await page.keyboard.press(key);
    await page.waitForTimeout(350);
    const now = await page.evaluate((seen) => window.times.slice(seen), seen);
    times.push(...now);
  }
  times.sort((a, b) => a - b);
  console.log(`first line after a keystroke: median ${times[times.length >> 1].toFixed(0)} ms, slowest ${times.at(-1).toFixed(0)} ms of ${times.length}`);
  assert.ok(times.length >= 9 && times[times.length >> 1] < 200, `${times}`);
  assert.deepEqual(wrong, []);

  // A page that takes long: two edits, and only the last is still being made.
  page.allow.length = 1;
  await drawn(page, () => page.fill("#expression", "art & frame - logo"));
  await page.fill("#size-first", "4000");
  await page.waitForTimeout(400);
  await page.click("#all-lines");
  await page.waitForFunction(() => / of /.test(document.querySelector("#stats dd").textContent));
  const streams = async () => Number(/^runset_streams (\d+)/m.exec(await (await fetch(`${service.address}/metrics`)).text())?.[1] ?? 0);
  assert.ok((await streams()) >= 1);
  await drawn(page, () => page.fill("#expression", "sun"));
  await page.waitForTimeout(300);
  assert.equal(await streams(), 0, "streams under way");
  await close();
});

test("errors stand at their place", async () => {
  const { page, wrong, close } = await tab(browser, service.address, { allow: [/422|400/] });
  await page.waitForFunction(() => document.querySelector("#canvas").dataset.done);
  await page.fill("#expression", "sky - lgoo");
  await page.waitForSelector("#expression-problem:not([hidden])");
  assert.match(await page.textContent("#expression-problem"), /unknown name "lgoo".*logo/);
  assert.equal(await page.textContent("#mirror mark"), "lgoo");
  assert.equal(await page.getAttribute("#expression", "aria-invalid"), "true");
  await page.fill("#expression", "sky -\n (sun");
  await page.waitForFunction(() => document.querySelector("#mirror mark")?.textContent !== "lgoo");
  await drawn(page, () => page.fill("#expression", "sky - logo"));
  assert.equal(await page.isHidden("#expression-problem"), true);
  assert.equal(await page.getAttribute("#expression", "aria-invalid"), null);
  await page.fill("#size-first", "99999999");
  assert.match(await page.textContent("#size-problem"), /at most 1048576 × 8388608/);
  await drawn(page, () => page.fill("#size-first", "300"));
  assert.equal(await page.isHidden("#size-problem"), true);
  await page.setInputFiles("#file", { name: "broken.svg", mimeType: "image/svg+xml", buffer: Buffer.from("<svg xmlns='http://www.w3.org/2000/svg'>\n<path>\n</svg>") });
  await page.waitForSelector("#drawing-problem:not([hidden])");
  assert.match(await page.textContent("#drawing-problem"), /^broken\.svg:3:\d+: /);
  assert.deepEqual(wrong, []);
  await close();
});

test("a drawing is dropped", async () => {
  const { page, wrong, close } = await tab(browser, service.address);
  await page.waitForFunction(() => document.querySelector("#canvas").dataset.done);
  const text = '<svg xmlns="http://www.w3.org/2000/svg" width="300" height="200"><circle id="dot" cx="150" cy="100" r="80" fill="#1c6a72"/><rect id="a b" x="20" y="20" width="90" height="90"/></svg>';
  writeFileSync(join(SCRATCH, "dropped.svg"), text);
  await drawn(page, () =>
    page.evaluate((text) => {
      const data = new DataTransfer();
      data.items.add(new File([text], "dropped.svg", { type: "image/svg+xml" }));
      for (const name of ["dragenter", "dragover", "drop"]) document.body.dispatchEvent(new DragEvent(name, { dataTransfer: data, bubbles: true, cancelable: true }));
    }, text),
  );
  assert.deepEqual(await page.locator(".entry .id").allTextContents(), ["dot", "a b"]);
  assert.match(await page.locator(".entry .bounds").first().textContent(), /42\.3 × 42\.3 mm at 18\.5, 5\.3/);
  // Its name goes into the expression as it has to be written.
  await page.locator(".entry .name").nth(0).click();
  await drawn(page, () => page.locator(".entry .name").nth(1).click());
  assert.equal(await page.inputValue("#expression"), 'dot | "a b"');
  await page.mouse.move(700, 20);
  await page.waitForTimeout(300);
  const expected = raster(join(SCRATCH, "dropped.svg"), "--expr", 'dot | "a b"', "--width", "300");
  const shown = await canvas(page);
  const zoom = Math.floor(Math.min((shown.width - 32) / 300, (shown.height - 32) / 200));
  const [left, top] = [Math.floor((shown.width - 300 * zoom) / 2), Math.floor((shown.height - 200 * zoom) / 2)];
  const probe = await line(page);
  for (let y = 0; y < 200; y++) {
    for (let x = 0; x < 300; x++) {
      if (Math.abs(y - probe) < 6) continue;
      assert.equal(shown.rgba[4 * ((top + y * zoom + (zoom >> 1)) * shown.width + left + x * zoom + (zoom >> 1))], expected.rgb[3 * (y * 300 + x)], `pixel ${x}, ${y}`);
    }
  }
  // Pointed at, a shape is lit.
  const before = await canvas(page);
  await page.locator(".entry .name").first().hover();
  await page.waitForTimeout(500);
  assert.notDeepEqual((await canvas(page)).rgba, before.rgba);
  assert.deepEqual(wrong, []);
  await close();
});

test("a scanline is told", async () => {
  const { page, wrong, close } = await tab(browser, service.address, { hash: "#sample=poster.svg&width=2000&expr=sky+-+sun" });
  await page.waitForFunction(() => document.querySelector("#told").textContent.includes("Crossed"));
  const y = await line(page);
  const args = ["fill", POSTER, "--expr", "sky - sun", "--width", "2000", "--lines", `${y}..${y + 1}`, "--format", "ndjson", "-o", "-"];
  const [, record] = execFileSync(RUNSET, args, { cwd: ROOT }).toString().split("\n").map((text) => text && JSON.parse(text));
  await page.click("#line-table summary");
  // The tables are made when they are opened.
  await page.locator("table").nth(1).locator("tbody tr").first().waitFor();
  const rows = await page.locator("table").nth(1).locator("tbody tr").allTextContents();
  assert.deepEqual(rows.map((text) => text.slice(0, 6)), record.runs.map(([a, b]) => `${a}${b}`.slice(0, 6)));
  const crossings = await page.locator("table").nth(0).locator("tbody tr").evaluateAll((rows) => rows.map((row) => [...row.cells].map((cell) => cell.textContent)));
  // Where it begins to hold and where it ends: the runs, once more.
  const ends = crossings.filter((cells, i) => cells[3] !== (i ? crossings[i - 1][3] : "no")).map((cells) => Number(cells[0]));
  assert.deepEqual(ends, record.runs.flatMap(([a, b]) => [a, b]));
  await page.click("[aria-label^='Follow the counter of sun']");
  await page.waitForFunction(() => document.querySelector("#chart").textContent.includes("sun: winding"));
  assert.deepEqual(wrong, []);
  await close();
});

test("a job is kept, followed, left in the middle by a reload, and taken up again", async () => {
  const { page, wrong, close } = await tab(browser, service.address, { hash: "#sample=poster.svg&width=36000&expr=art+%26+frame+-+logo&format=pbm" });
  await page.waitForFunction(() => document.querySelector("#canvas").dataset.done);
  await page.click("#keep");
  await page.waitForSelector(".job");
  await page.locator(".job .download").click();
  await page.waitForFunction(() => / MB here/.test(document.querySelector(".job .far")?.textContent ?? ""));
  assert.equal(await page.textContent(".job .state"), "saving");
  await page.reload();
  await page.waitForFunction(() => document.querySelector(".job .download")?.textContent === "Resume", undefined, { timeout: 20_000 });
  const have = await page.textContent(".job .far");
  const [download] = await Promise.all([page.waitForEvent("download", { timeout: 60_000 }), page.locator(".job .download").click()]);
  const got = join(SCRATCH, "job.pbm");
  await download.saveAs(got);
  assert.match(download.suggestedFilename(), /\.pbm$/);
  const wanted = join(SCRATCH, "wanted.pbm");
  execFileSync(RUNSET, ["fill", POSTER, "--expr", "art & frame - logo", "--width", "36000", "-o", wanted], { cwd: ROOT });
  execFileSync("cmp", [got, wanted]);
  console.log(`left at ${have}, resumed, ${readFileSync(wanted).length} bytes the same`);
  await page.waitForFunction(() => document.querySelector(".job .state").textContent === "done");
  await page.locator(".job .delete").click();
  await page.waitForSelector(".job", { state: "detached" });
  assert.deepEqual(wrong, []);
  await close();
});

test("a job is shown, also by its address; commands and downloads are the same raster", async () => {
  const { page, wrong, close } = await tab(browser, service.address, { hash: "#sample=scene.json&scale=2&format=rls" });
  await page.waitForFunction(() => document.querySelector("#canvas").dataset.done);
  const [download] = await Promise.all([page.waitForEvent("download"), page.click("#download")]);
  const files = { page: join(SCRATCH, "page.rls"), shell: join(SCRATCH, "scene.rls"), curl: join(SCRATCH, "curl") };
  await download.saveAs(files.page);
  const wanted = readFileSync(files.page);
  for (const id of ["command-runset", "command-curl"]) {
    if (id === "command-curl") try { execFileSync("curl", ["--version"]); } catch { continue; }
    const command = (await page.textContent(`#${id}`)).replace("examples/art/", `${ROOT}examples/art/`);
    execFileSync("sh", ["-c", command], { cwd: SCRATCH, env: { ...process.env, PATH: `${join(RUNSET, "..")}:${process.env.PATH}` }, stdio: "pipe" });
    assert.deepEqual(readFileSync(files.shell), wanted, id);
  }
  await page.click("#keep");
  await page.waitForSelector(".job");
  await drawn(page, () => page.locator(".job .show").first().click());
  assert.match(page.url(), /#job=[0-9a-f]+/);
  const first = await canvas(page);
  await page.reload();
  await page.waitForFunction(() => document.querySelector("#canvas").dataset.done);
  await page.waitForTimeout(300);
  assert.deepEqual((await canvas(page)).rgba, first.rgba);
  await page.locator(".job .delete").first().click();
  assert.deepEqual(wrong, []);
  await close();
});

test("a job is printed, and its print cancelled", async () => {
  const device = await printer();
  if (!device) return;
  const own = await serve({}, ["--printer", device.uri]);
  const { page, wrong, close } = await tab(browser, own.address, { hash: "#sample=poster.svg&dpi=300" });
  await page.waitForFunction(() => document.querySelector("#canvas").dataset.done);
  await page.click("#keep");
  await page.waitForSelector(".job .printing:not([hidden])");
  assert.equal(await page.locator(".job .printer option").count(), 1);
  const state = (...names) => page.waitForFunction((names) => names.includes(document.querySelector(".job .printing")?.dataset.print), names, { timeout: 30_000 });
  await page.locator(".job .print").click();
  await state("sending", "printing");
  assert.equal(await page.locator(".job .stop").isVisible(), true);
  // Behind a reload it is there still.
  await page.reload();
  await state("printing", "printed");
  await state("printed");
  assert.match(await page.textContent(".job .told"), /^printed on 127\.0\.0\.1/);
  await AxeBuilder(page, "a job that is printed");
  await page.locator(".job .print").click();
  await state("printing");
  await page.locator(".job .stop").click();
  await state("cancelled");
  assert.match(await page.textContent(".job .told"), /cancelled/);
  const { jobs } = await (await fetch(`${own.address}/v1/jobs`)).json();
  assert.equal(jobs[0].print.state, "cancelled");
  assert.deepEqual(wrong, []);
  await close();
  await own.end();
  device.end();
});

test("a job of a model is shown in its colours", async () => {
  const query = "kind=solid&imgsize=400,300&format=rls&colorscheme=DeepOcean";
  const answer = await fetch(`${service.address}/v1/jobs?${query}`, { method: "POST", body: readFileSync(model()), headers: { "Content-Type": "text/plain" } });
  const { id } = await answer.json();
  const { page, wrong, close } = await tab(browser, service.address, { hash: `#job=${id}` });
  await page.waitForFunction(() => document.querySelector("#canvas").dataset.done);
  await page.waitForTimeout(300);
  assert.match(await page.textContent(".job .format"), /^model, rls/);
  // Pixel by pixel in the middle of the canvas; the scanline that is looked at lies over it.
  assert.equal(await page.textContent("#zoom"), "100 %");
  const shown = await canvas(page);
  const expected = picture("solid", model(), "--imgsize", "400,300", "--colorscheme", "DeepOcean");
  const [left, top] = [Math.floor((shown.width - 400) / 2), Math.floor((shown.height - 300) / 2)];
  const { compared, different } = compare(shown, expected, left, top, (_, y) => Math.abs(y - top - 120) < 9);
  assert.ok(compared > 100_000, `${compared} pixels compared`);
  assert.equal(different, 0, "pixels that differ");
  await page.locator(".job .delete").first().click();
  await page.waitForSelector(".job", { state: "detached" });
  assert.deepEqual(wrong, []);
  await close();
});

test("by keyboard alone", async () => {
  const { page, wrong, close } = await tab(browser, service.address, { allow: [/422|400/] });
  await page.waitForFunction(() => document.querySelector("#canvas").dataset.done);
  const tabTo = async (id) => {
    for (let i = 0; i < 60; i++) {
      if (await page.evaluate((id) => document.activeElement?.id === id, id)) return;
      await page.keyboard.press("Tab");
    }
    assert.fail(`#${id} is not reached`);
  };
  await tabTo("expression");
  await page.keyboard.type("su");
  await page.waitForSelector("#completions li");
  assert.equal(await page.getAttribute("#expression", "aria-activedescendant"), "completion-0");
  await drawn(page, () => page.keyboard.press("Enter"));
  assert.equal(await page.inputValue("#expression"), "sun");
  await tabTo("canvas");
  const y = await line(page);
  await page.keyboard.press("ArrowDown");
  await page.waitForFunction((y) => document.querySelector("#line-title").textContent.includes(String(y + 1)), y);
  await page.keyboard.press("1");
  await page.waitForFunction(() => document.querySelector("#zoom").textContent === "1200 %");
  await page.keyboard.press("0");
  await tabTo("next");
  await page.keyboard.press("Enter");
  await page.waitForFunction(() => document.querySelector("#told").textContent.includes("Crossed"));
  await tabTo("keep");
  await page.keyboard.press("Enter");
  await page.waitForSelector(".job");
  const focus = await page.evaluate(() => getComputedStyle(document.activeElement).outlineStyle);
  assert.equal(focus, "solid", "the focus is seen");
  await page.locator(".job .delete").focus();
  await page.keyboard.press("Enter");
  await page.waitForSelector(".job", { state: "detached" });
  assert.deepEqual(wrong, []);
  await close();
});

test("wide and narrow, light and dark, without a fault that axe knows", async () => {
  for (const width of [1280, 390]) {
    for (const scheme of ["light", "dark"]) {
      const { page, wrong, close } = await tab(browser, service.address, { width, height: 800, scheme, hash: "#sample=poster.svg&dpi=300&expr=sky+-+sun", allow: [/422/] });
      await page.waitForFunction(() => document.querySelector("#told").textContent.includes("Crossed"));
      for (const summary of await page.locator("#plane summary").all()) await summary.click();
      await page.click("#keep");
      await page.waitForSelector(".job");
      await AxeBuilder(page, `${width} ${scheme}`);
      await page.fill("#expression", "sky - s");
      await page.waitForSelector("#completions li");
      await page.waitForSelector("#expression-problem:not([hidden])");
      await AxeBuilder(page, `${width} ${scheme}, an error and completions`);
      const [inner, scroll] = await page.evaluate(() => [innerWidth, document.scrollingElement.scrollWidth]);
      assert.ok(scroll <= inner, `${scroll} px in ${inner}`);
      await page.locator(".job .delete").first().click();
      assert.equal(await page.evaluate(() => document.documentElement.dataset.theme), scheme);
      await page.click("#theme");
      assert.notEqual(await page.evaluate(() => document.documentElement.dataset.theme), scheme);
      assert.deepEqual(wrong, []);
      await close();
    }
  }
});

test("a service that asks for a token", async (t) => {
  const other = await serve({ RUNSET_TOKEN: "a-token-of-the-tests" });
  t.after(() => other.end());
  const { page, wrong, close } = await tab(browser, other.address, { allow: [/401/] });
  await page.waitForSelector("#token-dialog[open]");
  await page.fill("#token", "a-token-of-the-tests");
  await drawn(page, () => page.keyboard.press("Enter"));
  page.allow.length = 1;
  assert.equal(await page.evaluate(() => sessionStorage.getItem("runset-token")), "a-token-of-the-tests");
  assert.match(await page.textContent("#command-curl"), /Authorization: Bearer \$RUNSET_TOKEN/);
  await page.selectOption("#format", "rls");
  await page.click("#keep");
  await page.waitForSelector(".job");
  const [download] = await Promise.all([page.waitForEvent("download"), page.locator(".job .download").click()]);
  assert.ok(await download.path());
  await page.waitForFunction(() => document.querySelector(".job .state").textContent === "done");
  assert.deepEqual(wrong, []);
  await close();
});

test("a stream that breaks off is shown as broken", async (t) => {
  const other = await serve();
  t.after(() => other.end());
  const { page, close } = await tab(browser, other.address, { hash: "#sample=poster.svg&dpi=9000" });
  await page.waitForFunction(() => document.querySelector("#canvas").dataset.done);
  await page.click("#all-lines");
  await page.waitForFunction(() => / of /.test(document.querySelector("#stats dd").textContent));
  await other.end("SIGKILL");
  await page.waitForSelector("#stream-problem:not([hidden])");
  assert.match(await page.textContent("#stream-problem"), /^Broken: /);
  await page.fill("#expression", "sky");
  await page.waitForFunction(() => /does not answer/.test(document.querySelector("#stream-problem").textContent));
  await close();
});

test("65,536 x 65,536 pixels in a tab", async () => {
  const { page, wrong, close } = await tab(browser, service.address);
  await page.waitForFunction(() => document.querySelector("#canvas").dataset.done);
  await drawn(page, () => page.fill("#expression", "art & frame - logo"));
  await page.selectOption("#size-mode", "box");
  await page.fill("#size-first", "65536");
  await drawn(page, () => page.fill("#size-second", "65536"));
  const session = await page.context().newCDPSession(page);
  let [most, whole, heap] = [0, 0, 0];
  const look = async () => {
    const { tab, all } = memory();
    most = Math.max(most, tab);
    whole = Math.max(whole, all);
    heap = Math.max(heap, (await session.send("Runtime.getHeapUsage")).usedSize / 1e6);
  };
  const before = Number(await page.getAttribute("#canvas", "data-done"));
  await page.click("#all-lines");
  for (;;) {
    await look();
    if (Number(await page.getAttribute("#canvas", "data-done")) > before) break;
    await page.waitForTimeout(100);
  }
  const speed = await page.locator("#stats dd").nth(1).textContent();
  const runs = await page.locator("#stats dd").nth(2).textContent();
  for (const [x, y] of [[300, 150], [450, 200], [500, 260]]) {
    await page.click("#fit");
    await page.locator("#canvas").hover({ position: { x, y } });
    await page.click("#pixels");
    await page.waitForTimeout(500);
    await look();
  }
  console.log(`65,536 lines at ${speed} a second, ${runs} runs; the tab has at most ${most.toFixed(0)} MB, its heap ${heap.toFixed(0)} MB, all of the browser ${whole.toFixed(0)} MB`);
  assert.ok(most > 0 && most < 300, `${most} MB`);
  assert.deepEqual(wrong, []);
  await close();
});
