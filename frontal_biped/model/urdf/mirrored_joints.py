"""Joints that move a robot in its sagittal plane: those of both legs, as mirror images, and the pitch of the torso."""

from collections.abc import Collection, Mapping

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from frontal_biped.arrays import FloatArray
from frontal_biped.model.urdf.legs import Legs

LIMIT_MARGIN = 1e-6  # [rad] that a joint keeps from its limits
MOST_LEAN = 0.6  # [rad] of the pelvis


class MirroredJoints:
    """Postures x = (lean of the pelvis, angles of a leg from the hip down, pitch of the torso) [rad].

    The torso's angle is there only where a joint for it is. Every other joint stays where it is at the start.

    Args:
        full: 3D model with a free-flyer root.
        legs: its legs.
        roll_joints: the four roll joints.
        start: (nq,) posture to start from; the root's rotation is replaced.
        all_joints: move every joint of a leg down to its ankle roll joint, not only those that pitch.
    """

    def __init__(
        self,
        full: pin.Model,
        legs: Legs,
        roll_joints: Mapping[str, str],
        start: FloatArray,
        all_joints: bool = False,
    ) -> None:
        self.full, self.legs = full, legs
        self.data = full.createData()
        self.start = start.copy()
        self.hips = [full.getJointId(roll_joints[f"{side}_hip"]) for side in ("left", "right")]
        self.ankles = [full.getJointId(roll_joints[f"{side}_ankle"]) for side in ("left", "right")]
        self.feet = [self._flat_foot(ankle) for ankle in self.ankles]
        last = legs.left.index(roll_joints["left_ankle"])  # beyond the ankle are toes
        moved = range(last + 1) if all_joints else [i for i in legs.pitch if i < last]
        self.pairs = [(full.getJointId(legs.left[i]), full.getJointId(legs.right[i])) for i in moved]
        self.signs = [float(np.sign(self._mirror_image(left) @ self.zero_axis(right))) for left, right in self.pairs]
        self.torso = self._torso_pitch()
        self.address = [full.joints[left].idx_q for left, _ in self.pairs]
        if self.torso is not None:
            self.address.append(full.joints[self.torso].idx_q)

    @property
    def at_start(self) -> FloatArray:
        """The posture x at the start, the pelvis upright."""
        return np.concatenate([[0.0], self.start[self.address]])

    def followed(self, names: Collection[str]) -> tuple[FloatArray, NDArray[np.bool_]]:
        """The posture x at the start, and which of its entries belong to joints with given names.

        Where only the right one of a pair is named, its angle at the start is taken for both.
        """
        x, named = self.at_start, np.zeros(self.at_start.size, dtype=bool)
        for i, ((left, right), sign) in enumerate(zip(self.pairs, self.signs, strict=True), start=1):
            is_left, is_right = (self.full.names[joint] in names for joint in (left, right))
            named[i] = is_left or is_right
            if is_right and not is_left:
                x[i] = sign * self.start[self.full.joints[right].idx_q]
        if self.torso is not None:
            named[-1] = self.full.names[self.torso] in names
        return x, named

    def configuration(self, x: FloatArray) -> FloatArray:
        """(nq,) configuration of a posture x."""
        q = self.start.copy()
        q[3:7] = pin.Quaternion(pin.rpy.rpyToMatrix(0.0, float(x[0]), 0.0) @ self.legs.upright).coeffs()
        for (left, right), sign, angle in zip(self.pairs, self.signs, x[1:], strict=False):
            q[self.full.joints[left].idx_q] = angle
            q[self.full.joints[right].idx_q] = sign * angle
        if self.torso is not None:
            q[self.full.joints[self.torso].idx_q] = x[-1]
        return q

    def alignment(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(8,) sines by which the roll axes leave X, and (6,) rotations by which the feet leave flat [rad]."""
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

    def bounds(self) -> tuple[FloatArray, FloatArray]:
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

    def angles(self, q: FloatArray) -> dict[str, float]:
        """Angles of the joints that move, at a configuration, by name [rad]."""
        joints = [joint for pair in self.pairs for joint in pair]
        if self.torso is not None:
            joints.append(self.torso)
        return {self.full.names[joint]: float(q[self.full.joints[joint].idx_q]) for joint in joints}

    def _range(self, joint: int) -> tuple[float, float]:
        address = self.full.joints[joint].idx_q
        return float(self.full.lowerPositionLimit[address]), float(self.full.upperPositionLimit[address])

    def _flat_foot(self, ankle: int) -> FloatArray:
        """A foot's rotation with all joints at zero and the root upright: flat, as URDFs are drawn."""
        q = pin.neutral(self.full)
        q[3:7] = pin.Quaternion(self.legs.upright).coeffs()
        pin.forwardKinematics(self.full, self.data, q)
        return self.data.oMi[ankle].rotation.copy()

    def zero_axis(self, joint: int) -> FloatArray:
        """World axis of a joint, all joints at zero and the root upright."""
        q = pin.neutral(self.full)
        q[3:7] = pin.Quaternion(self.legs.upright).coeffs()
        pin.computeJointJacobians(self.full, self.data, q)
        jacobian = pin.getJointJacobian(self.full, self.data, joint, pin.LOCAL_WORLD_ALIGNED)
        return jacobian[3:, self.full.joints[joint].idx_v].copy()

    def _mirror_image(self, left: int) -> FloatArray:
        """Axis whose positive turns mirror those of a left joint: a rotation vector keeps its y, x and z turn round."""
        return self.zero_axis(left) * [-1.0, 1.0, -1.0]

    def _torso_pitch(self) -> int | None:
        """The first pitch joint that carries at least a fifth of the mass and no leg."""
        full = self.full
        masses = [inertia.mass for inertia in full.inertias]
        for joint in range(2, full.njoints):
            carried = list(full.subtrees[joint])
            if any(ankle in carried for ankle in self.ankles) or full.joints[joint].nq != 1:
                continue
            if sum(masses[j] for j in carried) >= 0.2 * sum(masses) and abs(self.zero_axis(joint)[1]) > 1.0 - 1e-6:
                return joint
        return None
