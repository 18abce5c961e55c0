// What is drawn over the triangles of a figure: the boundary, the foundation, marks of the unknowns and the principal
// directions, and the triangle under the pointer.

import { extent } from "/pages/fields.js";
import { nodesOf } from "/pages/nodes.js";

const mostMarks = 20000; // nodes or crosses that are drawn; more could not be told apart

function stroke(pen, colour, width) {
  pen.strokeStyle = colour;
  pen.lineWidth = width;
  pen.stroke();
}

export function drawOver(figure) {
  const { over, frame, dense, shape, readout: { triangle } } = figure, pen = over.getContext("2d");
  pen.setTransform(dense, 0, 0, dense, 0, 0);
  pen.clearRect(0, 0, frame.clientWidth, frame.clientHeight);
  pen.lineCap = pen.lineJoin = "round";
  drawMarks(figure, pen);
  if (triangle >= 0) {
    pen.beginPath();
    shape.cornersOf(triangle).forEach((corner) => pen.lineTo(...corner));
    pen.closePath();
    stroke(pen, "#fff", 3.5);
    stroke(pen, "#000", 1.5);
  }
}

/// All but the triangle under the pointer.
export function drawMarks({ frame, shape, view }, pen) {
  const { mesh, contact = {}, stress, principal } = shape.result;
  const style = getComputedStyle(frame), colour = (name) => style.getPropertyValue(`--${name}`);
  for (const [name, edges] of Object.entries(mesh.boundary)) {
    pen.beginPath();
    trace(pen, shape, edges);
    if (Object.hasOwn(contact, name)) stroke(pen, colour("accent"), 2.5);
    else if (!shape.surface) stroke(pen, colour("quiet"), 1.2);
  }
  pen.beginPath();
  for (const line of shape.foundation()) line.forEach((place, i) => pen[i ? "lineTo" : "moveTo"](...place));
  pen.setLineDash([7, 4]);
  stroke(pen, colour("ink"), 1.6);
  pen.setLineDash([]);
  if (view.nodes && stress) drawNodes(pen, colour, shape);
  if (view.crosses && principal) drawCrosses(pen, colour, shape);
}

/// Edges that follow each other are one line, with corners that are not told apart left out.
function trace(pen, shape, edges) {
  let at = null;
  for (let i = 0; i < edges.length; i += 2) {
    if (i === 0 || edges[i] !== edges[i - 1]) pen.moveTo(...(at = shape.pixelOfPoint(edges[i])));
    const next = shape.pixelOfPoint(edges[i + 1]);
    if (edges[i + 1] === edges[i + 2] && Math.hypot(next[0] - at[0], next[1] - at[1]) < 1.5) continue;
    pen.lineTo(...(at = next));
  }
}

const isSeen = ({ projection: { width, height } }, [x, y]) => x >= 0 && y >= 0 && x <= width && y <= height;

/// Where the unknowns sit: of the stress a bar across its edge, or inside a square, of the displacement a disc, of the clearance a ring.
function drawNodes(pen, colour, shape) {
  const nodes = (shape.nodes ??= nodesOf(shape.result)), ink = colour("ink"), ground = colour("paper");
  const size = Math.min(1, Math.max(0.3, shape.edge / 30)); // marks of a fine mesh are small
  const marks = (places, draw) => {
    const seen = [];
    for (const [t, weights] of places) {
      const corners = shape.cornersOf(t);
      const at = [0, 1].map((c) => corners.reduce((sum, corner, k) => sum + weights[k] * corner[c], 0));
      if (isSeen(shape, at)) seen.push([at, corners, weights]);
      if (seen.length > mostMarks) return;
    }
    seen.forEach((own) => draw(...own));
  };
  marks(nodes.stress, ([x, y], corners, weights) => {
    const opposite = weights.indexOf(0);
    pen.beginPath();
    if (opposite < 0) pen.rect(x - 2.5 * size, y - 2.5 * size, 5 * size, 5 * size);
    else {
      const [a, b] = [corners[(opposite + 1) % 3], corners[(opposite + 2) % 3]], long = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
      const [nx, ny] = [b[1] - a[1], a[0] - b[0]].map((side) => (5 * size * side) / long);
      pen.moveTo(x - nx, y - ny);
      pen.lineTo(x + nx, y + ny);
    }
    stroke(pen, ground, 4 * size);
    stroke(pen, ink, 1.6 * size);
  });
  marks(nodes.displacement, ([x, y]) => {
    pen.beginPath();
    pen.arc(x, y, 2.6 * size, 0, 7);
    pen.fillStyle = ink;
    stroke(pen, ground, 1.6 * size);
    pen.fill();
  });
  for (const [a, b, way] of nodes.clearance) {
    const [from, to] = [shape.pixelOfPoint(a), shape.pixelOfPoint(b)], at = from.map((each, c) => each + way * (to[c] - each));
    if (!isSeen(shape, at)) continue;
    pen.beginPath();
    pen.arc(...at, 4.5 * size, 0, 7);
    pen.fillStyle = ground;
    pen.fill();
    stroke(pen, colour("accent"), 2.2 * size);
  }
}

/// The principal directions at the centroids; arms by the size of the stress, pressure in the colour of pressure.
function drawCrosses(pen, colour, shape) {
  const { stress: { at_centroids: stress }, principal } = shape.result;
  const [low, high] = extent(principal), largest = Math.max(-low, high) || 1;
  const apart = 14, arm = 7, taken = new Set();
  const colours = [colour("pull"), colour("push")];
  for (let t = 0; t < shape.count; ++t) {
    const corners = shape.cornersOf(t), at = [0, 1].map((c) => (corners[0][c] + corners[1][c] + corners[2][c]) / 3);
    const cell = `${Math.floor(at[0] / apart)},${Math.floor(at[1] / apart)}`;
    if (!isSeen(shape, at) || taken.has(cell)) continue;
    taken.add(cell);
    const [xx, yy, xy] = stress.subarray(3 * t, 3 * t + 3), angle = 0.5 * Math.atan2(2 * xy, xx - yy);
    for (let c = 0; c < 2; ++c) {
      const size = (arm * Math.abs(principal[2 * t + c])) / largest, way = angle + (c * Math.PI) / 2;
      const [dx, dy] = [Math.cos(way) * Math.max(size, 0.6), -Math.sin(way) * Math.max(size, 0.6)];
      pen.beginPath();
      pen.moveTo(at[0] - dx, at[1] - dy);
      pen.lineTo(at[0] + dx, at[1] + dy);
      stroke(pen, "#ffffffb0", 3);
      stroke(pen, colours[principal[2 * t + c] < 0 ? 1 : 0], 1.5);
    }
  }
}
