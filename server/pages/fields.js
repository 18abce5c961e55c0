// The fields of a result: what may colour its triangles, by one number each or one at each corner.

/// Fields by key: `name`, `corners` (1 or 3 numbers a triangle), `values()`, `atPoints()`, the same without jumps, and
/// `parts`, the keys of the components whose size it is: within a triangle they are linear, their size is not.
export function fieldsOf(result) {
  const { mesh, displacement, stress = {}, principal, von_mises: vonMises, error_squares: squares } = result;
  const count = mesh.triangles.length / 3, fields = new Map();
  const areas = once(() => areasOf(mesh));
  const add = (key, name, corners, values, atPoints, parts) => {
    const own = once(values);
    fields.set(key, { key, name, corners, parts, values: own, atPoints: once(atPoints ?? (() => averaged(mesh, areas(), own(), corners))) });
  };
  const made = (length, entry) => () => Float64Array.from({ length }, (_, i) => entry(i));
  const components = isBody(result) ? 2 : 1, corners = displacement.values.length / components / count;
  const u = displacement.values, points = displacement.at_points, q = stress.at_centroids;
  if (components === 1) {
    add("displacement", "displacement u", corners, () => u, () => points);
    if (q) add("stress", "size of the stress |σ|", 1, made(count, (t) => Math.hypot(q[2 * t], q[2 * t + 1])));
    if (q) ["x", "y"].forEach((axis, c) => add(`stress_${axis}`, `stress σ${axis}`, 1, made(count, (t) => q[2 * t + c])));
  } else {
    if (q) add("von_mises", "von Mises stress", 1, () => vonMises);
    const size = (list) => (i) => Math.hypot(list[2 * i], list[2 * i + 1]);
    add("displacement", "size of the displacement |u|", corners, made(u.length / 2, size(u)), made(points.length / 2, size(points)), ["displacement_x", "displacement_y"]);
    ["x", "y"].forEach((axis, c) => add(`displacement_${axis}`, `displacement u${axis}`, corners, made(u.length / 2, (i) => u[2 * i + c]), made(points.length / 2, (i) => points[2 * i + c])));
    if (q) ["xx", "yy", "xy"].forEach((axes, c) => add(`stress_${axes}`, `stress σ${axes}`, 1, made(count, (t) => q[3 * t + c])));
    if (q) ["first", "second"].forEach((which, c) => add(`principal_${which}`, `principal stress σ${"₁₂"[c]}`, 1, made(count, (t) => principal[2 * t + c])));
  }
  if (squares) {
    add("error", "share of the error bound", 1, made(count, (t) => Math.sqrt(Math.max(0, squares[t]))));
    add("error_density", "density of the error bound", 1, made(count, (t) => Math.sqrt(Math.max(0, squares[t]) / areas()[t])));
  }
  return fields;
}

export const isBody = ({ mesh, displacement }) => displacement.at_points.length === mesh.points.length;

/// A level of the mesh as a result, one without stress.
export function resultOnLevel({ points, triangles, displacement_at_points: moved, error_squares }) {
  const components = (2 * moved.length) / points.length;
  const values = Float64Array.from({ length: components * triangles.length }, (_, i) => moved[components * triangles[Math.floor(i / components)] + (i % components)]);
  return { mesh: { points, triangles, boundary: {} }, displacement: { at_points: moved, values }, error_squares };
}

/// What is computed when it is first asked for.
function once(make) {
  let made;
  return () => (made ??= make());
}

function areasOf({ points, triangles }) {
  const areas = new Float64Array(triangles.length / 3);
  for (let t = 0; t < areas.length; ++t) {
    const [a, b, c] = [2 * triangles[3 * t], 2 * triangles[3 * t + 1], 2 * triangles[3 * t + 2]];
    areas[t] = ((points[b] - points[a]) * (points[c + 1] - points[a + 1]) - (points[c] - points[a]) * (points[b + 1] - points[a + 1])) / 2;
  }
  return areas;
}

/// At each point the mean of the triangles around it, by their areas.
function averaged({ points, triangles }, areas, values, corners) {
  const sums = new Float64Array(points.length / 2), weights = new Float64Array(points.length / 2);
  for (let i = 0; i < triangles.length; ++i) {
    const t = Math.floor(i / 3);
    sums[triangles[i]] += areas[t] * values[corners === 1 ? t : i];
    weights[triangles[i]] += areas[t];
  }
  return sums.map((sum, p) => sum / weights[p]);
}

/// The value at a corner of a triangle, as it is shown.
export function valueAt(field, smooth, triangles) {
  if (smooth) {
    const points = field.atPoints();
    return (i) => points[triangles[i]];
  }
  const values = field.values();
  return field.corners === 1 ? (i) => values[Math.floor(i / 3)] : (i) => values[i];
}

export function extent(values) {
  let low = Infinity, high = -Infinity;
  for (let i = 0; i < values.length; ++i) {
    if (values[i] < low) low = values[i];
    if (values[i] > high) high = values[i];
  }
  return [low, high];
}
