// What pages with a scene share: the room, light or dark, and how far away the camera stands.
const Room = (() => {
  const COLOURS = {
    light: { top: [0.8, 0.87, 0.94], bottom: [0.97, 0.98, 0.99], floor: 0xe4e9ef, glow: 0x565a60, line: 0xaab4c2, rim: 0x222222 },
    dark: { top: [0.12, 0.15, 0.19], bottom: [0.26, 0.3, 0.35], floor: 0x424c58, glow: 0x101418, line: 0x5a6673, rim: 0xd8dee6 },
  };
  const wish = matchMedia("(prefers-color-scheme: dark)"); // of the browser

  // page and room; gives the colours
  const paint = (viewer, dark) => {
    document.documentElement.classList.toggle("dark", dark);
    const room = COLOURS[dark ? "dark" : "light"];
    viewer.set_property(["Background"], "top_color", room.top);
    viewer.set_property(["Background"], "bottom_color", room.bottom);
    viewer.show_background();
    const scene = viewer.scene_tree.children.meshcat, ground = scene && scene.children.ground;
    for (const [name, part] of Object.entries(ground ? ground.children : {})) {
      part.object.traverse((mesh) => {
        if (!mesh.material) return;
        mesh.material.color.setHex(name === "slab" ? room.floor : room.line);
        if (mesh.material.emissive) mesh.material.emissive.setHex(room.glow);
      });
    }
    viewer.set_dirty();
    return room;
  };

  // factor of the camera's distance at which everything is seen, however narrow the picture; `free` is a share of it
  const away = (viewer, { position, target, half_width }, free = 1) => {
    const distance = Math.hypot(...position.map((value, k) => value - target[k]));
    const shown = distance * Math.tan((viewer.camera.fov * Math.PI) / 360) * viewer.camera.aspect;
    return Math.max(1, (1.05 * half_width) / (free * shown));
  };

  return { paint, away, wish };
})();
