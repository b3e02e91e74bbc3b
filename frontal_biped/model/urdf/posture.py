"""Find a posture at which the four roll axes are parallel to world X, the feet flat, the centre of mass over the soles.

Legs whose hip roll joint hangs below the hip pitch joint (g1, icub, human) have parallel axes at one sum of pelvis and
hip pitch only. The pitch joints of both legs move as mirror images; the pelvis and the torso may lean.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.model.urdf.legs import Legs

ALIGNED = 1e-5
"""Angle [rad] to which axes and feet must come; URDFs that print six digits allow no better."""

LIMIT_MARGIN = 1e-6  # [rad] that a joint keeps from its limits
MOST_LEAN = 0.6  # [rad] of the pelvis
SEARCH_STEPS = 60


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
) -> Posture:
    """The nearest posture with parallel roll axes, flat feet, and the centre of mass over the middle of the soles.

    Args:
        full: 3D model with a free-flyer root.
        legs: its legs.
        roll_joints: the four roll joints.
        start: (nq,) posture to stay close to; the root's rotation is replaced.
        sole_x: heel and toe, from the ankle roll joint [m]; None: unknown.
    """
    search = _Search(full, legs, roll_joints, start, sole_x)
    best = search.solve()
    return search.posture(best)


class _Search:
    """Weighted least squares; alignment weighs so much that what remains of it is rounding."""

    def __init__(
        self,
        full: pin.Model,
        legs: Legs,
        roll_joints: Mapping[str, str],
        start: FloatArray,
        sole_x: tuple[float, float] | None,
    ) -> None:
        self.full, self.legs, self.sole_x = full, legs, sole_x
        self.data = full.createData()
        self.start = start.copy()
        self.hips = [full.getJointId(roll_joints[f"{side}_hip"]) for side in ("left", "right")]
        self.ankles = [full.getJointId(roll_joints[f"{side}_ankle"]) for side in ("left", "right")]
        self.feet = [self._flat_foot(ankle) for ankle in self.ankles]
        last = legs.left.index(roll_joints["left_ankle"])
        pitch = [i for i in legs.pitch if i < last]  # beyond the ankle are toes
        self.pairs = [(full.getJointId(legs.left[i]), full.getJointId(legs.right[i])) for i in pitch]
        self.signs = [self._mirror_sign(left, right) for left, right in self.pairs]
        self.torso = self._torso_pitch()
        self.address = [full.joints[left].idx_q for left, _ in self.pairs]
        if self.torso is not None:
            self.address.append(full.joints[self.torso].idx_q)

    def configuration(self, x: FloatArray) -> FloatArray:
        """(nq,) for pelvis pitch, leg pitch angles and, where there is one, the torso's."""
        q = self.start.copy()
        q[3:7] = pin.Quaternion(pin.rpy.rpyToMatrix(0.0, float(x[0]), 0.0) @ self.legs.upright).coeffs()
        for (left, right), sign, angle in zip(self.pairs, self.signs, x[1:], strict=False):
            q[self.full.joints[left].idx_q] = angle
            q[self.full.joints[right].idx_q] = sign * angle
        if self.torso is not None:
            q[self.full.joints[self.torso].idx_q] = x[-1]
        return q

    def alignment(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Sines by which the roll axes leave X, and rotations by which the feet leave flat [rad]."""
        full, data = self.full, self.data
        pin.computeJointJacobians(full, data, q)
        axes = [
            pin.getJointJacobian(full, data, joint, pin.LOCAL_WORLD_ALIGNED)[4:, full.joints[joint].idx_v]
            for joint in (*self.hips, *self.ankles)
        ]
        turns = [pin.log3(data.oMi[a].rotation @ flat.T) for a, flat in zip(self.ankles, self.feet, strict=True)]
        return np.concatenate(axes), np.concatenate(turns)

    def com_x(self, q: FloatArray) -> float:
        """Centre of mass ahead of the ankles [m]."""
        com = pin.centerOfMass(self.full, self.data, q)[0]
        return float(com - np.mean([self.data.oMi[ankle].translation[0] for ankle in self.ankles]))

    def residual(self, x: FloatArray) -> FloatArray:
        q = self.configuration(x)
        axes, turns = self.alignment(q)
        lean = 0.0
        if self.sole_x is not None:
            heel, toe = self.sole_x
            quarter = 0.25 * (toe - heel)
            com = self.com_x(q)
            lean = (com - np.clip(com, heel + quarter, toe - quarter)) / (toe - heel)
        stay = x[1:] - self.start[self.address]
        return np.concatenate([1e4 * axes, 1e4 * turns, [3.0 * lean], x[:1], 0.05 * stay])

    def solve(self) -> FloatArray:
        low, high = self._bounds()
        upright_low, upright_high = low.copy(), high.copy()
        upright_low[0], upright_high[0] = -LIMIT_MARGIN, LIMIT_MARGIN
        x = self._solve_between(upright_low, upright_high)  # an upright pelvis, where it will do
        x[0] = 0.0
        x = self._align(x, upright_low, upright_high)
        found = self.posture(x)
        return x if found.aligned and found.balanced else self._solve_between(low, high)

    def _solve_between(self, low: FloatArray, high: FloatArray) -> FloatArray:
        from scipy.optimize import least_squares

        x = np.clip(np.concatenate([[0.0], self.start[self.address]]), low + 1e-9, high - 1e-9)
        for _ in range(3):  # again from its own end: the weights are far apart
            found = least_squares(
                self.residual, x, bounds=(low, high), xtol=1e-15, ftol=1e-15, gtol=1e-15, max_nfev=SEARCH_STEPS
            )
            x = found.x
            x = np.clip(x, low + 1e-9, high - 1e-9)
        return self._align(x, low, high)

    def _bounds(self) -> tuple[FloatArray, FloatArray]:
        """What every joint can do on both sides; a pair without a common range is held at the left one's start."""
        ranges = [(-MOST_LEAN, MOST_LEAN)]
        for (left, right), sign in zip(self.pairs, self.signs, strict=True):
            a, b = self._range(left), self._range(right)
            b = b if sign > 0.0 else (-b[1], -b[0])
            ranges.append((max(a[0], b[0]), min(a[1], b[1])))
        if self.torso is not None:
            ranges.append(self._range(self.torso))
        low, high = (np.array(ends) for ends in zip(*ranges, strict=True))
        low, high = low + LIMIT_MARGIN, high - LIMIT_MARGIN
        return low, np.maximum(high, low + LIMIT_MARGIN)

    def _range(self, joint: int) -> tuple[float, float]:
        address = self.full.joints[joint].idx_q
        return float(self.full.lowerPositionLimit[address]), float(self.full.upperPositionLimit[address])

    def _align(self, x: FloatArray, low: FloatArray, high: FloatArray) -> FloatArray:
        """Gauss-Newton steps of least length on the alignment alone, away from the limits."""
        for _ in range(10):
            error = np.concatenate(self.alignment(self.configuration(x)))
            free = np.minimum(x - low, high - x) > 1.5 * LIMIT_MARGIN
            J = np.zeros((error.size, x.size))
            for i in np.flatnonzero(free):
                step = np.zeros(x.size)
                step[i] = 1e-6
                ahead = np.concatenate(self.alignment(self.configuration(x + step)))
                behind = np.concatenate(self.alignment(self.configuration(x - step)))
                J[:, i] = (ahead - behind) / 2e-6
            x = np.clip(x - np.linalg.lstsq(J, error, rcond=1e-6)[0], low, high)
        return x

    def posture(self, x: FloatArray) -> Posture:
        q = self.configuration(x)
        axes, turns = self.alignment(q)
        base = pin.rpy.matrixToRpy(pin.Quaternion(q[3:7]).matrix())
        angles = {self.full.names[j]: float(q[self.full.joints[j].idx_q]) for pair in self.pairs for j in pair}
        if self.torso is not None:
            angles[self.full.names[self.torso]] = float(x[-1])
        axis_error, foot_error = (
            float(np.max(np.linalg.norm(part.reshape(-1, n), axis=1))) for part, n in ((axes, 2), (turns, 3))
        )
        heel, toe = self.sole_x or (None, None)
        roll, pitch, yaw = (float(angle) for angle in base)
        return Posture((roll, pitch, yaw), angles, axis_error, foot_error, self.com_x(q), heel, toe)

    def _flat_foot(self, ankle: int) -> FloatArray:
        """A foot's rotation with all joints at zero and the root upright: flat, as URDFs are drawn."""
        q = pin.neutral(self.full)
        q[3:7] = pin.Quaternion(self.legs.upright).coeffs()
        pin.forwardKinematics(self.full, self.data, q)
        return self.data.oMi[ankle].rotation.copy()

    def _zero_axis(self, joint: int) -> FloatArray:
        q = pin.neutral(self.full)
        q[3:7] = pin.Quaternion(self.legs.upright).coeffs()
        pin.computeJointJacobians(self.full, self.data, q)
        jacobian = pin.getJointJacobian(self.full, self.data, joint, pin.LOCAL_WORLD_ALIGNED)
        return jacobian[3:, self.full.joints[joint].idx_v].copy()

    def _mirror_sign(self, left: int, right: int) -> float:
        """+1 where equal angles are mirror images: a rotation vector keeps its y and loses the sign of x and z."""
        return float(np.sign(self._zero_axis(left) * [-1.0, 1.0, -1.0] @ self._zero_axis(right)))

    def _torso_pitch(self) -> int | None:
        """The first pitch joint that carries at least a fifth of the mass and no leg."""
        full = self.full
        masses = [inertia.mass for inertia in full.inertias]
        for joint in range(2, full.njoints):
            carried = list(full.subtrees[joint])
            if any(ankle in carried for ankle in self.ankles) or full.joints[joint].nq != 1:
                continue
            if sum(masses[j] for j in carried) >= 0.2 * sum(masses) and abs(self._zero_axis(joint)[1]) > 1.0 - 1e-6:
                return joint
        return None
