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
  viewer.camera.position.set(...own(about.camera.position));
  viewer.controls.target.set(...own(about.camera.target));
  viewer.controls.update();
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
