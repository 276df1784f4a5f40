// Histories over time: lines, round ticks, a cursor at the time of the picture; a click goes there.

class Plot {
  constructor(canvas, chips, seek) {
    this.canvas = canvas;
    this.chips = chips; // element that names the lines
    this.lines = [];
    this.unit = "";
    canvas.addEventListener("pointerdown", (event) => this.follow(event, seek));
    canvas.addEventListener("pointermove", (event) => event.buttons && this.follow(event, seek));
  }

  follow(event, seek) {
    const { left, width, start, end } = this.frame ?? {};
    if (width > 0) seek(start + (end - start) * Math.min(1, Math.max(0, (event.offsetX - left) / width)));
  }

  // Show columns: [{name, values}] in one unit, over times [s].
  set(times, lines, unit) {
    this.times = times;
    this.lines = lines;
    this.unit = unit;
    this.chips.replaceChildren(...(lines.length < 2 ? [] : lines.map(({ name }, k) => {
      const chip = document.createElement("span"), mark = document.createElement("i");
      mark.style.background = GROUPS[k % GROUPS.length];
      chip.append(mark, name);
      return chip;
    })));
  }

  draw(time) {
    const canvas = this.canvas;
    const ratio = devicePixelRatio || 1;
    const w = canvas.clientWidth;
    const h = canvas.clientHeight;
    if (!w || !this.lines.length || !this.times.length) return;
    canvas.width = w * ratio;
    canvas.height = h * ratio;
    const x = canvas.getContext("2d"), style = getComputedStyle(canvas);
    x.scale(ratio, ratio);
    x.font = `11px ${style.fontFamily}`;
    x.fillStyle = style.color;
    let low = Infinity, high = -Infinity;
    for (const { values } of this.lines)
      for (const v of values.filter(Number.isFinite)) {
        low = Math.min(low, v);
        high = Math.max(high, v);
      }
    if (!(high > low)) { low = Math.min(low, 0); high = Math.max(high, low + 1); }
    if (!Number.isFinite(low)) return;
    const { factor, unit } = scaled(Math.max(Math.abs(low), Math.abs(high)), this.unit);
    const marks = ticks(low / factor, high / factor, 4), texts = marks.map((v) => digits(v));
    const left = 10 + Math.max(...texts.map((t) => x.measureText(t).width));
    const top = 20;
    const bottom = 20;
    const right = 12;
    const start = this.times[0], end = Math.max(this.times.at(-1), start + 1e-12);
    const px = (t) => left + (w - left - right) * (t - start) / (end - start);
    const py = (v) => h - bottom - (h - bottom - top) * (v - low) / (high - low);
    this.frame = { left, width: w - left - right, start, end };
    x.textAlign = "right";
    marks.forEach((v, k) => {
      x.globalAlpha = 0.13;
      x.fillRect(left, Math.round(py(v * factor)), w - left - right, 1);
      x.globalAlpha = 0.8;
      x.fillText(texts[k], left - 5, py(v * factor) + 4);
    });
    x.textAlign = "left";
    x.fillText(unit && unit !== "1" ? `[${unit}]` : "", 2, 10);
    x.textAlign = "center";
    const wide = Math.max(2, Math.min(6, Math.floor((w - left) / 70)));
    for (const t of ticks(start, end, wide)) if (px(t) < w - right - 14) x.fillText(digits(t), px(t), h - 5);
    x.textAlign = "right";
    x.fillText("s", w - 2, h - 5);
    x.globalAlpha = 1;
    this.lines.forEach(({ values }, k) => {
      x.strokeStyle = GROUPS[k % GROUPS.length];
      x.lineWidth = 1.7;
      x.lineJoin = "round";
      x.beginPath();
      values.forEach((v, i) => Number.isFinite(v) && x.lineTo(px(this.times[i]), py(v)));
      x.stroke();
    });
    x.globalAlpha = 0.75;
    x.fillRect(px(Math.min(end, Math.max(start, time))) - 0.75, top - 4, 1.5, h - bottom - top + 4);
  }
}
