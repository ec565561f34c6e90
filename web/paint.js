// What is seen on the canvas: the page, panes over each other, and what is shown beside and above them.

/** @typedef {import("./stage.js").Stage} Stage */
/** @typedef {import("./pane.js").Pane} Pane */

/** @param {Stage} stage */
export function paint(stage) {
  const { context: c, canvas, content, view } = stage;
  c.setTransform(1, 0, 0, 1, 0, 0);
  c.clearRect(0, 0, canvas.width, canvas.height);
  if (!content) return;
  const { page } = content;
  const X = (/** @type {number} */ x) => Math.round((x - view.x) * view.zoom);
  const Y = (/** @type {number} */ y) => Math.round((y - view.y) * view.zoom);
  const [left, top, width, height] = [X(0), Y(0), X(page.width) - X(0), Y(page.height) - Y(0)];
  c.fillStyle = "#fff";
  c.fillRect(left, top, width, height);
  const put = (/** @type {Pane} */ { rect, canvas: from, front, scale }) => {
    if (!front) return;
    c.imageSmoothingEnabled = scale > view.zoom * 1.01;
    const [w, h] = [X(rect.x1) - X(rect.x0), Y(rect.y1) - Y(rect.y0)];
    // A pane for this very zoom is shown pixel by pixel, although both of its sides were rounded.
    const own = Math.abs(w - from.width) <= 1 && Math.abs(h - from.height) <= 1;
    c.drawImage(from, X(rect.x0), Y(rect.y0), own ? from.width : w, own ? from.height : h);
  };
  if (stage.before) put(stage.before);
  if (stage.base) put(stage.base);
  for (const pane of [...stage.details].sort((a, b) => a.scale - b.scale)) if (pane.scale <= view.zoom * 4.1) put(pane);
  paintKinds(stage, left, width, Y);
  if (stage.lit) put(stage.lit);
  if (stage.box) {
    const [x0, y0, x1, y1] = stage.box;
    c.lineWidth = stage.ratio;
    c.strokeStyle = "#e4472f";
    c.setLineDash([4 * stage.ratio, 3 * stage.ratio]);
    c.strokeRect(X(x0) - 0.5, Y(y0) - 0.5, X(x1) - X(x0) + 1, Y(y1) - Y(y0) + 1);
    c.setLineDash([]);
  }
  if (view.zoom >= 10 * stage.ratio) paintGrid(stage, X, Y);
  if (stage.base && !stage.base.done && stage.base.front) {
    const y = Y((stage.base.front / stage.base.canvas.height) * page.height);
    c.fillStyle = "#e4472f";
    c.fillRect(left, y, width, Math.max(1, Math.round(stage.ratio)));
  }
  paintProbe(stage, left, width, X, Y);
}

/**
 * How the lines came about: beside the page, and over it if that is wanted.
 * @param {Stage} stage @param {number} left @param {number} width @param {(y: number) => number} Y
 */
function paintKinds(stage, left, width, Y) {
  if (!stage.kinds) return;
  const { context: c } = stage;
  const { kinds, scale } = stage.kinds;
  const colours = { counted: "228 71 47", unordered: "150 60 160", carried: "31 128 136", repeated: "232 170 60" };
  const bar = Math.round(5 * stage.ratio);
  for (const { y, n, how } of kinds) {
    const [y0, y1] = [Y(y / scale), Y((y + n) / scale)];
    if (y1 < 0 || y0 > stage.canvas.height) continue;
    const colour = colours[/** @type {keyof typeof colours} */ (how)];
    c.fillStyle = `rgb(${colour})`;
    c.fillRect(left - 2 * bar, y0, bar, Math.max(y1 - y0, 1));
    if (stage.tint) {
      c.fillStyle = `rgb(${colour} / 0.32)`;
      c.fillRect(left, y0, width, Math.max(y1 - y0, 1));
    }
  }
}

/** @param {Stage} stage @param {(x: number) => number} X @param {(y: number) => number} Y */
function paintGrid(stage, X, Y) {
  const { context: c } = stage;
  const { x0, y0, x1, y1 } = stage.seen();
  c.fillStyle = "rgb(20 33 61 / 0.14)";
  for (let x = Math.ceil(x0); x <= x1; x++) c.fillRect(X(x), Y(y0), 1, Y(y1) - Y(y0));
  for (let y = Math.ceil(y0); y <= y1; y++) c.fillRect(X(x0), Y(y), X(x1) - X(x0), 1);
}

/**
 * The scanline that is looked at, through the centres of its pixels.
 * @param {Stage} stage @param {number} left @param {number} width @param {(x: number) => number} X @param {(y: number) => number} Y
 */
function paintProbe(stage, left, width, X, Y) {
  const { context: c, probe, ratio } = stage;
  const thin = Math.max(1, Math.round(ratio));
  const y = Y(probe.y + 0.5);
  c.fillStyle = "rgb(255 255 255 / 0.6)";
  c.fillRect(left - 12 * ratio, y - thin, width + 24 * ratio, 3 * thin);
  c.fillStyle = "#c23a22";
  c.fillRect(left - 12 * ratio, y, width + 24 * ratio, thin);
  const x = X(probe.x + 0.5);
  c.beginPath();
  c.arc(x, y + thin / 2, 4 * ratio, 0, 7);
  c.fillStyle = "#c23a22";
  c.fill();
  c.lineWidth = 1.5 * ratio;
  c.strokeStyle = "#fff";
  c.stroke();
}
