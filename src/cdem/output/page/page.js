// The page: what its controls do, and how it follows a run that goes on.
// Texts of a case are put in as text only, never as HTML.

const by = (id) => document.getElementById(id);
const DARK = matchMedia("(prefers-color-scheme: dark)");
const LOOK_SECONDS = 2; // between two looks for new frames
const AXES = { light: ["#cc3311", "#228833", "#0077bb"], dark: ["#ff8468", "#5cc46e", "#62b4ff"] };
const LOST_AFTER = 3; // looks that get no answer
const PLAY_SECONDS = 8; // that all frames take
const LOG_RANGE = 1000; // highest over lowest value of an automatic logarithmic scale

class Page {
  constructor(run, source) {
    this.run = run;
    this.source = source; // where packs come from, or null for a page that is whole
    this.frame = 0;
    this.playing = false;
    this.dirty = true;
    this.mapBytes = bytesOfMap("viridis");
    this.ranges = new Map(); // that were typed, by name of the field
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
    if (head.length) {
      table.className = "columns";
      table.style.setProperty("--columns", head.length - 1);
      table.append(line(head, "th"));
    }
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
    by("now").addEventListener("focus", () => by("now").select());
    by("now").addEventListener("change", () => {
      const time = typed(by("now").value.replace(/s\s*$/, ""));
      by("now").blur();
      this.play(false);
      this.seek(Number.isFinite(time) ? this.run.nearest(time) : this.frame);
    });
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
    for (const id of ["low", "high", "logarithmic"]) by(id).addEventListener("change", () => this.readRange());
    by("automatic").addEventListener("click", () => {
      by("low").value = by("high").value = "";
      this.readRange();
    });
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
    const amount = this.field.kind === "amount";
    by("map").disabled = !amount;
    by("range-row").hidden = by("least-row").hidden = !amount;
    this.showRange();
    this.setLegend();
    this.setLeast();
  }

  // The ends of the colours for what was typed: what is missing is automatic.
  ends({ low, high, logarithmic }) {
    const last = high ?? this.field.top;
    return [low ?? (logarithmic ? last / LOG_RANGE : 0), last];
  }

  // Take over what was typed, unless no colours could lie between it.
  readRange() {
    const { factor } = scaled(this.field.top, this.field.unit), range = { logarithmic: by("logarithmic").checked };
    for (const id of ["low", "high"]) if (by(id).value.trim()) range[id] = typed(by(id).value) * factor;
    if (range.logarithmic && range.low <= 0) {
      delete range.low;
      by("low").value = "";
    }
    const [low, high] = this.ends(range), good = low < high && high - low < Infinity;
    for (const id of ["low", "high"]) by(id).ariaInvalid = String(!good);
    if (!good) return;
    this.ranges.set(this.field.name, range);
    this.showRange();
    this.setLegend();
  }

  showRange() {
    const { top, unit } = this.field, inUnit = scaled(top, unit), { look } = this.picture;
    const range = this.ranges.get(this.field.name) ?? {};
    look.span = this.ends(range);
    look.logarithmic = by("logarithmic").checked = Boolean(range.logarithmic);
    ["low", "high"].forEach((id, k) => {
      if (document.activeElement !== by(id)) by(id).value = id in range ? String(Number((range[id] / inUnit.factor).toPrecision(9))) : "";
      by(id).placeholder = digits(look.span[k] / inUnit.factor, 3);
      by(id).ariaInvalid = "false";
      by(id).title = unit === "1" ? "" : `in ${inUnit.unit}`;
    });
    by("automatic").disabled = !("low" in range || "high" in range);
    this.dirty = true;
  }

  // Numbers along the bar of colours, and how far each lies along it.
  marks() {
    const { logarithmic, span } = this.picture.look, { factor } = scaled(this.field.top, this.field.unit);
    const [low, high] = span.map((value) => value / factor);
    const values = logarithmic ? logTicks(low, high) : ticks(low, high, 4);
    const part = (v) => (logarithmic ? Math.log(v / low) / Math.log(high / low) : (v - low) / (high - low));
    const every = Math.ceil(values.length / 7);
    return values.filter((_, k) => k % every === 0).map((v) => ({ text: digits(v), part: part(v) }));
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
    if (shown) shown.textContent = ` [${inUnit.unit}]${this.picture.look.logarithmic ? ", log" : ""}`;
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
      by("ticks").replaceChildren(...this.marks().map(({ text, part }) => {
        const tick = mark(text, "");
        tick.style.left = `${100 * part}%`;
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
    for (const [id, what] of [["lines", "lines"], ["fixed-lines", "fixedLines"], ["start", "start"]])
      by(id).addEventListener("change", () => { look[what] = by(id).checked; this.dirty = true; });
    by("fixed-row").hidden = !this.run.facts.fixed.length;
    for (const id of ["section", "section-place"]) by(id).addEventListener("input", () => this.setSection());
    const views = { top: [-Math.PI / 2, Math.PI / 2], x: [-Math.PI, 0], y: [-Math.PI / 2, 0] };
    for (const button of document.querySelectorAll("[data-view]"))
      button.addEventListener("click", () => {
        const view = views[button.dataset.view];
        if (view) { [camera.azimuth, camera.height] = view; this.fit(); } else this.turnToMotion();
      });
    by("save").addEventListener("click", () => this.save());
    addEventListener("resize", () => (this.dirty = true));
    DARK.addEventListener("change", () => (this.dirty = true));
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
      const amount = (value / 255) ** 2 * (frame.high[name] ?? 1), inUnit = scaled(top, unit);
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
      picture.draw(this.frame, DARK.matches ? [0.1, 0.12, 0.15] : [1, 1, 1]);
      this.drawScale(by("hud"), devicePixelRatio || 1);
      by("slider").value = this.frame;
      if (document.activeElement !== by("now")) by("now").value = time.toFixed(this.decimals);
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

  // Directions at the top, a bar of round length at the bottom.
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
    const { right, up, eye } = this.picture.axes();
    const flat = (way) => ({ x: dot(way, right), y: -dot(way, up), z: dot(way, eye) });
    x.translate(w - 58, 58);
    if (this.run.facts.north) this.drawNorth(x, flat);
    else this.drawAxes(x, flat);
  }

  drawAxes(x, flat) {
    [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
      .map((way, k) => ({ color: AXES[DARK.matches ? "dark" : "light"][k], name: "xyz"[k], ...flat(way) }))
      .sort((a, b) => a.z - b.z)
      .forEach((arm) => {
        x.strokeStyle = x.fillStyle = arm.color;
        x.beginPath();
        x.moveTo(0, 0);
        x.lineTo(32 * arm.x, 32 * arm.y);
        x.stroke();
        if (Math.hypot(arm.x, arm.y) > 0.2) x.fillText(arm.name, 42 * arm.x, 42 * arm.y + 4);
      });
  }

  // A needle to the north in a level ring.
  drawNorth(x, flat) {
    const path = (points) => {
      x.beginPath();
      for (const point of points) { const { x: right, y: down } = flat(point); x.lineTo(30 * right, 30 * down); }
      x.closePath();
      x.stroke();
    };
    x.lineWidth = 1;
    path(Array.from({ length: 48 }, (_, k) => [Math.sin((k * Math.PI) / 24), Math.cos((k * Math.PI) / 24), 0]));
    path([[0, -0.8, 0], [0.24, 0, 0], [-0.24, 0, 0]]);
    path([[0, 0.8, 0], [0.24, 0, 0], [-0.24, 0, 0]]);
    x.fill();
    const tip = flat([0, 1, 0]);
    x.font = `600 13px ${getComputedStyle(document.body).fontFamily}`;
    x.fillText("N", 40 * tip.x, 40 * tip.y + 5);
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
    x.fillText(`${by("legend-name").textContent}   t = ${by("now").value} s`, 16, 28);
    this.saveLegend(x, style);
    const link = document.createElement("a");
    link.href = all.toDataURL("image/png");
    link.download = `${this.field.name}-${by("now").value}s.png`;
    link.click();
  }

  saveLegend(x, style) {
    x.font = `12px ${style.fontFamily}`;
    const { kind, labels } = this.field;
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
    for (const { text, part } of this.marks()) x.fillText(text, 16 + 236 * part, 64);
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
  by("loading")?.remove();
  told.className = "missing";
  told.textContent = `This page cannot be shown: ${error.message}`;
  document.body.prepend(told);
});
