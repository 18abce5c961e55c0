// The picture of one result: its triangles by WebGL, over them the boundary, nodes and crosses, beside it the scale.

import { coarse } from "/pages/coarse.js";
import { colour, scaleOf } from "/pages/colours.js";
import { Drawing } from "/pages/drawing.js";
import { element, short } from "/pages/element.js";
import { extent, fieldsOf, isBody, valueAt } from "/pages/fields.js";
import { foundationOf } from "/pages/foundation.js";
import { nodesOf } from "/pages/nodes.js";
import { Projection } from "/pages/view.js";

const mostMoved = 20000; // triangles that software draws ten times a second
const still = 250; // ms after which what was moved is drawn as it is
const smallestJumping = 16; // pixels of the edges of a surface's triangles that do not meet
const mostMarks = 20000; // nodes or crosses that are drawn; more could not be told apart

function stroke(pen, colour, width) {
  pen.strokeStyle = colour;
  pen.lineWidth = width;
  pen.stroke();
}

export class Figure {
  constructor(result, view, name) {
    Object.assign(this, { view, name, body: isBody(result), scheduled: false });
    this.canvas = element("canvas");
    this.over = element("canvas");
    this.frame = element("div", { className: "frame", tabIndex: 0, role: "application", ariaRoleDescription: "picture", ariaLabel: name }, this.canvas, this.over);
    this.scaleBar = element("canvas", { width: 1, height: 256, className: "bar" });
    this.ticks = element("ol", { className: "ticks" });
    this.readout = element("output", { className: "readout", ariaLive: "off" });
    this.title = element("p", { className: "field" });
    this.whole = element("figure", { className: "figure" }, element("figcaption", {}, this.title), element("div", { className: "drawn" }, this.frame, element("div", { className: "scale" }, this.scaleBar, this.ticks)), this.readout);
    this.take(result);
    try {
      this.drawing = new Drawing(this.canvas, this.count, this.rough(), () => { this.drawn = {}; this.schedule(); });
    } catch (error) {
      this.frame.replaceChildren(element("p", { className: "notice bad" }, error.message));
    }
    this.listen();
    view.onChange(() => this.schedule());
    addEventListener("themechange", () => this.schedule());
    new ResizeObserver(() => this.schedule()).observe(this.frame);
  }

  take(result) {
    Object.assign(this, { result, fields: fieldsOf(result), drawn: {}, nodes: null, lines: null, picked: -1 });
    this.measure();
  }
  rough() {
    return this.count > mostMoved ? coarse(this.result.mesh, this.middle, this.unit) : null;
  }
  /// From now on another result of the same body, on another mesh.
  show(result) {
    if (result === this.result) return;
    this.take(result);
    this.drawing?.change(this.rough());
    this.schedule();
  }

  get surface() {
    return !this.body && (this.view.surface ?? true);
  }
  get field() {
    return this.fields.get(this.view.field) ?? this.fields.values().next().value;
  }

  /// Places become relative to the middle of the body and its size, which single precision then holds in any unit.
  measure() {
    const { mesh: { points, triangles }, displacement } = this.result;
    this.count = triangles.length / 3;
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
    const [least, most] = extent(this.body ? displacement.at_points : displacement.values);
    this.base = this.body ? 0 : least / 2 + most / 2;
    this.largest = (this.body ? Math.max(-least, most) : most / 2 - least / 2) || 1;
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

  schedule() {
    if (this.scheduled) return;
    this.scheduled = true;
    requestAnimationFrame(() => { this.scheduled = false; this.draw(); });
  }

  // --- what is drawn

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
    const normal = new Float32Array(all.length);
    for (let i = 0; i < all.length; ++i) normal[i] = this.normal(all[i]);
    this.drawing?.setValues(normal);
    drawn.values = key;
  }

  /// Where the triangles are, if that has changed.
  prepareShape() {
    const { drawn, result: { mesh: { points, triangles } } } = this, shape = `${this.surface && this.joined}`;
    if (drawn.shape === shape) return;
    const places = new Float32Array(2 * triangles.length), [x, y] = this.middle;
    for (let i = 0; i < triangles.length; ++i) {
      places[2 * i] = (points[2 * triangles[i]] - x) / this.unit;
      places[2 * i + 1] = (points[2 * triangles[i] + 1] - y) / this.unit;
    }
    this.drawing?.setShape(places, this.shifts());
    drawn.shape = shape;
  }

  /// Whether triangles of a surface meet. Where it jumps one sees through it, which of small triangles would leave more
  /// holes than surface; they meet until one is near enough to see the jumps.
  get joined() {
    const edge = Math.sqrt((8 * this.size[0] * this.size[1]) / this.count);
    return this.view.smooth || edge * this.projection.scale < smallestJumping;
  }

  /// The values at corners; of the difference to the other result if there is one.
  values(smooth) {
    const { triangles } = this.result.mesh, own = valueAt(this.field, smooth, triangles);
    if (!this.other) return own;
    const others = valueAt(this.other.fields.get(this.field.key), smooth, triangles);
    return (i) => own(i) - others(i);
  }

  /// By which corners move: of a body at the points, of a membrane by its displacement.
  shifts() {
    const { mesh: { triangles }, displacement: { at_points: points } } = this.result;
    const shifts = new Float32Array((this.body ? 2 : 1) * triangles.length);
    if (this.body) {
      for (let i = 0; i < shifts.length; ++i) shifts[i] = points[2 * triangles[i >> 1] + (i & 1)] / this.largest;
      return shifts;
    }
    this.heights = valueAt(this.fields.get("displacement"), this.joined, triangles);
    for (let i = 0; i < shifts.length; ++i) shifts[i] = (this.heights(i) - this.base) / this.largest;
    return shifts;
  }

  draw() {
    const { frame, view } = this, width = frame.clientWidth, height = frame.clientHeight;
    if (!width || !height) return;
    this.prepare();
    const dense = devicePixelRatio || 1;
    const pixels = [Math.round(width * dense), Math.round(height * dense)];
    if (this.over.width !== pixels[0] || this.over.height !== pixels[1]) [this.over.width, this.over.height] = pixels;
    this.dense = dense;
    const lifted = this.body ? 0 : this.liftDrawn;
    this.projection = new Projection(view, this.surface, width, height, this.body ? this.size.map((half) => half + 0.5 * this.liftDrawn) : this.size, lifted);
    this.prepareShape();
    this.scale = this.scaleWith(this.beside?.() ?? []);
    this.showScale();
    this.looked = {
      turn: this.projection.turn, frame: this.projection.frame, lift: this.surface || this.body ? this.liftDrawn : 0,
      range: [this.scale.low, this.scale.high].map(this.normal), even: this.field.corners === 1 && !view.smooth, mesh: view.mesh, lit: this.surface,
    };
    this.moving = this.moves();
    this.drawing?.draw(this.looked, this.moving, ...pixels);
    this.drawOver();
    if (this.pointer) this.look(...this.pointer);
    this.onDrawn?.();
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
    const { fixed, low, high } = this.view, all = [this, ...others];
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

  /// The place of a corner in the picture.
  corner(i) {
    const { points, triangles } = this.result.mesh, p = triangles[i];
    return this.surface ? this.pixelOf(points[2 * p], points[2 * p + 1], (this.heights(i) - this.base) / this.largest) : this.pixelOfPoint(p);
  }
  /// How far behind the screen it is.
  depthOf(i) {
    const { points, triangles } = this.result.mesh, p = triangles[i];
    return this.projection.depth(...[0, 1].map((c) => (points[2 * p + c] - this.middle[c]) / this.unit), ((this.heights(i) - this.base) / this.largest) * this.liftDrawn);
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

  drawOver() {
    const pen = this.over.getContext("2d"), style = getComputedStyle(this.frame), { view, result: { mesh, contact = {} } } = this;
    pen.setTransform(this.dense, 0, 0, this.dense, 0, 0);
    pen.clearRect(0, 0, this.frame.clientWidth, this.frame.clientHeight);
    pen.lineCap = pen.lineJoin = "round";
    for (const [name, edges] of Object.entries(mesh.boundary)) {
      pen.beginPath();
      this.trace(pen, edges);
      if (name in contact) stroke(pen, style.getPropertyValue("--accent"), 2.5);
      else if (!this.surface) stroke(pen, style.getPropertyValue("--quiet"), 1.2);
    }
    if (this.body) {
      pen.beginPath();
      for (const line of this.foundation()) line.forEach((place, i) => pen[i ? "lineTo" : "moveTo"](...place));
      pen.setLineDash([7, 4]);
      stroke(pen, style.getPropertyValue("--ink"), 1.6);
      pen.setLineDash([]);
    }
    if (view.nodes && this.result.stress) this.drawNodes(pen, style);
    if (view.crosses && this.result.principal) this.drawCrosses(pen, style);
    if (this.picked >= 0) {
      pen.beginPath();
      for (let k = 0; k < 3; ++k) pen[k ? "lineTo" : "moveTo"](...this.corner(3 * this.picked + k));
      pen.closePath();
      stroke(pen, "#fff", 3.5);
      stroke(pen, "#000", 1.5);
    }
  }

  /// Lines of places where the foundation is; the gap is as many times too large as the deformation.
  foundation() {
    this.lines ??= this.body ? foundationOf(this.result) : [];
    return this.lines.map((line) => line.map(([x, y, dx, dy]) => this.pixelOf(x + this.lift * dx, y + this.lift * dy)));
  }

  /// Edges that follow each other are one line, with corners that are not told apart left out.
  trace(pen, edges) {
    let at = null;
    for (let i = 0; i < edges.length; i += 2) {
      if (i === 0 || edges[i] !== edges[i - 1]) pen.moveTo(...(at = this.pixelOfPoint(edges[i])));
      const next = this.pixelOfPoint(edges[i + 1]);
      if (edges[i + 1] === edges[i + 2] && Math.hypot(next[0] - at[0], next[1] - at[1]) < 1.5) continue;
      pen.lineTo(...(at = next));
    }
  }

  isSeen([x, y]) {
    return x >= 0 && y >= 0 && x <= this.frame.clientWidth && y <= this.frame.clientHeight;
  }

  /// Where the unknowns sit: of the stress a bar across its edge, or inside a square, of the displacement a disc, of the
  /// clearance a ring.
  drawNodes(pen, style) {
    this.nodes ??= nodesOf(this.result);
    const ink = style.getPropertyValue("--ink"), ground = style.getPropertyValue("--paper");
    const marks = (places, draw) => {
      const seen = [];
      for (const [t, weights] of places) {
        const corners = [0, 1, 2].map((k) => this.corner(3 * t + k));
        const at = [0, 1].map((c) => corners.reduce((sum, corner, k) => sum + weights[k] * corner[c], 0));
        if (this.isSeen(at)) seen.push([at, corners, weights]);
        if (seen.length > mostMarks) return;
      }
      seen.forEach((own) => draw(...own));
    };
    marks(this.nodes.stress, ([x, y], corners, weights) => {
      const opposite = weights.indexOf(0);
      pen.beginPath();
      if (opposite < 0) pen.rect(x - 2.5, y - 2.5, 5, 5);
      else {
        const [a, b] = [corners[(opposite + 1) % 3], corners[(opposite + 2) % 3]], long = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
        const [nx, ny] = [((b[1] - a[1]) / long) * 5, ((a[0] - b[0]) / long) * 5];
        pen.moveTo(x - nx, y - ny);
        pen.lineTo(x + nx, y + ny);
      }
      stroke(pen, ground, 4);
      stroke(pen, ink, 1.6);
    });
    marks(this.nodes.displacement, ([x, y]) => {
      pen.beginPath();
      pen.arc(x, y, 2.6, 0, 7);
      pen.fillStyle = ink;
      stroke(pen, ground, 1.6);
      pen.fill();
    });
    for (const [x, y] of this.nodes.clearance.map((own) => this.clearanceNode(own)).filter((at) => this.isSeen(at))) {
      pen.beginPath();
      pen.arc(x, y, 4.5, 0, 7);
      pen.fillStyle = ground;
      pen.fill();
      stroke(pen, style.getPropertyValue("--accent"), 2.2);
    }
  }
  /// It lies between the ends of an edge.
  clearanceNode([a, b, way]) {
    const [from, to] = [this.pixelOfPoint(a), this.pixelOfPoint(b)];
    return from.map((each, c) => each + way * (to[c] - each));
  }

  /// The principal directions at the centroids; arms by the size of the stress, pressure in the colour of pressure.
  drawCrosses(pen, style) {
    const { stress: { at_centroids: stress }, principal } = this.result;
    const [low, high] = extent(principal), largest = Math.max(-low, high) || 1;
    const apart = 14, arm = 7, taken = new Set();
    const colours = [style.getPropertyValue("--pull"), style.getPropertyValue("--push")];
    for (let t = 0; t < this.count; ++t) {
      const corners = [0, 1, 2].map((k) => this.corner(3 * t + k));
      const at = [0, 1].map((c) => (corners[0][c] + corners[1][c] + corners[2][c]) / 3);
      const cell = `${Math.floor(at[0] / apart)},${Math.floor(at[1] / apart)}`;
      if (!this.isSeen(at) || taken.has(cell)) continue;
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

  // --- what is under the pointer

  look(x, y) {
    this.pointer = [x, y];
    if (!this.drawing || !this.looked || this.moving) return;
    const t = this.drawing.triangleAt(this.looked, x * this.dense, y * this.dense), before = this.picked;
    this.picked = t;
    if (t < 0) this.readout.textContent = "";
    else this.tellValue(t, [x, y]);
    if (before !== t) this.drawOver();
  }

  /// A picture is parallel: shares of the corners are the same on the screen and in the body.
  tellValue(t, [x, y]) {
    const [a, b, c] = [0, 1, 2].map((k) => this.corner(3 * t + k));
    const twice = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
    const second = ((x - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (y - a[1])) / twice, third = ((b[0] - a[0]) * (y - a[1]) - (x - a[0]) * (b[1] - a[1])) / twice;
    const shares = [1 - second - third, second, third];
    const { points, triangles } = this.result.mesh, mixed = (at) => shares.reduce((sum, share, k) => sum + share * at(3 * t + k), 0);
    const place = [0, 1].map((own) => mixed((i) => points[2 * triangles[i] + own]));
    const value = this.looked.even ? this.at(3 * t) : mixed(this.at);
    this.readout.replaceChildren(element("span", {}, `x ${short(place[0])}`), element("span", {}, `y ${short(place[1])}`),
      element("span", {}, `triangle ${t}`), element("strong", {}, `${this.title.textContent} ${short(value, 6)}`));
    Object.assign(this.readout.dataset, { triangle: t, value, x: place[0], y: place[1] });
  }

  // --- what moves it

  listen() {
    const { frame, view } = this, fingers = new Map();
    const place = (event) => { const box = frame.getBoundingClientRect(); return [event.clientX - box.left, event.clientY - box.top]; };
    const pan = (dx, dy) => view.set({ x: view.x + dx / frame.clientWidth, y: view.y + dy / frame.clientHeight });
    const turn = (dx, dy) => view.set({ turn: view.turn + dx * 0.008, tilt: Math.min(Math.PI / 2, Math.max(0.02, view.tilt + dy * 0.008)) });
    /// What is at (x, y) stays there.
    const zoom = (factor, [x, y]) => {
      const own = Math.min(1e4, Math.max(0.2, view.zoom * factor)) / view.zoom, [w, h] = [frame.clientWidth, frame.clientHeight];
      const kept = (offset, at, whole) => (at - own * (at - (whole / 2 + offset * whole)) - whole / 2) / whole;
      view.set({ zoom: view.zoom * own, x: kept(view.x, x, w), y: kept(view.y, y, h) });
    };
    frame.addEventListener("pointerdown", (event) => { frame.setPointerCapture(event.pointerId); fingers.set(event.pointerId, place(event)); });
    frame.addEventListener("pointermove", (event) => {
      const at = place(event), before = fingers.get(event.pointerId);
      if (!before) return this.look(...at);
      const other = [...fingers].find(([id]) => id !== event.pointerId)?.[1];
      fingers.set(event.pointerId, at);
      if (other) {
        const long = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]) || 1, middle = [0, 1].map((c) => (at[c] + other[c]) / 2);
        pan((at[0] - before[0]) / 2, (at[1] - before[1]) / 2);
        zoom(long(at) / long(before), middle);
      } else if (this.surface && !event.shiftKey && event.button !== 1) turn(at[0] - before[0], at[1] - before[1]);
      else pan(at[0] - before[0], at[1] - before[1]);
    });
    for (const end of ["pointerup", "pointercancel"]) frame.addEventListener(end, (event) => { fingers.delete(event.pointerId); if (event.type === "pointerup") this.look(...place(event)); });
    frame.addEventListener("pointerleave", () => { this.pointer = null; this.picked = -1; this.drawOver(); });
    frame.addEventListener("wheel", (event) => { event.preventDefault(); zoom(Math.exp(-event.deltaY * 0.0015), place(event)); }, { passive: false });
    frame.addEventListener("dblclick", () => view.reset());
    frame.addEventListener("keydown", (event) => {
      const middle = [frame.clientWidth / 2, frame.clientHeight / 2], turns = this.surface && !event.shiftKey, step = turns ? 12 : 30;
      const move = (dx, dy) => (turns ? turn(dx * step, dy * step) : pan(dx * step, dy * step));
      const does = {
        ArrowLeft: () => move(-1, 0), ArrowRight: () => move(1, 0), ArrowUp: () => move(0, -1), ArrowDown: () => move(0, 1),
        "+": () => zoom(1.25, middle), "=": () => zoom(1.25, middle), "-": () => zoom(0.8, middle), 0: () => view.reset(),
        m: () => view.set({ mesh: !view.mesh }), f: () => view.set({ surface: !this.surface }),
      }[event.key];
      if (!does || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      does();
    });
  }

  /// The picture as it is seen, with its scale.
  async png() {
    do this.draw(); while (this.moving);
    const { width, height } = this.canvas, d = this.dense, wide = 90 * d, whole = element("canvas", { width: width + wide, height: height + 30 * d }), pen = whole.getContext("2d");
    pen.fillStyle = getComputedStyle(this.frame).getPropertyValue("--paper");
    pen.fillRect(0, 0, whole.width, whole.height);
    pen.drawImage(this.canvas, 0, 30 * d);
    pen.drawImage(this.over, 0, 30 * d);
    pen.imageSmoothingEnabled = false;
    pen.drawImage(this.scaleBar, width + 8 * d, 40 * d, 14 * d, height - 20 * d);
    pen.fillStyle = getComputedStyle(this.frame).getPropertyValue("--ink");
    pen.font = `${13 * d}px system-ui, sans-serif`;
    pen.fillText(this.title.textContent, 10 * d, 20 * d);
    [...this.ticks.children].forEach((tick, i) => pen.fillText(tick.textContent, width + 27 * d, 45 * d + (i / 4) * (height - 20 * d)));
    return new Promise((resolve) => { whole.toBlob(resolve, "image/png"); });
  }
}

