const MOST_MARKS = 240; // on a strip; of a longer run only every tenth, twentieth ... impact has one, and phases are not told

// The strip under the slider: phases, reversals, impacts and pushes of each run; a click on a mark goes there.
function drawStrips(host, about, seek) {
  const share = (time) => (100 * Math.min(Math.max(time, 0), about.duration)) / (about.duration || 1) + "%";

  const place = (strip, kind, start, end, text) => {
    const part = document.createElement("i");
    part.className = kind;
    part.style.left = share(start);
    if (end !== null) part.style.width = "calc(" + share(end) + " - " + share(start) + ")";
    part.title = text;
    strip.append(part);
    return part;
  };

  const mark = (strip, event, text = event.kind) => {
    const button = document.createElement("button");
    button.type = "button";
    button.tabIndex = -1; // shift and the arrow keys go from event to event
    button.className = "mark " + event.kind;
    button.style.left = share(event.t);
    button.title = text + " at " + event.t.toFixed(3) + " s";
    button.setAttribute("aria-label", button.title);
    button.addEventListener("click", () => seek(event.t));
    strip.append(button);
  };

  about.runs.forEach((run, index) => {
    const strip = document.createElement("div");
    strip.className = "strip" + (run.events.length > 60 ? " dense" : "");
    if (about.runs.length > 1) {
      const name = document.createElement("b");
      name.textContent = "AB"[index];
      strip.append(name);
    }
    const many = run.events.length > MOST_MARKS;
    if (!many) run.phases.forEach((phase, k) => {
      const end = k + 1 < run.phases.length ? run.phases[k + 1].start : run.duration;
      place(strip, "part " + phase.phase, phase.start, end, "step " + phase.step + ", " + phase.phase);
    });
    for (const push of run.pushes) {
      if (push.text) { place(strip, "push", push.start, push.start + push.duration, push.text); continue; }
      const side = push.impulse > 0 ? "to the robot's left" : "to the robot's right";
      place(strip, "push", push.start, push.start + push.duration, "push of " + Math.abs(push.impulse) + " N s " + side);
    }
    const impacts = run.events.filter((event) => event.kind === "impact");
    const every = [10, 20, 50, 100, 200, 500, 1000, 2000].find((k) => impacts.length / k <= MOST_MARKS / 4) ?? 5000;
    if (many) impacts.forEach((event, k) => k % every || mark(strip, event, k ? "impact after " + k + " steps" : event.kind));
    else run.events.forEach((event) => mark(strip, event));
    if (run.outcome !== "completed") place(strip, "fall", run.duration, null, run.outcome).textContent = "✕";
    host.append(strip);
  });
}

// Where a run is at a time: its phase, the event it is just passing, and whether it is over.
function stateAt(run, time) {
  const near = 0.025; // [s] an event is shown that long before and after
  const phase = run.phases.reduce((found, next) => (next.start <= time + 1e-9 ? next : found), run.phases[0]);
  const event = run.events.find((one) => Math.abs(one.t - time) < near);
  const over = run.outcome !== "completed" && time >= run.duration - 1e-9;
  return { phase, lit: event ? event.kind : phase.phase, over };
}

// The line of a run in the picture: step, foot, and which of rising, reversal, falling and impact it is in.
// `readout` says what else stands there as a number.
function drawCaption(host, run, name) {
  const box = document.createElement("div");
  box.className = "run";
  const where = document.createElement("p"), source = document.createElement("p");
  source.className = "source";
  source.textContent = run.source || "";
  const cycle = document.createElement("ul");
  cycle.className = "cycle";
  for (const word of ["rising", "reversal", "falling", "impact"]) {
    const item = document.createElement("li");
    item.className = word;
    item.textContent = word;
    cycle.append(item);
  }
  box.append(where, cycle, source);
  host.append(box);
  let shown = "";
  const of = run.outcome === "completed" ? " of " + run.steps : ""; // of a walk that fell there is no last one
  return (time) => {
    const { phase, lit, over } = stateAt(run, time);
    const numbers = (run.readout || []).map((one) => `${one.name} ${told(valueAt(run.data, one.y, time), one.digits)} ${one.unit}`);
    const text = name + (over ? `fell after ${run.steps} ${run.steps === 1 ? "step" : "steps"}: ${run.outcome}` : ["step " + phase.step + of, phase.stance + " foot stands", ...numbers].join(", "));
    if (shown === text + lit) return;
    shown = text + lit;
    where.textContent = text;
    where.className = over ? "fell" : "";
    for (const item of cycle.children) item.classList.toggle("on", !over && item.className.split(" ")[0] === lit);
  };
}
