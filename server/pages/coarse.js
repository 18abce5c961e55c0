// What is drawn of a large mesh while it is moved: as many triangles as can be drawn ten times a second.

const cells = 80; // along the longer side of the body; a mesh that is even leaves two triangles a cell

/// The corners in one cell of a grid become one, and triangles that still have three are kept (Rossignac, Borrel 1993):
/// `own`, the corners that are kept, and `at`, a corner for each in whose place it is drawn.
export function coarse({ points, triangles }, middle, unit) {
  const width = cells + 2, column = (p, c) => Math.floor(((points[2 * p + c] - middle[c]) / unit + 1) * 0.5 * cells);
  const cellOf = new Int32Array(points.length / 2);
  for (let p = 0; p < cellOf.length; ++p) cellOf[p] = column(p, 0) + width * column(p, 1);
  const first = new Int32Array(width * width).fill(-1), own = [], at = [];
  for (let i = 0; i < triangles.length; i += 3) {
    const a = cellOf[triangles[i]], b = cellOf[triangles[i + 1]], c = cellOf[triangles[i + 2]];
    if (a === b || b === c || c === a) continue;
    [a, b, c].forEach((cell, k) => {
      if (first[cell] < 0) first[cell] = i + k;
      own.push(i + k);
      at.push(first[cell]);
    });
  }
  return { own, at };
}
