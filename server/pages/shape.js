// Where a result is in its picture: from places in the body to pixels, moved by the displacement.

import { extent, isBody, valueAt } from "/pages/fields.js";
import { foundationOf } from "/pages/foundation.js";
import { Projection } from "/pages/view.js";

const smallestJumping = 16; // pixels of the edges of a surface's triangles that do not meet

export class Shape {
  /// `displacement`: the field. Places become relative to the middle of the body and its size, which single precision
  /// then holds in any unit.
  constructor(result, displacement, view) {
    const { mesh: { points, triangles }, displacement: u } = result;
    Object.assign(this, { result, displacement, view, body: isBody(result), count: triangles.length / 3 });
    const low = [Infinity, Infinity], high = [-Infinity, -Infinity];
    for (let i = 0; i < points.length; ++i) {
      low[i % 2] = Math.min(low[i % 2], points[i]);
      high[i % 2] = Math.max(high[i % 2], points[i]);
    }
    this.middle = low.map((each, c) => each / 2 + high[c] / 2);
    const halves = low.map((each, c) => high[c] / 2 - each / 2);
    this.unit = Math.max(...halves);
    this.size = halves.map((half) => half / this.unit);
    // Of a membrane what is seen may lie between its values at the corners of the triangles.
    const [least, most] = extent(this.body ? u.at_points : u.values);
    this.base = this.body ? 0 : least / 2 + most / 2;
    this.largest = (this.body ? Math.max(-least, most) : most / 2 - least / 2) || 1;
  }

  get surface() {
    return !this.body && (this.view.surface ?? true);
  }
  /// By what a body is deformed in the picture: a number of two digits at which its largest displacement is seen.
  get usualLift() {
    const share = (0.06 * this.unit) / this.largest, power = 10 ** (Math.floor(Math.log10(share)) - 1);
    return this.body ? Math.max(Math.round(share / power), 1) * power : 1;
  }
  get lift() {
    return this.view.lift ?? this.usualLift;
  }
  /// The same in units of the picture.
  get liftDrawn() {
    return this.body ? (this.lift * this.largest) / this.unit : 0.35 * this.lift;
  }

  /// From now on it is seen in so many pixels.
  project(width, height) {
    const { body, size, liftDrawn } = this;
    this.projection = new Projection(this.view, this.surface, width, height, body ? size.map((half) => half + 0.5 * liftDrawn) : size, body ? 0 : liftDrawn);
  }

  /// The pixels of a usual edge.
  get edge() {
    return Math.sqrt((8 * this.size[0] * this.size[1]) / this.count) * this.projection.scale;
  }
  /// Whether triangles of a surface meet. Where it jumps one sees through it, which of small triangles would leave more
  /// holes than surface; they meet until one is near enough to see the jumps.
  get joined() {
    return this.view.smooth || this.edge < smallestJumping;
  }

  /// Where the corners of the triangles are before they move.
  places() {
    const { points, triangles } = this.result.mesh, places = new Float32Array(2 * triangles.length);
    for (let i = 0; i < places.length; ++i) places[i] = (points[2 * triangles[i >> 1] + (i & 1)] - this.middle[i & 1]) / this.unit;
    return places;
  }

  /// By which corners move: of a body at the points, of a membrane by its displacement.
  shifts() {
    const { mesh: { triangles }, displacement: { at_points: points } } = this.result;
    const shifts = new Float32Array((this.body ? 2 : 1) * triangles.length);
    if (this.body) {
      for (let i = 0; i < shifts.length; ++i) shifts[i] = points[2 * triangles[i >> 1] + (i & 1)] / this.largest;
      return shifts;
    }
    this.heights = valueAt(this.displacement, this.joined, triangles);
    for (let i = 0; i < shifts.length; ++i) shifts[i] = this.height(i);
    return shifts;
  }
  height(i) {
    return (this.heights(i) - this.base) / this.largest;
  }

  /// The place of a corner in the picture.
  corner(i) {
    const { points, triangles } = this.result.mesh, p = triangles[i];
    return this.surface ? this.pixelOf(points[2 * p], points[2 * p + 1], this.height(i)) : this.pixelOfPoint(p);
  }
  cornersOf(t) {
    return [0, 1, 2].map((k) => this.corner(3 * t + k));
  }
  /// How far behind the screen it is.
  depthOf(i) {
    const { points, triangles } = this.result.mesh, p = triangles[i];
    return this.projection.depth(...[0, 1].map((c) => (points[2 * p + c] - this.middle[c]) / this.unit), this.height(i) * this.liftDrawn);
  }
  pixelOf(x, y, height = 0) {
    return this.projection.pixel((x - this.middle[0]) / this.unit, (y - this.middle[1]) / this.unit, height * this.liftDrawn);
  }
  /// The place of a point of the mesh.
  pixelOfPoint(p) {
    const { mesh: { points }, displacement: { at_points: moved } } = this.result;
    if (this.body) return this.pixelOf(points[2 * p] + this.lift * moved[2 * p], points[2 * p + 1] + this.lift * moved[2 * p + 1]);
    return this.pixelOf(points[2 * p], points[2 * p + 1], this.surface ? (moved[p] - this.base) / this.largest : 0);
  }

  /// Lines of places where the foundation is; the gap is as many times too large as the deformation.
  foundation() {
    this.lines ??= this.body ? foundationOf(this.result) : [];
    return this.lines.map((line) => line.map(([x, y, dx, dy]) => this.pixelOf(x + this.lift * dx, y + this.lift * dy)));
  }
}
