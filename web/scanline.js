// One scanline, seen as the engine sees it: crossings from left to right, the count, and the runs that come of it.
//
//   crossings   |a   |b      |a   |b          the chart stands under the canvas, column under column
//   a           =============                 what holds
//   count      _|1  ‾|2     _|1   |0          with its threshold
//   runs             ########

import { at, draw, make, number } from "./dom.js";

/**
 * What POST /v1/explain tells.
 * @typedef {{ name: string | null, rule: string, k: number | null, inputs: [number, number][], operands: number, start: number, ink: number | null }} Node
 * @typedef {{ column: number, crossed: [number, number][], counts: [number, number][] }} Step
 * @typedef {{ y: number, since: number, nodes: Node[], steps: Step[], runs: [number, number, number][] }} Line
 * @typedef {{ width: number, inks: string[], lines: [number, number, string][], line: Line | null }} Explanation
 */

/** Lanes of operands or layers at most. */
const MOST_LANES = 5;
/** Rows of a table at most. */
const MOST_ROWS = 200;
/** Crossings that are drawn in the view at most. */
const MOST_TICKS = 1500;

const SENTENCES = {
  counted: () => "Counted: something entered, ended or passed another.",
  unordered: () => "Counted column by column, without order: too much changes places here.",
  carried: (/** @type {Line} */ line) => `Carried over from line ${line.since}: no crossing came, went or changed its place, so nothing was counted.`,
  repeated: (/** @type {Line} */ line) => `Repeats the line above; counted last on line ${line.since}. Nothing moves here.`,
};

export class Scanline extends EventTarget {
  /** @param {import("./stage.js").Stage} stage */
  constructor(stage) {
    super();
    this.stage = stage;
    /** @type {Explanation | undefined} */
    this.told = undefined;
    /** @type {{ id: string, told: Explanation } | undefined} the shape whose counter is followed */
    this.followed = undefined;
    stage.addEventListener("view", () => this.render());
    stage.addEventListener("probe", () => this.#look());
    at("previous").addEventListener("click", () => this.#step(-1));
    at("next").addEventListener("click", () => this.#step(1));
    at("line-table").addEventListener("toggle", () => this.#tables());
  }

  /** @param {Explanation | undefined} told @param {{ id: string, told: Explanation }} [followed] */
  show(told, followed) {
    this.told = told;
    this.followed = followed;
    at("line-title").textContent = told?.line ? `Scanline ${told.line.y}` : "Scanline";
    const how = told?.lines[0]?.[2];
    at("line-how").textContent = told?.line && how ? SENTENCES[/** @type {keyof typeof SENTENCES} */ (how)](told.line) : "";
    at("line-how").className = `grow how ${how ?? ""}`;
    if (!told?.line) at("told").textContent = "";
    this.render();
    this.#tables();
    this.#look();
  }

  get #line() {
    return this.told?.line ?? undefined;
  }

  /** The node that is drawn, if the picture is one region; layers are several. */
  #root() {
    const roots = this.#line?.nodes.flatMap((node, i) => (node.ink === null ? [] : [i])) ?? [];
    return roots.length === 1 ? roots[0] : undefined;
  }

  /** Goes to the crossing before or behind. @param {number} by */
  #step(by) {
    const steps = this.#line?.steps ?? [];
    const { x, y } = this.stage.probe;
    const found = by > 0 ? steps.find((step) => step.column > x) : steps.findLast((step) => step.column < x);
    if (found) this.stage.look(found.column, y, true);
  }

  /** Says what is at the pixel that is looked at. */
  #look() {
    const line = this.#line;
    const { x, y } = this.stage.probe;
    const marker = at("chart").querySelector(".marker");
    if (marker) marker.setAttribute("transform", `translate(${this.stage.left(x + 0.5)} 0)`);
    if (!line || line.y !== y) return;
    const run = line.runs.find(([start, end]) => start <= x && x < end);
    const inks = this.told?.inks ?? [];
    const where = run ? `in the run ${run[0]} to ${run[1]}, ${number(run[1] - run[0])} px${inks.length > 1 ? `, ${inks[run[2]]}` : ""}` : "on paper";
    const step = line.steps.findLast((step) => step.column <= x);
    at("told").textContent = `Pixel ${x}, ${y}: ${where}. ${step ? this.#sentence(line, step) : "No crossing before it: every count is as at the left side."}`;
  }

  /** @param {Line} line @param {Step} step */
  #sentence(line, step) {
    const shapes = [...new Set(step.crossed.map(([node]) => node))];
    const names = shapes.slice(0, 3).map((node) => {
      const before = countBefore(line, node, step);
      const now = step.counts.find(([changed]) => changed === node)?.[1] ?? before;
      const [held, holds] = [truth(line.nodes[node], before), truth(line.nodes[node], now)];
      return `${label(line, node)} ${held === holds ? "goes on" : holds ? "begins" : "ends"} (winding ${minus(before)} \u2192 ${minus(now)})`;
    });
    if (shapes.length > 3) names.push(`${shapes.length - 3} more`);
    const root = this.#root();
    let what = "";
    if (root !== undefined) {
      const now = step.counts.find(([node]) => node === root)?.[1];
      const before = countBefore(line, root, step);
      const [held, holds] = [truth(line.nodes[root], before), truth(line.nodes[root], now ?? before)];
      const { operands, rule, k } = line.nodes[root];
      const met = rule === "odd" ? "odd" : rule === "nonzero" ? "not 0" : `at least ${k}`;
      const turn = held === holds ? "" : holds ? `${met}, a run begins` : `not ${met}, the run ends`;
      if (operands === 0) what = turn || "the run goes on";
      else if (now === undefined) what = `the count stays ${minus(before)}`;
      else what = `the count goes from ${minus(before)} to ${minus(now)}${turn && `: ${turn}`}`;
    } else {
      const flips = step.counts.flatMap(([node, now]) => {
        const [held, holds] = [truth(line.nodes[node], countBefore(line, node, step)), truth(line.nodes[node], now)];
        return line.nodes[node].ink === null || held === holds ? [] : [`${label(line, node)} ${holds ? "begins" : "ends"}`];
      });
      what = flips.length ? flips.slice(0, 3).join(", ") : "no layer begins or ends";
    }
    return `Crossed at column ${step.column}: ${names.join(", ")}; ${what}.`;
  }

  /** Draws the chart. */
  render() {
    const chart = at("chart");
    const line = this.#line;
    if (!line || !this.told) return chart.replaceChildren();
    const { stage } = this;
    const width = chart.clientWidth;
    const X = (/** @type {number} */ column) => Math.round(Math.min(Math.max(stage.left(column), -4), width + 4) * 10) / 10;
    const lanes = this.#lanes(line, X, width);
    let y = 0;
    const svg = draw("svg", { width, role: "img", "aria-label": `Crossings, counts and runs of line ${line.y}; the table below has the numbers` });
    for (const lane of lanes) {
      const group = draw("g", { transform: `translate(0 ${y})`, class: "lane" });
      group.append(draw("line", { x1: 0, x2: width, y1: lane.height - 0.5, y2: lane.height - 0.5, class: "rule" }), ...lane.parts);
      group.append(draw("rect", { x: 4, y: 1, width: lane.name.length * 6.1 + 9, height: 15, rx: 3, class: "plate" }), draw("text", { x: 8, y: 12, class: "label" }, lane.name));
      svg.append(group);
      y += lane.height;
    }
    svg.append(draw("line", { class: "marker", x1: 0, x2: 0, y1: 0, y2: y, transform: `translate(${X(stage.probe.x + 0.5)} 0)` }));
    svg.setAttribute("height", String(y));
    chart.replaceChildren(svg);
  }

  /**
   * @param {Line} line @param {(column: number) => number} X @param {number} width
   * @returns {{ name: string, height: number, parts: Element[] }[]}
   */
  #lanes(line, X, width) {
    const bars = (/** @type {[number, number, string?][]} */ spans, /** @type {string} */ name) =>
      spans.filter(([start, end]) => X(end) > 0 && X(start) < width)
        .map(([start, end, fill]) => draw("rect", { x: X(start), width: Math.max(X(end) - X(start), 0.5), y: 3, height: 12, class: name, ...(fill ? { fill } : {}) }));
    const seen = line.steps.filter((step) => X(step.column) >= 0 && X(step.column) <= width);
    const turns = turned(line);
    const ticks = seen.slice(0, MOST_TICKS).map((step) => {
      const by = turns.get(step) ?? 0;
      return draw("line", { x1: X(step.column), x2: X(step.column), y1: by > 0 ? 2 : 8, y2: by < 0 ? 16 : 10, class: by > 0 ? "tick enter" : by < 0 ? "tick leave" : "tick" });
    });
    const lanes = [{ name: `${number(line.steps.reduce((n, s) => n + s.crossed.length, 0))} crossings`, height: 18, parts: ticks }];
    const root = this.#root();
    const end = this.told?.width ?? 0;
    const holding = (/** @type {number} */ node) => spans(line, node, end);
    if (root !== undefined) {
      const { inputs, operands } = line.nodes[root];
      for (const [node, weight] of inputs.slice(0, MOST_LANES)) {
        lanes.push({ name: `${label(line, node)} ${signed(weight)}`, height: 18, parts: bars(holding(node), weight < 0 ? "bar minus" : "bar") });
      }
      if (operands > Math.min(inputs.length, MOST_LANES)) {
        lanes.push({ name: `and ${operands - Math.min(inputs.length, MOST_LANES)} more`, height: 18, parts: [] });
      }
      lanes.push(counter(line, root, X, end, line.nodes[root].operands ? "count" : `${label(line, root)}: winding`));
    } else {
      const layers = line.nodes.flatMap((node, i) => (node.ink === null ? [] : [{ i, spans: holding(i), ink: this.told?.inks[node.ink] }]));
      const here = layers.filter(({ spans }) => spans.some(([a, b]) => X(b) > 0 && X(a) < width)).reverse();
      for (const { i, spans, ink } of here.slice(0, MOST_LANES)) {
        lanes.push({ name: label(line, i), height: 18, parts: bars(spans.map(([a, b]) => [a, b, ink]), "inked") });
      }
      if (here.length > MOST_LANES) lanes.push({ name: `${here.length - MOST_LANES} layers below`, height: 18, parts: [] });
    }
    const followed = this.followed?.told.line;
    if (this.followed && followed?.y === line.y) {
      const node = followed.nodes.findIndex((node) => node.ink !== null);
      if (node >= 0) lanes.push(counter(followed, node, X, end, `${this.followed.id}: ${followed.nodes[node].operands ? "count" : "winding"}`));
    }
    lanes.push({ name: `${number(line.runs.length)} runs`, height: 18, parts: bars(line.runs.map(([a, b, ink]) => [a, b, this.told?.inks[ink]]), "run") });
    return lanes;
  }

  #tables() {
    const tables = at("tables");
    const line = this.#line;
    if (!(/** @type {HTMLDetailsElement} */ (at("line-table")).open) || !line) return tables.replaceChildren();
    const root = this.#root();
    const row = (/** @type {string[]} */ cells, tag = "td") => make("tr", {}, ...cells.map((cell) => make(/** @type {"td"} */ (tag), tag === "th" ? { scope: "col" } : {}, cell)));
    let count = root === undefined ? 0 : line.nodes[root].start;
    const crossings = line.steps.slice(0, MOST_ROWS).map((step) => {
      count = step.counts.find(([node]) => node === root)?.[1] ?? count;
      const what = step.crossed.map(([node, by]) => `${label(line, node)} ${signed(by)}`).join(", ");
      return row([String(step.column), what, ...(root === undefined ? [] : [String(count), truth(line.nodes[root], count) ? "yes" : "no"])]);
    });
    const runs = line.runs.slice(0, MOST_ROWS).map(([a, b, ink]) => row([String(a), String(b), String(b - a), this.told?.inks[ink] ?? ""]));
    const cut = (/** @type {number} */ n) => (n > MOST_ROWS ? `, the first ${MOST_ROWS} of ${n}` : "");
    tables.replaceChildren(
      make("table", {}, make("caption", {}, `Crossings${cut(line.steps.length)}`), make("thead", {}, row(["column", "crossed", ...(root === undefined ? [] : ["count", "holds"])], "th")), make("tbody", {}, ...crossings)),
      make("table", {}, make("caption", {}, `Runs${cut(line.runs.length)}`), make("thead", {}, row(["from", "to", "pixels", "ink"], "th")), make("tbody", {}, ...runs)),
    );
  }
}

/** @param {number} n */
const signed = (n) => (n < 0 ? `\u2212${-n}` : `+${n}`);

/** @param {number} n */
const minus = (n) => String(n).replace("-", "\u2212");

/** Whether a node holds with that count. @param {Node} node @param {number} count */
function truth({ rule, k }, count) {
  if (rule === "nonzero") return count !== 0;
  if (rule === "odd") return count % 2 !== 0;
  return rule === "everywhere" || count >= (k ?? 0);
}

/** What a node is called: its id, or the formula that it is. @param {Line} line @param {number} i @returns {string} */
function label({ nodes }, i) {
  const name = (/** @type {number} */ i, /** @type {number} */ depth) => {
    const { name: own, rule, k, inputs, operands } = nodes[i];
    if (own) return own.replace(/^an element in "(.*)"$/, "part of $1");
    if (rule === "everywhere" || operands === 0) return k !== null && k <= 0 ? "page" : "nothing";
    if (inputs.length < operands || operands > 4 || depth > 2) {
      const parts = new Set(inputs.map(([input]) => (nodes[input].name ?? "").replace(/^an element in "(.*)"$/, "$1")));
      const [first] = parts;
      const shapes = inputs.every(([input, weight]) => weight === 1 && nodes[input].operands === 0);
      if (parts.size === 1 && first && k === 1 && shapes) return `${first}, ${operands} parts`;
      return `${rule === "odd" ? "odd" : k === 1 ? "any" : k === operands ? "all" : `atleast ${k}`} of ${operands}`;
    }
    /** @type {string[]} */
    const parts = inputs.map(([input]) => name(input, depth + 1));
    const plus = inputs.every(([, weight]) => weight === 1);
    const join = (/** @type {string} */ by) => (depth ? `(${parts.join(by)})` : parts.join(by));
    if (rule === "odd") return join(" ^ ");
    if (plus) return k === 1 ? join(" | ") : k === operands ? join(" & ") : `atleast(${k}, ${parts.join(", ")})`;
    if (k === 0 && operands === 1) return `!${parts[0]}`;
    const taken = parts.filter((_, at) => inputs[at][1] > 0);
    const without = parts.filter((_, at) => inputs[at][1] < 0);
    parts.splice(0, parts.length, ...taken, ...without);
    return join(" \u2212 ");
  };
  return name(i, 0);
}

/** A node's count before a step. @param {Line} line @param {number} node @param {Step} step */
function countBefore(line, node, step) {
  let count = line.nodes[node].start;
  for (const other of line.steps) {
    if (other === step) break;
    count = other.counts.find(([changed]) => changed === node)?.[1] ?? count;
  }
  return count;
}

/** By step, shapes entered less shapes left. @param {Line} line */
function turned({ nodes, steps }) {
  const counts = nodes.map((node) => node.start);
  return new Map(
    steps.map((step) => {
      let turns = 0;
      for (const [node, now] of step.counts) {
        if (nodes[node].operands === 0) turns += Number(truth(nodes[node], now)) - Number(truth(nodes[node], counts[node]));
        counts[node] = now;
      }
      return [step, turns];
    }),
  );
}

/** A node's counts: from which column on, and what. @param {Line} line @param {number} node @returns {[number, number][]} */
function counts(line, node) {
  /** @type {[number, number][]} */
  const found = [[0, line.nodes[node].start]];
  for (const { column, counts } of line.steps) {
    const now = counts.find(([changed]) => changed === node)?.[1];
    if (now !== undefined) found.push([column, now]);
  }
  return found;
}

/** Where a node holds. @param {Line} line @param {number} node @param {number} width @returns {[number, number][]} */
function spans(line, node, width) {
  /** @type {[number, number][]} */
  const found = [];
  let start = -1;
  for (const [column, count] of counts(line, node)) {
    const holds = truth(line.nodes[node], count);
    if (holds && start < 0) start = column;
    if (!holds && start >= 0) {
      if (column > start) found.push([start, column]);
      start = -1;
    }
  }
  if (start >= 0) found.push([start, width]);
  return found;
}

/**
 * The lane of a counter: a staircase, and the threshold where there is one.
 * @param {Line} line @param {number} node @param {(column: number) => number} X @param {number} width @param {string} name
 */
function counter(line, node, X, width, name) {
  const found = counts(line, node);
  const { k, rule } = line.nodes[node];
  const values = [...found.map(([, count]) => count), 0, ...(k === null ? [] : [k])];
  const [least, most] = [Math.min(...values), Math.max(...values, 1)];
  const height = 50;
  const Y = (/** @type {number} */ count) => Math.round((height - 8 - ((count - least) / (most - least)) * (height - 16)) * 10) / 10;
  let path = "";
  found.forEach(([column, count], i) => {
    path += `${i ? `H${X(column)}V` : `M${X(0)} `}${Y(count)}`;
  });
  path += `H${X(width)}`;
  const parts = [];
  if (k !== null) {
    parts.push(draw("line", { x1: X(0), x2: X(width), y1: Y(k - 0.5), y2: Y(k - 0.5), class: "threshold" }));
  }
  const held = spans(line, node, width).map(([a, b]) => draw("rect", { x: X(a), width: Math.max(X(b) - X(a), 0.5), y: 4, height: height - 8, class: "held" }));
  parts.unshift(...held);
  parts.push(draw("path", { d: path, class: "stair" }));
  const right = Math.min(X(width), X(width)) + 6;
  for (let count = least; count <= most && most - least <= 4; count++) parts.push(draw("text", { x: right, y: Y(count) + 4, class: "mark" }, String(count)));
  const rules = { nonzero: "not 0", odd: "odd", everywhere: "everywhere" };
  return { name: `${name}, ${k === null ? rules[/** @type {keyof typeof rules} */ (rule)] : `at least ${k}`}`, height, parts };
}
