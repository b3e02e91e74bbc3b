// A robot without a run: a slider for every joint. Reads `commands` (the scene) and `about` (see joints_page.py).
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
  viewer.gui.domElement.style.display = "none";
  for (const text of commands) {
    viewer.handle_command_bytearray(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)));
  }
  const own = ([x, y, z]) => [x, z, -y]; // the viewer's own frame has y up
  const { position, target } = about.camera;
  let turned = false;
  const fit = () => {
    viewer.set_3d_pane_size(at("scene").clientWidth, at("scene").clientHeight);
    if (!turned) {
      const away = Room.away(viewer, about.camera);
      viewer.camera.position.set(...own(target.map((value, k) => value + away * (position[k] - value))));
      viewer.controls.target.set(...own(target));
      viewer.controls.update();
    }
    viewer.render(); // at once: a canvas of a new size is empty
  };
  at("scene").addEventListener("pointerdown", () => { turned = true; });
  at("scene").addEventListener("wheel", () => { turned = true; }, { passive: true });
  at("scene").addEventListener("dblclick", () => { turned = false; fit(); });
  window.addEventListener("load", fit); // after MeshCat's own, which take the height of the window
  window.addEventListener("resize", fit);
  new ResizeObserver(fit).observe(at("scene"));

  const paint = () => Room.paint(viewer, Room.wish.matches);
  Room.wish.addEventListener("change", paint);
  paint();
  at("about").textContent = about.text;

  const sliders = about.joints.map((joint) => {
    const node = viewer.scene_tree.find(joint.node).object;
    const label = document.createElement("label"), shown = document.createElement("output"), slider = document.createElement("input");
    label.append(joint.part ? `${joint.name} (${joint.part})` : joint.name, shown, slider);
    label.className = joint.part ? "roll" : "";
    Object.assign(slider, { type: "range", min: joint.lower, max: joint.upper, step: "any", name: joint.name });
    const move = (value) => {
      Motion.how[joint.how](node, [value], joint);
      shown.textContent = `${value.toFixed(3)} ${joint.unit}`;
      viewer.set_dirty();
    };
    slider.addEventListener("input", () => move(slider.valueAsNumber));
    at("joints").append(label);
    return () => { slider.value = joint.value; move(joint.value); };
  });
  const reset = () => { for (const back of sliders) back(); };
  at("reset").addEventListener("click", reset);
  reset();
})();
