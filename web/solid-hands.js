// What hands do on the picture of a model: orbit, pan, zoom, point, drag a primitive, and the same by keys.

/**
 * What is done. Places and distances are in device pixels.
 * @typedef {{
 *   orbit: (turn: number, tilt: number) => void,
 *   pan: (dx: number, dy: number) => void,
 *   zoom: (factor: number, x: number, y: number) => void,
 *   fit: () => void,
 *   point: (x: number, y: number) => void,
 *   grab: (x: number, y: number) => void,
 *   drag: (dx: number, dy: number, axis: boolean) => void,
 *   drop: (keep: boolean) => void,
 *   nudge: (dx: number, dy: number, axis: boolean) => void,
 *   section: (axis: string) => void,
 *   slide: (by: number) => void,
 *   mode: () => void,
 *   undo: (which: "undo" | "redo") => void,
 *   moves: () => boolean,
 * }} Acts
 */

/** Degrees for a CSS pixel that the model is dragged. */
const TURN = 0.5;
/** A pointer that went less far did not move, in CSS pixels. */
const STILL = 4;

/** @param {HTMLCanvasElement} canvas @param {() => number} ratio device pixels to a CSS pixel @param {Acts} act */
export function listen(canvas, ratio, act) {
  /** @type {Map<number, { x: number, y: number }>} */
  const down = new Map();
  /** @type {{ x: number, y: number, does: "orbit" | "pan" | "grab", still: boolean } | undefined} */
  let began;
  const at = (/** @type {MouseEvent} */ event) => ({ x: event.offsetX * ratio(), y: event.offsetY * ratio() });
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("pointerdown", (event) => {
    const here = at(event);
    down.set(event.pointerId, here);
    canvas.setPointerCapture(event.pointerId);
    if (down.size === 2) {
      if (began?.does === "grab") act.drop(false);
      began = undefined;
    } else if (down.size === 1) {
      const grabs = event.button === 0 && (act.moves() || event.ctrlKey || event.metaKey);
      const pans = !grabs && (event.button !== 0 || event.shiftKey);
      began = { ...here, does: pans ? "pan" : grabs ? "grab" : "orbit", still: true };
      if (grabs) act.grab(here.x, here.y);
    }
  });
  canvas.addEventListener("pointermove", (event) => {
    const from = down.get(event.pointerId);
    if (!from) return;
    const to = at(event);
    const [dx, dy] = [to.x - from.x, to.y - from.y];
    if (down.size === 2) {
      const other = [...down].find(([id]) => id !== event.pointerId)?.[1] ?? to;
      const apart = (/** @type {{ x: number, y: number }} */ p) => Math.hypot(p.x - other.x, p.y - other.y) || 1;
      act.pan(dx / 2, dy / 2);
      act.zoom(apart(to) / apart(from), (to.x + other.x) / 2, (to.y + other.y) / 2);
    } else if (began) {
      if (began.still && Math.hypot(to.x - began.x, to.y - began.y) < STILL * ratio()) return;
      began.still = false;
      if (began.does === "grab") act.drag(to.x - began.x, to.y - began.y, event.shiftKey);
      if (began.does === "pan") act.pan(dx, dy);
      if (began.does === "orbit") act.orbit((-TURN * dx) / ratio(), (-TURN * dy) / ratio());
    }
    down.set(event.pointerId, to);
  });
  const up = (/** @type {PointerEvent} */ event) => {
    if (!down.delete(event.pointerId) || !began) return;
    const { does, still, x, y } = began;
    began = undefined;
    if (does === "grab") act.drop(!still && event.type === "pointerup");
    if (still && does !== "pan" && event.type === "pointerup") act.point(x, y);
  };
  canvas.addEventListener("pointerup", up);
  canvas.addEventListener("pointercancel", up);
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      const { x, y } = at(event);
      act.zoom(Math.exp(-event.deltaY / (event.deltaMode ? 20 : 400)), x, y);
    },
    { passive: false },
  );
  canvas.addEventListener("keydown", (event) => {
    const [width, height] = [canvas.width, canvas.height];
    if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "z") {
      event.preventDefault();
      return act.undo(event.shiftKey ? "redo" : "undo");
    }
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const zoom = (/** @type {number} */ factor) => act.zoom(factor, width / 2, height / 2);
    const step = (/** @type {number} */ x, /** @type {number} */ y) => {
      const far = 10 * ratio();
      if (act.moves()) act.nudge(far * x, far * y, event.shiftKey);
      else if (event.shiftKey) act.pan(2 * far * x, 2 * far * y);
      else act.orbit(-4 * x, -4 * y);
    };
    const keys = {
      ArrowUp: () => step(0, -1),
      ArrowDown: () => step(0, 1),
      ArrowLeft: () => step(-1, 0),
      ArrowRight: () => step(1, 0),
      "+": () => zoom(1.25),
      "=": () => zoom(1.25),
      "-": () => zoom(1 / 1.25),
      0: () => act.fit(),
      x: () => act.section("x"),
      y: () => act.section("y"),
      z: () => act.section("z"),
      "[": () => act.slide(-1),
      "]": () => act.slide(1),
      m: () => act.mode(),
      Enter: () => act.point(Math.floor(width / 2), Math.floor(height / 2)),
      Escape: () => {
        if (began?.does === "grab") began = undefined;
        act.drop(false);
      },
    };
    if (!(event.key in keys)) return;
    event.preventDefault();
    keys[/** @type {keyof typeof keys} */ (event.key)]();
  });
}
