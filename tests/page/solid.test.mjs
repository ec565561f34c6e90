// The tab of models, end to end: turned, cut, pointed at and dragged in a real browser, beside the command line.

import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import AxeBuilder from "./axe.mjs";
import { ROOT, SCRATCH, browser as launch, canvas, clean, compare, drawn, drop, model, picture, serve, tab } from "./help.mjs";

let service, browser;
before(async () => {
  [service, browser] = await Promise.all([serve(), launch()]);
});
after(async () => {
  await browser?.close();
  await service?.end();
  clean();
});

const CANVAS = "#solid-canvas";
const SAMPLES = ["bracket.csg", "cubes.csg", "sponge.csg"];
const sample = (name) => join(ROOT, "examples/models", name);
const radians = (degrees) => (degrees * Math.PI) / 180;
/** Until the picture rests. */
const rests = (page, act) => drawn(page, act, CANVAS);

/** A tab with a sample that is drawn. */
async function open(name, options = {}) {
  const opened = await tab(browser, service.address, { hash: `#model=${name}`, ...options });
  await opened.page.waitForFunction((which) => document.querySelector(which).dataset.done, CANVAS);
  await opened.page.waitForTimeout(200);
  return opened;
}

/** The camera that sees all of a box, by hand: its middle, and half its diagonal over the sine of half the field of view, more on pages higher than wide. */
function fitted([least, most], { width, height }) {
  const far = (Math.hypot(...least.map((x, i) => most[i] - x)) / 2 / Math.sin(radians(11.25))) * Math.max(height / width, 1);
  return { target: least.map((x, i) => (x + most[i]) / 2), tilt: 55, turn: 25, far };
}
const size = (page) => page.evaluate((which) => ({ width: document.querySelector(which).width, height: document.querySelector(which).height }), CANVAS);
const bounds = async () => (await (await fetch(`${service.address}/v1/models`)).json()).models[0].bounds;

/** Whether the canvas is the command line's picture, to the pixel. */
async function shows(page, file, { target, tilt, turn, far }, ...more) {
  const { width, height } = await size(page);
  const camera = [...target, tilt, 0, turn, far].join(",");
  // What makes it finer at rest has the names of the command line.
  const fine = await page.locator("#solid-fine select").evaluateAll((fields) =>
    fields.filter((field) => field.value).flatMap(({ name, value }) => (value === "true" ? `--${name}` : `--${name}=${value}`)));
  const expected = picture("solid", file, "--imgsize", `${width},${height}`, `--camera=${camera}`, ...fine, ...more);
  const { compared, different } = compare(await canvas(page, CANVAS), expected, 0, 0);
  assert.equal(compared, width * height);
  assert.ok(new Set(expected.rgb).size > 6, "there is something to compare");
  return different;
}

/** Has a text in a file. */
function written(text) {
  const path = join(SCRATCH, `text-${Math.random()}.csg`);
  writeFileSync(path, text);
  return path;
}

test("turned, shifted, nearer, cut: the command line's pictures", async () => {
  const { page, wrong, close } = await open("bracket.csg");
  const file = sample("bracket.csg");
  assert.equal(await page.inputValue("#csg"), readFileSync(file, "utf8"));
  assert.match(await page.textContent("#solid-note"), /^bracket\.csg, .* 9 parts, 269 faces/);
  const page_ = await size(page);
  const box = await bounds();
  const at = fitted(box, page_);
  assert.equal(await shows(page, file, at), 0);

  // Half a degree for a pixel; then 4 for a key.
  const on = await page.locator(CANVAS).boundingBox();
  await page.mouse.move(on.x + 300, on.y + 200);
  await page.mouse.down();
  await rests(page, async () => {
    for (let i = 1; i <= 10; i++) await page.mouse.move(on.x + 300 + 4 * i, on.y + 200 - i);
    await page.mouse.up();
  });
  [at.turn, at.tilt] = [25 - 20, 55 + 5];
  assert.equal(await shows(page, file, at), 0, "turned");
  await page.focus(CANVAS);
  await rests(page, () => page.keyboard.press("ArrowLeft"));
  at.turn += 4;
  await rests(page, () => page.keyboard.press("+"));
  at.far /= 1.25;
  assert.equal(await shows(page, file, at), 0, "nearer");
  // Shifted 40 pixels to the right with the button on the right: what is looked at goes to the left.
  await page.mouse.move(on.x + 300, on.y + 200);
  await page.mouse.down({ button: "right" });
  await rests(page, async () => {
    await page.mouse.move(on.x + 340, on.y + 200);
    await page.mouse.up({ button: "right" });
  });
  const pixel = (2 * at.far * Math.tan(radians(11.25))) / page_.height;
  const before = [...at.target];
  at.target = [before[0] - 40 * pixel * Math.cos(radians(at.turn)), before[1] - 40 * pixel * Math.sin(radians(at.turn)), before[2]];
  assert.ok((await shows(page, file, at)) <= 4, "shifted: off by rounding at most");
  await rests(page, () => page.keyboard.press("0"));
  Object.assign(at, { target: before, far: fitted(box, page_).far });

  // Cut across z in the middle, then higher, then what is below.
  await page.focus(CANVAS);
  await rests(page, () => page.keyboard.press("z"));
  assert.equal(await shows(page, file, at, "--section=0,0,1,26.5"), 0, "cut");
  await rests(page, () => page.keyboard.press("]"));
  assert.equal(await shows(page, file, at, `--section=0,0,1,${(53 * 210) / 400}`), 0, "cut higher");
  await rests(page, () => page.check("#section-other"));
  assert.equal(await shows(page, file, at, `--section=0,0,-1,${(-53 * 210) / 400}`), 0, "what is above");
  await rests(page, () => page.selectOption("#section-axis", ""));
  await page.selectOption("#solid-projection", "o");
  await rests(page, () => page.selectOption("#solid-scheme", "Starnight"));
  assert.equal(await shows(page, file, at, "--projection", "o", "--colorscheme", "Starnight"), 0);
  // The wheel keeps the point under it where it is: in an orthographic view exactly.
  const [x, y] = [600, 200];
  await page.mouse.move(on.x + x, on.y + y);
  await rests(page, () => page.mouse.wheel(0, -200));
  await rests(page, () => page.click("#solid-fit"));

  // At rest it is finer, by whatever the service offers.
  for (const field of await page.locator("#solid-fine select").all()) {
    if (!(await field.isVisible())) continue;
    const values = await field.locator("option").evaluateAll((options) => options.map(({ value }) => value));
    await rests(page, () => field.selectOption(values.at(-1)));
    assert.equal(await shows(page, file, at, "--projection", "o", "--colorscheme", "Starnight"), 0, values.at(-1));
  }
  assert.deepEqual(wrong, []);
  await close();
});

/** The middle of what shows a primitive, by the command line's numbers. */
function middle(file, primitive, { target, tilt, turn, far }, { width, height }) {
  const out = join(SCRATCH, "parts.pgm");
  picture("solid", file, "--imgsize", `${width},${height}`, `--camera=${[...target, tilt, 0, turn, far].join(",")}`, "--aov", `primitive=${out}`);
  const bytes = readFileSync(out);
  const pixels = bytes.subarray(bytes.length - 2 * width * height);
  const found = [];
  for (let i = 0; i < width * height; i++) if (pixels.readUInt16BE(2 * i) === primitive) found.push([i % width, Math.floor(i / width)]);
  assert.ok(found.length > 50, `primitive ${primitive} is seen`);
  const [cx, cy] = [0, 1].map((k) => found.reduce((sum, p) => sum + p[k], 0) / found.length);
  return found.sort((a, b) => Math.hypot(a[0] - cx, a[1] - cy) - Math.hypot(b[0] - cx, b[1] - cy))[0];
}

test("a click shows the primitive and where it stands", async () => {
  const { page, wrong, close } = await open("bracket.csg");
  const file = sample("bracket.csg");
  const at = fitted(await bounds(), await size(page));
  const on = await page.locator(CANVAS).boundingBox();
  for (const [primitive, kind, line, inside] of [[1, "cube", 5, false], [3, "linear_extrude", 10, false], [4, "cylinder", 14, false], [5, "cylinder", 17, true], [8, "cylinder", 20, true]]) {
    const [x, y] = middle(file, primitive, at, await size(page));
    await page.mouse.click(on.x + x, on.y + y);
    await page.waitForFunction((text) => document.querySelector("#picked").textContent.startsWith(text), `${kind}, line ${line}: primitive ${primitive}, ${inside ? "taken" : "at"}`);
    const selected = await page.evaluate(() => {
      const { value, selectionStart, selectionEnd } = document.querySelector("#csg");
      return value.slice(selectionStart, selectionEnd);
    });
    assert.ok(selected.startsWith(`${kind}(`), selected);
    assert.ok(await page.isVisible("#csg-bar"));
  }
  await page.mouse.click(on.x + 5, on.y + 5);
  await page.waitForFunction(() => document.querySelector("#picked").textContent.startsWith("The background"));
  // By a key: what is in the middle, nearer and a little aside.
  await page.focus(CANVAS);
  for (let i = 0; i < 3; i++) await page.keyboard.press("Shift+ArrowUp");
  await rests(page, () => page.keyboard.press("+"));
  await page.keyboard.press("Enter");
  await page.waitForFunction(() => /, line \d+: primitive/.test(document.querySelector("#picked").textContent));
  assert.deepEqual(wrong, []);
  await close();
});

test("a primitive that is dragged moves in the picture and in the text", async () => {
  const { page, wrong, close } = await open("bracket.csg");
  const file = sample("bracket.csg");
  const text = readFileSync(file, "utf8");
  const at = fitted(await bounds(), await size(page));
  const on = await page.locator(CANVAS).boundingBox();
  await page.evaluate((which) => {
    window.frames_ = [];
    document.querySelector(which).addEventListener("frame", (event) => window.frames_.push(event.detail));
  }, CANVAS);
  // A hole whose own axes are turned against the model's.
  const [x, y] = middle(file, 8, at, await size(page));
  const drag = async (dx, dy) => {
    await page.keyboard.down("Control");
    await page.mouse.move(on.x + x, on.y + y);
    await page.mouse.down();
    await page.waitForTimeout(200);
    for (let i = 1; i <= 20; i++) {
      await page.mouse.move(on.x + x + (dx * i) / 20, on.y + y + (dy * i) / 20);
      await page.waitForTimeout(25);
    }
    const live = await canvas(page, CANVAS);
    await page.mouse.up();
    await page.keyboard.up("Control");
    return live;
  };
  const still = await canvas(page, CANVAS);
  let live;
  await rests(page, async () => (live = await drag(30, 40)));
  assert.ok(!still.rgba.equals(live.rgba), "the picture goes along");
  const edited = await page.inputValue("#csg");
  const wrap = /multmatrix\(\[\[1, 0, 0, ([^\]]+)\], \[0, 1, 0, ([^\]]+)\], \[0, 0, 1, ([^\]]+)\], \[0, 0, 0, 1\]\]\) \{ cylinder\(h = 8, r1 = 4, r2 = 4, \$fn = 32, center = false\); \}/;
  const [, ...own] = wrap.exec(edited).map(Number);
  assert.equal(edited.replace(wrap, "cylinder(h = 8, r1 = 4, r2 = 4, $fn = 32, center = false);"), text, "and nothing else is changed");
  // The matrix around it takes (x, y, z) to (z, y, -x); on the screen it went as far as the pointer, by hand.
  const by = [own[2], own[1], -own[0]];
  const turned = [Math.cos(radians(25)), Math.sin(radians(25)), 0];
  const across = by[0] * turned[0] + by[1] * turned[1];
  assert.ok(across > 0 && Math.abs(by[0] * -turned[1] + by[1] * turned[0]) > 0 && by[2] < 0, `${by}`);
  assert.equal(await shows(page, written(edited), at), 0, "text and picture agree");
  const frames = await page.evaluate(() => window.frames_);
  const moving = frames.filter((frame) => frame.moving);
  assert.ok(moving.length > 5, `${moving.length} pictures on the way`);
  assert.ok(moving.some((frame) => frame.patch && frame.lines < 0.5 * frame.height), "some of them drew few lines");
  assert.match(await page.textContent("#picked"), /^cylinder, line 20: primitive 8/);

  // Dragged again, it is the same matrix.
  await rests(page, async () => {
    const [again] = [middle(written(edited), 8, at, await size(page))];
    await page.keyboard.down("Control");
    await page.keyboard.down("Shift");
    await page.mouse.move(on.x + again[0], on.y + again[1]);
    await page.mouse.down();
    await page.waitForTimeout(200);
    for (let i = 1; i <= 5; i++) await page.mouse.move(on.x + again[0], on.y + again[1] - 4 * i);
    await page.waitForTimeout(100);
    await page.mouse.up();
    await page.keyboard.up("Shift");
    await page.keyboard.up("Control");
  });
  const second = await page.inputValue("#csg");
  const [, ...sum] = wrap.exec(second).map(Number);
  assert.equal(second.match(/multmatrix/g).length, edited.match(/multmatrix/g).length);
  const steps = sum.map((x, i) => x - own[i]);
  assert.ok(steps[0] < 0 && Math.abs(steps[1]) + Math.abs(steps[2]) < 1e-9, `along z alone, which is -x of its own: ${steps}`);
  assert.equal(await shows(page, written(second), at), 0);

  // Taken back, one after the other.
  await page.focus(CANVAS);
  await rests(page, () => page.keyboard.press("Control+z"));
  assert.equal(await page.inputValue("#csg"), edited);
  await rests(page, () => page.keyboard.press("Control+z"));
  assert.equal(await page.inputValue("#csg"), text);
  assert.equal(await shows(page, file, at), 0, "and so is the picture");

  // Left in the middle: nothing has happened.
  await page.keyboard.down("Control");
  await page.mouse.move(on.x + x, on.y + y);
  await page.mouse.down();
  await page.mouse.move(on.x + x + 30, on.y + y);
  await page.waitForTimeout(200);
  await page.keyboard.up("Control");
  await rests(page, () => page.keyboard.press("Escape"));
  await page.mouse.up();
  assert.equal(await page.inputValue("#csg"), text);

  // By keys: what is pointed at, in the mode for it.
  await page.mouse.click(on.x + x, on.y + y);
  await page.waitForFunction(() => document.querySelector("#picked").textContent.includes("primitive 8"));
  await page.keyboard.press("m");
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("ArrowRight");
  await page.waitForFunction((text) => document.querySelector("#csg").value !== text, text);
  const [, ...pushed] = wrap.exec(await page.inputValue("#csg")).map(Number);
  // 20 pixels to the right: the axis that is turned by 25 degrees.
  assert.ok(Math.abs(pushed[1] / pushed[2] - Math.tan(radians(25))) < 0.05 && Math.abs(pushed[0]) < 1e-9, `${pushed}`);
  assert.deepEqual(wrong, []);
  await close();
});

test("what a move writes", async () => {
  const { page, wrong, close } = await open("cubes.csg");
  const write = (text, start, matrix, by) =>
    page.evaluate(async ([text, start, matrix, by]) => {
      const { move } = await import("/web/moves.js");
      const change = move(text, start, matrix, by);
      return change && text.slice(0, change.start) + change.text + text.slice(change.end);
    }, [text, start, matrix, by]);
  const one = [[1, 0, 0, 7], [0, 1, 0, 8], [0, 0, 1, 9]];
  const at = (x, y, z, inner) => `multmatrix([[1, 0, 0, ${x}], [0, 1, 0, ${y}], [0, 0, 1, ${z}], [0, 0, 0, 1]]) { ${inner} }`;
  assert.equal(await write("cube(size = 3);\nsphere();", 0, one, [1, -2.5, 0]), `${at(1, -2.5, 0, "cube(size = 3);")}\nsphere();`);
  assert.equal(await write(at(1, -2.5, 0, "cube(size = 3);"), at(1, -2.5, 0, "").length - 2, one, [0.5, 2.5, 1e-9]), at(1.5, 0, 1e-9, "cube(size = 3);"));
  // Strings and comments may hold anything; a block belongs to its statement.
  const hull = 'hull(/* ) } ; */ a = ")};\\"") { cube(); // }\n sphere(); }';
  assert.equal(await write(`union() { ${hull} cube(); }`, 10, one, [0, 0, 1]), `union() { ${at(0, 0, 1, hull)} cube(); }`);
  // Half as large and turned: twice as far, along another axis.
  assert.equal(await write("cube();", 0, [[0, -0.5, 0, 1], [0.5, 0, 0, 1], [0, 0, 0.5, 1]], [1, 0, 2]), at(0, -2, 4, "cube();"));
  assert.equal(await write("cube();", 0, [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 0]], [1, 0, 2]), undefined);
  assert.deepEqual(wrong, []);
  await close();
});

test("text that is typed, wrong or not, and files that are dropped", async () => {
  const { page, wrong, close } = await open("cubes.csg", { allow: [/404|400/] });
  await page.fill("#csg", "union() {\n  cube(size = [1, 2, 3]);\n  sphere(r = 1\n}");
  await page.waitForSelector("#solid-problem:not([hidden])");
  assert.match(await page.textContent("#solid-problem"), /^cubes\.csg:\d:\d+: /);
  assert.ok(await page.evaluate(() => document.querySelector("#csg-bar").classList.contains("wrong")));
  assert.match(await page.textContent("#solid-note"), /of the text before/);
  const right = "union() {\n  cube(size = [1, 2, 3]);\n  sphere(r = 1);\n}";
  await rests(page, () => page.fill("#csg", right));
  assert.ok(await page.isHidden("#solid-problem"));
  // It was looked at as a whole before, and is from there still.
  const old = fitted([[0, 0, 0], [45, 30, 30]], await size(page));
  assert.equal(await shows(page, written(right), old), 0);

  const text = readFileSync(model(), "utf8");
  await rests(page, () => drop(page, "block.csg", text));
  assert.match(await page.textContent("#solid-note"), /^block\.csg, .* 3 parts, /);
  const at = fitted(await bounds(), await size(page));
  assert.equal(await shows(page, model(), at), 0);
  // A service that has let go of it is sent it again.
  const { models } = await (await fetch(`${service.address}/v1/models`)).json();
  await fetch(`${service.address}/v1/models/${models[0].id}`, { method: "DELETE" });
  await page.focus(CANVAS);
  await rests(page, () => page.keyboard.press("ArrowUp"));
  assert.equal(await shows(page, model(), { ...at, tilt: 59 }), 0);
  assert.ok(await page.isHidden("#sight-problem"));

  const stl = "solid a\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex 1 0 0\nendloop\nendfacet\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 0 1\nendloop\nendfacet\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0 0 1\nvertex 0 1 0\nendloop\nendfacet\nfacet normal 0 0 0\nouter loop\nvertex 1 0 0\nvertex 0 1 0\nvertex 0 0 1\nendloop\nendfacet\nendsolid a\n";
  await rests(page, () => drop(page, "corner.stl", stl));
  assert.ok(await page.isDisabled("#csg"));
  assert.match(await page.textContent("#solid-note"), /^corner\.stl, .* 4 faces/);
  // To the drawings and back.
  await page.click("#tab-plane");
  await page.waitForFunction(() => document.querySelector("#canvas").dataset.done);
  assert.ok(await page.isVisible("#expression") && await page.isHidden("#csg"));
  await page.keyboard.press("ArrowRight");
  assert.ok(await page.isVisible("#csg"));
  assert.deepEqual(wrong, []);
  await close();
});

test("pictures a second while it is dragged, at 512 x 512", async () => {
  const { page, wrong, close } = await open("bracket.csg");
  for (let i = 0; i < 3; i++) {
    const { width, height } = await size(page);
    const viewport = page.viewportSize();
    await page.setViewportSize({ width: viewport.width + 512 - width, height: viewport.height + 512 - height });
    await page.waitForTimeout(200);
  }
  assert.deepEqual(await size(page), { width: 512, height: 512 });
  await page.evaluate((which) => {
    window.frames_ = [];
    document.querySelector(which).addEventListener("frame", (event) => window.frames_.push({ ...event.detail, at: performance.now() }));
  }, CANVAS);
  const median = (numbers) => numbers.sort((a, b) => a - b)[numbers.length >> 1];
  for (const name of SAMPLES) {
    if ((await page.inputValue("#solid-sample")) !== name) await rests(page, () => page.selectOption("#solid-sample", name));
    const on = await page.locator(CANVAS).boundingBox();
    const at = fitted(await bounds(), await size(page));
    const parts = { "bracket.csg": 8, "cubes.csg": 4, "sponge.csg": 2 };
    const [x, y] = middle(sample(name), parts[name], at, await size(page));
    for (const how of ["turned", "a part moved"]) {
      await page.evaluate(() => (window.frames_ = []));
      if (how !== "turned") await page.keyboard.down("Control");
      await page.mouse.move(on.x + x, on.y + y);
      await page.mouse.down();
      await page.waitForTimeout(100);
      for (let i = 1; i <= 60; i++) {
        await page.mouse.move(on.x + x + 20 * Math.sin(i / 6), on.y + y + 20 * Math.sin(i / 9));
        await page.waitForTimeout(12);
      }
      const frames = (await page.evaluate(() => window.frames_)).filter((frame) => frame.moving);
      if (how !== "turned") await page.keyboard.up("Control");
      await page.keyboard.press("Escape");
      await page.mouse.up();
      await page.waitForTimeout(400);
      const ms = median(frames.map((frame) => frame.ms));
      const apart = median(frames.slice(1).map((frame, i) => frame.at - frames[i].at));
      const lines = median(frames.map((frame) => frame.lines));
      const sizes = [...new Set(frames.map(({ width, height }) => `${width} x ${height}`))].join(", ");
      console.log(`${name}, ${how}: ${frames.length} pictures, ${ms.toFixed(1)} ms each, one in ${apart.toFixed(1)} ms; ${lines} lines of ${sizes}`);
      // 15 a second are 67 ms; a machine that is busy has some more.
      assert.ok(ms < 150, `${ms} ms`);
    }
    await rests(page, () => page.click("#solid-fit"));
  }
  assert.deepEqual(wrong, []);
  await close();
});

test("wide and narrow, light and dark, without a fault that axe knows", async () => {
  for (const width of [1280, 390]) {
    for (const scheme of ["light", "dark"]) {
      const { page, wrong, close } = await open("bracket.csg", { width, height: 800, scheme, allow: [/400/] });
      await page.click(".under summary");
      await page.focus(CANVAS);
      await rests(page, () => page.keyboard.press("x"));
      await page.keyboard.press("Enter");
      await page.waitForFunction(() => document.querySelector("#picked").textContent.trim());
      await AxeBuilder(page, `${width} ${scheme}`);
      if (process.env.RUNSET_PICTURES) await page.screenshot({ path: join(process.env.RUNSET_PICTURES, `solid-${width}-${scheme}.png`), fullPage: true });
      await page.fill("#csg", "cube(");
      await page.waitForSelector("#solid-problem:not([hidden])");
      await AxeBuilder(page, `${width} ${scheme}, an error`);
      assert.ok(await page.evaluate(() => innerWidth >= document.scrollingElement.scrollWidth), "the panels fit");
      assert.deepEqual(wrong, []);
      await close();
    }
  }
});
