// What moves a figure: pointers, fingers, the wheel and keys set its view.

import { within } from "/pages/view.js";

export function listen(figure) {
  const { frame, view, readout } = figure, fingers = new Map();
  const place = (event) => { const box = frame.getBoundingClientRect(); return [event.clientX - box.left, event.clientY - box.top]; };
  const pan = (dx, dy) => view.set({ x: view.x + dx / frame.clientWidth, y: view.y + dy / frame.clientHeight });
  const turn = (dx, dy) => view.set({ turn: view.turn + dx * 0.008, tilt: within("tilt", view.tilt + dy * 0.008) });
  /// What is at (x, y) stays there.
  const zoom = (factor, [x, y]) => {
    const own = within("zoom", view.zoom * factor) / view.zoom, [w, h] = [frame.clientWidth, frame.clientHeight];
    const kept = (offset, at, whole) => (at - own * (at - (whole / 2 + offset * whole)) - whole / 2) / whole;
    view.set({ zoom: view.zoom * own, x: kept(view.x, x, w), y: kept(view.y, y, h) });
  };
  frame.onpointerdown = (event) => { frame.setPointerCapture(event.pointerId); fingers.set(event.pointerId, place(event)); };
  frame.onpointermove = (event) => {
    const at = place(event), before = fingers.get(event.pointerId);
    if (!before) return readout.look(...at);
    const other = [...fingers].find(([id]) => id !== event.pointerId)?.[1];
    fingers.set(event.pointerId, at);
    if (other) {
      const long = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]) || 1, middle = [0, 1].map((c) => (at[c] + other[c]) / 2);
      pan((at[0] - before[0]) / 2, (at[1] - before[1]) / 2);
      zoom(long(at) / long(before), middle);
    } else if (figure.shape.surface && !event.shiftKey && event.button !== 1) turn(at[0] - before[0], at[1] - before[1]);
    else pan(at[0] - before[0], at[1] - before[1]);
  };
  frame.onpointerup = (event) => { fingers.delete(event.pointerId); readout.look(...place(event)); };
  frame.onpointercancel = (event) => { fingers.delete(event.pointerId); };
  frame.onpointerleave = () => readout.leave();
  frame.onwheel = (event) => { event.preventDefault(); zoom(Math.exp(-event.deltaY * 0.0015), place(event)); };
  frame.ondblclick = () => view.reset();
  frame.onkeydown = (event) => {
    const middle = [frame.clientWidth / 2, frame.clientHeight / 2], turns = figure.shape.surface && !event.shiftKey, step = turns ? 12 : 30;
    const move = (dx, dy) => (turns ? turn(dx * step, dy * step) : pan(dx * step, dy * step));
    const does = {
      ArrowLeft: () => move(-1, 0), ArrowRight: () => move(1, 0), ArrowUp: () => move(0, -1), ArrowDown: () => move(0, 1),
      "+": () => zoom(1.25, middle), "=": () => zoom(1.25, middle), "-": () => zoom(0.8, middle), 0: () => view.reset(),
      m: () => view.set({ mesh: !view.mesh }), f: () => view.set({ surface: !figure.shape.surface }),
    }[event.key];
    if (!does || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    does();
    readout.follow(middle);
  };
}
