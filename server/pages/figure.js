// The picture of one result: its triangles by WebGL, over them the boundary and marks, beside it the scale.

import { coarse } from "/pages/coarse.js";
import { colour, scaleOf } from "/pages/colours.js";
import { Drawing } from "/pages/drawing.js";
import { element, short } from "/pages/element.js";
import { extent, fieldsOf, valueAt } from "/pages/fields.js";
import { listen } from "/pages/gestures.js";
import { drawOver } from "/pages/overlay.js";
import { Readout } from "/pages/readout.js";
import { Shape } from "/pages/shape.js";

const mostMoved = 20000; // triangles that software draws ten times a second
const still = 250; // ms after which what was moved is drawn as it is

export class Figure {
  constructor(result, view, name) {
    Object.assign(this, { view, name, scheduled: false });
    this.canvas = element("canvas");
    this.over = element("canvas");
    this.frame = element("div", { className: "frame", tabIndex: 0, role: "application", ariaRoleDescription: "picture", ariaLabel: name }, this.canvas, this.over);
    this.scaleBar = element("canvas", { width: 1, height: 256, className: "bar" });
    this.ticks = element("ol", { className: "ticks" });
    this.readout = new Readout(this);
    this.title = element("p", { className: "field" });
    this.whole = element("figure", { className: "figure" }, element("figcaption", {}, this.title), element("div", { className: "drawn" }, this.frame, element("div", { className: "scale" }, this.scaleBar, this.ticks)), this.readout.whole);
    this.take(result);
    try {
      this.drawing = new Drawing(this.canvas, this.shape.count, this.rough(), () => { this.drawn = {}; this.schedule(); });
    } catch (error) {
      this.frame.replaceChildren(element("p", { className: "notice bad" }, error.message));
    }
    listen(this);
    view.onChange(() => this.schedule());
    addEventListener("themechange", () => this.schedule());
    new ResizeObserver(() => this.schedule()).observe(this.frame);
  }

  take(result) {
    const fields = fieldsOf(result);
    Object.assign(this, { result, fields, shape: new Shape(result, fields.get("displacement"), this.view), drawn: {} });
    this.moving = true; // until it is drawn, nothing can be told of it
    this.readout.triangle = -1;
  }
  rough() {
    const { count, middle, unit } = this.shape;
    return count > mostMoved ? coarse(this.result.mesh, middle, unit) : null;
  }
  /// From now on another result of the same body, on another mesh.
  show(result) {
    if (result === this.result) return;
    this.take(result);
    this.drawing?.change(this.rough());
    this.schedule();
  }

  get field() {
    return this.fields.get(this.view.field) ?? this.fields.values().next().value;
  }

  schedule() {
    if (this.scheduled) return;
    this.scheduled = true;
    requestAnimationFrame(() => { this.scheduled = false; this.draw(); });
  }

  draw() {
    const { frame, view, shape } = this, { clientWidth: width, clientHeight: height } = frame;
    if (!width || !height) return;
    this.prepare();
    const dense = (this.dense = devicePixelRatio || 1), pixels = [Math.round(width * dense), Math.round(height * dense)];
    if (this.over.width !== pixels[0] || this.over.height !== pixels[1]) [this.over.width, this.over.height] = pixels;
    shape.project(width, height);
    this.prepareShape();
    this.scale = this.scaleWith(this.beside?.() ?? []);
    this.showScale();
    const { projection: { turn, frame: placed }, surface } = shape;
    this.looked = {
      turn, frame: placed, lift: surface || shape.body ? shape.liftDrawn : 0,
      range: [this.scale.low, this.scale.high].map(this.normal), even: this.field.corners === 1 && !view.smooth, mesh: view.mesh, lit: surface,
    };
    this.moving = this.moves();
    this.drawing?.draw(this.looked, this.moving, ...pixels);
    drawOver(this);
    this.readout.again();
    this.onDrawn?.();
  }

  /// What the triangles show, if that has changed.
  prepare() {
    const { view, drawn, field, result: { mesh: { triangles } } } = this;
    const key = [field.key, view.smooth, this.other?.name].join();
    if (drawn.values === key) return;
    this.at = this.values(view.smooth);
    const all = new Float64Array(triangles.length);
    for (let i = 0; i < all.length; ++i) all[i] = this.at(i);
    [this.least, this.most] = extent(all);
    const middle = this.least / 2 + this.most / 2, half = this.most / 2 - this.least / 2 || 1;
    this.normal = (value) => (value - middle) / half;
    this.drawing?.setValues(new Float32Array(all.map(this.normal)));
    drawn.values = key;
  }

  /// The values at corners; of the difference to the other result if there is one.
  values(smooth) {
    const [own, others] = [this, this.other].map((figure) => figure && valueAt(figure.fields.get(this.field.key), smooth, this.result.mesh.triangles));
    return others ? (i) => own(i) - others(i) : own;
  }
  /// The value at a place, where `mixed` takes what is linear.
  valueAt(mixed) {
    const { field: { key }, other, view: { smooth }, result: { mesh: { triangles } } } = this;
    const of = ({ fields }) => Math.hypot(...fields.get(key).parts.map((part) => mixed(valueAt(fields.get(part), smooth, triangles))));
    if (!this.field.parts) return mixed(this.at);
    return of(this) - (other ? of(other) : 0);
  }

  /// Where the triangles are, if that has changed.
  prepareShape() {
    const { drawn, shape } = this, key = `${shape.surface && shape.joined}`;
    if (drawn.shape === key) return;
    this.drawing?.setShape(shape.places(), shape.shifts());
    drawn.shape = key;
  }

  /// Whether a large mesh is seen from elsewhere than last time, or first; then it is drawn once more when nothing has
  /// moved it for a while.
  moves() {
    const { drawn, looked: { turn, frame, lift } } = this, place = [turn, frame, lift].join();
    const moved = this.drawing?.rough && drawn.place !== place;
    drawn.place = place;
    if (moved) {
      clearTimeout(this.resting);
      this.resting = setTimeout(() => this.schedule(), still);
    }
    return moved;
  }

  /// The scale of what the figures show, or the range that was fixed.
  scaleWith(others) {
    const { fixed, low, high } = this.view, all = [this, ...others.filter(({ field }) => field.key === this.field.key)];
    return fixed && high > low ? { low, high, diverges: low < 0 && high > 0 } : scaleOf(Math.min(...all.map(({ least }) => least)), Math.max(...all.map(({ most }) => most)));
  }

  showScale() {
    const { low, high, diverges } = this.scale;
    const key = [low, high, diverges, this.field.name, this.other?.name].join();
    if (this.drawn.scale === key) return;
    this.drawn.scale = key;
    const colours = Uint8Array.from({ length: 1024 }, (_, i) => (i % 4 === 3 ? 255 : colour((i >> 2) / 255, diverges)[i % 4]));
    this.drawing?.setColours(colours);
    const pixels = new ImageData(1, 256);
    for (let i = 0; i < 256; ++i) pixels.data.set([...colour(1 - i / 255, diverges), 255], 4 * i);
    this.scaleBar.getContext("2d").putImageData(pixels, 0, 0);
    this.ticks.replaceChildren(...[4, 3, 2, 1, 0].map((i) => element("li", {}, short(low + (high - low) * (i / 4)))));
    this.title.textContent = this.other ? `${this.field.name}, less that of the other` : this.field.name;
  }
}
