// What a run has shown so far: packs of frames, as pack.py writes them, one after the other.

const ROW = 2048; // texels in a row of a texture: arrays are padded to whole rows
const STAYS = 0xffffffff; // frame in which a triangle goes that stays

const rowsOf = (count) => Math.max(1, Math.ceil(count / ROW));

// Undo gzip and split a pack into its header and a function that gives its arrays.
async function unpack(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  const buffer = await new Response(stream).arrayBuffer();
  const length = new DataView(buffer).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  const array = (name, Type) => {
    const [at, size] = header.arrays[name] ?? [0, 0];
    return new Type(buffer.slice(4 + length + at, 4 + length + at + size));
  };
  return { header, array };
}

// Positions from low and high bytes, zigzag, the difference from node to node, and the second one in
// time; typed arrays count modulo 65536 by themselves.
function decodePlaces(coded, frames, nodes) {
  const count = 3 * nodes, found = [];
  const change = new Uint16Array(count), difference = new Uint16Array(count);
  let before = null;
  for (let f = 0; f < frames; f++) {
    const low = coded.subarray(2 * f * count, (2 * f + 1) * count);
    const high = coded.subarray((2 * f + 1) * count, (2 * f + 2) * count);
    const place = new Uint16Array(3 * ROW * rowsOf(nodes));
    for (let i = 0; i < count; i++) {
      const folded = low[i] | (high[i] << 8);
      difference[i] = ((folded >>> 1) ^ -(folded & 1)) + (i < 3 ? 0 : difference[i - 3]);
      if (f === 0) place[i] = difference[i];
      else {
        change[i] = f > 1 ? change[i] + difference[i] : difference[i];
        place[i] = before[i] + change[i];
      }
    }
    found.push(place);
    before = place;
  }
  return found;
}

// Bytes from their difference in time.
function decodeBytes(coded, frames, count) {
  const found = [];
  for (let f = 0; f < frames; f++) {
    const values = new Uint8Array(ROW * rowsOf(count));
    values.set(coded.subarray(f * count, (f + 1) * count));
    if (f > 0) for (let i = 0; i < count; i++) values[i] += found[f - 1][i];
    found.push(values);
  }
  return found;
}

// Numbers from their difference from row to row, in an array of rows of `width`.
function decodeNumbers(coded, width = 1) {
  for (let i = width; i < coded.length; i++) coded[i] += coded[i - width];
  return coded;
}

// Two typed arrays one after the other.
function joined(first, second) {
  const both = new first.constructor(first.length + second.length);
  both.set(first);
  both.set(second, first.length);
  return both;
}

class Run {
  constructor() {
    this.facts = {}; // title, tables, log: texts of the page
    this.times = []; // of the frames [s]
    this.frames = []; // {bars, place, low, step, values, high}
    this.shown = []; // triangles that a frame draws, but those that have gone
    this.fields = [];
    this.groups = [];
    this.triangles = 0;
    this.corners = new Uint32Array(0); // four for each triangle: three nodes, block
    this.about = new Uint32Array(0); // four for each: element, face, group | joint | edges, goes
    this.group = new Uint8Array(0); // of elements
    this.block = new Uint32Array(0);
    this.columns = []; // names of the histories
    this.history = []; // their values
    this.rowsKnown = 0; // rows of histories.csv that have been looked at
    this.framesKnown = 0; // frames of the folder that have been looked at
    this.low = this.high = null; // corners of the box of all frames
  }

  append({ header, array }) {
    this.facts = header.facts;
    this.rowsKnown = header.rowsKnown;
    this.framesKnown = header.framesKnown;
    this.appendHistories(header, array);
    if (header.times) this.appendFrames(header, array);
  }

  appendHistories(header, array) {
    const values = array("history", Float32Array);
    const rows = header.columns.length ? values.length / header.columns.length : 0;
    this.columns = header.columns;
    const known = this.history;
    this.history = header.columns.map((_, k) =>
      joined(known[k] ?? new Float32Array(0), values.subarray(k * rows, (k + 1) * rows)));
  }

  appendFrames(header, array) {
    const base = this.times.length, frames = header.times.length;
    this.fields = header.fields;
    this.groups = header.groups;
    this.group = joined(this.group, array("group", Uint8Array));
    this.block = joined(this.block, decodeNumbers(array("block", Uint32Array)));
    this.appendTriangles(base, array);
    const places = decodePlaces(array("place", Uint8Array), frames, header.nodes);
    const values = {};
    for (const name of Object.keys(header.arrays).filter((n) => n.startsWith("field."))) {
      const coded = array(name, Uint8Array);
      values[name.slice(6)] = decodeBytes(coded, frames, coded.length / frames);
    }
    const bars = array("bars", Float32Array);
    let bar = 0;
    for (let f = 0; f < frames; f++)
      this.frames.push({
        bars: bars.subarray(6 * bar, 6 * (bar += header.bars[f])), // both ends of each, from `low`
        place: places[f], nodes: header.nodes, low: header.low, step: header.step, high: header.high,
        values: Object.fromEntries(Object.entries(values).map(([name, all]) => [name, all[f]])),
      });
    this.times.push(...header.times);
    this.shown.push(...header.shown);
    this.low = header.low;
    this.high = header.box;
  }

  appendTriangles(base, array) {
    const nodes = decodeNumbers(array("triangle", Uint32Array), 3);
    const element = decodeNumbers(array("element", Uint32Array));
    const face = decodeNumbers(array("face", Uint32Array)), edges = array("edges", Uint8Array);
    const joint = array("joint", Uint8Array), goes = array("goes", Uint32Array);
    const count = element.length;
    const corners = new Uint32Array(4 * count);
    const about = new Uint32Array(4 * count);
    for (let t = 0; t < count; t++) {
      const e = element[t];
      corners.set([nodes[3 * t], nodes[3 * t + 1], nodes[3 * t + 2], this.block[e]], 4 * t);
      about.set([e, face[t], this.group[e] | (joint[t] << 8) | (edges[t] << 16), STAYS], 4 * t);
    }
    this.corners = joined(this.corners, corners);
    this.about = joined(this.about, about);
    this.triangles += count;
    for (let k = 0; k < goes.length; k += 2) this.about[4 * goes[k] + 3] = base + goes[k + 1];
  }

  // Place of a node in a frame [m].
  place(node, frame) {
    const { place, low, step } = this.frames[frame];
    return [0, 1, 2].map((i) => low[i] + place[3 * node + i] * step);
  }

  // Time [s] of a frame, which may lie between two.
  timeOf(frame) {
    const first = Math.min(Math.floor(frame), this.times.length - 1);
    const second = Math.min(first + 1, this.times.length - 1);
    return this.times[first] + (this.times[second] - this.times[first]) * (frame - first);
  }

  // The frame next to a time [s].
  nearest(time) {
    const away = this.times.map((t) => Math.abs(t - time));
    return away.indexOf(Math.min(...away));
  }

  // The frame of a time [s]; it may lie between two.
  frameOf(time) {
    const last = this.times.length - 1, after = this.times.findIndex((t) => t > time);
    if (after < 0) return last;
    if (after === 0) return 0;
    const length = this.times[after] - this.times[after - 1];
    return after - 1 + (length > 0 ? (time - this.times[after - 1]) / length : 0);
  }
}
