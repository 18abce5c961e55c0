// What a figure tells of the place under the pointer.

import { element, short } from "/pages/element.js";
import { drawOver } from "/pages/overlay.js";

export class Readout {
  constructor(figure) {
    Object.assign(this, { figure, triangle: -1, whole: element("output", { className: "readout", ariaLive: "off" }) });
  }

  look(x, y) {
    const { figure, triangle: before } = this, { drawing, looked, moving, dense } = figure;
    this.pointer = [x, y];
    if (!drawing || !looked || moving) return;
    const t = (this.triangle = drawing.triangleAt(looked, x * dense, y * dense));
    if (t < 0) this.whole.textContent = "";
    else this.tell(t, this.pointer);
    if (before !== t) drawOver(figure);
  }
  /// Of what is moved by keys the place in the middle is told.
  follow(place) {
    this.pointer ??= place;
    this.whole.ariaLive = "polite";
    this.figure.schedule();
  }
  /// The figure has changed.
  again() {
    if (this.pointer) this.look(...this.pointer);
  }
  leave() {
    this.pointer = null;
    this.triangle = -1;
    drawOver(this.figure);
  }

  /// A picture is parallel: shares of the corners are the same on the screen and in the body.
  tell(t, [x, y]) {
    const { figure, figure: { shape, looked, title } } = this, [a, b, c] = shape.cornersOf(t);
    const twice = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
    const second = ((x - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (y - a[1])) / twice, third = ((b[0] - a[0]) * (y - a[1]) - (x - a[0]) * (b[1] - a[1])) / twice;
    const shares = [1 - second - third, second, third];
    const { points, triangles } = shape.result.mesh, mixed = (own) => shares.reduce((sum, share, k) => sum + share * own(3 * t + k), 0);
    const place = [0, 1].map((own) => mixed((i) => points[2 * triangles[i] + own]));
    const value = figure.valueAt(looked.even ? (own) => own(3 * t) : mixed);
    this.whole.replaceChildren(element("span", {}, `x ${short(place[0])}`), element("span", {}, `y ${short(place[1])}`),
      element("span", {}, `triangle ${t}`), element("strong", {}, `${title.textContent} ${short(value, 6)}`));
    Object.assign(this.whole.dataset, { triangle: t, value, x: place[0], y: place[1] });
  }
}
