"""Find a posture for walking in space: knees bent so far that the feet can be a step apart.

A leg that walks keeps its length as seen from the front while its foot passes from ahead of the hip to behind it, so it
is longest, and its knee straightest, at the ends of the step. The pelvis is upright, the feet are flat, and the centre
of mass is above the middle of what soles and ankles can hold. Of all such postures the least bent is taken, for bent
knees cost torque. Robots whose knees or ankles do not allow the step get the posture with the longest one they allow.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import RobotError
from frontal_biped.model.chain import GRAVITY
from frontal_biped.model.urdf.legs import Legs
from frontal_biped.model.urdf.sagittal_joints import SagittalJoints


class Margins(NamedTuple):
    """Distances [rad] that the legs keep at the posture and all along a step.

    Attributes:
        straight: angle between thigh and shank; at 0 the leg cannot follow any motion.
        limits: of the pitch joints from their limits.
    """

    straight: float
    limits: float


MARGINS = (Margins(0.15, 0.04), Margins(0.05, 0.01))
"""What is asked for; the second where nothing else is possible."""

MOST_BENT = 1.4  # [rad] between thigh and shank, of the posture
TORQUE_SHARE = 0.5
"""Of the torque limit of the ankle's pitch joint, used up where the centre of mass is held farthest from it."""

TORSO_SHARE = 0.3
"""Of the torque limit of the torso's pitch joint, beyond which the torso is balanced above it; it may lean so far."""

QUARTER = 0.25  # of the sole, at either end, that is left to the control of the walk
PLACE = 0.005  # [m] between the places of a foot at which a leg is tried
BEND = 0.03  # [rad] between the knee angles that are tried
UNLIMITED = 1e6  # [N m] of torque, for joints without a limit
SOLVED = 1e-11  # [m], [rad]
NEWTON_STEPS = 30


@dataclass(frozen=True)
class BentPosture:
    """A posture to walk from.

    Attributes:
        base_rpy: roll, pitch, yaw of the root link [rad].
        angles: of the pitch joints [rad].
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
        legs: its legs, each with three pitch joints from hip to ankle.
        roll_joints: the four roll joints.
        start: (nq,) posture of every other joint; the root's rotation is replaced.
        step_length: distance of the feet in x [m].
        sole_x: heel and toe, from the ankle roll joint [m]; None: unknown.

    Raises:
        RobotError: the legs have not three pitch joints each, or no bend of the knees leaves them any room.
    """
    joints = SagittalJoints(full, legs, roll_joints, start)
    if len(joints.pairs) != 3:
        raise RobotError(
            f"{full.name}: {len(joints.pairs)} joints of {', '.join(legs.left)} pitch, down to the ankle; a leg that"
            " bends has three of them: hip, knee, ankle"
        )
    bender = _Bender(joints, step_length, sole_x)
    for margins in MARGINS:
        found = bender.find(margins)
        if found is not None:
            return found
    raise RobotError(
        f"{full.name}: no bend of the knees puts flat feet below the centre of mass within the limits of"
        f" {', '.join(full.names[joint] for joint in bender.pitch)} on both sides; widen them in the URDF"
    )


class _Bender:
    """Tries knee angles from nearly straight on, and centres of mass from the best place on."""

    def __init__(self, joints: SagittalJoints, step_length: float, sole_x: tuple[float, float] | None) -> None:
        self.joints, self.step_length, self.sole_x = joints, step_length, sole_x
        self.full, self.data = joints.full, joints.data
        self.pitch = [left for left, _ in joints.pairs]  # hip, knee, ankle
        self.margins = MARGINS[0]
        self.x = joints.at_start

    def find(self, margins: Margins) -> BentPosture | None:
        """The first posture that leaves room for the step, else that with most room; None: no posture at all."""
        self.margins = margins
        best: tuple[float, float, FloatArray] | None = None
        for torso in self._torso_angles():
            self.x = self.joints.at_start
            self.x[4:] = torso
            straight, sense = self._knee()
            for com_x in self._places():
                reached = False
                for flexion in np.arange(margins.straight, MOST_BENT, BEND):
                    x = self._pose(straight + sense * flexion, com_x)
                    if x is None:
                        if reached:
                            break  # at the end of the joints' ranges
                        continue
                    reached = True
                    room = self._room(x)
                    if room >= self.step_length:
                        return self._posture(room, x)
                    if best is None or (room, flexion) > best[:2]:
                        best = room, float(flexion), x
        return None if best is None else self._posture(best[0], best[2])

    # ------------------------------------------------------------------ what is wanted
    def _places(self) -> FloatArray:
        """Where the centre of mass may be ahead of the ankles [m], the best first."""
        torque = min(self._effort(joint) for joint in self.joints.pairs[2])
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
            return [x[4:]]
        pin.centerOfMass(self.full, self.data, self.joints.configuration(x))
        pin.computeSubtreeMasses(self.full, self.data)
        lever = self.data.oMi[torso].act(self.data.com[torso]) - self.data.oMi[torso].translation
        sense = float(np.sign(self._axis(torso, x)[1]))
        balanced = x[4:] - sense * np.arctan2(lever[0], lever[2])
        length = max(float(np.hypot(lever[0], lever[2])), 1e-3)
        lean = sense * TORSO_SHARE * self._effort(torso) / (self.data.mass[torso] * GRAVITY * length)
        low, high = self.joints.bounds()
        return [np.clip(balanced + share * lean, low[4:], high[4:]) for share in (0.0, 0.5, -0.5, 1.0, -1.0)]

    def _effort(self, joint: int) -> float:
        """A joint's torque limit [N m]; a large one where the URDF has none."""
        limit = float(self.full.effortLimit[self.full.joints[joint].idx_v])
        return limit if 0.0 < limit < UNLIMITED else UNLIMITED

    # ------------------------------------------------------------------ legs in the sagittal plane
    def _knee(self) -> tuple[float, float]:
        """Angle of the knee joint at which the leg is straight, and the sense in which it has more room to bend."""
        x = self.x.copy()
        x[2] = 0.0
        straight = -self._axis(self.pitch[1], x)[1] * self._signed_flexion(x)
        low, high = self.joints.bounds()
        sense = 1.0 if high[2] - straight > straight - low[2] else -1.0
        return straight, sense

    def _signed_flexion(self, x: FloatArray) -> float:
        """Turn from thigh to shank about +Y [rad]: positive for knees that point forward."""
        pin.forwardKinematics(self.full, self.data, self.joints.configuration(x))
        hip, knee, ankle = (self.data.oMi[joint].translation[[2, 0]] for joint in self.pitch)  # a turn about +Y: z to x
        thigh, shank = knee - hip, ankle - knee
        return float(np.arctan2(thigh[0] * shank[1] - thigh[1] * shank[0], thigh @ shank))

    def _pose(self, knee: float, com_x: float) -> FloatArray | None:
        """Hip and ankle for a knee: feet flat, centre of mass at a place; None where the limits are in the way."""
        x = self.x.copy()
        x[2] = knee
        x[[1, 3]] = -0.5 * knee, -0.5 * knee  # legs whose pitch axes agree; Newton's method mends the others

        def error(x: FloatArray) -> FloatArray:
            q = self.joints.configuration(x)
            return np.array([self._foot_pitch(q), self.joints.com_x(q) - com_x])

        return self._within(_newton(error, x, [1, 3]))

    def _room(self, x: FloatArray) -> float:
        """Distance of the feet up to which both legs keep the posture's length [m]; at most what is asked for."""
        return 2.0 * min(self._reach(x, 1.0), self._reach(x, -1.0))

    def _reach(self, x: FloatArray, sense: float) -> float:
        """How far a flat foot gets ahead of (+1) or behind (-1) its place at the same height [m]."""
        pin.forwardKinematics(self.full, self.data, self.joints.configuration(x))
        home = self.data.oMi[self.joints.ankles[0]].translation[[0, 2]].copy()
        half, done = 0.5 * self.step_length, 0.0
        place = half  # the whole way at once, and only where that fails in small steps
        while done < half:
            further = min(done + place, half)
            wanted = home + np.array([sense * further, 0.0])

            def error(x: FloatArray, wanted: FloatArray = wanted) -> FloatArray:
                pitch = self._foot_pitch(self.joints.configuration(x))
                return np.array([pitch, *(self.data.oMi[self.joints.ankles[0]].translation[[0, 2]] - wanted)])

            moved = self._within(_newton(error, x, [1, 2, 3]))
            if moved is None or abs(self._signed_flexion(moved)) < self.margins.straight:
                if place == PLACE:
                    break
                place = PLACE
                continue
            x, done = moved, further
        return done

    def _within(self, x: FloatArray | None) -> FloatArray | None:
        low, high = self.joints.bounds()
        margin = self.margins.limits
        return x if x is not None and np.all((low + margin <= x)[1:4] & (x <= high - margin)[1:4]) else None

    def _foot_pitch(self, q: FloatArray) -> float:
        pin.forwardKinematics(self.full, self.data, q)
        return float(pin.log3(self.data.oMi[self.joints.ankles[0]].rotation @ self.joints.feet[0].T)[1])

    def _axis(self, joint: int, x: FloatArray) -> FloatArray:
        full, data = self.full, self.data
        pin.computeJointJacobians(full, data, self.joints.configuration(x))
        jacobian = pin.getJointJacobian(full, data, joint, pin.LOCAL_WORLD_ALIGNED)
        return np.array(jacobian[3:, full.joints[joint].idx_v])

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
        held = self.pitch if joints.torso is None else [*self.pitch, joints.torso]
        return {full.names[joint]: float(torque[full.joints[joint].idx_v] / self._effort(joint)) for joint in held}

    def _posture(self, room: float, x: FloatArray) -> BentPosture:
        q = self.joints.configuration(x)
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
            flexion=abs(self._signed_flexion(x)),
            leg_length=float(np.mean(lengths)),
            step_length=room,
            axis_error=float(np.arcsin(min(float(np.max(sines)), 1.0))),
            com_x=self.joints.com_x(q),
            torques=self._torques(x),
        )


def _newton(error: Callable[[FloatArray], FloatArray], x: FloatArray, free: list[int]) -> FloatArray | None:
    """A zero of as many errors as there are free entries, near x; None where there is none."""
    x = x.copy()
    for _ in range(NEWTON_STEPS):
        e = error(x)
        if float(np.max(np.abs(e))) < SOLVED:
            return x
        J = np.empty((e.size, len(free)))
        for column, i in enumerate(free):
            ahead, behind = x.copy(), x.copy()
            ahead[i] += 1e-6
            behind[i] -= 1e-6
            J[:, column] = (error(ahead) - error(behind)) / 2e-6
        try:
            step = np.linalg.solve(J, e)
        except np.linalg.LinAlgError:
            return None
        x[free] -= np.clip(step, -0.3, 0.3)
        if not np.all(np.isfinite(x)):
            return None
    return None
