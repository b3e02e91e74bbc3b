r"""What the whole-body program keeps: what a flat sole can carry, and how fast joints may approach their limits.

*Contact.* The wrench w = (F, M) of a sole about the point below its ankle, eleven rows that are linear in w: a friction
pyramid inside the cone, |F_x|, |F_y| <= mu/sqrt(2) F_z; the centre of pressure inside the sole, x = -M_y/F_z and
y = M_x/F_z; the yaw moment; a normal force above a least one.

*Yaw.* Friction of a sole whose pressure is spread evenly holds the moment mu F_z r about the vertical, r the mean
distance of its points from the middle (`holding_wrench.friction_arm`). With the centre of pressure near an edge it
holds less than that if the pressure is even on what is left, and more if it is in the corners.

*Ranges and speeds.* A joint approaches the end of its range as a critically damped spring of rate lambda would,

.. math:: \ddot q \le \lambda^2 (q_{max} - q) - 2 \lambda \dot q, \qquad \ddot q \le \lambda (v_{max} - \dot q),

and likewise below.
"""

from typing import NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.whole_body.settings import WholeBodySettings
from frontal_biped.gait.holding_wrench import friction_arm
from frontal_biped.model.space.free_robot import BASE, FreeRobot
from frontal_biped.model.space.virtual_legs import SpaceState
from frontal_biped.model.stance_map import Stance

CONTACT = 11
"""Rows of the contact."""

LOADED = 10
"""The row of the normal force."""

UNLIMITED = 1e6
"""Stands for a torque without limit [N m]: arithmetic with it stays finite."""


def contact_rows(free: FreeRobot, side: Stance, settings: WholeBodySettings) -> FloatArray:
    """(11, 6) rows of a sole: times its wrench at least zero, the last one at least the smallest normal force."""
    left, right = free.soles
    sole = left if side is Stance.LEFT else right
    share = settings.sole_share
    inner, outer = share * sole.inner, share * sole.outer
    low, high = (-inner, outer) if side is Stance.LEFT else (-outer, inner)
    mu = settings.friction / np.sqrt(2.0)
    arm = settings.friction * friction_arm(np.array(0.5 * sole.length), np.array(0.5 * sole.width))
    F_x, F_y, F_z, M_x, M_y, M_z = np.eye(6)
    return np.array(
        [
            mu * F_z + F_x,
            mu * F_z - F_x,
            mu * F_z + F_y,
            mu * F_z - F_y,
            M_x - low * F_z,
            high * F_z - M_x,
            share * sole.front * F_z + M_y,
            share * sole.back * F_z - M_y,
            arm * F_z + M_z,
            arm * F_z - M_z,
            F_z,
        ]
    )


class Bounds(NamedTuple):
    """Smallest and largest accelerations, (n,) each [rad/s^2]."""

    lower: FloatArray
    upper: FloatArray


class MotionLimits:
    """Accelerations that keep every joint inside its range and speed.

    Args:
        free: the robot.
        settings: shares, margins and the rate.
    """

    def __init__(self, free: FreeRobot, settings: WholeBodySettings) -> None:
        rate, margin, limits = settings.limit_rate, settings.range_margin, free.limits
        self._rate = rate
        self._speed = rate * settings.speed_share * limits.velocity
        # a posture may stand nearer to the end of a range than the margin
        at = free.posture[BASE + 1 :]
        self._upper = rate**2 * np.maximum(limits.upper - margin, np.minimum(at, limits.upper))
        self._lower = rate**2 * np.minimum(limits.lower + margin, np.maximum(at, limits.lower))

    def at(self, state: SpaceState) -> Bounds:
        """The bounds at a state."""
        rate = self._rate
        towards = rate * state.v[BASE:]
        there = rate**2 * state.q[BASE + 1 :] + 2.0 * towards
        return Bounds(
            np.maximum(-self._speed - towards, self._lower - there),
            np.minimum(self._speed - towards, self._upper - there),
        )
