"""What the joints of a walk in space come to, measured at every tick."""

from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.model.space.free_robot import FreeRobot


class JointMeter:
    """The largest share of each joint's limits that a walk has used.

    Args:
        free: the robot, whose limits they are.
    """

    def __init__(self, free: FreeRobot) -> None:
        self._names, limits = free.joint_names, free.limits
        # a share of nothing, or of no limit, is none
        self._effort = np.where(limits.effort > 0.0, limits.effort, np.inf)
        self._velocity = np.where(limits.velocity > 0.0, limits.velocity, np.inf)
        self._lower, self._upper = limits.lower, limits.upper
        n = len(self._names)
        self._largest = {"torque_share": np.zeros(n), "speed_share": np.zeros(n), "beyond_range": np.zeros(n)}

    def measure(self, positions: FloatArray, velocities: FloatArray, tau: FloatArray) -> None:
        """Joints (n,) are at positions [rad] and rates [rad/s], under torques [N m]."""
        for kept, value in zip(
            self._largest.values(),
            (
                np.abs(tau) / self._effort,
                np.abs(velocities) / self._velocity,
                np.maximum(self._lower - positions, positions - self._upper),
            ),
            strict=True,
        ):
            np.maximum(kept, value, out=kept)

    def summary(self) -> dict[str, dict[str, Any]]:
        """Largest share of torque and speed limits [-], largest way beyond a range [rad]; and whose."""
        return {
            name: {"largest": float(values.max()), "joint": self._names[int(values.argmax())]}
            for name, values in self._largest.items()
        }
