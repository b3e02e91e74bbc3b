"""Find a posture for walking in space: knees bent so far that the feet can be a step apart.

A leg that walks keeps its length as seen from the front while its foot passes from ahead of the hip to behind it, so it
is longest, and its knee straightest, at the ends of the step. The pelvis is upright, the feet are flat, and the centre
of mass is above the middle of what soles and ankles can hold. Of all such postures the least bent is taken, for bent
knees cost torque. Robots whose knees or ankles do not allow the step get the posture with the longest one they allow.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import RobotError
from frontal_biped.model.chain import GRAVITY
from frontal_biped.model.urdf.bending_leg import BendingLeg, Margins
from frontal_biped.model.urdf.legs import Legs
from frontal_biped.model.urdf.mirrored_joints import MirroredJoints

MARGINS = (Margins(0.15, 0.04), Margins(0.05, 0.01))
"""What is asked for; the second where nothing else is possible."""

MOST_BENT = 1.4  # [rad] between thigh and shank, of the posture
TORQUE_SHARE = 0.5
"""Of the torque limit of the ankle's pitch joint, used up where the centre of mass is held farthest from it."""

TORSO_SHARE = 0.3
"""Of the torque limit of the torso's pitch joint, beyond which the torso is balanced above it; it may lean so far."""

QUARTER = 0.25  # of the sole, at either end, that is left to the control of the walk
BEND = 0.03  # [rad] between the knee angles that are tried
UNLIMITED = 1e6  # [N m] of torque, for joints without a limit


@dataclass(frozen=True)
class BentPosture:
    """A posture to walk from.

    Attributes:
        base_rpy: roll, pitch, yaw of the root link [rad].
        angles: of the legs' joints and of the torso's pitch joint [rad].
        flexion: angle between thigh and shank [rad].
        leg_length: between the origins of hip and ankle roll joint, seen from the front [m].
        step_length: distance of the feet in x up to which the legs keep it [m]; at most what was asked for.
        axis_error: largest angle between a roll axis and X [rad].
        com_x: centre of mass ahead of the ankle roll joints [m].
        torques: static torque of each pitch joint over its limit, standing on the left foot [-].
    """

    base_rpy: tuple[float, float, float]
    angles: Mapping[str, float]
    flexion: float
    leg_length: float
    step_length: float
    axis_error: float
    com_x: float
    torques: Mapping[str, float]


def find_bent_posture(
    full: pin.Model,
    legs: Legs,
    roll_joints: Mapping[str, str],
    start: FloatArray,
    step_length: float,
    sole_x: tuple[float, float] | None = None,
) -> BentPosture:
    """The least bent posture that leaves room for a step, or for as much of it as the joints' limits allow.

    Args:
        full: 3D model with a free-flyer root.
        legs: its legs, each with six joints from hip to ankle roll.
        roll_joints: the four roll joints.
        start: (nq,) posture of every other joint; the root's rotation is replaced.
        step_length: distance of the feet in x [m].
        sole_x: heel and toe, from the ankle roll joint [m]; None: unknown.

    Raises:
        RobotError: the legs have not six joints each, none of them is a knee, or no posture keeps their limits.
    """
    leg = BendingLeg(MirroredJoints(full, legs, roll_joints, start, all_joints=True))
    bender = _Bender(leg, step_length, sole_x)
    for margins in MARGINS:
        found = bender.find(margins)
        if found is not None:
            return found
    raise RobotError(
        f"{full.name}: no bend of the knees puts flat feet below the centre of mass within the limits of"
        f" {', '.join(full.names[joint] for joint in leg.pitch)} on both sides; widen them in the URDF"
    )


def room_for_steps(
    full: pin.Model, legs: Legs, roll_joints: Mapping[str, str], posture: FloatArray, step_length: float
) -> float:
    """Distance of the feet in x up to which the legs keep the length they have at a posture [m].

    Args:
        full: 3D model with a free-flyer root.
        legs: its legs, each with six joints from hip to ankle roll.
        roll_joints: the four roll joints.
        posture: (nq,) with an upright pelvis.
        step_length: up to which it is tried [m].

    Raises:
        RobotError: the legs have not six joints each, or none of them is a knee.
    """
    leg = BendingLeg(MirroredJoints(full, legs, roll_joints, posture, all_joints=True))
    leg.margins = MARGINS[0]
    x = leg.joints.at_start
    if leg.sense * leg.flexion(x) < leg.margins.straight:
        return 0.0
    return 2.0 * min(leg.farthest(x, sense * 0.5 * step_length) for sense in (1.0, -1.0))


class _Bender:
    """Tries knee angles from nearly straight on, and centres of mass from the best place on."""

    def __init__(self, leg: BendingLeg, step_length: float, sole_x: tuple[float, float] | None) -> None:
        self.leg, self.joints, self.step_length, self.sole_x = leg, leg.joints, step_length, sole_x
        self.full, self.data = leg.full, leg.data

    def find(self, margins: Margins) -> BentPosture | None:
        """The first posture that leaves room for the step, else that with most room; None: no posture at all."""
        leg = self.leg
        leg.margins = margins
        leg.flexion(self.joints.at_start)
        ankle_y = float(leg.ankle[1])
        best: tuple[float, float, FloatArray] | None = None
        for torso in self._torso_angles():
            for com_x in self._places():
                start, reached = leg.guess(margins.straight), False
                for flexion in np.arange(margins.straight, MOST_BENT, BEND):
                    start[7:] = torso
                    x = leg.pose(start, flexion, ankle_y, com_x)
                    if x is None:
                        if reached:
                            break  # at the end of the joints' ranges
                        start = leg.guess(flexion + BEND)
                        continue
                    start, reached = x.copy(), True
                    room = 2.0 * min(leg.farthest(x, sense * 0.5 * self.step_length) for sense in (1.0, -1.0))
                    if room >= self.step_length:
                        return self._posture(room, x)
                    if best is None or (room, flexion) > best[:2]:
                        best = room, float(flexion), x
        return None if best is None else self._posture(best[0], best[2])

    # ------------------------------------------------------------------ what is wanted
    def _places(self) -> FloatArray:
        """Where the centre of mass may be ahead of the ankles [m], the best first."""
        torque = min(self._effort(joint) for joint in (self.leg.pitch[2], self._right_of(self.leg.pitch[2])))
        reach = TORQUE_SHARE * torque / (pin.computeTotalMass(self.full) * GRAVITY)
        low, high = -reach, reach
        if self.sole_x is not None:
            heel, toe = self.sole_x
            margin = QUARTER * (toe - heel)
            low, high = max(low, heel + margin), min(high, toe - margin)
        middle = 0.5 * (low + high)
        return middle + 0.5 * max(high - low, 0.0) * np.array([0.0, -0.5, 0.5, -1.0, 1.0])

    def _torso_angles(self) -> list[FloatArray]:
        """As at the start, or, where its joint can hardly hold that: balanced above the joint, and leaning a little."""
        torso, x = self.joints.torso, self.joints.at_start
        if torso is None or abs(self._torques(x)[self.full.names[torso]]) <= TORSO_SHARE:
            return [x[7:]]
        pin.centerOfMass(self.full, self.data, self.joints.configuration(x))
        pin.computeSubtreeMasses(self.full, self.data)
        lever = self.data.oMi[torso].act(self.data.com[torso]) - self.data.oMi[torso].translation
        sense = float(np.sign(self.joints.zero_axis(torso)[1]))
        balanced = x[7:] - sense * np.arctan2(lever[0], lever[2])
        length = max(float(np.hypot(lever[0], lever[2])), 1e-3)
        lean = sense * TORSO_SHARE * self._effort(torso) / (self.data.mass[torso] * GRAVITY * length)
        low, high = self.joints.bounds()
        return [np.clip(balanced + share * lean, low[7:], high[7:]) for share in (0.0, 0.5, -0.5, 1.0, -1.0)]

    def _right_of(self, left: int) -> int:
        return next(right for joint, right in self.joints.pairs if joint == left)

    def _effort(self, joint: int) -> float:
        """A joint's torque limit [N m]; a large one where the URDF has none."""
        limit = float(self.full.effortLimit[self.full.joints[joint].idx_v])
        return limit if 0.0 < limit < UNLIMITED else UNLIMITED

    # ------------------------------------------------------------------ what was found
    def _torques(self, x: FloatArray) -> dict[str, float]:
        """Torques of the pitch joints over their limits, all weight on the left sole below the centre of mass."""
        full, data, joints = self.full, self.data, self.joints
        q = joints.configuration(x)
        gravity = pin.computeGeneralizedGravity(full, data, q).copy()
        com = pin.centerOfMass(full, data, q).copy()
        pin.computeJointJacobians(full, data, q)
        ankle = joints.ankles[0]
        J = pin.getJointJacobian(full, data, ankle, pin.LOCAL_WORLD_ALIGNED)
        weight = pin.computeTotalMass(full) * GRAVITY
        lever = com[0] - data.oMi[ankle].translation[0]
        torque = gravity - J.T @ np.array([0.0, 0.0, weight, 0.0, -lever * weight, 0.0])
        held = [*self.leg.pitch] if joints.torso is None else [*self.leg.pitch, joints.torso]
        return {full.names[joint]: float(torque[full.joints[joint].idx_v] / self._effort(joint)) for joint in held}

    def _posture(self, room: float, x: FloatArray) -> BentPosture:
        q = self.leg.with_both_feet_flat(x)
        axes, _ = self.joints.alignment(q)
        data = self.data
        lengths = [
            float(np.linalg.norm((data.oMi[hip].translation - data.oMi[ankle].translation)[1:]))
            for hip, ankle in zip(self.joints.hips, self.joints.ankles, strict=True)
        ]
        roll, pitch, yaw = (float(angle) for angle in pin.rpy.matrixToRpy(pin.Quaternion(q[3:7]).matrix()))
        sines = np.linalg.norm(axes.reshape(-1, 2), axis=1)
        return BentPosture(
            base_rpy=(roll, pitch, yaw),
            angles=self.joints.angles(q),
            flexion=abs(self.leg.flexion(x)),
            leg_length=float(np.mean(lengths)),
            step_length=room,
            axis_error=float(np.arcsin(min(float(np.max(sines)), 1.0))),
            com_x=self.joints.com_x(q),
            torques=self._torques(x),
        )
