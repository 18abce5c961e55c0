// Curves in a frame, as SVG; what is at the pointer is told below, and all of it stands in a table beside.

import { drawn, element, short } from "/pages/element.js";

const wide = 640, left = 74, right = 14, top = 12, bottom = 44;

/// Numbers of one, two or five times a power of ten in the range.
function evenTicks(low, high, count) {
  const raw = (high - low) / count, power = 10 ** Math.floor(Math.log10(raw)), step = [1, 2, 5, 10].map((each) => each * power).find((each) => each >= raw * 0.999);
  const first = Math.ceil(low / step - 1e-9);
  return Array.from({ length: Math.max(0, Math.floor(high / step + 1e-9) - first + 1) }, (_, i) => (first + i) * step);
}

/// Powers of ten, or where there are not two, their double and fivefold too.
function powerTicks(low, high) {
  const from = Math.ceil(Math.log10(low) - 1e-9), to = Math.floor(Math.log10(high) + 1e-9), step = Math.max(1, Math.ceil((to - from) / 6));
  const powers = Array.from({ length: Math.max(0, Math.floor((to - from) / step) + 1) }, (_, i) => 10 ** (from + i * step));
  return powers.length > 1 ? powers : [from - 1, from].flatMap((power) => [1, 2, 5].map((each) => each * 10 ** power)).filter((tick) => tick >= low && tick <= high);
}

function axisOf(values, logarithmic, whole) {
  const own = values.filter((value) => Number.isFinite(value) && (!logarithmic || value > 0));
  let low = Math.min(...own), high = Math.max(...own);
  if (!own.length) [low, high] = logarithmic ? [0.1, 1] : [0, 1];
  if (logarithmic) {
    if (high / low < 10) [low, high] = [low / 2, high * 2];
    return { low, high, ticks: powerTicks(low, high), share: (value) => Math.log(value / low) / Math.log(high / low), has: (value) => value > 0 };
  }
  if (high - low <= 1e-12 * Math.max(Math.abs(low), Math.abs(high))) [low, high] = low === 0 ? [0, 1] : [low - Math.abs(low) / 2, low + Math.abs(low) / 2];
  return { low, high, ticks: evenTicks(low, high, 5).filter((tick) => !whole || Number.isInteger(tick)), share: (value) => (value - low) / (high - low), has: Number.isFinite };
}

/// `x`: { name, values, log, whole }, `y`: { name, log, zero }, `curves`: [{ name, values, dots, broken, band: [lower, upper] }], `stretches`: [[from, to]],
/// `marked`: an index. `whole`: values are counts. `onPick(i)` is called for the row that is clicked.
export function plot({ label, x, y, curves, stretches = [], marked = -1, high = 240, onPick }) {
  const across = axisOf([...x.values], x.log, x.whole), shown = curves.flatMap(({ values, band = [] }) => [...values, ...band.flat()]);
  const up = axisOf(y.zero ? [...shown, 0] : shown, y.log);
  const px = (value) => left + (wide - left - right) * across.share(value), py = (value) => high - bottom - (high - top - bottom) * up.share(value);
  const text = (place, anchor, own, more = {}) => drawn("text", { x: place[0], y: place[1], "text-anchor": anchor, ...more }, own);
  const svg = drawn("svg", { viewBox: `0 0 ${wide} ${high}`, role: "img", "aria-label": label, class: "plot" },
    stretches.map(([from, to]) => drawn("rect", { class: "closed", x: px(from), y: top, width: Math.max(px(to) - px(from), 1), height: high - top - bottom })),
    up.ticks.map((value) => [drawn("line", { class: "grid", x1: left, x2: wide - right, y1: py(value), y2: py(value) }), text([left - 7, py(value) + 4], "end", short(value, 3))]),
    across.ticks.map((value) => [drawn("line", { class: "grid", x1: px(value), x2: px(value), y1: top, y2: high - bottom }), text([px(value), high - bottom + 17], "middle", short(value, 3))]),
    text([(left + wide - right) / 2, high - 6], "middle", x.name), text([14, (top + high - bottom) / 2], "middle", y.name, { transform: `rotate(-90 14 ${(top + high - bottom) / 2})` }),
    curves.map(({ values, dots, broken, curve, band }, c) => {
      const style = `curve${(curve ?? c) % 6}`;
      const places = [...values].map((value, i) => (up.has(value) && across.has(x.values[i]) ? [px(x.values[i]), py(value)] : null));
      const path = places.reduce((all, at, i) => (at ? `${all}${i && places[i - 1] ? "L" : "M"}${at[0].toFixed(1)} ${at[1].toFixed(1)}` : all), "");
      const between = band && x.values.slice(1).map((to, i) => [[x.values[i], band[0][i]], [to, band[0][i + 1]], [to, band[1][i + 1]], [x.values[i], band[1][i]]]).filter((each) => each.every(([, value]) => up.has(value)));
      return [between ? drawn("path", { class: `band ${style}`, d: between.map((each) => `M${each.map(([own, value]) => `${px(own)} ${py(value)}`).join("L")}z`).join("") || "M0 0" }) : "", drawn("path", { class: `curve ${style}${broken ? " broken" : ""}`, d: path || "M0 0" }),
        dots ? places.map((at, i) => (at ? drawn("circle", { class: style, cx: at[0], cy: at[1], r: i === marked ? 5.5 : 3 }) : "")) : ""];
    }),
    marked >= 0 && across.has(x.values[marked]) ? drawn("line", { class: "marked", x1: px(x.values[marked]), x2: px(x.values[marked]), y1: top, y2: high - bottom }) : "");
  const said = element("output", { className: "readout" });
  const nearest = (event) => {
    const box = svg.getBoundingClientRect(), at = ((event.clientX - box.left) / box.width) * wide;
    let best = -1, far = Infinity;
    for (let i = 0; i < x.values.length; ++i) {
      const own = across.has(x.values[i]) ? Math.abs(px(x.values[i]) - at) : Infinity;
      if (own < far) [best, far] = [i, own];
    }
    return best;
  };
  svg.onpointermove = (event) => {
    const i = nearest(event);
    if (i >= 0) said.replaceChildren(element("span", {}, `${x.name} ${short(x.values[i], 6)}`), ...curves.filter(({ values }) => i < values.length).map(({ name, values }) => element("span", {}, `${name} ${short(values[i], 6)}`)));
  };
  if (onPick) svg.onclick = (event) => onPick(nearest(event));
  return element("div", { className: "plotted" }, legend(curves), svg, said);
}

const legend = (curves) => element("ul", { className: "legend", ariaLabel: "Curves" }, curves.map(({ name, broken, curve }, i) => element("li", { className: `curve${(curve ?? i) % 6}${broken ? " broken" : ""}` }, name)));
