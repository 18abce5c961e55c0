// Draws coloured triangles by WebGL2, each with three corners of its own, so that what jumps still jumps.

const corners = `#version 300 es
layout(location = 0) in vec2 place;
layout(location = 1) in vec2 shift;
layout(location = 2) in float value;
uniform vec4 turn;   // cosine and sine of the turn, and of the tilt
uniform vec4 frame;  // from the plane of the screen to that of the picture: factors, then offsets
uniform float lift;
uniform bool surface;
flat out float own;
out float along;
out vec3 corner, seen;
flat out int triangle;
void main() {
  vec3 p = surface ? vec3(place, lift * shift.x) : vec3(place + lift * shift, 0.0);
  float x = p.x * turn.x - p.y * turn.y, y = p.x * turn.y + p.y * turn.x;
  seen = vec3(x, y * turn.w + p.z * turn.z, y * turn.z - p.z * turn.w);
  gl_Position = vec4(seen.xy * frame.xy + frame.zw, seen.z * 0.2, 1.0);
  own = along = value;
  int k = gl_VertexID % 3;
  corner = vec3(k == 0, k == 1, k == 2);
  triangle = gl_VertexID / 3;
}`;

const coloured = `#version 300 es
precision highp float;
flat in float own;
in float along;
in vec3 corner, seen;
uniform sampler2D colours;
uniform vec2 range;
uniform bool even, mesh, lit;
out vec4 colour;
void main() {
  float share = clamp(((even ? own : along) - range.x) / (range.y - range.x), 0.0, 1.0);
  vec3 c = texture(colours, vec2((share * 255.0 + 0.5) / 256.0, 0.5)).rgb;
  if (lit) {
    vec3 n = cross(dFdx(seen), dFdy(seen));
    c *= 0.7 + 0.3 * abs(n.z) / max(length(n), 1e-20);
  }
  if (mesh) {
    vec3 wide = fwidth(corner), beside = smoothstep(vec3(0.0), 1.3 * wide, corner);
    float edge = 1.0 - min(beside.x, min(beside.y, beside.z));
    // Where edges are too close to each other to be told apart they would only darken the picture.
    edge *= 1.0 - smoothstep(0.15, 0.4, max(wide.x, max(wide.y, wide.z)));
    c = mix(c, vec3(0.0), 0.28 * edge);
  }
  colour = vec4(c, 1.0);
}`;

const numbered = `#version 300 es
precision highp float;
flat in float own;
in float along;
in vec3 corner, seen;
flat in int triangle;
out vec4 colour;
void main() {
  int n = triangle + 1;
  colour = vec4(n & 255, (n >> 8) & 255, (n >> 16) & 255, (n >> 24) & 255) / 255.0;
}`;

function program(gl, fragment) {
  const made = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, corners], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS) && !gl.isContextLost()) throw new Error(gl.getProgramInfoLog(made));
  const names = ["turn", "frame", "lift", "surface", "range", "even", "mesh", "lit"];
  return { made, ...Object.fromEntries(names.map((name) => [name, gl.getUniformLocation(made, name)])) };
}

const mostSmoothed = 100000; // triangles whose edges are smoothed: software draws four samples a pixel

/// The numbers of some corners.
function gathered(numbers, size, corners) {
  const own = new Float32Array(size * corners.length);
  corners.forEach((corner, i) => { for (let c = 0; c < size; ++c) own[size * i + c] = numbers[size * corner + c]; });
  return own;
}

export class Drawing {
  /// `coarse`: what is drawn of it in motion (coarse.js), null if that is all. Throws if the browser has no WebGL2.
  /// `onRestored` is called when a lost context is back, and all is to be set again.
  constructor(canvas, triangles, coarse, onRestored) {
    Object.assign(this, { canvas, coarse });
    this.gl = canvas.getContext("webgl2", { antialias: triangles <= mostSmoothed, alpha: true, premultipliedAlpha: true });
    if (!this.gl) throw new Error("This browser has no WebGL2.");
    canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    canvas.addEventListener("webglcontextrestored", () => { this.begin(); onRestored(); });
    this.begin();
  }

  begin() {
    const { gl } = this;
    this.shown = program(gl, coloured);
    this.numbers = program(gl, numbered);
    this.makeArrays();
    this.texture = gl.createTexture();
    this.target = null;
    gl.enable(gl.DEPTH_TEST);
  }

  makeArrays() {
    const { gl } = this;
    const arrays = () => ({ array: gl.createVertexArray(), buffers: [0, 1, 2].map(() => gl.createBuffer()) });
    this.whole = arrays();
    this.rough = this.coarse && arrays();
    this.waiting = new Map(); // location → what the whole is filled with when it is first drawn
  }

  /// Triangles of another mesh will be set.
  change(coarse) {
    for (const { array, buffers } of [this.whole, this.rough].filter(Boolean)) {
      this.gl.deleteVertexArray(array);
      buffers.forEach((own) => this.gl.deleteBuffer(own));
    }
    this.coarse = coarse;
    this.makeArrays();
  }

  /// So many numbers a corner; `of`: "own" or "at", by which corner of the whole those of the coarse one go.
  fill(location, numbers, size, of) {
    if (this.rough) this.load(this.rough, location, gathered(numbers, size, this.coarse[of]), size);
    this.waiting.set(location, [numbers, size]);
  }

  load({ array, buffers }, location, numbers, size) {
    const { gl } = this;
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffers[location]);
    gl.bufferData(gl.ARRAY_BUFFER, numbers, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(location);
    gl.vertexAttribPointer(location, size, gl.FLOAT, false, 0, 0);
  }

  /// Two coordinates a corner; one number a corner by which it is lifted, or two by which it is shifted.
  setShape(places, shifts) {
    this.whole.count = places.length / 2;
    if (this.rough) this.rough.count = this.coarse.own.length;
    this.surface = shifts.length < places.length;
    this.fill(0, places, 2, "at");
    this.fill(1, shifts, this.surface ? 1 : 2, "at");
  }

  setValues(values) {
    this.fill(2, values, 1, "own");
  }

  /// 256 colours of four bytes.
  setColours(colours) {
    const { gl } = this;
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, 256, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, colours);
    for (const [name, value] of [["MIN_FILTER", "LINEAR"], ["MAG_FILTER", "LINEAR"], ["WRAP_S", "CLAMP_TO_EDGE"], ["WRAP_T", "CLAMP_TO_EDGE"]])
      gl.texParameteri(gl.TEXTURE_2D, gl[`TEXTURE_${name}`], gl[value]);
  }

  run({ made, ...at }, arrays, view, width, height) {
    const { gl } = this;
    if (arrays === this.whole) {
      for (const [location, [numbers, size]] of this.waiting) this.load(arrays, location, numbers, size);
      this.waiting.clear();
    }
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.useProgram(made);
    gl.uniform4fv(at.turn, view.turn);
    gl.uniform4fv(at.frame, view.frame);
    gl.uniform1f(at.lift, view.lift);
    gl.uniform1i(at.surface, this.surface);
    // What only one of the shaders has is null for the other, which is set to no effect.
    gl.uniform2fv(at.range, view.range);
    for (const name of ["even", "mesh", "lit"]) gl.uniform1i(at[name], view[name]);
    gl.bindVertexArray(arrays.array);
    gl.drawArrays(gl.TRIANGLES, 0, arrays.count);
  }

  /// With so many pixels. `moving`: soon another one follows, so that of a large mesh a rough one does.
  draw(view, moving, width, height) {
    const { gl, canvas } = this, rough = moving ? this.rough : null, pixels = [width, height].map((each) => Math.ceil(rough ? each / 2 : each));
    if (canvas.width !== pixels[0] || canvas.height !== pixels[1]) [canvas.width, canvas.height] = pixels;
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    this.run(this.shown, rough || this.whole, rough ? { ...view, mesh: false } : view, ...pixels);
    this.numbered = false;
  }

  /// The number of the triangle that is seen at a pixel, counted from the top left; -1 if there is none.
  triangleAt(view, x, y) {
    const { gl, canvas: { width, height } } = this;
    if (x < 0 || y < 0 || x >= width || y >= height) return -1;
    if (!this.target || this.target.width !== width || this.target.height !== height) this.makeTarget(width, height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target.framebuffer);
    if (!this.numbered) this.run(this.numbers, this.whole, view, width, height);
    this.numbered = true;
    const bytes = new Uint8Array(4);
    gl.readPixels(Math.floor(x), height - 1 - Math.floor(y), 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    return bytes[0] + bytes[1] * 256 + bytes[2] * 65536 + bytes[3] * 16777216 - 1;
  }

  makeTarget(width, height) {
    const { gl } = this;
    const framebuffer = this.target?.framebuffer ?? gl.createFramebuffer();
    this.target?.buffers.forEach((old) => gl.deleteRenderbuffer(old));
    gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
    const buffers = [];
    for (const [format, place] of [[gl.RGBA8, gl.COLOR_ATTACHMENT0], [gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT]]) {
      const buffer = gl.createRenderbuffer();
      gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
      gl.renderbufferStorage(gl.RENDERBUFFER, format, width, height);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, place, gl.RENDERBUFFER, buffer);
      buffers.push(buffer);
    }
    this.target = { framebuffer, buffers, width, height };
    this.numbered = false;
  }
}
