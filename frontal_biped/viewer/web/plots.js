// Plots that follow the animation. Drag in one, and the robot follows the plot.

const LEAST_SHADE = 3; // [px] of a phase whose background is told
const CROWDED = 4; // samples to a column of pixels from which on a curve is drawn column by column
const MARGIN = { left: 52, right: 10, top: 6, bottom: 32 };
const GLYPHS = [
  (x, y) => `M${x - 3.4},${y}a3.4,3.4 0 1,0 6.8,0a3.4,3.4 0 1,0 -6.8,0Z`,
  (x, y) => `M${x - 3},${y - 3}h6v6h-6Z`,
  (x, y) => `M${x},${y - 4}l4,7h-8Z`,
  (x, y) => `M${x},${y - 4.4}l4,4.4l-4,4.4l-4,-4.4Z`,
];

const number = (value) => value.toFixed(1).replace(/\.0$/, "");
// A number with a true minus sign, and none before zero.
const told = (value, digits) => value.toFixed(digits).replace(/^-(0\.?0*)$/, "$1").replace("-", "−");
const clean = (text) => text.replaceAll("&", "&amp;").replaceAll("<", "&lt;");

// Round numbers that cover [low, high], about `count` of them.
function ticks(low, high, count) {
  const raw = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((k) => k * power).find((k) => k >= raw * 0.999);
  const every = (each) => {
    const found = [];
    for (let k = Math.ceil(low / each - 1e-9); k * each <= high + 1e-9 * each; k++) found.push(k * each);
    return found;
  };
  const fewer = Math.round(step / power) === 5 ? step / 2.5 : step / 2; // one number alone would tell no scale
  const chosen = every(step).length > 1 ? step : fewer, found = every(chosen);
  const digits = Math.max(0, -Math.floor(Math.log10(chosen) + 1e-9));
  return { at: found, text: (value) => told(value, digits) };
}

// Where most of the values are: between the quantiles of 2 and 98 %, and a third of that beyond either, but no further
// than the values go.
function bulk(values) {
  if (!values.length) return [Infinity, -Infinity];
  const sorted = Float64Array.from(values).sort(), last = sorted.length - 1;
  const [least, most] = [0.02, 0.98].map((share) => sorted[Math.round(share * last)]), beyond = (most - least) / 3;
  return [Math.max(sorted[0], least - beyond), Math.min(sorted[last], most + beyond)];
}

function unpack(samples) {
  const channels = {};
  for (const [name, text] of Object.entries(samples.channels)) {
    channels[name] = new Float32Array(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
  }
  return { count: samples.count, breaks: new Set(samples.breaks), ...channels };
}

// Index of the last sample at or before a time.
function indexAt(t, time) {
  let low = 0, high = t.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (t[middle] <= time + 1e-7) low = middle; else high = middle - 1;
  }
  return low;
}

// A channel at a time, linear between samples; an event has two samples, and the later one counts.
function valueAt(data, name, time) {
  const i = indexAt(data.t, time), j = Math.min(i + 1, data.count - 1);
  const width = data.t[j] - data.t[i];
  const weight = width > 1e-7 ? Math.min(Math.max((time - data.t[i]) / width, 0), 1) : 0;
  return data[name][i] * (1 - weight) + data[name][j] * weight;
}

class Plot {
  constructor(host, about, runs, first, hooks) {
    Object.assign(this, { about, runs, hooks });
    this.box = document.createElement("figure");
    this.box.className = "plot";
    this.box.innerHTML = '<header><select aria-label="What the plot shows"></select></header><div class="field"></div>';
    this.header = this.box.querySelector("header");
    this.choice = this.box.querySelector("select");
    this.field = this.box.querySelector(".field");
    about.panels.forEach((panel, k) => this.choice.add(new Option(panel.title, k)));
    this.choice.value = String(first);
    this.choice.addEventListener("change", () => this.draw());
    this.field.addEventListener("pointerdown", (event) => {
      this.field.setPointerCapture(event.pointerId);
      this.hooks.seek(this.timeUnder(event));
    });
    this.field.addEventListener("pointermove", (event) => {
      if (this.field.hasPointerCapture(event.pointerId)) this.hooks.seek(this.timeUnder(event));
    });
    host.append(this.box);
    new ResizeObserver(() => this.draw()).observe(this.field);
  }

  get panel() { return this.about.panels[Number(this.choice.value)]; }
  get overTime() { return this.panel.x === "t"; }

  // ------------------------------------------------------------------ drawing
  draw() {
    const panel = this.panel, width = this.field.clientWidth, height = this.field.clientHeight;
    if (!width || !height) return;
    this.span = this.hooks.window();
    this.field.classList.toggle("plane", !this.overTime);
    this.range(width, height);
    const { x, y } = this;
    const inner = { w: width - MARGIN.left - MARGIN.right, h: height - MARGIN.top - MARGIN.bottom };
    const bottom = MARGIN.top + inner.h, clip = "clip-" + Math.random().toString(36).slice(2);
    const parts = [`<clipPath id="${clip}"><rect x="${MARGIN.left}" y="${MARGIN.top - 4}" width="${inner.w}" height="${inner.h + 8}"/></clipPath>`];
    parts.push(this.shades(MARGIN.top, inner.h, clip));
    const across = ticks(this.low.x, this.high.x, Math.max(2, inner.w / 70)), up = ticks(this.low.y, this.high.y, Math.max(2, inner.h / 34));
    for (const value of across.at) {
      const anchor = x(value) > width - 16 ? "end" : "middle";
      parts.push(`<line class="grid" x1="${x(value)}" x2="${x(value)}" y1="${MARGIN.top}" y2="${bottom}"/>`);
      parts.push(`<text x="${x(value)}" y="${bottom + 13}" text-anchor="${anchor}">${across.text(value)}</text>`);
    }
    for (const value of up.at) {
      parts.push(`<line class="grid" x1="${MARGIN.left}" x2="${MARGIN.left + inner.w}" y1="${y(value)}" y2="${y(value)}"/>`);
      parts.push(`<text x="${MARGIN.left - 5}" y="${y(value) + 4}" text-anchor="end">${up.text(value)}</text>`);
    }
    parts.push(`<g clip-path="url(#${clip})">${this.limits(inner.w)}${this.closedForm()}${this.curves()}</g>${this.limitNames(inner.w)}`);
    parts.push(`<path class="axis" d="M${MARGIN.left},${MARGIN.top}V${bottom}H${MARGIN.left + inner.w}"/>`);
    parts.push(`<text class="xlabel" x="${MARGIN.left + inner.w / 2}" y="${height - 4}" text-anchor="middle">${clean(panel.xlabel)}</text>`);
    parts.push(`<text class="ylabel" transform="translate(11,${MARGIN.top + inner.h / 2}) rotate(-90)" text-anchor="middle">${clean(panel.ylabel)}</text>`);
    this.field.innerHTML = `<svg role="img" aria-label="${clean(panel.title)}">${parts.join("")}</svg>`;
    this.pointers = this.runs.map((_, k) => {
      if (this.overTime && k > 0) return null; // the runs share one time
      const pointer = document.createElement("div");
      pointer.className = (this.overTime ? "cursor" : "dot") + (k ? " second" : "");
      if (this.overTime) Object.assign(pointer.style, { top: MARGIN.top + "px", height: inner.h + "px" });
      this.field.append(pointer);
      return pointer;
    });
    this.legend();
    this.follow(this.hooks.time(), true);
  }

  range(width, height) {
    const panel = this.panel, low = { x: Infinity, y: Infinity }, high = { x: -Infinity, y: -Infinity };
    for (const run of this.runs) {
      for (const line of panel.lines) {
        for (const name of [line.y, line.wanted].filter(Boolean)) {
          for (let i = 0; i < run.data.count; i++) {
            if (run.data.t[i] < this.span[0] - 1e-6 || run.data.t[i] > this.span[1] + 1e-6) continue;
            low.y = Math.min(low.y, run.data[name][i]);
            high.y = Math.max(high.y, run.data[name][i]);
            low.x = Math.min(low.x, run.data[panel.x][i]);
            high.x = Math.max(high.x, run.data[panel.x][i]);
          }
        }
      }
    }
    if (!this.overTime) this.withoutSpikes(low, high);
    for (const axis of ["x", "y"]) {
      for (const value of (this.reference || { [axis]: [] })[axis]) {
        if (value === null) continue;
        low[axis] = Math.min(low[axis], value);
        high[axis] = Math.max(high[axis], value);
      }
    }
    if (!(high.y >= low.y)) Object.assign(low, { x: 0, y: 0 }), Object.assign(high, { x: 1, y: 1 });
    this.nearTheory(low, high);
    this.clipped = this.overTime ? 0 : this.shareOutside(low, high);
    const room = high.y - low.y;
    this.distant = []; // limits too far away to be worth the room
    for (const limit of this.runs[0].limits[panel.key] || []) {
      const missing = Math.max(limit.value - high.y, low.y - limit.value);
      if (missing > 0.8 * room && !panel.band) { this.distant.push(limit); continue; }
      low.y = Math.min(low.y, limit.value);
      high.y = Math.max(high.y, limit.value);
    }
    const flat = 1e-6 * Math.max(1, Math.abs(high.y)); // a constant gets an axis too
    if (high.y - low.y < flat) { low.y -= 0.5; high.y += 0.5; }
    const margin = 0.05 * (high.y - low.y);
    low.y -= margin;
    high.y += margin;
    if (this.overTime) [low.x, high.x] = this.span;
    else {
      const side = 0.05 * (high.x - low.x || 1);
      low.x -= side;
      high.x += side;
    }
    const across = (width - MARGIN.left - MARGIN.right) / (high.x - low.x || 1);
    const up = (height - MARGIN.top - MARGIN.bottom) / (high.y - low.y);
    this.x = (value) => Math.round(10 * (MARGIN.left + (value - low.x) * across)) / 10;
    this.y = (value) => Math.round(10 * (height - MARGIN.bottom - (value - low.y) * up)) / 10;
    Object.assign(this, { low, high, scale: { x: across, y: up } });
  }

  // The samples of the plane that are shown: of every run its x and y, within the time shown.
  planeSamples() {
    const name = this.panel.lines[0].y, found = { x: [], y: [] };
    for (const { data } of this.runs) {
      for (let i = 0; i < data.count; i++) {
        if (data.t[i] < this.span[0] - 1e-6 || data.t[i] > this.span[1] + 1e-6) continue;
        found.x.push(data[this.panel.x][i]);
        found.y.push(data[name][i]);
      }
    }
    return found;
  }

  // A foot that lands makes the state jump for some milliseconds; an axis that held these spikes would show little else.
  withoutSpikes(low, high) {
    for (const [axis, values] of Object.entries(this.planeSamples())) [low[axis], high[axis]] = bulk(values);
  }

  shareOutside(low, high) {
    const { x, y } = this.planeSamples(), slack = 1e-6;
    const out = x.filter((value, i) => value < low.x - slack || value > high.x + slack || y[i] < low.y - slack || y[i] > high.y + slack);
    return out.length / (x.length || 1);
  }

  // Of a robot that falls the plane shows what is near the closed form: elsewhere there is nothing to compare.
  nearTheory(low, high) {
    if (!this.reference || this.overTime) return;
    for (const axis of ["x", "y"]) {
      const values = this.reference[axis].filter((value) => value !== null), [least, most] = [Math.min(...values), Math.max(...values)], beyond = 0.4 * (most - least);
      low[axis] = Math.max(low[axis], least - beyond);
      high[axis] = Math.min(high[axis], most + beyond);
    }
  }

  // Rising phases shaded, impacts ruled, pushes coloured: of the first run.
  shades(top, height, clip) {
    if (!this.overTime) return "";
    const run = this.runs[0], parts = [], [from, to] = this.span;
    // of many steps in one picture a shade would be thinner than a line
    const inside = run.phases.filter((phase) => phase.start >= from && phase.start <= to).length;
    const clear = inside * LEAST_SHADE < this.x(to) - this.x(from);
    run.phases.forEach((phase, k) => {
      const end = k + 1 < run.phases.length ? run.phases[k + 1].start : run.duration;
      if (!clear || end < from || phase.start > to) return;
      const left = this.x(phase.start), wide = this.x(end) - left;
      if (phase.phase === "rising") parts.push(`<rect class="rise" x="${left}" width="${number(wide)}" y="${top}" height="${height}"/>`);
    });
    for (const push of run.pushes) {
      const wide = Math.max(2, this.x(push.start + push.duration) - this.x(push.start));
      parts.push(`<rect class="pushed" x="${this.x(push.start)}" width="${wide}" y="${top}" height="${height}"/>`);
    }
    for (const event of run.events.filter((one) => clear && one.kind === "impact" && one.t > 0 && one.t >= from && one.t <= to)) {
      parts.push(`<line class="impact" x1="${this.x(event.t)}" x2="${this.x(event.t)}" y1="${top}" y2="${top + height}"/>`);
    }
    return `<g clip-path="url(#${clip})">${parts.join("")}</g>`;
  }

  limits(width) {
    const near = (this.runs[0].limits[this.panel.key] || []).filter((limit) => !this.distant.includes(limit));
    const lines = near.map((limit) => `<line class="limit" x1="${MARGIN.left}" x2="${MARGIN.left + width}" y1="${this.y(limit.value)}" y2="${this.y(limit.value)}"/>`);
    if (this.panel.band && near.length === 2) {
      const [top, bottom] = near.map((limit) => this.y(limit.value)).sort((a, b) => a - b);
      lines.unshift(`<rect class="band" x="${MARGIN.left}" width="${width}" y="${top}" height="${number(bottom - top)}"/>`);
    }
    return lines.join("");
  }

  // Names and values of the limits in the picture, on their lines; drawn over the curves, with a rim to be read on them.
  limitNames(width) {
    const near = (this.runs[0].limits[this.panel.key] || []).filter((limit) => !this.distant.includes(limit) && limit.value !== 0);
    return near.map((limit) => {
      const y = this.y(limit.value), below = y < MARGIN.top + 14;
      return `<text class="told" x="${MARGIN.left + width - 3}" y="${y + (below ? 11 : -3)}" text-anchor="end">${clean(limit.name)} ${told(limit.value, 0)}</text>`;
    }).join("");
  }

  // What theory says the curve should be, below it.
  get reference() { return (this.runs[0].reference || {})[this.panel.key]; }

  closedForm() {
    if (!this.reference) return "";
    const { x, y } = this.reference;
    const d = x.map((value, i) => (value === null ? "" : (i && x[i - 1] !== null ? "L" : "M") + this.x(value) + "," + this.y(y[i]))).join("");
    return `<path class="curve closed" d="${d}"/>`;
  }

  curves() {
    const parts = [];
    this.runs.forEach((run, k) => {
      this.panel.lines.forEach((line, i) => {
        if (line.wanted && !k) parts.push(`<path class="curve wanted c${i}" d="${this.path(run.data, line.wanted)}"/>`);
        if (this.overTime) parts.push(`<path class="curve c${i}${k ? " second" : ""}" d="${this.path(run.data, line.y)}"/>`);
        else parts.push(...this.phasePaths(run, line.y, k));
        if (!k && this.panel.lines.length > 1) parts.push(this.glyphs(run.data, line.y, i));
      });
    });
    return parts.join("");
  }

  // No line bridges an event; points that would fall on the one before are left out. `wants` chooses phases.
  path(data, name, wants = () => true) {
    const inside = indexAt(data.t, this.span[1]) - indexAt(data.t, this.span[0]);
    if (this.overTime && inside > CROWDED * (this.x(this.span[1]) - this.x(this.span[0]))) return this.columns(data, name);
    const pieces = [], drawn = new Set();
    let px = NaN, py = NaN, phase = -1, fresh = true;
    for (let i = 0; i < data.count; i++) {
      const begins = data.breaks.has(i);
      if (begins) phase++;
      if (data.t[i] < this.span[0] - 0.1 || data.t[i] > this.span[1] + 0.1 || !wants(phase)) { fresh = true; continue; }
      const x = this.x(data[this.panel.x][i]), y = this.y(data[name][i]);
      const start = fresh || begins, end = i + 1 === data.count || data.breaks.has(i + 1);
      if (!start && !end && Math.abs(x - px) < 0.7 && Math.abs(y - py) < 0.7) continue;
      // a walk goes over the same lines of the plane again and again
      const line = start ? "" : [px, py, x, y].map(Math.round).join(" ");
      if (!start && !this.overTime && drawn.has(line)) pieces.push("M" + x + "," + y);
      else pieces.push((start ? "M" : "L") + x + "," + y);
      drawn.add(line);
      [px, py, fresh] = [x, y, false];
    }
    return pieces.join("").replace(/(M[^ML]*)+(?=M)/g, "");
  }

  // Of more samples than the picture has columns: in each what comes first, the extremes, what comes last.
  columns(data, name) {
    const pieces = [], last = indexAt(data.t, this.span[1]);
    let column = NaN, own = [];
    const put = () => own.length && pieces.push(...[own[0], Math.min(...own), Math.max(...own), own.at(-1)].map((y) => column + "," + y));
    for (let i = indexAt(data.t, this.span[0]); i <= last; i++) {
      const x = Math.round(this.x(data[this.panel.x][i]));
      if (x !== column) { put(); [column, own] = [x, []]; }
      own.push(this.y(data[name][i]));
    }
    put();
    return "M" + pieces.join("L");
  }

  // In the plane: rising phases drawn through, falling ones dashed.
  phasePaths(run, name, k) {
    return ["rising", "falling"].map((kind) => {
      const d = this.path(run.data, name, (phase) => run.phases[phase].phase === kind);
      return `<path class="curve c0 ${k ? "second" : kind}" d="${d}"/>`;
    });
  }

  // A sign of its own on every line: told apart without colour.
  glyphs(data, name, i) {
    const signs = [], every = 84 / this.scale.x, count = this.panel.lines.length;
    for (let time = this.span[0] + (every * (i + 0.5)) / count; this.overTime && time < Math.min(this.span[1], data.t[data.count - 1]); time += every) {
      signs.push(GLYPHS[i % 4](this.x(time), this.y(valueAt(data, name, time))));
    }
    return `<path class="glyph c${i}" d="${signs.join("")}"/>`;
  }

  legend() {
    for (const old of [...this.header.children].slice(1)) old.remove();
    const notes = [];
    if (this.panel.lines.some((line) => line.wanted)) notes.push("dashed desired");
    if (this.runs.length > 1) notes.push("dotted " + this.hooks.second);
    if (!this.overTime) notes.push("dashed falling");
    if (this.reference) notes.push("wide closed form");
    if (this.clipped) notes.push(`clipped: ${told(Math.max(0.1, 100 * this.clipped), 1)} % of the run, after contacts, lie outside`);
    const near = (this.runs[0].limits[this.panel.key] || []).filter((limit) => !this.distant.includes(limit)).map((limit) => limit.name);
    const distant = [...new Set(this.distant.map((limit) => limit.name))].filter((name) => !near.includes(name)).map((name) => {
      const values = this.distant.filter((limit) => limit.name === name).map((limit) => Math.abs(limit.value));
      return name + " " + (values.length > 1 ? "±" : "") + number(values[0]);
    });
    const unit = (this.panel.ylabel.match(/\[(.*)\]/) || ["", ""])[1].replaceAll(" ", "\u00a0");
    if (distant.length) notes.push(distant.join(", ") + "\u00a0" + unit);
    const note = document.createElement("span");
    note.className = "note";
    note.textContent = notes.join(", ");
    const keys = document.createElement("div");
    keys.className = "keys";
    this.header.append(note, keys);
    this.outputs = this.panel.lines.map((line, i) => {
      const key = document.createElement("span");
      key.className = "key";
      const sign = this.panel.lines.length > 1 ? `<path class="glyph c${i}" d="${GLYPHS[i % 4](10, 5)}"/>` : "";
      key.innerHTML = `<svg><path class="curve c${i}" d="M0,5H20"/>${sign}</svg>${clean(line.name)} <output></output>`;
      keys.append(key);
      return [key.querySelector("output"), line.y];
    });
  }

  // ------------------------------------------------------------------ following
  follow(time, say) {
    if (!this.pointers) return;
    const shown = this.hooks.window();
    if (shown[0] !== this.span[0] || shown[1] !== this.span[1]) { this.draw(); return; }
    this.pointers.forEach((pointer, k) => {
      if (!pointer) return;
      const data = this.runs[k].data, own = Math.min(time, data.t[data.count - 1]);
      if (this.overTime) pointer.style.transform = `translateX(${this.x(time) - 1}px)`;
      else {
        const { clientWidth, clientHeight } = this.field;
        const x = Math.min(Math.max(this.x(valueAt(data, this.panel.x, own)), MARGIN.left), clientWidth - MARGIN.right);
        const y = Math.min(Math.max(this.y(valueAt(data, this.panel.lines[0].y, own)), MARGIN.top), clientHeight - MARGIN.bottom);
        pointer.style.transform = `translate(${x}px,${y}px)`;
      }
    });
    if (!say) return;
    const data = this.runs[0].data, digits = this.panel.digits ?? (this.panel.ylabel.includes("rad") && !this.panel.ylabel.includes("m") ? 3 : 1);
    for (const [output, name] of this.outputs) output.textContent = told(valueAt(data, name, Math.min(time, data.t[data.count - 1])), digits);
  }

  // The time under a pointer: straight from a time axis; in the plane, of the nearest sample, rather one nearby in time.
  timeUnder(event) {
    const box = this.field.getBoundingClientRect(), px = event.clientX - box.left, py = event.clientY - box.top;
    if (this.overTime) return Math.min(Math.max(this.low.x + (px - MARGIN.left) / this.scale.x, 0), this.about.duration);
    const data = this.runs[0].data, name = this.panel.lines[0].y, now = this.hooks.time();
    let best = 0, least = Infinity;
    for (let i = 0; i < data.count; i++) {
      if (data.t[i] < this.span[0] || data.t[i] > this.span[1]) continue;
      const far = Math.hypot(this.x(data[this.panel.x][i]) - px, this.y(data[name][i]) - py) + 8 * Math.abs(data.t[i] - now);
      if (far < least) [best, least] = [i, far];
    }
    return data.t[best];
  }
}
