// The picture as it is seen as a file to keep, SVG or PNG.

import { colour } from "/pages/colours.js";
import { element } from "/pages/element.js";
import { drawMarks } from "/pages/overlay.js";
import { SvgPen } from "/pages/pen.js";

const bands = 32;
export const mostTriangles = 200000; // of an SVG that other programs still open

/// The part of a convex polygon where sign · (value − level) ≥ 0; corners are [x, y, value].
function beyond(polygon, level, sign) {
  return polygon.flatMap((a, i) => {
    const b = polygon[(i + 1) % polygon.length], da = sign * (a[2] - level), db = sign * (b[2] - level);
    const kept = da >= 0 ? [a] : [];
    if (da >= 0 === db >= 0) return kept;
    const way = da / (da - db);
    return [...kept, [0, 1].map((c) => a[c] + way * (b[c] - a[c])).concat(level)];
  });
}

const escaped = (text) => text.replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll(">", "&gt;");

/// Constant fields have one colour in each triangle, linear ones bands of colour.
export function svgOf(figure) {
  const { scale: { low, high, diverges }, looked: { even, mesh }, shape, frame: { clientWidth: width, clientHeight: height } } = figure;
  const bandOf = (value) => Math.min(bands - 1, Math.max(0, Math.floor(((value - low) / (high - low)) * bands))), startOf = (band) => low + ((high - low) / bands) * band;
  const place = ([x, y]) => `${x.toFixed(2)} ${y.toFixed(2)}`;
  const order = Array.from({ length: shape.count }, (_, t) => t);
  if (shape.surface) {
    const depths = order.map((t) => [0, 1, 2].reduce((sum, k) => sum + shape.depthOf(3 * t + k), 0));
    order.sort((a, b) => depths[b] - depths[a]);
  }
  const shapes = [], put = (polygon, band) => { if (polygon.length > 2) shapes.push([band, `M${polygon.map(place).join("L")}z`]); };
  for (const t of order) {
    const corners = shape.cornersOf(t).map((corner, k) => [...corner, figure.at(3 * t + k)]);
    const first = bandOf(even ? corners[0][2] : Math.min(...corners.map((own) => own[2]))), last = even ? first : bandOf(Math.max(...corners.map((own) => own[2])));
    for (let band = first; band <= last; ++band) {
      let part = corners;
      if (band > first) part = beyond(part, startOf(band), 1);
      if (band < last) part = beyond(part, startOf(band + 1), -1);
      put(part, band);
    }
    if (mesh) shapes.push([-1, `M${corners.map(place).join("L")}z`]);
  }
  // Shapes of one colour that follow each other are one element; lines may wait where nothing hides them.
  const lines = shape.surface ? [] : shapes.filter(([band]) => band < 0), filled = shape.surface ? shapes : shapes.filter(([band]) => band >= 0), paths = [];
  for (const [band, path] of [...filled, ...lines]) {
    if (paths.at(-1)?.[0] === band) paths.at(-1)[1].push(path);
    else paths.push([band, [path]]);
  }
  const pen = new SvgPen();
  drawMarks(figure, pen);
  const rgb = (band) => `rgb(${colour(band / (bands - 1), diverges).join(",")})`;
  const styles = Array.from({ length: bands }, (_, band) => `.c${band}{fill:${rgb(band)};stroke:${rgb(band)}}`).join("");
  const bar = Array.from({ length: bands }, (_, band) => `<rect class="c${band}" x="${width + 10}" y="${30 + ((bands - 1 - band) * (height - 20)) / bands}" width="14" height="${(height - 20) / bands}"/>`);
  const ticks = [...figure.ticks.children].map((tick, i) => `<text x="${width + 30}" y="${34 + (i / 4) * (height - 20)}">${escaped(tick.textContent)}</text>`);
  return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width + 100} ${height + 24}" width="${width + 100}" height="${height + 24}">
<title>${escaped(figure.title.textContent)}</title>
<style>text{font:13px system-ui,sans-serif;fill:#222}path{stroke-width:.5;stroke-linejoin:round}.l{fill:none;stroke:#000;stroke-opacity:.3}${styles}</style>
<rect width="100%" height="100%" fill="#fff"/><text x="10" y="18">${escaped(figure.title.textContent)}</text>
<g transform="translate(0 24)">${paths.map(([band, own]) => `<path class="${band < 0 ? "l" : `c${band}`}" d="${own.join("")}"/>`).join("\n")}${pen.drawn.join("\n")}</g>
${bar.join("")}${ticks.join("")}
</svg>
`;
}

/// With its scale.
export async function pngOf(figure) {
  do figure.draw(); while (figure.moving);
  const { canvas, over, frame, scaleBar, ticks, title, dense: d } = figure, { width, height } = canvas;
  const whole = element("canvas", { width: width + 90 * d, height: height + 30 * d }), pen = whole.getContext("2d"), style = getComputedStyle(frame);
  pen.fillStyle = style.getPropertyValue("--paper");
  pen.fillRect(0, 0, whole.width, whole.height);
  pen.drawImage(canvas, 0, 30 * d);
  pen.drawImage(over, 0, 30 * d);
  pen.imageSmoothingEnabled = false;
  pen.drawImage(scaleBar, width + 8 * d, 40 * d, 14 * d, height - 20 * d);
  pen.fillStyle = style.getPropertyValue("--ink");
  pen.font = `${13 * d}px system-ui, sans-serif`;
  pen.fillText(title.textContent, 10 * d, 20 * d);
  [...ticks.children].forEach((tick, i) => pen.fillText(tick.textContent, width + 27 * d, 45 * d + (i / 4) * (height - 20 * d)));
  return new Promise((resolve) => { whole.toBlob(resolve, "image/png"); });
}
