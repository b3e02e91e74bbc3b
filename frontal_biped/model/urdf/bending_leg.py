"""A leg of six joints that bends: how far its knee is from straight, and its joints for a place of the flat foot."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import RobotError
from frontal_biped.model.urdf.mirrored_joints import MirroredJoints

LEG = slice(1, 7)
"""Of a posture x of `MirroredJoints`: the six joints of the leg."""

PLACE = 0.005  # [m] between the places of a foot that are tried on its way
SOLVED = 1e-11  # [m], [rad]
NEWTON_STEPS = 30
LONGEST_STEP = 0.3  # [rad] of a joint in one of them


Equations = Callable[[FloatArray], tuple[FloatArray, FloatArray]]
"""Six errors of six angles, and their (6, 6) derivatives."""


class Margins(NamedTuple):
    """Distances [rad] that a leg keeps.

    Attributes:
        straight: angle between thigh and shank; at 0 the leg cannot follow any motion.
        limits: of its joints from their limits.
    """

    straight: float
    limits: float


class BendingLeg:
    """The left leg; the right one is its mirror image.

    The joint that pitches most among those with their origin in the middle of the leg is its knee, and the hip and the
    ankle are where the joints above and below it pitch most, whatever their order and tilt.

    Args:
        joints: of both legs, all of them.

    Attributes:
        pitch: hip, knee and ankle pitch joint.
        straight: angle of the knee joint [rad] at which the leg is straight.
        sense: +1 where the knee bends towards larger flexions, -1 where it has more room to bend backwards.

    Raises:
        RobotError: a leg has not six joints with limits, or none of them is a knee.
    """

    def __init__(self, joints: MirroredJoints) -> None:
        self.joints, self.full, self.data = joints, joints.full, joints.data
        self.margins = Margins(0.0, 0.0)
        names = ", ".join(self.full.names[left] for left, _ in joints.pairs)
        if len(joints.pairs) != 6 or any(self.full.joints[joint].nq != 1 for pair in joints.pairs for joint in pair):
            below = ", ".join(self.full.names[joint] for joint in self.full.children[joints.ankles[0]])
            order = f"; here {below} moves below the ankle roll joint, which in space is the last" if below else ""
            raise RobotError(
                f"{self.full.name}: {len(joints.pairs)} joints down to the ankle roll joint, {names}; a leg that bends"
                f" and keeps its foot flat has six, all with limits{order}"
            )
        self.pitch = self._pitch_joints(names)
        self._knee = 1 + [left for left, _ in joints.pairs].index(self.pitch[1])
        x = joints.at_start
        x[self._knee] = 0.0
        sign = float(np.sign(joints.zero_axis(self.pitch[1])[1]))
        self.straight = -sign * self.flexion(x)
        low, high = (bound[self._knee] for bound in joints.bounds())
        self.sense = sign if high - self.straight > self.straight - low else -sign

    def flexion(self, x: FloatArray) -> float:
        """Turn from thigh to shank about +Y [rad]: positive for knees that point forward."""
        pin.forwardKinematics(self.full, self.data, self.joints.configuration(x))
        thigh, shank = self._bones()
        return float(np.arctan2(thigh[0] * shank[1] - thigh[1] * shank[0], thigh @ shank))

    def pose(self, start: FloatArray, flexion: float, ankle_y: float, com_x: float) -> FloatArray | None:
        """A posture x whose feet are flat and whose centre of mass is above a place; None: the limits are in the way.

        Args:
            start: posture x near which it is looked for; its lean and its torso are kept.
            flexion: angle between thigh and shank, in the leg's own sense [rad].
            ankle_y: where the left ankle roll joint is, across [m].
            com_x: centre of mass ahead of the ankles [m].
        """

        def equations(x: FloatArray) -> tuple[FloatArray, FloatArray]:
            turn, turn_rows, place, place_rows = self._foot(x)
            com = pin.jacobianCenterOfMass(self.full, self.data, self.joints.configuration(x))
            thigh, shank = self._bones()
            bent = np.arctan2(thigh[0] * shank[1] - thigh[1] * shank[0], thigh @ shank)
            error = np.array([*turn, place[1] - ankle_y, self.data.com[0][0] - place[0] - com_x, bent])
            error[5] -= self.sense * flexion
            com_row = self._columns(com[:1], mirrored=True)[0] - place_rows[0]
            return error, np.vstack([turn_rows, place_rows[1], com_row, self._flexion_row()])

        return self._within(self._solved(equations, start))

    def reach(self, x: FloatArray, ahead: float) -> FloatArray | None:
        """The posture x with the flat foot moved forwards [m], at the same height; None: limits, or straight."""
        pin.forwardKinematics(self.full, self.data, self.joints.configuration(x))
        wanted = self.ankle + np.array([ahead, 0.0, 0.0])

        def equations(x: FloatArray) -> tuple[FloatArray, FloatArray]:
            turn, turn_rows, place, place_rows = self._foot(x)
            return np.concatenate([turn, place - wanted]), np.vstack([turn_rows, place_rows])

        moved = self._within(self._solved(equations, x))
        if moved is None or self.sense * self.flexion(moved) < self.margins.straight:
            return None
        return moved

    def farthest(self, x: FloatArray, ahead: float) -> float:
        """How far the foot gets on its way forwards [m], up to a place; in either sense, as a positive distance."""
        wanted, done = abs(ahead), 0.0
        if self.reach(x, ahead) is not None:
            return wanted
        place = float(np.copysign(PLACE, ahead))
        while done + PLACE < wanted:  # where the whole way is too far: in small steps
            moved = self.reach(x, place)
            if moved is None:
                break
            x, done = moved, done + PLACE
        return done

    def with_both_feet_flat(self, x: FloatArray) -> FloatArray:
        """(nq,) configuration of a posture, the right foot flat too where the legs are mirrored only nearly."""
        full, data, joints = self.full, self.data, self.joints
        q = joints.configuration(x)
        pin.forwardKinematics(full, data, q)
        left, right = (data.oMi[ankle].translation.copy() for ankle in joints.ankles)
        wanted = np.array([left[0], right[1], left[2]])
        chain = [full.joints[joint] for _, joint in joints.pairs]
        places, columns = [joint.idx_q for joint in chain], [joint.idx_v for joint in chain]

        def equations(angles: FloatArray) -> tuple[FloatArray, FloatArray]:
            q[places] = angles
            pin.computeJointJacobians(full, data, q)
            foot = joints.ankles[1]
            turned = data.oMi[foot].rotation @ joints.feet[1].T
            J = pin.getJointJacobian(full, data, foot, pin.LOCAL_WORLD_ALIGNED)[:, columns]
            error = np.concatenate([pin.log3(turned), data.oMi[foot].translation - wanted])
            return error, np.vstack([pin.Jlog3(turned) @ turned.T @ J[3:], J[:3]])

        mirrored = q[places].copy()
        angles = _newton(equations, mirrored)
        q[places] = mirrored if angles is None else angles
        return q

    @property
    def ankle(self) -> FloatArray:
        """(3,) origin of the left ankle roll joint, at the last posture looked at [m]."""
        return np.array(self.data.oMi[self.joints.ankles[0]].translation)

    def guess(self, flexion: float) -> FloatArray:
        """A posture x near one with that flexion [rad]: hip and ankle turn back half of it each."""
        x = self.joints.at_start
        places = [left for left, _ in self.joints.pairs]
        for joint, share in zip(self.pitch, (-0.5, 1.0, -0.5), strict=True):
            sign = float(np.sign(self.joints.zero_axis(joint)[1]))
            x[1 + places.index(joint)] = share * sign * self.sense * flexion
        x[self._knee] += self.straight
        return x

    # ------------------------------------------------------------------ rows of Newton's method
    def _foot(self, x: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Turn of the left foot from flat and place of its ankle, each with its rows over the leg's joints."""
        pin.computeJointJacobians(self.full, self.data, self.joints.configuration(x))
        foot = self.joints.ankles[0]
        turned = self.data.oMi[foot].rotation @ self.joints.feet[0].T
        J = self._columns(pin.getJointJacobian(self.full, self.data, foot, pin.LOCAL_WORLD_ALIGNED))
        return pin.log3(turned), pin.Jlog3(turned) @ turned.T @ J[3:], self.ankle, J[:3]

    def _flexion_row(self) -> FloatArray:
        """Of the angle between thigh and shank; Jacobians are computed."""
        rows = [
            self._columns(pin.getJointJacobian(self.full, self.data, joint, pin.LOCAL_WORLD_ALIGNED))[[2, 0]]
            for joint in self.pitch
        ]
        row = np.zeros(6)
        for sign, bone, moved in zip((-1.0, 1.0), self._bones(), (rows[1] - rows[0], rows[2] - rows[1]), strict=True):
            row += sign * (bone[0] * moved[1] - bone[1] * moved[0]) / (bone @ bone)
        return row

    def _columns(self, J: FloatArray, mirrored: bool = False) -> FloatArray:
        """Columns of the left leg's joints; with those of the right one, which moves as its mirror image."""
        joints, full = self.joints, self.full
        columns = J[:, [full.joints[left].idx_v for left, _ in joints.pairs]]
        if not mirrored:
            return columns
        right = J[:, [full.joints[right].idx_v for _, right in joints.pairs]]
        return columns + right * np.array(joints.signs)

    def _bones(self) -> tuple[FloatArray, FloatArray]:
        """(z, x) from hip to knee and from knee to ankle, in which a turn about +Y is counter-clockwise [m]."""
        hip, knee, ankle = (self.data.oMi[joint].translation[[2, 0]] for joint in self.pitch)
        return knee - hip, ankle - knee

    def _solved(self, equations: Equations, start: FloatArray) -> FloatArray | None:
        """The posture x with the leg's joints where equations of x are zero."""

        def of_leg(angles: FloatArray) -> tuple[FloatArray, FloatArray]:
            x[LEG] = angles
            return equations(x)

        x = start.copy()
        angles = _newton(of_leg, start[LEG])
        if angles is None:
            return None
        x[LEG] = angles
        return x

    def _within(self, x: FloatArray | None) -> FloatArray | None:
        low, high = self.joints.bounds()
        margin = self.margins.limits
        return x if x is not None and np.all((low + margin <= x)[LEG] & (x <= high - margin)[LEG]) else None

    def _pitch_joints(self, names: str) -> tuple[int, int, int]:
        joints = [left for left, _ in self.joints.pairs]
        pitches = [abs(float(self.joints.zero_axis(joint)[1])) for joint in joints]
        heights = [float(self.data.oMi[joint].translation[2]) for joint in joints]
        middle = [i for i in range(1, 5) if 0.2 < (heights[i] - heights[-1]) / (heights[0] - heights[-1]) < 0.8]
        if not middle or max(pitches[i] for i in middle) < np.cos(np.radians(60.0)):
            raise RobotError(f"{self.full.name}: of {names} none is a knee: half-way down, and turning about Y")
        knee = max(middle, key=lambda i: pitches[i])
        hip = max(range(knee), key=lambda i: pitches[i])
        ankle = max(range(knee + 1, 6), key=lambda i: pitches[i])
        return joints[hip], joints[knee], joints[ankle]


def _newton(equations: Equations, start: FloatArray) -> FloatArray | None:
    """A zero near a start; None where there is none."""
    angles = start.copy()
    for _ in range(NEWTON_STEPS):
        error, J = equations(angles)
        if float(np.max(np.abs(error))) < SOLVED:
            return angles
        try:
            step = np.linalg.solve(J, error)
        except np.linalg.LinAlgError:
            return None
        angles -= np.clip(step, -LONGEST_STEP, LONGEST_STEP)
        if not np.all(np.isfinite(angles)):
            return None
    return None
