"""Limits the walking controller keeps: contact, torques, and joints.

**Joints.** Positions and speeds are held inside their limits by bounds on the acceleration, an exponential control
barrier function (Nguyen and Sreenath, ACC 2016) with both poles at r. The distance h = q_max - q to a limit obeys

    ddh + 2 r dh + r^2 h >= 0,   that is   ddq + 2 r dq <= r^2 (q_max - q),

so that a joint with dh + r h >= 0, h >= 0 never leaves its range; of the speed, ddq <= 2 r (dq_max - dq), that is
ddq + 2 r dq <= 2 r dq_max. With that second rate, inside the ranges, some acceleration always meets all four bounds.
"""

from collections.abc import Callable
from typing import NamedTuple, TypeVar

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.settings import ControllerSettings
from frontal_biped.control.torques.linearisation import Motion
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.state import State

Numbers = TypeVar("Numbers", float, FloatArray)


class ContactLimits(NamedTuple):
    """Limits of contact and motors.

    Attributes:
        friction: coefficient of friction [-].
        min_normal_force: smallest normal force [N].
        fri_outer: outermost FRI [m], negative.
        fri_inner: innermost FRI [m].
        max_torque: (4,) [N m].
    """

    friction: float
    min_normal_force: float
    fri_outer: float
    fri_inner: float
    max_torque: FloatArray

    def keeps(self, generalized_forces: list[float]) -> bool:
        """Are F_h, F_v [N], N_0 [N m] and the four torques [N m] within the limits?"""
        F_h, F_v, N_0, u_1, u_2, u_3, u_4 = generalized_forces
        most_1, most_2, most_3, most_4 = self.max_torque.tolist()  # plain numbers, as above: four of them are faster
        return bool(
            F_v >= self.min_normal_force
            and abs(F_h) <= self.friction * F_v
            and self.fri_outer * F_v <= N_0 <= self.fri_inner * F_v
            and abs(u_1) <= most_1
            and abs(u_2) <= most_2
            and abs(u_3) <= most_3
            and abs(u_4) <= most_4
        )


class JointLimits:
    """Bounds on the accelerations that keep the joints inside their ranges.

    Args:
        lower: (4,) lowest positions [rad]; -inf where there is no limit.
        upper: (4,) highest positions [rad].
        max_velocity: (4,) largest speeds [rad/s].
        rate: r, the rate at which a limit may be approached [1/s].

    Attributes:
        limited: the joints that have any limit.
        ranges: (3, 4) r^2 q_min, r^2 q_max, 2 r dq_max [rad/s^2].
    """

    def __init__(self, lower: FloatArray, upper: FloatArray, max_velocity: FloatArray, rate: float) -> None:
        self.rate = rate
        self._lower, self._upper = rate**2 * lower, rate**2 * upper
        self._velocity = 2.0 * rate * max_velocity
        self.ranges = np.stack([self._lower, self._upper, self._velocity])
        bounded = np.isfinite(lower) | np.isfinite(upper) | np.isfinite(max_velocity)
        self.limited = np.flatnonzero(bounded)
        # the same in plain numbers: on four joints NumPy's calls would cost more than the arithmetic
        self._ranges = list(zip(self._lower.tolist(), self._upper.tolist(), self._velocity.tolist(), strict=True))

    def bounds(self, state: State) -> tuple[FloatArray, FloatArray]:
        """(4,) least and (4,) largest ddq [rad/s^2] at a state."""
        pull, drag = self.rate**2 * state.q, 2.0 * self.rate * state.dq
        return _between(self._lower - pull, self._upper - pull, self._velocity, drag, np.minimum, np.maximum)

    def bounds_of_joints(self, state: State) -> list[tuple[float, float]]:
        """The same joint by joint, in plain numbers."""
        q, dq = state
        r, twice = self.rate**2, 2.0 * self.rate
        return [
            _between(lower - r * at, upper - r * at, fastest, twice * speed, min, max)
            for (lower, upper, fastest), at, speed in zip(self._ranges, q.tolist(), dq.tolist(), strict=True)
        ]

    def keeps(self, state: State, ddq: FloatArray) -> bool:
        """Is ddq (4,) [rad/s^2] within the bounds?"""
        q, dq = state
        r, twice = self.rate**2, 2.0 * self.rate
        for (lower, upper, fastest), at, speed, change in zip(
            self._ranges, q.tolist(), dq.tolist(), ddq.tolist(), strict=True
        ):
            asked = change + twice * speed
            if not (-fastest <= asked <= fastest and lower <= asked + r * at <= upper):
                return False
        return True


def _between(
    lower: Numbers,
    upper: Numbers,
    fastest: Numbers,
    drag: Numbers,
    smaller: Callable[[Numbers, Numbers], Numbers],
    larger: Callable[[Numbers, Numbers], Numbers],
) -> tuple[Numbers, Numbers]:
    """Least and largest ddq from r^2 times the distances to the ends of a range, 2 r dq_max and 2 r dq [rad/s^2]."""
    most = smaller(upper, fastest) - drag
    least = larger(lower, -fastest) - drag
    return smaller(least, most), most  # they cross only far outside a range


class WalkingLimits(NamedTuple):
    """Everything that a walking robot keeps.

    Attributes:
        contact: of contact and motors.
        joints: of the joints' motion; None: none.
    """

    contact: ContactLimits
    joints: JointLimits | None = None

    @classmethod
    def of(cls, biped: FrontalBiped, settings: ControllerSettings) -> "WalkingLimits":
        """The limits of a robot, as the settings say."""
        torque = biped.max_torque if settings.max_torque is None else np.array(settings.max_torque)
        contact = ContactLimits(settings.friction, settings.min_normal_force * biped.weight, *biped.sole, torque)
        if settings.joint_rate is None:
            return cls(contact)
        ranges = (biped.joint_lower, biped.joint_upper, biped.joint_max_velocity)
        return cls(contact, JointLimits(*ranges, settings.joint_rate))

    def keep(self, state: State, motion: Motion) -> bool:
        """Does a motion at a state meet every constraint?"""
        if not self.contact.keeps(motion.forces.tolist()):
            return False
        return self.joints is None or self.joints.keeps(state, motion.ddq)
