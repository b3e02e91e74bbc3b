"""How the scene of a walk in space moves: the robot by its joints, wrenches, centre of mass, footholds and pushes."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.space.resampling import resample_spatial
from frontal_biped.simulation.space.run import SpatialRun
from frontal_biped.simulation.space.soles import pressure_in_world, yaw_moments
from frontal_biped.simulation.world import FEET, frame_times
from frontal_biped.viewer.channels import ROOT_POSE, Channels, frame_rate, held
from frontal_biped.viewer.markers import COM, CONTACT
from frontal_biped.viewer.page_data import told_pushes
from frontal_biped.viewer.scene import ROBOT
from frontal_biped.viewer.space_robot import body_drivers, channel
from frontal_biped.viewer.space_scene import FOOTHOLD, PUSH

SMOOTH = 0.5
"""Over how long the way is averaged that the camera follows [s]: it does not sway with the robot."""

MOMENT_ARM = 0.02
"""A yaw moment of the weight at this arm has an arc of full size [m]."""

LEAST_SHOWN = 0.5
"""A push is shown at least so long [s]; most are over too soon to be seen."""


class ShownPush(NamedTuple):
    """A push as the page tells it.

    Attributes:
        start: from the first sample of the run [s].
        duration: [s].
        impulse: (3,) in world axes [N s].
        link: URDF name; "" for the root link.
        point: (3,) where it acts, in the axes of the link [m].
    """

    start: float
    duration: float
    impulse: FloatArray
    link: str
    point: FloatArray

    @property
    def text(self) -> str:
        """In words."""
        x, y, z = (float(part) for part in self.impulse)
        return f"push of ({x:g}, {y:g}, {z:g}) N s on {self.link or 'the root link'}"


def spatial_pushes(robot: FreeRobot, run: SpatialRun) -> list[ShownPush]:
    """Pushes that the run's settings tell; those that are not told fully are left out."""
    found = []
    for start, told in told_pushes(run, run.settings.get("pushes")):
        try:
            link = str(told.get("link") or "")
            impulse, point = (np.asarray(told.get(key, np.zeros(3)), dtype=float) for key in ("impulse", "point"))
            push = ShownPush(start, float(told["duration"]), impulse, link, point)
        except (KeyError, TypeError, ValueError):
            continue
        if impulse.shape == point.shape == (3,) and (not link or robot.model.existBodyName(link)):
            found.append(push)
    return found


def motion(robot: FreeRobot, run: SpatialRun, pushes: Sequence[ShownPush] = (), fps: float = 30.0) -> dict[str, Any]:
    """What moves, and how, at a fixed rate.

    Args:
        robot: the robot.
        run: its walk, see `drawable_part`.
        pushes: what has an arrow in the scene.
        fps: frames a second; fewer for a long walk, see `frame_rate`.

    Returns:
        See `Channels.table`; the channels "way_x" and "way_y" lead the camera.
    """
    rate = frame_rate(float(run.t[-1] - run.t[0]), fps)
    times = frame_times(run, rate)
    inside = times.copy()
    inside[-1] -= 1e-9  # the last instant has no sample after it
    seen = resample_spatial(run, inside)
    found = Channels()
    found.channels["t"] = times - run.t[0]
    found.channels |= {name: seen.q[:, i] for i, name in enumerate(ROOT_POSE)}
    found.channels |= {channel(i): seen.q[:, 7 + i] for i in range(len(run.joint_names))}
    found.drivers += [driver | {"node": [ROBOT, *driver["node"]]} for driver in body_drivers(robot)]
    found.drive_vector([COM], "place", "com", seen.com)
    found.drivers.append({"node": [COM, "plumb"], "how": "stretch", "from": ["com_z"]})
    _drive_contacts(found, robot, seen)
    _drive_footholds(found, seen)
    _drive_pushes(found, robot, seen, pushes)
    smooth = _smoothed(seen.com[:, :2], max(1, round(SMOOTH * rate)))
    found.channels |= {"way_x": smooth[:, 0], "way_y": smooth[:, 1]}
    return found.table()


def _drive_contacts(found: Channels, robot: FreeRobot, seen: SpatialRun) -> None:
    pressure, moments = pressure_in_world(seen), np.nan_to_num(yaw_moments(seen))
    for i, foot in enumerate(FEET):
        side, loaded = foot.value, np.isfinite(pressure[:, i, 0])
        node = [CONTACT, side]
        found.drive(node, "shown", **{f"on_{side}": loaded.astype(float)})
        # where the foot is in the air its hidden marker waits at the last place
        found.drive_vector(node, "place", f"cop_{side}", held(pressure[:, i], loaded))
        force = seen.wrench[:, i, :3] / robot.weight
        found.drive_vector([*node, "force"], "point", f"force_{side}", held(force, loaded))
        size = np.sqrt(np.abs(moments[:, i]) / (MOMENT_ARM * robot.weight)) * np.sign(moments[:, i])
        found.drive([*node, "moment"], "arc", **{f"arc_{side}": np.clip(size, -1.5, 1.5)})


def _drive_footholds(found: Channels, seen: SpatialRun) -> None:
    for foot in FEET:
        swings = np.array([Stance.of_sign(sign) is not foot for sign in seen.stance], dtype=float)
        found.drive([FOOTHOLD, foot.value], "shown", **{f"next_{foot.value}": swings})
        place = {f"next_{name}": seen.foothold[:, i] for i, name in enumerate(("x", "y", "yaw"))}
        found.drive([FOOTHOLD, foot.value], "lay", **place)


def _drive_pushes(found: Channels, robot: FreeRobot, seen: SpatialRun, pushes: Sequence[ShownPush]) -> None:
    model, data, times = robot.model, robot.model.createData(), found.channels["t"]
    for k, push in enumerate(pushes):
        shown = (times >= push.start) & (times <= push.start + max(push.duration, LEAST_SHOWN))
        tips = np.zeros((len(times), 3))
        for i in np.flatnonzero(shown):
            pin.framesForwardKinematics(model, data, seen.q[i])
            link = data.oMf[model.getBodyId(push.link)] if push.link else data.oMi[1]
            tips[i] = link.act(push.point)
        node, strength = [PUSH, str(k)], float(np.linalg.norm(push.impulse))
        along = np.tile(push.impulse / max(strength, 1e-12), (len(times), 1))
        found.drive(node, "shown", **{f"push{k}_on": shown.astype(float)})
        found.drive_vector(node, "place", f"push{k}_at", tips)
        found.drive_vector(node, "point", f"push{k}_along", along)


def _smoothed(way: FloatArray, frames: int) -> FloatArray:
    """Moving averages (T, 2) over so many frames on either side; at the ends the way goes on as it did."""
    ahead, behind = way[-1] - way[-min(frames + 1, len(way))], way[min(frames, len(way) - 1)] - way[0]
    ramp = np.arange(1, frames + 1)[:, None] / frames
    longer = np.concatenate([way[:1] - ramp[::-1] * behind, way, way[-1:] + ramp * ahead])
    kernel = np.full(2 * frames + 1, 1.0 / (2 * frames + 1))
    return np.stack([np.convolve(longer[:, i], kernel, mode="valid") for i in (0, 1)], axis=1)
