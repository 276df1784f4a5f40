// The moving picture: raw WebGL 2, parallel projection, positions read from textures by number.
//
// A frame draws the first `shown` triangles. No vertex has attributes: gl_VertexID gives the
// triangle, that its nodes, those their positions in the two frames around the time.

const GROUPS = ["#4477aa", "#ee6677", "#228833", "#ccbb44", "#66ccee", "#aa3377", "#9a9a9a",
  "#8866cc", "#ddcc77", "#44aa99", "#882255", "#999933"];

const rgb = (color) => [1, 3, 5].map((k) => parseInt(color.slice(k, k + 2), 16) / 255);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

const COLOR_OF = { amount: 0, label: 1, scattered: 2 };
const DRAW = { ROCK: 0, START: 1, NUMBERS: 2 };
const FIXED_ROCK = [0.7, 0.715, 0.735]; // rock that cannot move has no amount to show
const ABOVE = 56, BELOW = 66; // pixels of the page
const COLORS = 251; // of blocks and pieces: the same in moving_surface.py
const UNITS = ["place0", "place1", "corners", "about", "value0", "value1", "map"];

const VERTEX = `#version 300 es
precision highp float; precision highp int; precision highp usampler2D; precision highp sampler2D;
uniform usampler2D place0, place1, corners, about;
uniform sampler2D value0, value1;
uniform vec3 low0, low1; uniform float step0, step1, scale0, scale1, between, bias;
uniform int on, color, source; uniform uint frame; uniform mat4 view;
out vec3 P, side; out float value;
flat out int label, triangle; flat out uint bits, block;
ivec2 at(int i) { return ivec2(i % ${ROW}, i / ${ROW}); }
void main() {
  int t = gl_VertexID / 3, k = gl_VertexID % 3;
  uvec4 c = texelFetch(corners, at(t), 0), a = texelFetch(about, at(t), 0);
  int node = int(c[k]), row = on == 0 ? node : on == 1 ? int(a.x) : int(a.y);
  P = mix(low0 + step0 * vec3(texelFetch(place0, at(node), 0).xyz),
          low1 + step1 * vec3(texelFetch(place1, at(node), 0).xyz), between);
  float v0 = texelFetch(value0, at(row), 0).r, v1 = texelFetch(value1, at(row), 0).r;
  value = mix(v0 * v0 * scale0, v1 * v1 * scale1, between);
  uint group = a.z & 255u;
  label = source == 1 ? int(group) : source == 2 ? int((a.z >> 8) & 255u)
        : source == 3 ? int(c.w % ${COLORS}u) : int(v0 * 255. + .5);
  side = vec3(k == 0, k == 1, k == 2);
  bits = a.z; block = c.w; triangle = t;
  gl_Position = view * vec4(P, 1.);
  gl_Position.z += bias * gl_Position.w;
  if (frame >= a.w) gl_Position = vec4(2., 2., 2., 1.); // it has gone
}`;

const FRAGMENT = `#version 300 es
precision highp float; precision highp int; precision highp sampler2D;
in vec3 P, side; in float value;
flat in int label, triangle; flat in uint bits, block;
uniform sampler2D map; uniform int draw, color; uniform bool lines, fixedLines, cut, logarithmic, groups;
uniform vec3 palette[12], eye, paper; uniform vec4 plane; uniform float least; uniform vec2 span;
uniform uint hidden[8], fixedRock[8], chosen;
out vec4 result;
vec3 scattered(int number) { // hues that lie far from one another
  float hue = fract(float(number) * .61803399), light = .5 + .16 * fract(float(number) * .7548777);
  vec3 c = clamp(abs(mod(hue * 6. + vec3(0., 4., 2.), 6.) - 3.) - 1., 0., 1.);
  return mix(vec3(light), c, .42) * (.55 + .5 * light) + .12;
}
vec3 colored() {
  if (color == 1) return palette[label % 12];
  if (color == 2) return scattered(label);
  float part = logarithmic ? log(max(value, 1e-30) / span.x) / log(span.y / span.x)
             : (value - span.x) / (span.y - span.x);
  return texture(map, vec2(clamp(part, 0., 1.) * .996 + .002, .5)).rgb;
}
float edge() { // how much of the pixel is an edge of the face
  vec3 wide = fwidth(side), near = smoothstep(vec3(0.), wide * 1.1, side);
  float far = 1.;
  if (((bits >> 16) & 1u) == 1u) far = min(far, near.x);
  if (((bits >> 16) & 2u) == 2u) far = min(far, near.y);
  if (((bits >> 16) & 4u) == 4u) far = min(far, near.z);
  float largest = max(wide.x, max(wide.y, wide.z)); // small faces on the screen lose their edges
  return (1. - far) * (1. - smoothstep(.08, .4, largest));
}
bool has(uint mask, uint group) { return ((mask >> (group % 32u)) & 1u) == 1u; }
void main() {
  uint group = bits & 255u;
  if (has(hidden[group / 32u], group)) discard;
  if (dot(P, plane.xyz) < plane.w || (draw != ${DRAW.START} && color == 0 && value < least)) discard;
  if (draw == ${DRAW.NUMBERS}) {
    int n = triangle + 1;
    result = vec4(n & 255, (n >> 8) & 255, (n >> 16) & 255, 255) / 255.;
    return;
  }
  bool isFixed = has(fixedRock[group / 32u], group);
  vec3 grey = vec3(${FIXED_ROCK}), c = isFixed && !groups ? grey : colored();
  bool inside = cut && !gl_FrontFacing && draw == ${DRAW.ROCK};
  if (inside) { // rock that the section goes through: hatched, as in a drawing
    float line = abs(fract((gl_FragCoord.x + gl_FragCoord.y) / 9.) - .5);
    vec3 rock = mix(isFixed && !groups ? grey : palette[int(group) % 12], paper, .62);
    result = vec4(mix(rock * .72, rock, smoothstep(.05, .14, line)), 1.);
    return;
  }
  vec3 n = normalize(cross(dFdx(P), dFdy(P))), toEye = normalize(eye);
  if (dot(n, toEye) < 0.) n = -n;
  float sun = max(dot(n, normalize(vec3(-.45, -.35, .82))), 0.);
  float light = .46 + .22 * (.5 + .5 * n.z) + .30 * sun + .10 * max(dot(n, toEye), 0.);
  if (draw == ${DRAW.START}) { result = vec4(mix(paper, vec3(.36, .42, .5), .8), .22); return; }
  c *= light;
  if (chosen == block) c = mix(c, vec3(1., .62, .1), .55);
  if (isFixed ? fixedLines : lines) c = mix(c, c * .3, .5 * edge());
  result = vec4(c, 1.);
}`;

// Bolts: each bar is a strip of a few pixels, on both sides of the line between its ends.
const BAR_VERTEX = `#version 300 es
precision highp float;
in vec3 end0, end1; uniform mat4 view; uniform vec2 pixel;
void main() {
  vec4 a = view * vec4(end0, 1.), b = view * vec4(end1, 1.);
  vec2 way = (b.xy - a.xy) / pixel, along = way / max(length(way), 1e-6);
  vec2 aside = vec2(-along.y, along.x) * pixel * (gl_VertexID % 2 == 0 ? -1.6 : 1.6);
  gl_Position = (gl_VertexID < 2 ? a : b) + vec4(aside, -2e-4, 0.);
}`;
const BAR_FRAGMENT = `#version 300 es
precision highp float; uniform vec4 ink; out vec4 result;
void main() { result = ink; }`;

class Picture {
  // Throws an error if the browser has no WebGL 2.
  constructor(canvas) {
    this.canvas = canvas;
    const gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
    if (!gl) throw new Error("this browser has no WebGL 2, so there is no moving picture");
    this.gl = gl;
    this.program = this.link(VERTEX, FRAGMENT);
    this.barProgram = this.link(BAR_VERTEX, BAR_FRAGMENT);
    this.places = new Map();
    this.held = UNITS.map(() => null); // what each texture holds
    this.textures = UNITS.map(() => gl.createTexture());
    this.camera = { azimuth: -1, height: 0.5, radius: 1, center: [0, 0, 0] };
    this.look = {
      field: null, span: [0, 1], logarithmic: false, hidden: new Uint32Array(8), least: 0,
      section: null, lines: true, fixedLines: false, start: false, chosen: STAYS,
    };
    gl.useProgram(this.program);
    this.noArrays = gl.createVertexArray();
    this.setUpBars();
    gl.bindVertexArray(this.noArrays);
    UNITS.forEach((name, unit) => gl.uniform1i(this.at(name), unit));
    gl.uniform3fv(this.at("palette"), GROUPS.flatMap(rgb));
  }

  link(vertex, fragment) {
    const gl = this.gl, program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    return program;
  }

  // Where a uniform lies.
  at(name) {
    if (!this.places.has(name)) this.places.set(name, this.gl.getUniformLocation(this.program, name));
    return this.places.get(name);
  }

  // Put an array into the texture of a unit, if it is not there already.
  hold(unit, data, width, internal, format, type) {
    const gl = this.gl;
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(gl.TEXTURE_2D, this.textures[unit]);
    if (this.held[unit] === data) return;
    this.held[unit] = data;
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.texImage2D(gl.TEXTURE_2D, 0, internal, ROW, data.length / width / ROW, 0, format, type, data);
    for (const which of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, which, gl.NEAREST);
  }

  // Colours from 0 to 1: bytes of red, green, blue.
  setMap(bytes) {
    const gl = this.gl;
    gl.activeTexture(gl.TEXTURE0 + 6);
    gl.bindTexture(gl.TEXTURE_2D, this.textures[6]);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB, bytes.length / 3, 1, 0, gl.RGB, gl.UNSIGNED_BYTE, bytes);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
  }

  // Take over the triangles of a run, when it begins and after it has grown.
  setRun(run) {
    this.run = run;
    const padded = (data) => {
      const full = new Uint32Array(4 * ROW * rowsOf(data.length / 4));
      full.set(data);
      return full;
    };
    this.corners = padded(run.corners);
    this.about = padded(run.about);
    this.origin = run.frames[0].low;
    this.fixedRock = new Uint32Array(8);
    run.groups.forEach((name, g) => {
      if (run.facts.fixed.includes(name)) this.fixedRock[g >> 5] |= 1 << (g & 31);
    });
    this.empty ??= new Uint8Array(ROW);
  }

  // Directions of the screen: towards the eye, right, up.
  axes() {
    const { azimuth, height } = this.camera, flat = Math.cos(height);
    const eye = [Math.cos(azimuth) * flat, Math.sin(azimuth) * flat, Math.sin(height)];
    const right = [-Math.sin(azimuth), Math.cos(azimuth), 0];
    const up = [0, 1, 2].map((i) => [(i + 1) % 3, (i + 2) % 3])
      .map(([j, k]) => eye[j] * right[k] - eye[k] * right[j]);
    return { eye, right, up };
  }

  // Metres that a pixel of the page is wide.
  get metresPerPixel() {
    return (2 * this.camera.radius) / this.canvas.clientHeight;
  }

  // Look at points so that all are in the picture: those of a few nodes at the start and end.
  fit() {
    const { right, up } = this.axes();
    const run = this.run;
    const wide = this.canvas.clientWidth / this.canvas.clientHeight || 1;
    const box = { x: [Infinity, -Infinity], y: [Infinity, -Infinity], z: [Infinity, -Infinity] };
    for (const f of new Set([0, run.frames.length - 1])) {
      const count = run.frames[f].nodes;
      const every = Math.max(1, Math.floor(count / 4000));
      const eye = this.axes().eye;
      for (let n = 0; n < count; n += every) {
        const p = run.place(n, f).map((x, i) => x - this.origin[i]);
        for (const [axis, way] of [["x", right], ["y", up], ["z", eye]]) {
          const d = dot(p, way);
          box[axis] = [Math.min(box[axis][0], d), Math.max(box[axis][1], d)];
        }
      }
    }
    // the legend covers a strip at the top, the slider one at the bottom
    const tall = this.canvas.clientHeight || 1, free = Math.max(0.3, 1 - (ABOVE + BELOW) / tall);
    const half = [box.x, box.y].map(([a, b]) => (b - a) / 2);
    this.camera.radius = Math.max(half[1] / free, (half[0] / wide) * 1.07) * 1.03 || 1;
    const middle = [box.x, box.y, box.z].map(([a, b]) => (a + b) / 2), eye = this.axes().eye;
    middle[1] -= ((BELOW - ABOVE) / tall) * this.camera.radius;
    this.camera.center = [0, 1, 2].map((i) => middle[0] * right[i] + middle[1] * up[i] + middle[2] * eye[i]);
  }

  // Draw a frame, which may lie between two.
  draw(frame, paper) {
    const gl = this.gl, ratio = devicePixelRatio || 1, canvas = this.canvas;
    const width = Math.max(1, canvas.clientWidth * ratio | 0);
    const height = Math.max(1, canvas.clientHeight * ratio | 0);
    if (canvas.width !== width || canvas.height !== height) { canvas.width = width; canvas.height = height; }
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.uniform3fv(this.at("paper"), paper);
    this.setView(width / height);
    const first = Math.min(Math.floor(frame), this.run.frames.length - 1);
    this.setFrame(first, Math.min(first + 1, this.run.frames.length - 1), frame - first);
    gl.uniform1i(this.at("draw"), DRAW.ROCK);
    gl.uniform1f(this.at("bias"), 0);
    this.drawRock(this.run.shown[first]);
    this.drawBars(first, [width, height]);
    if (this.look.start) this.drawStart();
  }

  // The hatched insides of a cut lie a little behind: they must not shine through seams of blocks.
  drawRock(triangles) {
    const gl = this.gl;
    if (this.look.section) {
      gl.enable(gl.CULL_FACE);
      gl.enable(gl.POLYGON_OFFSET_FILL);
      gl.cullFace(gl.FRONT);
      gl.polygonOffset(1, 8);
      gl.drawArrays(gl.TRIANGLES, 0, 3 * triangles);
      gl.cullFace(gl.BACK);
      gl.disable(gl.POLYGON_OFFSET_FILL);
    }
    gl.drawArrays(gl.TRIANGLES, 0, 3 * triangles);
    gl.disable(gl.CULL_FACE);
  }

  // Ends of the bars of a frame, without those that a cut takes away.
  barsOf(number) {
    const { bars, low } = this.run.frames[number];
    const [nx, ny, nz, place] = this.look.section ?? [0, 0, 0, -1];
    const ends = bars.map((x, k) => x + low[k % 3] - this.origin[k % 3]), kept = [];
    for (let k = 0; k < ends.length; k += 6) {
      const [x, y, z] = [0, 1, 2].map((i) => (ends[k + i] + ends[k + 3 + i]) / 2);
      if (x * nx + y * ny + z * nz >= place) kept.push(...ends.subarray(k, k + 6));
    }
    return new Float32Array(kept);
  }

  setUpBars() {
    const gl = this.gl;
    this.barArrays = gl.createVertexArray();
    this.barBuffer = gl.createBuffer();
    gl.bindVertexArray(this.barArrays);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.barBuffer);
    ["end0", "end1"].forEach((name, k) => {
      const place = gl.getAttribLocation(this.barProgram, name);
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, 3, gl.FLOAT, false, 24, 12 * k);
      gl.vertexAttribDivisor(place, 1);
    });
  }

  // Bolts, faint where they lie in the rock.
  drawBars(number, size) {
    const gl = this.gl, bars = this.barsOf(number), ink = [0.78, 0.1, 0.12];
    if (!bars.length) return;
    gl.useProgram(this.barProgram);
    gl.bindVertexArray(this.barArrays);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.barBuffer);
    gl.bufferData(gl.ARRAY_BUFFER, bars, gl.STREAM_DRAW);
    const at = (name) => gl.getUniformLocation(this.barProgram, name);
    gl.uniformMatrix4fv(at("view"), false, this.view);
    gl.uniform2fv(at("pixel"), size.map((length) => ((devicePixelRatio || 1) / length)));
    gl.enable(gl.BLEND);
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    for (const [test, much] of [[gl.GREATER, 0.45], [gl.LEQUAL, 1]]) {
      gl.depthFunc(test);
      gl.uniform4f(at("ink"), ...ink, much);
      gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, bars.length / 6);
    }
    gl.disable(gl.BLEND);
    gl.bindVertexArray(this.noArrays);
    gl.useProgram(this.program);
  }

  // The rock as it began, like glass; behind rock that has not moved.
  drawStart() {
    const gl = this.gl;
    this.setFrame(0, 0, 0);
    gl.enable(gl.BLEND);
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthMask(false);
    gl.uniform1i(this.at("draw"), DRAW.START);
    gl.uniform1f(this.at("bias"), 4e-4);
    gl.drawArrays(gl.TRIANGLES, 0, 3 * this.run.shown[0]);
    gl.depthMask(true);
    gl.disable(gl.BLEND);
  }

  setView(wide) {
    const gl = this.gl, { eye, right, up } = this.axes(), { center, radius } = this.camera;
    const size = Math.hypot(...this.run.high.map((h, i) => h - this.origin[i]));
    const depth = 4 * Math.max(size, radius);
    const view = new Float32Array(16);
    for (let i = 0; i < 3; i++) {
      view[4 * i] = right[i] / radius / wide;
      view[4 * i + 1] = up[i] / radius;
      view[4 * i + 2] = -eye[i] / depth;
    }
    view.set([-dot(center, right) / radius / wide, -dot(center, up) / radius, dot(center, eye) / depth, 1], 12);
    this.view = view;
    gl.uniformMatrix4fv(this.at("view"), false, view);
    gl.uniform3fv(this.at("eye"), eye);
  }

  // Bind two frames, the field that colours them, and what is hidden.
  setFrame(first, second, between) {
    const gl = this.gl, run = this.run, { field, section, span } = this.look;
    [first, second].forEach((f, k) => {
      const frame = run.frames[f], values = frame.values[field.name];
      this.hold(k, frame.place, 3, gl.RGB16UI, gl.RGB_INTEGER, gl.UNSIGNED_SHORT);
      this.hold(4 + k, values ?? this.empty, 1, gl.R8, gl.RED, gl.UNSIGNED_BYTE);
      gl.uniform3fv(this.at(`low${k}`), frame.low.map((x, i) => x - this.origin[i]));
      gl.uniform1f(this.at(`step${k}`), frame.step);
      gl.uniform1f(this.at(`scale${k}`), (frame.high[field.name] ?? 1) / field.top);
    });
    this.hold(2, this.corners, 4, gl.RGBA32UI, gl.RGBA_INTEGER, gl.UNSIGNED_INT);
    this.hold(3, this.about, 4, gl.RGBA32UI, gl.RGBA_INTEGER, gl.UNSIGNED_INT);
    gl.activeTexture(gl.TEXTURE0 + 6);
    gl.bindTexture(gl.TEXTURE_2D, this.textures[6]);
    gl.uniform1f(this.at("between"), between);
    gl.uniform1ui(this.at("frame"), first);
    gl.uniform1i(this.at("on"), ["node", "element", "face"].indexOf(field.on));
    gl.uniform1i(this.at("color"), COLOR_OF[field.kind]);
    const changes = field.name in run.frames[first].values;
    const source = changes ? 0 : ["", "group", "joint", "block"].indexOf(field.name);
    gl.uniform1i(this.at("source"), source);
    gl.uniform1f(this.at("least"), this.look.least);
    gl.uniform2fv(this.at("span"), span.map((value) => value / field.top));
    gl.uniform1i(this.at("logarithmic"), this.look.logarithmic);
    gl.uniform1i(this.at("groups"), field.name === "group");
    gl.uniform1uiv(this.at("hidden"), this.look.hidden);
    gl.uniform1uiv(this.at("fixedRock"), this.fixedRock);
    gl.uniform1ui(this.at("chosen"), this.look.chosen);
    gl.uniform1i(this.at("lines"), this.look.lines);
    gl.uniform1i(this.at("fixedLines"), this.look.fixedLines);
    gl.uniform1i(this.at("cut"), section !== null && !this.look.least);
    gl.uniform4fv(this.at("plane"), section ?? [0, 0, 0, -1]);
  }

  // The triangle under a pixel of the page, or -1.
  under(x, y, frame) {
    const gl = this.gl, ratio = devicePixelRatio || 1, { width, height } = this.canvas;
    const target = gl.createFramebuffer();
    const colors = gl.createRenderbuffer();
    const depths = gl.createRenderbuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, target);
    for (const [buffer, format, where] of [
      [colors, gl.RGBA8, gl.COLOR_ATTACHMENT0],
      [depths, gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT],
    ]) {
      gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
      gl.renderbufferStorage(gl.RENDERBUFFER, format, width, height);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, where, gl.RENDERBUFFER, buffer);
    }
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const first = Math.min(Math.floor(frame), this.run.frames.length - 1);
    this.setFrame(first, Math.min(first + 1, this.run.frames.length - 1), frame - first);
    gl.uniform1i(this.at("draw"), DRAW.NUMBERS);
    gl.drawArrays(gl.TRIANGLES, 0, 3 * this.run.shown[first]);
    const pixel = new Uint8Array(4);
    gl.readPixels(x * ratio | 0, height - 1 - (y * ratio | 0), 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.deleteFramebuffer(target);
    gl.deleteRenderbuffer(colors);
    gl.deleteRenderbuffer(depths);
    return (pixel[0] | (pixel[1] << 8) | (pixel[2] << 16)) - 1;
  }
}
