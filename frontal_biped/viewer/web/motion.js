// Moves the nodes of a scene by channels of numbers; which node by which channels, and how, is said by drivers
// (see channels.py). MeshCat's own animation writes every pose of every body out; this stays small.
class Motion {
  constructor(motion, find) {
    this.data = unpack(motion);
    this.movers = motion.drivers.map((driver) => [find(driver.node), Motion.how[driver.how], driver]).filter(([node]) => node);
  }

  // The channels' values at a time are linear between frames.
  pose(time) {
    const { data } = this, i = indexAt(data.t, time), j = Math.min(i + 1, data.count - 1);
    const width = data.t[j] - data.t[i], weight = width > 1e-7 ? Math.min(Math.max((time - data.t[i]) / width, 0), 1) : 0;
    const at = (name) => data[name][i] * (1 - weight) + data[name][j] * weight;
    for (const [node, move, driver] of this.movers) move(node, driver.from.map(at), driver);
  }
}

Motion.how = {
  pose: (node, [x, y, z, ...q]) => { node.position.set(x, y, z); node.quaternion.set(...q).normalize(); },
  turn: (node, [angle], { axis }) => {
    const s = Math.sin(angle / 2);
    node.quaternion.set(s * axis[0], s * axis[1], s * axis[2], Math.cos(angle / 2));
  },
  slide: (node, [way], { axis }) => node.position.set(...axis.map((part) => part * way)),
  place: (node, place) => node.position.set(...place),
  // the shortest turn from the y axis: half-way between y and the direction
  point: (node, [x, y, z]) => {
    const length = Math.hypot(x, y, z);
    if (length > 1e-6) {
      const up = 1 + y / length;
      if (up > 1e-6) node.quaternion.set(z / length, 0, -x / length, up).normalize();
      else node.quaternion.set(1, 0, 0, 0);
    }
    node.scale.set(1, Math.max(length, 1e-3), 1);
  },
  lay: (node, [x, y, yaw]) => { node.position.set(x, y, 0); node.quaternion.set(0, 0, Math.sin(yaw / 2), Math.cos(yaw / 2)); },
  stretch: (node, [length]) => node.scale.set(1, 1, Math.max(length, 1e-3)),
  arc: (node, [size]) => { const s = Math.max(Math.abs(size), 1e-3); node.scale.set(s, size < 0 ? -s : s, 1); },
  shown: (node, [value]) => { node.visible = value > 0.5; },
};
