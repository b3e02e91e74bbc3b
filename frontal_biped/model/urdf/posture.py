"""Find a posture at which the four roll axes are parallel to world X, the feet flat, the centre of mass over the soles.

Legs whose hip roll joint hangs below the hip pitch joint (g1, icub, human) have parallel axes at one sum of pelvis and
hip pitch only. The pitch joints of both legs move as mirror images; the pelvis and the torso may lean.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.model.urdf.legs import Legs
from frontal_biped.model.urdf.mirrored_joints import LIMIT_MARGIN, MirroredJoints

ALIGNED = 1e-5
"""Angle [rad] to which axes and feet must come; URDFs that print six digits allow no better."""

SEARCH_STEPS = 60

HELD = 1e-8
"""How far [rad] a joint that is kept may move during the search, which wants room between limits."""


@dataclass(frozen=True)
class Posture:
    """A posture in the sagittal plane.

    Attributes:
        base_rpy: roll, pitch, yaw of the root link [rad].
        angles: of the pitch joints [rad].
        axis_error: largest angle between a roll axis and X [rad].
        foot_error: largest pitch of a foot [rad].
        com_x: centre of mass ahead of the ankle roll joints [m].
        heel: end of the soles behind them [m]; None: unknown.
        toe: end of the soles ahead of them [m]; None: unknown.
    """

    base_rpy: tuple[float, float, float]
    angles: Mapping[str, float]
    axis_error: float
    foot_error: float
    com_x: float
    heel: float | None
    toe: float | None

    @property
    def aligned(self) -> bool:
        """Are the axes parallel and the feet flat?"""
        return max(self.axis_error, self.foot_error) <= ALIGNED * 10.0

    @property
    def balanced(self) -> bool:
        """Is the centre of mass over the soles; True where they are unknown."""
        return self.heel is None or self.toe is None or self.heel < self.com_x < self.toe


def find_posture(
    full: pin.Model,
    legs: Legs,
    roll_joints: Mapping[str, str],
    start: FloatArray,
    sole_x: tuple[float, float] | None = None,
    kept: Collection[str] = (),
) -> Posture:
    """The nearest posture with parallel roll axes, flat feet, and the centre of mass over the middle of the soles.

    Joints that are to be kept move only where nothing else puts feet flat, axes parallel and the robot in balance.

    Args:
        full: 3D model with a free-flyer root.
        legs: its legs.
        roll_joints: the four roll joints.
        start: (nq,) posture to stay close to; the root's rotation is replaced.
        sole_x: heel and toe, from the ankle roll joint [m]; None: unknown.
        kept: joints that stay at the start if they can; of a pair, if only one is named, the other follows it.
    """
    search = _Search(MirroredJoints(full, legs, roll_joints, start), sole_x, kept)
    best = search.solve()
    return search.posture(best)


class _Search:
    """Weighted least squares; alignment weighs so much that what remains of it is rounding."""

    def __init__(self, joints: MirroredJoints, sole_x: tuple[float, float] | None, kept: Collection[str]) -> None:
        self.joints, self.sole_x = joints, sole_x
        self.start, self.held = joints.followed(kept)

    def residual(self, x: FloatArray) -> FloatArray:
        q = self.joints.configuration(x)
        axes, turns = self.joints.alignment(q)
        lean = 0.0
        if self.sole_x is not None:
            heel, toe = self.sole_x
            quarter = 0.25 * (toe - heel)
            com = self.joints.com_x(q)
            lean = (com - np.clip(com, heel + quarter, toe - quarter)) / (toe - heel)
        stay = x[1:] - self.start[1:]
        return np.concatenate([1e4 * axes, 1e4 * turns, [3.0 * lean], x[:1], 0.05 * stay])

    def solve(self) -> FloatArray:
        low, high = self.joints.bounds()
        if self.held.any():
            held_low, held_high = low.copy(), high.copy()
            at = np.clip(self.start, low, high)[self.held]
            held_low[self.held], held_high[self.held] = at - HELD, at + HELD
            x, done = self._solve_upright_first(held_low, held_high)
            x[self.held] = at
            if done:
                return self._align(x, held_low, held_high)
        return self._solve_upright_first(low, high)[0]

    def _solve_upright_first(self, low: FloatArray, high: FloatArray) -> tuple[FloatArray, bool]:
        """A posture, and whether it is all that it should be."""
        upright_low, upright_high = low.copy(), high.copy()
        upright_low[0], upright_high[0] = -LIMIT_MARGIN, LIMIT_MARGIN
        x = self._solve_between(upright_low, upright_high)  # an upright pelvis, where it will do
        x[0] = 0.0
        x = self._align(x, upright_low, upright_high)
        if not self._good(x):
            x = self._solve_between(low, high)
        return x, self._good(x)

    def _good(self, x: FloatArray) -> bool:
        found = self.posture(x)
        return found.aligned and found.balanced

    def _solve_between(self, low: FloatArray, high: FloatArray) -> FloatArray:
        from scipy.optimize import least_squares

        x = np.clip(self.start, low + 1e-9, high - 1e-9)
        for _ in range(3):  # again from its own end: the weights are far apart
            found = least_squares(
                self.residual, x, bounds=(low, high), xtol=1e-15, ftol=1e-15, gtol=1e-15, max_nfev=SEARCH_STEPS
            )
            x = found.x
            x = np.clip(x, low + 1e-9, high - 1e-9)
        return self._align(x, low, high)

    def _align(self, x: FloatArray, low: FloatArray, high: FloatArray) -> FloatArray:
        """Gauss-Newton steps of least length on the alignment alone, away from the limits."""

        def error_of(x: FloatArray) -> FloatArray:
            return np.concatenate(self.joints.alignment(self.joints.configuration(x)))

        for _ in range(10):
            error = error_of(x)
            free = np.minimum(x - low, high - x) > 1.5 * LIMIT_MARGIN
            J = np.zeros((error.size, x.size))
            for i in np.flatnonzero(free):
                step = np.zeros(x.size)
                step[i] = 1e-6
                J[:, i] = (error_of(x + step) - error_of(x - step)) / 2e-6
            x = np.clip(x - np.linalg.lstsq(J, error, rcond=1e-6)[0], low, high)
        return x

    def posture(self, x: FloatArray) -> Posture:
        q = self.joints.configuration(x)
        axes, turns = self.joints.alignment(q)
        base = pin.rpy.matrixToRpy(pin.Quaternion(q[3:7]).matrix())
        axis_error, foot_error = (
            float(np.max(np.linalg.norm(part.reshape(-1, n), axis=1))) for part, n in ((axes, 2), (turns, 3))
        )
        heel, toe = self.sole_x or (None, None)
        roll, pitch, yaw = (float(angle) for angle in base)
        com_x = self.joints.com_x(q)
        return Posture((roll, pitch, yaw), self.joints.angles(q), axis_error, foot_error, com_x, heel, toe)
