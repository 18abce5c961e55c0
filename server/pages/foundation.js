// The foundation that an elastic body meets: its contact boundary, moved by the gap.

import { clearanceNodes } from "/pages/nodes.js";

/// Lines of [x, y, gap in x, gap in y].
export function foundationOf({ mesh, contact = {}, problem }) {
  return Object.entries(contact).flatMap(([name, { points: places, gap }]) => {
    const { direction } = problem.boundary[name] ?? problem.boundary.all, { points } = mesh, lines = [];
    let before = [];
    clearanceNodes(points, outward(mesh, mesh.boundary[name]), places).forEach(([a, b, way], i) => {
      const [dx, dy] = [0, 1].map((c) => points[2 * b + c] - points[2 * a + c]), [nx, ny] = direction ?? [dy, -dx], share = gap[i] / Math.hypot(nx, ny);
      if (!before.includes(a) && !before.includes(b)) lines.push([]);
      lines.at(-1).push([points[2 * a] + way * dx, points[2 * a + 1] + way * dy, share * nx, share * ny]);
      before = [a, b];
    });
    return lines;
  });
}

/// Edges of the boundary as their triangles have them, with the body on the left.
function outward({ points, triangles }, edges) {
  const count = points.length / 2, on = new Uint8Array(count), places = new Map(), turned = edges.slice();
  for (let e = 0; e < edges.length; e += 2) {
    places.set(edges[e] * count + edges[e + 1], e);
    on[edges[e]] = on[edges[e + 1]] = 1;
  }
  for (let i = 0; i < triangles.length; ++i) {
    const a = triangles[i], b = triangles[i % 3 === 2 ? i - 2 : i + 1], e = on[a] && on[b] ? places.get(b * count + a) : undefined;
    if (e !== undefined) turned.set([a, b], e);
  }
  return turned;
}
