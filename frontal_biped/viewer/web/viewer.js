// The page around MeshCat's viewer. Reads `commands` (the scene), `about` (see page_data.py) and `live`.
(() => {
  const at = (id) => document.getElementById(id);
  let viewer;
  try {
    viewer = new MeshCat.Viewer(at("scene"));
  } catch (error) {
    at("trouble").hidden = false;
    at("trouble").textContent = "This browser cannot draw in 3D (WebGL is missing or switched off).";
    return;
  }
  window.viewer = viewer;
  const runs = about.runs || [], node = (...path) => viewer.scene_tree.find(path).object;
  const animator = () => viewer.animator;
  const duration = () => animator().duration || about.duration || 0;
  const now = () => Math.min(animator().time, duration());
  const exists = (...path) => {
    let place = viewer.scene_tree;
    for (const name of path) {
      if (!(name in place.children)) return false;
      place = place.children[name];
    }
    return true;
  };

  // ------------------------------------------------------------------ scene
  const panel = viewer.gui.domElement;
  panel.style.display = "none";
  at("tree").addEventListener("click", () => {
    const shown = panel.style.display === "none";
    panel.style.display = shown ? "" : "none";
    at("tree").setAttribute("aria-pressed", String(shown));
    if (shown) viewer.gui.open();
  });

  for (const text of commands) {
    viewer.handle_command_bytearray(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)));
  }
  if (live) viewer.connect("ws://" + location.host + location.pathname);

  // The camera goes along with a robot that goes somewhere, and so does the light.
  const leader = about.follow && runs[0].motion ? unpack(runs[0].motion) : null;
  const way = (time) => (leader && following() ? ["way_x", "way_y"].map((name) => valueAt(leader, name, time)) : [0, 0]);
  const following = () => { const box = document.querySelector("[data-part=follow]"); return !box || box.checked; };
  let along = [0, 0];
  const goAlong = (time) => {
    if (!leader || !following()) return;
    const [x, y] = way(time), [dx, dy] = [x - along[0], y - along[1]];
    along = [x, y];
    for (const place of [viewer.camera.position, viewer.controls.target]) { place.x += dx; place.z -= dy; }
    viewer.controls.update();
    lead(x, y);
  };
  const lead = (x, y) => {
    // those that stand somewhere; what shines in one direction does so everywhere
    for (const { object } of Object.values(viewer.scene_tree.find(["Lights"]).children)) {
      object.traverse((light) => {
        if (!light.isPointLight && !light.isSpotLight) return;
        object.position.set(x, y, 0);
        if (!light.target) return;
        light.target.position.set(x, 0, -y); // it is in no scene, and has the viewer's own axes
        light.target.updateMatrixWorld();
      });
    }
  };

  // far enough away for everything to be seen, however narrow the window
  const look = () => {
    if (!about.camera) return;
    const { position, target } = about.camera, [wayX, wayY] = way(now());
    const offset = position.map((value, k) => value - target[k]);
    const shown = Math.hypot(...offset) * Math.tan((viewer.camera.fov * Math.PI) / 360) * viewer.camera.aspect;
    const over = about.inset && getComputedStyle(at("inset")).position === "absolute";
    const free = over ? 1 - at("inset").offsetWidth / Math.max(at("scene").clientWidth, 1) : 1;
    const away = Room.away(viewer, about.camera, free);
    const own = ([x, y, z]) => [x, z, -y]; // the viewer's own frame has y up
    // the middle of the picture is that of what is left free beside the inset
    const aside = ((1 - free) * away * shown) / Math.hypot(offset[0], offset[1]);
    const centre = [target[0] + wayX - aside * offset[1], target[1] + wayY + aside * offset[0], target[2]];
    viewer.camera.position.set(...own(centre.map((value, k) => value + away * offset[k])));
    viewer.controls.target.set(...own(centre));
    along = [wayX, wayY];
    viewer.controls.update();
    viewer.set_dirty();
  };
  let turned = false;
  at("scene").addEventListener("pointerdown", () => { turned = true; });
  at("scene").addEventListener("wheel", () => { turned = true; }, { passive: true });
  at("scene").addEventListener("dblclick", () => { turned = false; look(); });

  // MeshCat takes the height of the window for its own; here it has a share of it
  const fit = () => {
    viewer.set_3d_pane_size(at("scene").clientWidth, at("scene").clientHeight);
    if (!turned) look();
    viewer.render(); // at once: a canvas of a new size is empty
  };
  window.onload = fit;
  for (const part of ["scene", "inset"]) new ResizeObserver(fit).observe(at(part));
  window.addEventListener("resize", fit);
  requestAnimationFrame(fit);

  // ------------------------------------------------------------------ light and dark
  let dark = about.theme === "dark" || (about.theme !== "light" && Room.wish.matches);
  const paint = () => {
    const room = Room.paint(viewer, dark);
    at("theme").textContent = dark ? "Light" : "Dark";
    for (const run of runs) {
      for (const part of [["rim"], ["plumb", "line"]]) {
        if (exists("meshcat", run.node, "centre_of_mass", ...part)) {
          node("meshcat", run.node, "centre_of_mass", ...part).traverse((mesh) => mesh.material && mesh.material.color.setHex(room.rim));
        }
      }
    }
    viewer.set_dirty();
  };
  at("theme").addEventListener("click", () => { dark = !dark; paint(); });
  if (about.theme === "auto") Room.wish.addEventListener("change", () => { dark = Room.wish.matches; paint(); });
  paint();

  // ------------------------------------------------------------------ time
  const slider = at("slider"), play = at("play"), speed = at("speed");
  const seek = (wanted) => {
    const time = Math.min(Math.max(wanted, 0), duration());
    animator().pause();
    animator().seek(time);
    animator().display_progress(time);
  };
  const toggle = () => (animator().playing ? animator().pause() : animator().play());
  const pace = () => { animator().mixer.timeScale = Number(speed.value); };
  play.addEventListener("click", toggle);
  slider.addEventListener("input", () => seek(Number(slider.value)));
  speed.addEventListener("change", pace);

  const events = [...new Set([0, ...runs.flatMap((run) => run.events.map((event) => event.t)), about.duration || 0])].sort((a, b) => a - b);
  const KEYS = {
    " ": toggle,
    ArrowRight: (event) => seek(event.shiftKey ? events.find((t) => t > now() + 1e-3) ?? duration() : now() + 1 / 60),
    ArrowLeft: (event) => seek(event.shiftKey ? events.findLast((t) => t < now() - 1e-3) ?? 0 : now() - 1 / 60),
    Home: () => seek(0),
    End: () => seek(duration()),
    "+": () => { speed.selectedIndex = Math.min(speed.selectedIndex + 1, speed.length - 1); pace(); },
    "-": () => { speed.selectedIndex = Math.max(speed.selectedIndex - 1, 0); pace(); },
    p: () => at("fold").click(),
    d: () => at("theme").click(),
  };
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || !(event.key in KEYS)) return;
    const own = event.target.closest("button, select, input, .dg"); // what has a use for the key itself
    if (own && (own.matches("select, .dg") || (event.key === " " && own !== slider))) return;
    event.preventDefault();
    KEYS[event.key](event);
  });

  // ------------------------------------------------------------------ what is shown
  const boxes = (about.parts || []).map((part) => {
    const label = document.createElement("label"), box = document.createElement("input"), sign = document.createElement("i");
    Object.assign(box, { type: "checkbox", checked: true });
    box.dataset.part = part.key;
    sign.className = part.key;
    label.append(box, sign, part.label);
    at("toggles").append(label);
    return [box, part.nodes.map((path) => ["meshcat", ...path])];
  });
  const choose = () => {
    for (const [box, nodes] of boxes) {
      for (const path of nodes.filter((one) => exists(...one))) node(...path).visible = box.checked;
    }
    viewer.set_dirty();
  };
  for (const [box] of boxes) box.addEventListener("change", choose);
  if (leader) {
    const label = document.createElement("label"), box = document.createElement("input");
    Object.assign(box, { type: "checkbox", checked: true });
    box.dataset.part = "follow";
    label.className = "follow";
    label.append(box, "camera follows");
    at("toggles").append(label);
    box.addEventListener("change", () => { if (!turned) look(); else if (box.checked) along = way(now()); });
  }
  at("toggles").hidden = !boxes.length;

  // Triangles of a mesh that are drawn, from which one on and how many.
  const drawOnly = (path, first, count) => {
    if (exists(...path)) node(...path).traverse((mesh) => mesh.geometry && mesh.geometry.setDrawRange(3 * first, 3 * count));
  };

  // The trace grows with time, and the step before stays: a part of the mesh of either foot, two triangles a piece.
  for (const run of runs) {
    const sum = { left: 0, right: 0 };
    for (const trace of run.traces) [trace.first, sum[trace.foot]] = [sum[trace.foot], sum[trace.foot] + 2 * trace.pieces];
    run.swings = run.traces.map((trace) => trace.start);
  }
  const uncover = (time) => {
    for (const run of runs.filter((one) => one.traces.length)) {
      const last = indexAt(run.swings, time), shown = { left: [0, 0], right: [0, 0] };
      for (const trace of run.traces.slice(Math.max(0, last - 1), last + 1)) {
        const share = Math.min(Math.max((time - trace.start) / (trace.end - trace.start), 0), 1), before = shown[trace.foot];
        const from = before[1] ? before[0] : trace.first; // a foot that swings twice in a row has one part
        shown[trace.foot] = [from, trace.first + 2 * Math.ceil(share * trace.pieces) - from];
      }
      for (const [foot, [first, count]] of Object.entries(shown)) drawOnly(["meshcat", run.node, "trace", foot], first, count);
    }
  };

  // Footsteps stay where a foot has stood.
  const leave = (time) => {
    for (const run of runs.filter((one) => one.footsteps)) {
      for (const [side, times] of Object.entries(run.footsteps.times)) {
        const count = times.length && times[0] <= time + 1e-7 ? indexAt(times, time) + 1 : 0;
        for (const [name, triangles] of Object.entries(run.footsteps.triangles)) {
          drawOnly(["meshcat", run.node, "footsteps", side, name], 0, triangles * count);
        }
      }
    }
  };

  // What MeshCat has no command for: one light casts shadows, markers and ghosts do not; a ghost gives way to the robot
  // where both are in one place, and markers are drawn over both
  const shade = () => {
    node("Lights", "SpotLight", "<object>").castShadow = true;
    const each = (paths, change) => {
      for (const path of paths.filter((one) => exists("meshcat", ...one))) node("meshcat", ...path).traverse(change);
    };
    const ghosts = [...(about.ghost ? [["ghost"]] : []), ...(about.overlaid ? [["second"]] : [])];
    const marks = runs.flatMap((run) => ["contact", "centre_of_mass", "trace", "push"].map((part) => [run.node, part]));
    const flat = runs.flatMap((run) => ["footsteps", "foothold"].map((part) => [run.node, part]));
    each([...ghosts, ...marks, ...flat], (part) => { part.castShadow = false; part.receiveShadow = false; });
    each(ghosts, ({ material }) => {
      if (material) Object.assign(material, { polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 8, depthWrite: false });
    });
    each(marks, (part) => { part.renderOrder = part.parent.name === "rim" ? 2 : 3; });
    viewer.set_dirty();
  };

  // ------------------------------------------------------------------ captions and plots
  const names = runs.map((run, k) => (runs.length > 1 ? "AB"[k] + ", " + run.robot + ": " : ""));
  const plotted = runs.filter((run) => run.samples).map((run) => Object.assign(run, { data: unpack(run.samples) }));
  const captions = runs.map((run, k) => drawCaption(at("captions"), run, names[k]));
  drawStrips(at("strips"), { ...about, runs }, seek);

  const span = at("window");
  const shownTimes = () => {
    const length = Number(span.value), whole = about.duration || 1;
    if (!length || length >= whole) return [0, whole];
    const start = Math.min(Math.floor(now() / length) * length, whole - length);
    return [Math.max(0, start), Math.max(0, start) + length];
  };
  const hooks = { seek, time: now, window: shownTimes, second: "B" };
  const plots = [];
  if (plotted.length) for (let k = 0; k < (about.rows ?? 4); k++) plots.push(new Plot(at("plots"), about, plotted, k, hooks));
  document.body.classList.toggle("bare", !plots.length);
  at("inset").hidden = !about.inset;
  document.body.classList.toggle("spatial", Boolean(about.inset));
  if (about.inset) plots.push(new Plot(at("inset"), about, plotted, about.panels.findIndex((panel) => panel.key === about.inset), hooks));
  if (about.duration > 8) span.value = "4";
  span.addEventListener("change", () => plots.forEach((plot) => plot.draw()));
  at("fold").addEventListener("click", () => {
    const folded = at("plots").classList.toggle("folded");
    at("fold").setAttribute("aria-pressed", String(!folded));
  });

  // ------------------------------------------------------------------ every frame
  let ready = false, last = -1, said = 0, motions = [];
  const show = (time, say) => {
    last = time;
    if (slider.max !== String(duration())) slider.max = String(duration());
    slider.value = String(time);
    slider.style.setProperty("--done", (100 * time) / (duration() || 1) + "%");
    at("clock").textContent = time.toFixed(2) + " / " + duration().toFixed(2) + " s";
    for (const tell of captions) tell(time);
    uncover(time);
    leave(time);
    for (const motion of motions) motion.pose(time);
    goAlong(time);
    viewer.set_dirty();
    for (const plot of plots) plot.follow(time, say);
  };
  const refresh = (clock) => {
    requestAnimationFrame(refresh);
    if (!ready && animator().duration > 0) {
      ready = true;
      motions = [...runs, ...(about.moved || [])].filter((one) => one.motion).map((one) => new Motion(one.motion, (path) => {
        const whole = ["meshcat", one.node, ...path];
        return exists(...whole) ? node(...whole) : null;
      }));
      shade(); paint(); choose(); pace();
      if (!turned) look(); // what comes by web socket has told the field of view by now
      last = -1;
    }
    const time = now(), label = animator().playing ? "Pause" : "Play";
    if (play.textContent !== label) play.textContent = label;
    if (time === last) return;
    const say = !animator().playing || clock - said > 80; // digits that can be read
    if (say) said = clock;
    show(time, say);
  };
  requestAnimationFrame(refresh);

  // What is drawn, as text: the camera, the place of every part to a tenth of a millimetre, and where only some of its
  // triangles are drawn, these.
  const drawn = () => {
    const numbers = [], tell = (values) => { for (const value of values) numbers.push(Math.round(1e4 * value)); };
    viewer.scene.updateMatrixWorld();
    tell(viewer.camera.matrixWorld.elements);
    viewer.scene.traverseVisible(({ geometry, matrixWorld }) => {
      if (!geometry) return;
      tell(matrixWorld.elements);
      const { index, attributes, drawRange: { start, count } } = geometry;
      for (let k = start; count < Infinity && k < start + count; k++) {
        const corner = index ? index.getX(k) : k;
        tell(["getX", "getY", "getZ"].map((axis) => attributes.position[axis](corner)));
      }
    });
    return numbers.join();
  };

  // The scene at a time: its picture, or null if it has been given before under the same number; where in `main` it is;
  // and whether what stands around it is another than the time before.
  const given = new Map();
  let around = "";
  const picture = (time) => {
    seek(time);
    show(now(), true);
    const text = drawn(), before = around, known = given.has(text);
    if (known) viewer.needs_render = false;
    else {
      given.set(text, given.size);
      viewer.render();
    }
    around = at("caption").innerHTML + at("inset").innerHTML; // the rest stays
    const canvas = at("scene").querySelector("canvas");
    const [whole, part] = [document.querySelector("main"), canvas].map((box) => box.getBoundingClientRect());
    return {
      number: given.get(text),
      scene: known ? null : canvas.toDataURL(),
      place: [Math.round(part.x - whole.x), Math.round(part.y - whole.y)],
      changed: around !== before,
    };
  };
  window.page = { seek, now, duration, toggle, picture, look: () => { turned = false; look(); } };
})();
