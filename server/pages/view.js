// How a solve is looked at: what the controls set, what the address of the page keeps, and what several pictures share.

const defaults = {
  field: "", surface: null, turn: -0.6, tilt: 0.6, zoom: 1, x: 0, y: 0, lift: null,
  mesh: true, nodes: false, crosses: false, smooth: false, fixed: false, low: null, high: null, entry: 0, level: 0, with: "", difference: false,
};

const ranges = { zoom: [0.2, 1e4], tilt: [0.02, Math.PI / 2], lift: [0, Infinity] };

/// The nearest value that the member may have.
export function within(name, number) {
  const [least, most] = ranges[name] ?? [-Infinity, Infinity];
  return Math.min(most, Math.max(least, number));
}

/// A value of the address as the kind that the member has.
function read(name, text) {
  if (typeof defaults[name] === "boolean" || name === "surface") return text === "1";
  if (name === "field" || name === "with") return text;
  const number = Number(text);
  if (text === "" || !Number.isFinite(number)) return defaults[name];
  return name === "entry" || name === "level" ? Math.trunc(number) : within(name, number);
}

export class View {
  constructor() {
    this.listeners = [];
    this.timer = 0;
    this.readAddress();
    addEventListener("hashchange", () => { this.readAddress(); this.tell(); });
  }

  readAddress() {
    const written = new URLSearchParams(location.hash.slice(1));
    for (const name of Object.keys(defaults)) this[name] = written.has(name) ? read(name, written.get(name)) : defaults[name];
  }

  /// What differs from the beginning stands in the address, so that it leads to the same view.
  writeAddress() {
    const own = Object.keys(defaults).filter((name) => this[name] !== defaults[name] && this[name] !== null);
    const kept = (value) => (typeof value === "boolean" ? Number(value) : typeof value === "number" ? Number(value.toPrecision(6)) : value);
    const hash = new URLSearchParams(own.map((name) => [name, kept(this[name])])).toString();
    history.replaceState(null, "", location.pathname + location.search + (hash ? `#${hash}` : ""));
  }

  onChange(listener) {
    this.listeners.push(listener);
  }

  /// Only when the member is another one.
  onChangeOf(name, listener) {
    let seen = this[name];
    this.onChange(() => { if (this[name] !== seen) { seen = this[name]; listener(); } });
  }

  set(changes) {
    Object.assign(this, changes);
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.writeAddress(), 200);
    this.tell();
  }

  tell() {
    for (const listener of this.listeners) listener();
  }

  reset() {
    const { turn, tilt, zoom, x, y } = defaults;
    this.set({ turn, tilt, zoom, x, y });
  }
}

/// From places in a body, whose largest half is 1, to pixels of a picture.
export class Projection {
  /// `size`: of the body, half in x and y; `lifted`: half its height.
  constructor(view, surface, width, height, size, lifted) {
    const turn = surface ? view.turn : 0, tilt = surface ? view.tilt : Math.PI / 2;
    Object.assign(this, { cosTurn: Math.cos(turn), sinTurn: Math.sin(turn), cosTilt: Math.cos(tilt), sinTilt: Math.sin(tilt), width, height });
    const across = Math.abs(size[0] * this.cosTurn) + Math.abs(size[1] * this.sinTurn);
    const up = (Math.abs(size[0] * this.sinTurn) + Math.abs(size[1] * this.cosTurn)) * this.sinTilt + lifted * this.cosTilt;
    const margin = 0.92;
    this.scale = margin * view.zoom * Math.min(width / 2 / (surface ? Math.hypot(...size) : across), height / 2 / up || Infinity);
    this.offset = [width / 2 + view.x * width, height / 2 + view.y * height];
  }

  pixel(x, y, z = 0) {
    const across = x * this.cosTurn - y * this.sinTurn, up = (x * this.sinTurn + y * this.cosTurn) * this.sinTilt + z * this.cosTilt;
    return [this.offset[0] + this.scale * across, this.offset[1] - this.scale * up];
  }

  depth(x, y, z = 0) {
    return (x * this.sinTurn + y * this.cosTurn) * this.cosTilt - z * this.sinTilt;
  }

  /// For the shader.
  get turn() {
    return [this.cosTurn, this.sinTurn, this.cosTilt, this.sinTilt];
  }
  get frame() {
    const { scale, width, height, offset } = this;
    return [(2 * scale) / width, (2 * scale) / height, (2 * offset[0]) / width - 1, 1 - (2 * offset[1]) / height];
  }
}
