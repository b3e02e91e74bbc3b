"use strict";
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

  // MeshCat takes the height of the window for its own; here the bar below takes a share of it
  const fit = () => viewer.set_3d_pane_size(at("scene").clientWidth, at("scene").clientHeight);
  window.onload = fit;
  new ResizeObserver(fit).observe(at("scene"));
  window.addEventListener("resize", fit);
  requestAnimationFrame(fit);

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
  if (live) viewer.connect("ws://" + location.host + "/");

  if (timeline.camera) {
    // the viewer's own frame has y up: (x, z, -y)
    const own = ([x, y, z]) => [x, z, -y];
    viewer.camera.position.set(...own(timeline.camera.position));
    viewer.controls.target.set(...own(timeline.camera.target));
    viewer.controls.update();
    viewer.controls.saveState();
    at("scene").addEventListener("dblclick", () => { viewer.controls.reset(); viewer.set_dirty(); });
  }

  const slider = at("slider"), play = at("play"), phases = timeline.phases || [];
  const animator = () => viewer.animator;
  const duration = () => animator().duration || timeline.duration || 0;

  const strip = at("phases");
  phases.forEach((phase, k) => {
    const end = k + 1 < phases.length ? phases[k + 1].start : timeline.duration;
    const part = document.createElement("i");
    part.className = phase.phase + (k > 0 && phases[k - 1].step !== phase.step ? " new" : "");
    part.style.width = (100 * (end - phase.start)) / (timeline.duration || 1) + "%";
    strip.append(part);
  });

  const seek = (time) => {
    animator().pause();
    animator().seek(time);
    animator().display_progress(time);
  };
  const toggle = () => (animator().playing ? animator().pause() : animator().play());
  play.addEventListener("click", toggle);
  slider.addEventListener("input", () => seek(Number(slider.value)));
  at("speed").addEventListener("change", (event) => { animator().mixer.timeScale = Number(event.target.value); });
  document.addEventListener("keydown", (event) => {
    if (event.target.closest("button, select, input, .dg")) return;
    if (event.key === " ") { event.preventDefault(); toggle(); }
    if (event.key === "ArrowRight") seek(Math.min(duration(), animator().time + 1 / 30));
    if (event.key === "ArrowLeft") seek(Math.max(0, animator().time - 1 / 30));
  });

  // What MeshCat has no command for: one light casts shadows, the markers do not
  const node = (...path) => viewer.scene_tree.find(path).object;
  const shade = () => {
    node("Lights", "SpotLight", "<object>").castShadow = true;
    for (const name of ["contact", "centre_of_mass"]) {
      node("meshcat", name).traverse((part) => { part.castShadow = false; part.receiveShadow = false; });
    }
    viewer.set_dirty();
  };

  const phaseAt = (time) => phases.reduce((found, phase) => (phase.start <= time + 1e-9 ? phase : found), phases[0]);
  let shown = null, shaded = false;
  const refresh = () => {
    requestAnimationFrame(refresh);
    if (!shaded && duration() > 0 && animator().duration > 0) { shade(); shaded = true; }
    const time = Math.min(animator().time, duration());
    if (slider.max !== String(duration())) slider.max = String(duration());
    slider.value = String(time);
    play.textContent = animator().playing ? "Pause" : "Play";
    at("clock").textContent = time.toFixed(2) + " / " + duration().toFixed(2) + " s";
    const phase = phases.length ? phaseAt(time) : null;
    if (phase === shown) return;
    shown = phase;
    const badge = document.createElement("b");
    badge.className = phase.phase;
    badge.textContent = phase.phase;
    at("phase").replaceChildren("step " + phase.step + ", " + phase.stance + " foot stands ", badge);
  };
  refresh();
})();
