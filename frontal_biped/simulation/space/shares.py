"""How much of its limits every joint of a walk in space uses."""

from typing import NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.simulation.space.run import SpatialRun


class JointShares(NamedTuple):
    """Shares of limits, 1 is the limit; 0 where a joint has none.

    Attributes:
        torque: (T, n) |tau| over the largest torque [-].
        speed: (T, n) |rate| over the largest speed [-].
        range: (T, n) distance from the middle of the range over half of it [-].
    """

    torque: FloatArray
    speed: FloatArray
    range: FloatArray


def joint_shares(robot: FreeRobot, run: SpatialRun) -> JointShares:
    """Shares of the limits of every joint, in the order of `FreeRobot.joint_names`.

    Args:
        robot: the robot, whose limits they are.
        run: its walk.
    """
    limits, joints = robot.limits, run.q[:, 7:]
    middle, half = 0.5 * (limits.lower + limits.upper), 0.5 * (limits.upper - limits.lower)
    ranged = np.isfinite(half)
    away = np.abs(joints - np.where(ranged, middle, 0.0)) / np.where(ranged, half, np.inf)
    return JointShares(np.abs(run.tau) / limits.effort, np.abs(run.v[:, 6:]) / limits.velocity, away)
