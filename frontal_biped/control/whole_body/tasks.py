r"""The rows of the whole-body program: what the robot does by nature, what it is asked for.

Unknown are the accelerations dv of base and joints and the wrench w of the stance sole, about the origin of its frame
on the ground below the ankle, x = (dv, w).

By nature (base and stance foot, twelve rows):

.. math::
    M_b \dot v - J_b^T w = -h_b, \qquad J_{st} \dot v = -\dot J_{st} v - k v_{st}

Asked for, thirty rows for a robot of thirty joints: the paper's outputs on the virtual angles (3), over beta or over
the sway, its FRI target N_x = p_y F_z and the centre of pressure forwards N_y = -p_x F_z, both lengths of the virtual
legs, pitch and yaw of the pelvis, the swing sole forwards, in pitch and yaw, and every joint outside the legs at its
posture. Where the robot turns, pelvis and swing foot are led along a yaw. As many rows as unknowns: while no limit is
active the solution is that of a linear system.
"""

from typing import NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.whole_body.settings import WholeBodySettings
from frontal_biped.control.whole_body.targets import WholeBodyTargets, Yaw
from frontal_biped.exceptions import RobotError
from frontal_biped.model.space.free_robot import BASE, FreeRobot
from frontal_biped.model.space.virtual_legs import LENGTH, PITCH, SpaceState, Turning
from frontal_biped.model.stance_map import Stance

WRENCH = 6
NATURE = BASE + WRENCH
"""Rows of the base's dynamics and of the standing foot."""

OUTPUTS, FRI, COP, LENGTHS, PELVIS, SWING, FOOT = (
    slice(0, 3),
    3,
    4,
    slice(5, 7),
    slice(7, 9),
    9,
    slice(10, 12),
)
LEGS = 12
"""Asked-for rows before those of the joints outside the legs."""


class Rows(NamedTuple):
    """A x = b: nature first, then what is asked for.

    Attributes:
        A: (12 + tasks, nv + 6).
        b: (12 + tasks,).
    """

    A: FloatArray
    b: FloatArray


class TaskRows:
    """Writes the rows of a tick.

    Args:
        free: the robot.
        settings: gains.

    Attributes:
        outside: indices, among the joints, of those outside the legs.

    Raises:
        RobotError: a leg has not six joints.
    """

    def __init__(self, free: FreeRobot, settings: WholeBodySettings) -> None:
        self.free, self.settings = free, settings
        legs: set[int] = set()
        for side in Stance:
            leg = free.leg(side)
            if len(leg) != 6:
                raise RobotError(
                    f"{free.robot.description.urdf}: the {side.value} leg has {len(leg)} joints from the pelvis to the"
                    " ankle roll joint; in space a leg needs six: hip yaw, roll, pitch, knee, ankle pitch, roll"
                )
            legs.update(leg)
        n = len(free.joint_names)
        self.outside = np.array([i for i in range(n) if i not in legs], dtype=int)
        nv = BASE + n
        self._A = np.zeros((NATURE + LEGS + len(self.outside), nv + WRENCH))
        self._b = np.zeros(len(self._A))
        at = NATURE + LEGS + np.arange(len(self.outside))
        self._A[at, BASE + self.outside] = 1.0
        self._wrench = slice(nv, nv + WRENCH)
        self._nv = nv

    def write(self, state: SpaceState, targets: WholeBodyTargets) -> Rows:
        """The rows at a state; the arrays are overwritten by the next call.

        Rows of nature are in N and N m (base), then m/s^2 and rad/s^2 (stance foot); what is asked for in rad/s^2 and
        m/s^2 but for the FRI and the centre of pressure, in N m.

        Args:
            state: where they are written.
            targets: what is asked for there.
        """
        s, A, b, nv = self.settings, self._A, self._b, self._nv
        soft = targets.softness
        stance, swing = targets.stance, targets.stance.other
        foot, other = state.feet[stance], state.feet[swing]
        w = self._wrench
        A[:BASE, :nv] = state.M[:BASE]
        A[:BASE, w] = -foot.J[:, :BASE].T
        b[:BASE] = -state.bias[:BASE]
        A[BASE:NATURE, :nv] = foot.J
        b[BASE:NATURE] = -foot.drift - s.stance * foot.velocity

        A, b = A[NATURE:], b[NATURE:]
        frontal, wanted = state.frontal(stance), targets.frontal
        sway = wanted.sway
        J, drift = (frontal.J[0], frontal.drift[0]) if sway is None else (sway.J, sway.drift)
        A[OUTPUTS, :nv] = frontal.J[1:] - wanted.h_d1[:, None] * J
        b[OUTPUTS] = wanted.ddy + wanted.h_d2_dbeta2 - frontal.drift[1:] + wanted.h_d1 * drift
        _, _, fz, mx, my, _ = range(nv, nv + WRENCH)
        A[FRI, mx], A[FRI, fz] = 1.0, stance.sign * wanted.p_fri  # y = -sign h
        A[COP, my], A[COP, fz] = 1.0, targets.cop_x
        b[FRI] = b[COP] = 0.0
        firm = max(soft, s.length_softness)
        for i, (side, asked) in enumerate(((stance, targets.stance_length), (swing, targets.swing_length))):
            leg = state.legs[side]
            A[LENGTHS.start + i, :nv] = leg.J[LENGTH]
            error = leg.values[LENGTH] - state.lengths[side] - asked.offset
            back = held(s.length, firm, error, leg.rates[LENGTH] - asked.rate)
            b[LENGTHS.start + i] = asked.acceleration + back - leg.drift[LENGTH]
        pelvis = state.pelvis
        A[PELVIS, :nv] = pelvis.J[PITCH:]
        b[PELVIS] = turned(s.pelvis, soft, pelvis, targets.pelvis_yaw)
        A[SWING, :nv] = other.J[0]
        b[SWING] = targets.swing_acceleration - other.drift[0]
        turning = other.turning
        A[FOOT, :nv] = turning.J[PITCH:]
        b[FOOT] = turned(s.foot, soft, turning, targets.swing_yaw)
        out = self.outside
        error = state.q[BASE + 1 + out] - targets.joints[out]
        b[LEGS:] = held(s.posture, 1.0, error, state.v[BASE + out])
        return Rows(self._A, self._b)


def held(frequency: float, softness: float, error: FloatArray, rate: FloatArray) -> FloatArray:
    """Acceleration of a critically damped return to zero, of an error and its rate, numbers or arrays.

    Args:
        frequency: natural frequency [rad/s].
        softness: factor of the acceleration [-].
        error: from where it is to be.
        rate: of the error.
    """
    return -softness * (frequency**2 * error + 2.0 * frequency * rate)


def turned(frequency: float, softness: float, turning: Turning, yaw: Yaw) -> FloatArray:
    """(2,) what the rows of pitch and yaw are to come to for a body led along a yaw, its pitch kept at zero.

    Args:
        frequency: natural frequency [rad/s].
        softness: factor of the feedback [-].
        turning: of the body.
        yaw: where it is to look.
    """
    wanted = np.array([(0.0, 0.0, 0.0), yaw])
    error, rate = turning.angles[PITCH:] - wanted[:, 0], turning.rates[PITCH:] - wanted[:, 1]
    return wanted[:, 2] + held(frequency, softness, error, rate) - turning.drift[PITCH:]


def weights(rows: TaskRows) -> FloatArray:
    """(12 + outside,) what a unit of each asked-for row is worth, where not all can be had [-].

    The unit is 1 rad/s^2 or 1 m/s^2; of the two rows of the wrench 1 N m, which the program scales to the robot.
    """
    worth = np.full(LEGS + len(rows.outside), 0.01)
    worth[OUTPUTS] = worth[LENGTHS] = worth[FRI] = 1.0
    worth[COP], worth[PELVIS], worth[SWING], worth[FOOT] = 0.5, 0.3, 0.3, 0.3
    return worth
