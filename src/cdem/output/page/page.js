// The page: what its controls do, and how it follows a run that goes on.
// Texts of a case are put in as text only, never as HTML.

const by = (id) => document.getElementById(id);
const LOOK_SECONDS = 2; // between two looks for new frames
const LOST_AFTER = 3; // looks that get no answer
const PLAY_SECONDS = 8; // that all frames take

class Page {
  constructor(run, source) {
    this.run = run;
    this.source = source; // where packs come from, or null for a page that is whole
    this.frame = 0;
    this.playing = false;
    this.dirty = true;
    this.mapBytes = bytesOfMap("viridis");
    this.plots = [];
    this.showFacts();
    this.setUpPlots();
    if (run.times.length) this.begin();
    else this.showMissing(run.facts.missing);
    this.seen = 0;
    requestAnimationFrame((now) => this.loop(now));
  }

  // ---------------------------------------------------------------- texts

  showFacts() {
    const { facts } = this.run;
    document.title = facts.title;
    by("title").textContent = facts.title;
    by("subtitle").textContent = facts.subtitle;
    by("status").textContent = facts.status;
    by("status").className = `badge ${facts.tone}`;
    by("tiles").replaceChildren(...facts.tiles.map(([name, value, tone]) => {
      const tile = document.createElement("div");
      const strong = document.createElement("b");
      const label = document.createElement("span");
      tile.className = `tile ${tone}`;
      strong.textContent = value;
      label.textContent = name;
      tile.append(strong, label);
      return tile;
    }));
    by("warnings").hidden = !facts.warnings.length;
    by("warnings").querySelector("ul").replaceChildren(...facts.warnings.map((text) => {
      const item = document.createElement("li");
      item.textContent = text;
      return item;
    }));
    by("tables").replaceChildren(...facts.tables.map((table) => this.card(table)));
    for (const name of ["repeat", "case", "log"]) by(name).textContent = facts[name];
    const out = facts.leftOut.join("; ");
    by("left-out").textContent = out && `Left out to keep this page small: ${out}.`;
  }

  card({ title, head, rows }) {
    const card = document.createElement("article");
    const heading = document.createElement("h2");
    const table = document.createElement("table");
    card.className = "card";
    heading.textContent = title;
    const line = (cells, kind) => {
      const row = document.createElement("tr");
      for (const text of cells) row.append(Object.assign(document.createElement(kind), { textContent: text }));
      return row;
    };
    if (head.length) table.append(line(head, "th"));
    table.append(...rows.map((row) => line(row, "td")));
    card.append(heading, table);
    return card;
  }

  showMissing(text) {
    const told = document.createElement("p");
    told.className = "missing";
    told.textContent = text;
    by("stage").replaceChildren(told);
    for (const part of by("controls").querySelectorAll("fieldset:not(.grow)")) part.hidden = true;
    this.picture = null;
  }

  // ---------------------------------------------------------------- the picture

  begin() {
    try {
      this.picture = new Picture(by("gl"));
    } catch (error) {
      this.showMissing(`No moving picture: ${error.message}.`);
      return;
    }
    this.picture.setRun(this.run);
    this.picture.setMap(this.mapBytes);
    this.setUpColors();
    this.setUpGroups();
    this.setUpView();
    this.setUpTime();
    this.setUpPointer();
    this.turnToMotion();
    this.seek(this.run.times.length - 1);
  }

  get last() {
    return this.run.times.length - 1;
  }

  seek(frame) {
    this.frame = Math.min(this.last, Math.max(0, frame));
    this.dirty = true;
  }

  setUpTime() {
    by("slider").max = this.last;
    by("slider").addEventListener("input", () => { this.play(false); this.seek(Number(by("slider").value)); });
    by("play").addEventListener("click", () => this.play(!this.playing));
  }

  play(on) {
    if (on && this.frame >= this.last) this.frame = 0;
    this.playing = on;
    by("play").textContent = on ? "❚❚" : "▶";
    by("play").ariaLabel = on ? "Pause" : "Play";
  }

  setUpColors() {
    this.setFields();
    for (const name of Object.keys(MAPS)) by("map").add(new Option(name));
    by("field").addEventListener("change", () => this.setField());
    by("map").addEventListener("change", () => {
      this.mapBytes = bytesOfMap(by("map").value);
      this.picture.setMap(this.mapBytes);
      this.setField();
    });
    by("least").addEventListener("input", () => this.setLeast());
  }

  // Offer the fields; the one that is shown stays.
  setFields() {
    const now = by("field").value, names = this.run.fields.map((f) => f.name);
    by("field").replaceChildren(...this.run.fields.map((f) => new Option(f.label, f.name)));
    by("field").value = [now, "displacement", "damage", "group"].find((n) => names.includes(n));
    this.setField();
  }

  setField() {
    this.field = this.run.fields.find((f) => f.name === by("field").value);
    this.picture.look.field = this.field;
    by("map").disabled = this.field.kind !== "amount";
    by("least-row").hidden = this.field.kind !== "amount";
    this.setLegend();
    this.setLeast();
  }

  setLeast() {
    const part = this.field.kind === "amount" ? Number(by("least").value) : 0;
    const { factor, unit } = scaled(this.field.top, this.field.unit);
    this.picture.look.least = part;
    const least = digits((part * this.field.top) / factor, 3);
    by("least-value").textContent = part ? `${least} ${unit === "1" ? "" : unit}` : "all";
    this.dirty = true;
  }

  setLegend() {
    const { label, kind, unit, top, labels } = this.field, inUnit = scaled(top, unit);
    const shown = unit && unit !== "1" ? document.createElement("span") : "";
    if (shown) shown.textContent = ` [${inUnit.unit}]`;
    by("legend-name").replaceChildren(label, shown);
    by("bar").hidden = kind !== "amount";
    by("ticks").className = kind === "amount" ? "" : "names";
    const mark = (text, color) => {
      const tick = document.createElement("span"), box = document.createElement("i");
      box.style.background = color;
      tick.append(...(color ? [box] : []), text);
      return tick;
    };
    if (kind === "amount") {
      const stops = [];
      for (let k = 0; k <= 255; k += 15) stops.push(`rgb(${this.mapBytes.slice(3 * k, 3 * k + 3)})`);
      by("bar").style.background = `linear-gradient(90deg, ${stops})`;
      by("ticks").replaceChildren(...ticks(0, top / inUnit.factor, 4).map((v) => {
        const tick = mark(digits(v), "");
        tick.style.left = `${100 * v * inUnit.factor / top}%`;
        return tick;
      }));
    } else if (kind === "label") {
      by("ticks").replaceChildren(...labels.slice(0, 12).map((name, k) => mark(name, GROUPS[k % GROUPS.length])));
    } else by("ticks").replaceChildren(mark("a colour each", ""));
  }

  setUpGroups() {
    const hidden = this.picture.look.hidden;
    by("groups").replaceChildren(...this.run.groups.map((name, g) => {
      const label = document.createElement("label"), box = document.createElement("input");
      box.type = "checkbox";
      box.checked = true;
      box.addEventListener("change", () => { hidden[g >> 5] ^= 1 << (g & 31); this.dirty = true; });
      label.append(box, name);
      return label;
    }));
  }

  setUpView() {
    const { look, camera } = this.picture;
    by("lines").addEventListener("change", () => { look.lines = by("lines").checked; this.dirty = true; });
    by("start").addEventListener("change", () => { look.start = by("start").checked; this.dirty = true; });
    for (const id of ["section", "section-place"]) by(id).addEventListener("input", () => this.setSection());
    const views = { top: [-Math.PI / 2, Math.PI / 2], x: [-Math.PI, 0], y: [-Math.PI / 2, 0] };
    for (const button of document.querySelectorAll("[data-view]"))
      button.addEventListener("click", () => {
        const view = views[button.dataset.view];
        if (view) { [camera.azimuth, camera.height] = view; this.fit(); } else this.turnToMotion();
      });
    by("save").addEventListener("click", () => this.save());
    addEventListener("resize", () => (this.dirty = true));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => (this.dirty = true));
  }

  // Cut away what lies before a plane.
  setSection() {
    const axis = by("section").value, { run, picture } = this;
    by("section-place").disabled = axis === "";
    picture.look.section = null;
    if (axis !== "") {
      const i = Number(axis), part = Number(by("section-place").value);
      const place = run.low[i] + part * (run.high[i] - run.low[i]) - picture.origin[i];
      const toEye = picture.axes().eye[i] > 0 ? -1 : 1; // the half towards the eye goes
      picture.look.section = [0, 1, 2].map((k) => (k === i ? toEye : 0)).concat(toEye * place);
    }
    this.dirty = true;
  }

  // Look from the side of the motion, a little from above.
  turnToMotion() {
    const { run, picture } = this;
    const move = [0, 0];
    const every = Math.max(1, Math.floor(run.frames[0].nodes / 3000));
    for (let n = 0; n < run.frames[0].nodes; n += every) {
      const [a, b] = [run.place(n, 0), run.place(n, this.last)];
      move[0] += b[0] - a[0];
      move[1] += b[1] - a[1];
    }
    const size = Math.max(...run.high.map((h, i) => h - run.low[i]));
    const much = Math.hypot(...move) * every / run.frames[0].nodes;
    picture.camera.azimuth = much > 1e-3 * size ? Math.atan2(move[1], move[0]) - 1.05 : -1.05;
    picture.camera.height = 0.48;
    this.fit();
  }

  fit() {
    this.picture.fit();
    if (by("section").value !== "") this.setSection();
    this.dirty = true;
  }

  // ---------------------------------------------------------------- mouse, fingers, keys

  setUpPointer() {
    const canvas = by("gl"), points = new Map(), { camera } = this.picture;
    let way = 0;
    const move = (dx, dy) => {
      const { right, up } = this.picture.axes(), metres = this.picture.metresPerPixel;
      camera.center = camera.center.map((c, i) => c + (up[i] * dy - right[i] * dx) * metres);
    };
    canvas.addEventListener("pointerdown", (event) => {
      points.set(event.pointerId, event);
      canvas.setPointerCapture(event.pointerId);
      if (points.size === 1) way = 0;
    });
    canvas.addEventListener("pointermove", (event) => {
      const before = points.get(event.pointerId);
      if (!before) return;
      const dx = event.clientX - before.clientX, dy = event.clientY - before.clientY;
      way += Math.abs(dx) + Math.abs(dy);
      if (points.size > 1) {
        const other = [...points].find(([id]) => id !== event.pointerId)[1];
        const apart = (e) => Math.hypot(e.clientX - other.clientX, e.clientY - other.clientY) || 1;
        camera.radius *= apart(before) / apart(event);
        move(dx / 2, dy / 2);
      } else if (event.shiftKey || event.buttons & 6) move(dx, dy);
      else {
        camera.azimuth -= dx * 0.008;
        camera.height = Math.max(-Math.PI / 2, Math.min(Math.PI / 2, camera.height + dy * 0.008));
      }
      points.set(event.pointerId, event);
      this.dirty = true;
    });
    const end = (event) => {
      const click = event.type === "pointerup" && event.button === 0 && way < 5;
      if (points.delete(event.pointerId) && click) this.pick(event);
    };
    for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, end);
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => {
      camera.radius *= Math.exp(event.deltaY * 0.001);
      event.preventDefault();
      this.dirty = true;
    }, { passive: false });
    canvas.addEventListener("keydown", (event) => {
      const [after, before] = [Math.floor(this.frame) + 1, Math.ceil(this.frame) - 1];
      const steps = { ArrowRight: after, ArrowLeft: before, Home: 0, End: this.last };
      if (event.key === " ") this.play(!this.playing);
      else if (event.key in steps) { this.play(false); this.seek(steps[event.key]); } else return;
      event.preventDefault();
    });
  }

  // Say what lies under the pointer.
  pick(event) {
    const { run, picture } = this, t = picture.under(event.offsetX, event.offsetY, this.frame);
    this.picked = t < 0 ? null : { triangle: t, block: run.corners[4 * t + 3] };
    picture.look.chosen = this.picked ? this.picked.block : STAYS;
    this.dirty = true;
  }

  tellPicked() {
    const { run } = this;
    if (!this.picked) { by("picked").textContent = ""; return; }
    const t = this.picked.triangle, f = Math.round(this.frame), frame = run.frames[f];
    const [node, element, face] = [run.corners[4 * t], run.about[4 * t], run.about[4 * t + 1]];
    const texts = [`block ${this.picked.block} of ${run.groups[run.group[element]]}`,
      `at ${run.place(node, f).map((x) => rounded(x, frame.step)).join(", ")} m`];
    for (const { name, label, unit, on, kind, top, labels } of run.fields) {
      const value = frame.values[name]?.[{ node, element, face }[on]];
      if (value === undefined || kind === "scattered") continue;
      const amount = (value / 255) * (frame.high[name] ?? 1), inUnit = scaled(top, unit);
      const shown = `${digits(amount / inUnit.factor, 2)} ${unit === "1" ? "" : inUnit.unit}`;
      texts.push(`${label}: ${kind === "label" ? labels[value] : shown}`);
    }
    by("picked").textContent = texts.join("\n");
  }

  // ---------------------------------------------------------------- histories

  setUpPlots() {
    const seek = (time) => { if (this.picture) { this.play(false); this.seek(this.run.frameOf(time)); } };
    this.columns = new Plot(by("columns-plot"), by("columns-chips"), seek);
    this.energies = new Plot(by("energy-plot"), by("energy-chips"), seek);
    by("columns").addEventListener("change", () => this.setColumns());
    this.fillPlots();
  }

  // Histories by what they have in common: the three components of a vector are one plot.
  fillPlots() {
    const { run } = this, sets = new Map(), energies = [];
    run.columns.forEach((name, k) => {
      const energy = name.match(/^(\w+) (energy|work) \[J\]$/);
      const part = name.match(/^(.+)_([xyz]) \[(.*)\]$/);
      const [, plain, unit] = name.match(/^(.*?)(?: \[(.*)\])?$/);
      const line = { name: part ? part[2] : plain, values: run.history[k] };
      if (energy) energies.push({ name: energy[1].replaceAll("_", " "), values: run.history[k] });
      else if (k > 1) {
        const title = (part ? part[1] : plain).replace(".", ": ").replaceAll("_", " ");
        if (!sets.has(title)) sets.set(title, { unit: (part ? part[3] : unit) ?? "", lines: [] });
        sets.get(title).lines.push(line);
      }
    });
    const now = by("columns").value;
    this.sets = sets;
    by("columns").replaceChildren(...[...sets.keys()].map((title) => new Option(title)));
    const first = [...sets.keys()].find((t) => t.endsWith("velocity")) ?? [...sets.keys()].find((t) => t.includes(":"));
    by("columns").value = sets.has(now) ? now : first ?? [...sets.keys()][0];
    const some = energies.filter(({ values }) => values.some((v) => v !== 0));
    this.energies.set(run.history[0] ?? [], some, "J");
    this.setColumns();
  }

  setColumns() {
    const set = this.sets.get(by("columns").value);
    if (set) this.columns.set(this.run.history[0], set.lines, set.unit);
    this.dirty = true;
  }

  // ---------------------------------------------------------------- drawing

  loop(now) {
    if (this.playing) {
      this.frame += ((now - this.seen) / 1000) * (this.last / PLAY_SECONDS);
      if (this.frame >= this.last) { this.frame = this.last; this.play(false); }
      this.dirty = true;
    }
    this.seen = now;
    if (this.dirty) {
      this.dirty = false;
      this.draw();
      document.body.dataset.ready = "1";
    }
    requestAnimationFrame((next) => this.loop(next));
  }

  draw() {
    const { run, picture } = this, time = run.times.length ? run.timeOf(this.frame) : 0;
    if (picture) {
      picture.draw(this.frame, matchMedia("(prefers-color-scheme: dark)").matches ? [0.1, 0.12, 0.15] : [1, 1, 1]);
      this.drawScale(by("hud"), devicePixelRatio || 1);
      by("slider").value = this.frame;
      by("now").textContent = `${time.toFixed(this.decimals)} s`;
      this.tellPicked();
    }
    this.columns.draw(time);
    this.energies.draw(time);
  }

  // Decimals that tell two frames apart.
  get decimals() {
    const { times } = this.run, step = (times.at(-1) - times[0]) / Math.max(1, times.length - 1);
    return step > 0 ? Math.min(9, Math.max(0, 1 - Math.floor(Math.log10(step)))) : 2;
  }

  // Axes at the top, a bar of round length at the bottom.
  drawScale(canvas, ratio) {
    const w = canvas.clientWidth, h = canvas.clientHeight, style = getComputedStyle(document.body);
    canvas.width = w * ratio;
    canvas.height = h * ratio;
    const x = canvas.getContext("2d");
    x.scale(ratio, ratio);
    x.font = `12px ${style.fontFamily}`;
    x.strokeStyle = x.fillStyle = style.color;
    x.lineWidth = 2;
    const metres = this.picture.metresPerPixel;
    const length = roundDown(Math.min(150, w / 3) * metres);
    const wide = length / metres;
    const inUnit = scaled(length, "m"), left = w - 22 - wide, low = h - 68;
    x.strokeRect(left, low, 0, 5);
    x.strokeRect(left + wide, low, 0, 5);
    x.strokeRect(left, low + 5, wide, 0);
    x.textAlign = "center";
    x.fillText(`${digits(length / inUnit.factor)} ${inUnit.unit}`, left + wide / 2, low - 3);
    const { right, up, eye } = this.picture.axes(), ox = w - 58, oy = 58;
    const arms = [["#cc3311", [1, 0, 0]], ["#228833", [0, 1, 0]], ["#0077bb", [0, 0, 1]]];
    arms.map(([color, way], k) => ({ color, name: "xyz"[k], x: dot(way, right), y: -dot(way, up), z: dot(way, eye) }))
      .sort((a, b) => a.z - b.z)
      .forEach((arm) => {
        x.strokeStyle = x.fillStyle = arm.color;
        x.beginPath();
        x.moveTo(ox, oy);
        x.lineTo(ox + 32 * arm.x, oy + 32 * arm.y);
        x.stroke();
        if (Math.hypot(arm.x, arm.y) > 0.2) x.fillText(arm.name, ox + 42 * arm.x, oy + 42 * arm.y + 4);
      });
  }

  // Picture, scale, legend and time as one PNG.
  save() {
    const gl = by("gl");
    const all = document.createElement("canvas");
    const x = all.getContext("2d");
    const ratio = devicePixelRatio || 1;
    this.draw();
    all.width = gl.width;
    all.height = gl.height;
    const style = getComputedStyle(document.body);
    x.fillStyle = style.backgroundColor;
    x.fillRect(0, 0, all.width, all.height);
    x.drawImage(gl, 0, 0);
    x.drawImage(by("hud"), 0, 0);
    x.scale(ratio, ratio);
    x.font = `600 14px ${style.fontFamily}`;
    x.fillStyle = style.color;
    x.fillText(`${by("legend-name").textContent}   t = ${by("now").textContent}`, 16, 28);
    this.saveLegend(x, style);
    const link = document.createElement("a");
    link.href = all.toDataURL("image/png");
    link.download = `${this.field.name}-${by("now").textContent.replace(" ", "")}.png`;
    link.click();
  }

  saveLegend(x, style) {
    x.font = `12px ${style.fontFamily}`;
    const { kind, top, unit, labels } = this.field, { factor } = scaled(top, unit);
    if (kind === "label") labels.slice(0, 12).forEach((name, k) => {
      x.fillStyle = GROUPS[k % GROUPS.length];
      x.fillRect(16, 38 + 18 * k, 11, 11);
      x.fillStyle = style.color;
      x.fillText(name, 34, 48 + 18 * k);
    });
    if (kind !== "amount") return;
    for (let k = 0; k < 236; k++) {
      const place = 3 * Math.round((k / 235) * 255);
      x.fillStyle = `rgb(${this.mapBytes.slice(place, place + 3).join(",")})`;
      x.fillRect(16 + k, 38, 1.5, 11);
    }
    x.fillStyle = style.color;
    x.textAlign = "center";
    for (const v of ticks(0, top / factor, 4)) x.fillText(digits(v), 16 + (236 * v * factor) / top, 64);
  }

  // ---------------------------------------------------------------- a run that goes on

  async follow() {
    for (let failed = 0; failed < LOST_AFTER; ) {
      await new Promise((done) => setTimeout(done, 1000 * LOOK_SECONDS));
      try {
        await this.look();
        failed = 0;
      } catch {
        failed++;
      }
    }
    by("status").textContent = "cdem view has ended";
    by("status").className = "badge doubt";
  }

  async look() {
    const { facts, framesKnown, rowsKnown } = this.run;
    const state = await (await this.source("state")).json();
    if (state.run !== facts.run) location.reload();
    else if (state.frames > framesKnown || state.rows !== rowsKnown || state.over !== facts.over) await this.grow();
  }

  async grow() {
    const { run } = this, atEnd = this.frame >= this.last, none = !run.times.length;
    const answer = await this.source(`data?frames=${run.framesKnown}&rows=${run.rowsKnown}`);
    run.append(await unpack(await answer.arrayBuffer()));
    if (none && run.times.length) { location.reload(); return; }
    this.showFacts();
    this.fillPlots();
    if (this.picture) {
      this.picture.setRun(run);
      this.setFields();
      by("slider").max = this.last;
      if (atEnd && !this.playing) this.seek(this.last);
    }
    this.dirty = true;
  }
}

async function main() {
  const run = new Run(), live = document.body.dataset.live;
  const source = async (path) => {
    const answer = await fetch(path, { cache: "no-store" });
    if (!answer.ok) throw new Error(await answer.text());
    return answer;
  };
  const text = by("data").textContent.trim();
  const bytes = live
    ? await (await source("data?frames=0&rows=0")).arrayBuffer()
    : Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  run.append(await unpack(bytes));
  const page = new Page(run, live ? source : null);
  if (live) await page.follow();
}

main().catch((error) => {
  const told = document.createElement("p");
  told.className = "missing";
  told.textContent = `This page cannot be shown: ${error.message}`;
  document.body.prepend(told);
});
