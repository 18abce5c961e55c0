// Where the unknowns of both schemes sit, as shares of the corners of a triangle; an edge is told of one triangle.

const half = (k) => [0, 1, 2].map((i) => (i === k ? 0 : 0.5));

/// `stress` and `displacement`: [triangle, shares]; `clearance`: [point, point, way from one to the other].
export function nodesOf({ mesh: { points, triangles, boundary }, stress: { space }, contact = {} }) {
  const linear = space === "RT1", stress = [], displacement = [], told = new Set();
  for (let t = 0; t < triangles.length / 3; ++t) {
    for (let k = 0; k < 3; ++k) {
      const ends = [triangles[3 * t + ((k + 1) % 3)], triangles[3 * t + ((k + 2) % 3)]].sort((a, b) => a - b).join();
      if (told.has(ends)) continue;
      told.add(ends);
      if (!linear) stress.push([t, half(k)]);
      // The two moments of the linear trace are those of its values at Gauss's points.
      else for (const way of [0.5 - Math.sqrt(3) / 6, 0.5 + Math.sqrt(3) / 6]) stress.push([t, [0, 1, 2].map((i) => (i === k ? 0 : i === (k + 1) % 3 ? 1 - way : way))]);
    }
    if (linear) {
      stress.push([t, [1 / 3, 1 / 3, 1 / 3]]);
      for (let k = 0; k < 3; ++k) displacement.push([t, [0, 1, 2].map((i) => (i === k ? 0.72 : 0.14))]);
    } else displacement.push([t, [1 / 3, 1 / 3, 1 / 3]]);
  }
  return { stress, displacement, clearance: Object.entries(contact).flatMap(([name, own]) => clearanceNodes(points, boundary[name], own.points)) };
}

/// Each on the edge of its part that it is nearest to, of two that which follows the one before sooner. Where the
/// direction of a contact turns a node has two rows, one for each of its edges.
export function clearanceNodes(points, edges, places) {
  const found = [];
  let first = 0;
  for (let i = 0; i < places.length; i += 2) {
    if (places[i] === places[i - 2] && places[i + 1] === places[i - 1]) first += 2;
    let best = [Infinity];
    for (let step = 0; step < edges.length; step += 2) {
      const e = (first + step) % edges.length, [a, b] = [edges[e], edges[e + 1]], [dx, dy] = [points[2 * b] - points[2 * a], points[2 * b + 1] - points[2 * a + 1]];
      const [px, py] = [places[i] - points[2 * a], places[i + 1] - points[2 * a + 1]];
      const way = Math.min(1, Math.max(0, (px * dx + py * dy) / (dx * dx + dy * dy))), far = Math.hypot(px - way * dx, py - way * dy);
      if (far < best[0]) best = [far, a, b, way, e];
    }
    first = best.pop();
    found.push(best.slice(1));
  }
  return found;
}
