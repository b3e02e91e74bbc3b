"""What the joints of a walk in space come to, measured at every tick, and whether the robot ran into itself."""

import threading
from functools import lru_cache
from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.model.space.self_collision import SelfDistances

COLLISION_RATE = 50.0
"""How often a walk is searched for links that touch [1/s]."""


class JointMeter:
    """The largest share of each joint's limits that a walk has used.

    Args:
        free: the robot, whose limits they are.
    """

    def __init__(self, free: FreeRobot) -> None:
        self._names, limits = free.joint_names, free.limits
        self._effort, self._velocity = limits.effort, limits.velocity
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


def self_collisions(free: FreeRobot, t: FloatArray, q: FloatArray) -> dict[str, Any]:
    """Did the robot run into itself?

    Args:
        free: the robot.
        t: (T,) times [s].
        q: (T, nq) configurations.

    Returns:
        ``shapes`` that were searched, at how many ``instants``, in how many of them links were ``touching`` and which
        ``pairs`` (at how many), and the ``least`` distance of the left leg from the right one [m], between which
        ``links``; negative: how deep one was in the other.
    """
    distances, pairs = _distances(free, threading.get_ident()), dict[str, int]()
    wanted = np.arange(t[0], t[-1], 1.0 / COLLISION_RATE) if len(t) else np.zeros(0)
    instants = np.unique(np.searchsorted(t, wanted))
    touching, least, links = 0, float("inf"), ("", "")
    for configuration in q[instants]:
        found = distances.touching(configuration)
        touching += bool(found)
        for pair in found:
            pairs[" - ".join(pair)] = pairs.get(" - ".join(pair), 0) + 1
        closest = distances.between_legs(configuration)
        if closest.distance < least:
            least, links = closest
    return {
        "shapes": distances.shapes,
        "instants": len(instants),
        "touching": touching,
        "pairs": pairs,
        "least": least if np.isfinite(least) else None,
        "links": list(links),
    }


@lru_cache(maxsize=8)
def _distances(free: FreeRobot, thread: int) -> SelfDistances:
    """Meshes are read once for all walks of a robot in one thread: its work data cannot be shared."""
    return SelfDistances(free)
