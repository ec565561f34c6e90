// What hands do on the canvas: point, drag, pinch, turn the wheel, press keys.

/** @param {import("./stage.js").Stage} stage */
export function listen(stage) {
  const { canvas } = stage;
  /** @type {Map<number, { x: number, y: number }>} */
  const down = new Map();
  const at = (/** @type {MouseEvent} */ event) => ({ x: event.offsetX * stage.ratio, y: event.offsetY * stage.ratio });
  const look = (/** @type {MouseEvent} */ event) => {
    const { x, y } = at(event);
    stage.look(stage.view.x + x / stage.view.zoom, stage.view.y + y / stage.view.zoom);
  };
  canvas.addEventListener("pointerdown", (event) => {
    down.set(event.pointerId, at(event));
    canvas.setPointerCapture(event.pointerId);
    look(event);
  });
  canvas.addEventListener("pointermove", (event) => {
    const from = down.get(event.pointerId);
    const to = at(event);
    if (!from) return look(event);
    if (down.size === 2) {
      const other = [...down].find(([id]) => id !== event.pointerId)?.[1] ?? to;
      const apart = (/** @type {{ x: number, y: number }} */ p) => Math.hypot(p.x - other.x, p.y - other.y) || 1;
      stage.zoomBy(apart(to) / apart(from), (to.x + other.x) / 2, (to.y + other.y) / 2);
    } else if (event.pointerType !== "touch" || !stage.fits) {
      stage.pan(to.x - from.x, to.y - from.y);
    } else {
      look(event);
    }
    down.set(event.pointerId, to);
  });
  for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, (event) => down.delete(/** @type {PointerEvent} */ (event).pointerId));
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      const { x, y } = at(event);
      if (event.shiftKey) stage.pan(-event.deltaY * stage.ratio, 0);
      else stage.zoomBy(Math.exp(-event.deltaY / (event.deltaMode ? 20 : 400)), x, y);
    },
    { passive: false },
  );
  canvas.addEventListener("keydown", (event) => {
    const step = event.shiftKey ? 10 : 1;
    const { x, y } = stage.probe;
    const move = (/** @type {number} */ dx, /** @type {number} */ dy) => stage.look(x + dx, y + dy, true);
    const keys = {
      ArrowUp: () => move(0, -step),
      ArrowDown: () => move(0, step),
      ArrowLeft: () => move(-step, 0),
      ArrowRight: () => move(step, 0),
      "+": () => stage.zoomBy(1.5),
      "=": () => stage.zoomBy(1.5),
      "-": () => stage.zoomBy(1 / 1.5),
      0: () => stage.fit(),
      1: () => stage.pixels(),
    };
    if (event.ctrlKey || event.metaKey || event.altKey || !(event.key in keys)) return;
    event.preventDefault();
    keys[/** @type {keyof typeof keys} */ (event.key)]();
  });
}
