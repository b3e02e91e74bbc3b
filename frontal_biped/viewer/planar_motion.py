"""How the scene of a walk in the plane moves: the poses of its bodies and its markers, as channels over time."""

from typing import Any

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.space.resampling import same_hemisphere
from frontal_biped.simulation.world import FEET, WorldMotion, resample, world_motion
from frontal_biped.viewer.channels import ROOT_POSE, Channels, held
from frontal_biped.viewer.markers import COM, CONTACT
from frontal_biped.viewer.scene import ROBOT, Actor, body_poses


def planar_motion(actor: Actor, times: FloatArray) -> dict[str, Any]:
    """What of a robot moves, and how; a run that is shorter waits at its end.

    Args:
        actor: the robot and its run.
        times: (K,) frames, from the first sample of the run on [s].

    Returns:
        See `Channels.table`; its nodes are below that of the actor.
    """
    motion = world_motion(actor.biped, resample(actor.trajectory, actor.trajectory.t[0] + times))
    found = Channels()
    found.channels["t"] = times
    for k, (body, poses) in enumerate(body_poses(actor.biped, motion)):
        pose = np.array([pin.SE3ToXYZQUAT(each) for each in poses])
        pose[:, 3:] = same_hemisphere(pose[:, 3:])
        found.drive([ROBOT, body], "pose", **{f"body{k}_{name}": pose[:, i] for i, name in enumerate(ROOT_POSE)})
    if actor.marked:
        _drive_markers(found, actor.biped, motion)
    return found.table()


def _drive_markers(found: Channels, biped: FrontalBiped, motion: WorldMotion) -> None:
    found.drive_vector([COM], "place", "com", motion.com)
    found.drivers.append({"node": [COM, "plumb"], "how": "stretch", "from": ["com_z"]})
    for foot in FEET:
        side, standing = foot.value, np.array([Stance.of_sign(sign) is foot for sign in motion.stance])
        node = [CONTACT, side]
        found.drive(node, "shown", **{f"on_{side}": standing.astype(float)})
        # where the foot swings, its hidden marker waits at its last place
        found.drive_vector(node, "place", f"fri_{side}", held(motion.fri, standing))
        found.drive_vector([*node, "force"], "point", f"force_{side}", held(motion.force / biped.weight, standing))
