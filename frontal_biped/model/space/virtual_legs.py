r"""The frontal plane seen in the free robot: virtual legs.

Look at each leg from the front. From a point fixed in the pelvis, the hip roll centre at the posture, to the ankle
roll centre runs

.. math:: r = (r_y, r_z), \qquad \varphi = \mathrm{atan2}(r_y, -r_z) - \varphi_0, \qquad l = |r|,

phi counted about +X from the posture. The planar robot's roll joints are phi_leg - phi_pelvis and phi_foot - phi_leg,
so that its stance coordinates are functions of the configuration in space, whatever the order and the axes of the real
joints. While both lengths are the posture's, pelvis and feet do not pitch or yaw and the feet are flat in roll too
where the plane has them so, every (y, z) is the planar robot's, however far the feet are apart in x: x is not in it.

All in the *heading frame*: at the world's origin, turned about Z to where the robot is to walk.
"""

from dataclasses import dataclass
from math import asin, atan2, cos, sin, sqrt

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.model.chain import UPRIGHT
from frontal_biped.model.space.free_robot import BASE, FreeRobot
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.sway import Sway

ROLL, PITCH, YAW = range(3)
X, Y, Z = range(3)
LINEAR, ANGULAR = slice(0, 3), slice(3, 6)
ANGLE, LENGTH = range(2)


@dataclass
class Turning:
    """Roll, pitch and yaw (R = R_z R_y R_x) of a body in the heading frame.

    Attributes:
        angles: (3,) roll, pitch, yaw [rad].
        rates: (3,) [rad/s].
        J: (3, nv) Jacobian of the angles.
        drift: (3,) acceleration of the angles where the robot does not accelerate [rad/s^2].
    """

    angles: FloatArray
    rates: FloatArray
    J: FloatArray
    drift: FloatArray


@dataclass
class Foot:
    """A sole in the heading frame.

    Attributes:
        position: (3,) of the origin of the sole's frame, below the ankle [m].
        rotation: (3, 3) of the sole's frame.
        velocity: (6,) linear [m/s] and angular [rad/s].
        J: (6, nv) its Jacobian.
        drift: (6,) its acceleration where the robot does not accelerate [m/s^2, rad/s^2].
        turning: of the sole.
    """

    position: FloatArray
    rotation: FloatArray
    velocity: FloatArray
    J: FloatArray
    drift: FloatArray
    turning: Turning


@dataclass
class VirtualLeg:
    """Angle and length of a leg seen from the front.

    Attributes:
        values: (2,) angle about +X from the posture [rad], length [m].
        rates: (2,) [rad/s, m/s].
        J: (2, nv) Jacobian.
        drift: (2,) acceleration where the robot does not accelerate [rad/s^2, m/s^2].
    """

    values: FloatArray
    rates: FloatArray
    J: FloatArray
    drift: FloatArray


@dataclass
class FrontalCoordinates:
    """The planar robot's stance coordinates of a state in space.

    Attributes:
        q: (4,) [rad].
        dq: (4,) [rad/s].
        J: (4, nv) Jacobian.
        drift: (4,) acceleration where the robot does not accelerate [rad/s^2].
    """

    q: FloatArray
    dq: FloatArray
    J: FloatArray
    drift: FloatArray


class SpaceState:
    """A free robot at one state: what a controller and a theorem need of it.

    Owns Pinocchio's work data and its arrays, which are written anew by every `at`; not thread-safe.

    Args:
        free: the robot.

    Attributes:
        heading: of the heading frame about Z [rad].
        q: (nq,) configuration.
        v: (nv,) velocity.
        M: (nv, nv) mass matrix, rotor inertia included.
        bias: (nv,) Coriolis, centrifugal and gravity terms.
        com: (3,) centre of mass [m].
        com_velocity: (3,) [m/s].
        pelvis: its roll, pitch and yaw.
        feet: the left and the right sole.
        legs: the left and the right virtual leg.
        lengths: of the legs at the posture, l* [m].
    """

    def __init__(self, free: FreeRobot) -> None:
        self.free = free
        model = free.model
        self._data = data = model.createData()
        self._still = np.zeros(model.nv)
        pin.framesForwardKinematics(model, data, free.posture)
        root = data.oMi[1].copy()
        self._upright = root.rotation.T.copy()  # of the pelvis as the plane sees it, in the root link
        self._hip: dict[Stance, FloatArray] = {}
        self._ankle: dict[Stance, FloatArray] = {}
        self._angle: dict[Stance, float] = {}
        self.lengths: dict[Stance, float] = {}
        joints = free.robot.description.joints
        for side, sole in zip((Stance.LEFT, Stance.RIGHT), free.soles, strict=True):
            hip = data.oMi[model.getJointId(joints[f"{side.value}_hip"])].translation
            ankle = data.oMi[model.getJointId(sole.joint)].translation
            self._hip[side] = root.rotation.T @ (hip - root.translation)
            self._ankle[side] = data.oMf[free.sole_frame(side)].actInv(ankle)
            r = ankle - hip
            self._angle[side] = float(np.arctan2(r[Y], -r[Z]))
            self.lengths[side] = float(np.hypot(r[Y], r[Z]))
        self._frontal: dict[Stance, FrontalCoordinates] = {}
        self._corners = dict(zip((Stance.LEFT, Stance.RIGHT), (sole.corners for sole in free.soles), strict=True))

        # What moves: root link, left sole, right sole; linear then angular. Everything else is rows times that.
        self._moved_J = np.zeros((18, model.nv))
        self._moved_v, self._moved_a = np.zeros(18), np.zeros(18)
        self._rows = np.zeros((SEEN, 18))
        self._values, self._rates, self._drift = np.zeros(SEEN), np.zeros(SEEN), np.zeros(SEEN)
        self._J = np.zeros((SEEN, model.nv))
        self.pelvis = Turning(*self._seen(PELVIS))
        self.feet: dict[Stance, Foot] = {}
        self.legs: dict[Stance, VirtualLeg] = {}
        for side in Stance:
            moved, turning = _MOVED[side], Turning(*self._seen(_FOOT[side]))
            self.feet[side] = Foot(
                np.zeros(3), np.eye(3), self._moved_v[moved], self._moved_J[moved], self._moved_a[moved], turning
            )
            self.legs[side] = VirtualLeg(*self._seen(_LEG[side]))
        self.at(free.posture, self._still)

    def _seen(self, which: slice) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        return self._values[which], self._rates[which], self._J[which], self._drift[which]

    def at(self, q: FloatArray, v: FloatArray, heading: float = 0.0) -> "SpaceState":
        """Evaluate at a state; returns itself.

        Args:
            q: (nq,) configuration.
            v: (nv,) velocity.
            heading: of the heading frame about Z [rad].
        """
        model, data = self.free.model, self._data
        self.q, self.v, self.heading = q, v, heading
        self.M = pin.crba(model, data, q, pin.Convention.WORLD)
        self.bias = pin.nonLinearEffects(model, data, q, v)
        pin.centerOfMass(model, data, q, v, self._still, False)  # with the kinematics of all joints
        self._turn = turn = _about_z(heading)
        self.com, self.com_velocity = turn @ data.com[0], turn @ data.vcom[0]
        self._com_drift = turn @ data.acom[0]

        root = data.oMi[1]
        self._R = R = turn @ root.rotation
        position = turn @ root.translation
        J, moved_v, moved_a = self._moved_J, self._moved_v, self._moved_a
        # the free-flyer's velocity is in its own axes, R (dv + omega x v) its classical acceleration
        J[0:3, 0:3] = J[3:6, 3:6] = R
        moved_a[0:3] = R @ _cross(v[3:6].tolist(), v[0:3].tolist())
        for side in Stance:
            foot, frame, moved = self.feet[side], self.free.sole_frame(side), _MOVED[side]
            placement = pin.updateFramePlacement(model, data, frame)
            foot.position[:] = turn @ placement.translation
            foot.rotation[:] = turn @ placement.rotation
            J[moved] = pin.getFrameJacobian(model, data, frame, pin.LOCAL_WORLD_ALIGNED)
            moved_a[moved] = pin.getFrameClassicalAcceleration(model, data, frame, pin.LOCAL_WORLD_ALIGNED).vector
            if heading:
                for three in (slice(moved.start, moved.start + 3), slice(moved.start + 3, moved.stop)):
                    J[three] = turn @ J[three]
                    moved_a[three] = turn @ moved_a[three]
        np.dot(J, v, out=moved_v)

        omega = moved_v[3:6].tolist()
        self._turned(PELVIS, 0, (R @ self._upright).tolist(), omega)
        for side in Stance:
            foot, moved = self.feet[side], _MOVED[side]
            self._turned(_FOOT[side], moved.start, foot.rotation.tolist(), moved_v[moved].tolist()[3:])
            self._leg(side, foot, R, position, omega)
        self._frontal.clear()
        np.dot(self._rows, J, out=self._J)
        np.dot(self._rows, moved_v, out=self._rates)
        self._drift += self._rows @ moved_a
        return self

    def _turned(self, seen: slice, moved: int, R: list[list[float]], omega: list[float]) -> None:
        """Roll, pitch and yaw of R = R_z R_y R_x: their rows, values, and what of their drift is none of the body's."""
        roll, yaw = atan2(R[2][1], R[2][2]), atan2(R[1][0], R[0][0])
        sin_pitch = min(max(-R[2][0], -1.0), 1.0)
        pitch = asin(sin_pitch)
        c, s, cos_pitch = cos(yaw), sin(yaw), sqrt(max(1.0 - sin_pitch**2, 1e-12))
        tan_pitch = sin_pitch / cos_pitch
        x, y, z = omega
        # omega = yaw' e_z + pitch' R_z e_y + roll' R_z R_y e_x, solved for the rates
        self._rows[seen, moved + 3 : moved + 6] = (
            (c / cos_pitch, s / cos_pitch, 0.0),
            (-s, c, 0.0),
            (c * tan_pitch, s * tan_pitch, 1.0),
        )
        along, across = c * x + s * y, -s * x + c * y
        d_pitch, d_yaw = across, z + tan_pitch * along
        # at a fixed omega ``along`` grows as yaw' ``across``, and ``across`` as -yaw' ``along``
        self._values[seen] = roll, pitch, yaw
        self._drift[seen] = (
            d_yaw * across / cos_pitch + along * tan_pitch / cos_pitch * d_pitch,
            -d_yaw * along,
            d_yaw * across * tan_pitch + along * d_pitch / cos_pitch**2,
        )

    def _leg(self, side: Stance, foot: Foot, R: FloatArray, position: FloatArray, omega: list[float]) -> None:
        """Angle and length of a virtual leg: as `_turned`."""
        to_ankle, to_hip = (foot.rotation @ self._ankle[side]).tolist(), (R @ self._hip[side]).tolist()
        omega_foot = foot.velocity.tolist()[3:]
        at_foot, at_root = foot.position.tolist(), position.tolist()
        r_y = at_foot[Y] + to_ankle[Y] - at_root[Y] - to_hip[Y]
        r_z = at_foot[Z] + to_ankle[Z] - at_root[Z] - to_hip[Z]
        length = sqrt(r_y**2 + r_z**2)
        seen, moved = _LEG[side], _MOVED[side].start
        # rate of r = v_foot + omega_foot x to_ankle - v_root - omega x to_hip, then polar coordinates
        to_polar = ((-r_z / length**2, r_y / length**2), (r_y / length, r_z / length))
        rows = self._rows[seen]
        x, y, z = to_ankle
        rows[:, moved : moved + 6] = [(0.0, a, b, b * y - a * z, -b * x, a * x) for a, b in to_polar]
        x, y, z = to_hip
        rows[:, 0:6] = [(0.0, -a, -b, a * z - b * y, b * x, -a * x) for a, b in to_polar]
        _, foot_y, foot_z = _cross(omega_foot, _cross(omega_foot, to_ankle))
        _, hip_y, hip_z = _cross(omega, _cross(omega, to_hip))
        self._drift[seen] = [a * (foot_y - hip_y) + b * (foot_z - hip_z) for a, b in to_polar]
        turned, stretched = (rows @ self._moved_v).tolist()
        self._drift[seen.start + ANGLE] -= 2.0 * stretched * turned / length
        self._drift[seen.start + LENGTH] += length * turned**2
        self._values[seen] = atan2(r_y, -r_z) - self._angle[side], length

    def frontal(self, stance: Stance) -> FrontalCoordinates:
        """The planar robot's stance coordinates, for a foot taken as the stance foot, which is taken to stand flat.

        Args:
            stance: the stance foot.
        """
        found = self._frontal.get(stance)
        if found is None:
            S = _FRONTAL[stance]
            found = FrontalCoordinates(UPRIGHT + S @ self._values, S @ self._rates, S @ self._J, S @ self._drift)
            self._frontal[stance] = found
        return found

    def sway(self, stance: Stance) -> Sway:
        """The sway, for a foot taken as the stance foot.

        Args:
            stance: the stance foot.
        """
        inwards = -stance.sign
        ahead = self.com[Y] - self.feet[stance].position[Y]
        # the free-flyer's rows of M are the momentum in the root link's axes
        J = (inwards / float(self._data.mass[0])) * (self._R[Y] @ self.M[LINEAR])
        return Sway(
            inwards * float(ahead), inwards * float(self.com_velocity[Y]), J, inwards * float(self._com_drift[Y])
        )

    @property
    def com_rows(self) -> tuple[FloatArray, FloatArray]:
        """(3, nv) Jacobian of the centre of mass, and (3,) its acceleration where the robot does not accelerate."""
        # the free-flyer's rows of M are the momentum in the root link's axes
        return (self._R @ self.M[LINEAR]) / float(self._data.mass[0]), self._com_drift

    def clearance(self, side: Stance) -> float:
        """Height of the lowest corner of a foot's sole above z = 0 [m]."""
        foot = self.feet[side]
        return float(foot.position[Z] + (self._corners[side] @ foot.rotation[Z]).min())

    def to_world(self, vector: FloatArray) -> FloatArray:
        """A vector (3,) of the heading frame in the world."""
        turned: FloatArray = self._turn.T @ vector
        return turned


PELVIS = slice(0, 3)
_FOOT = {Stance.LEFT: slice(3, 6), Stance.RIGHT: slice(6, 9)}
_LEG = {Stance.LEFT: slice(9, 11), Stance.RIGHT: slice(11, 13)}
SEEN = 13
"""What is seen of a state: roll, pitch, yaw of the pelvis and both feet, angle and length of both legs."""

_MOVED = {Stance.LEFT: slice(6, 12), Stance.RIGHT: slice(12, 18)}


def _frontal_rows(stance: Stance) -> FloatArray:
    """(4, 13) stance coordinates from what is seen."""
    S = np.zeros((4, SEEN))
    leg, swing = _LEG[stance].start + ANGLE, _LEG[stance.other].start + ANGLE
    pelvis, foot = PELVIS.start + ROLL, _FOOT[stance.other].start + ROLL
    S[0, leg] = -1.0
    S[1, [leg, pelvis]] = 1.0, -1.0
    S[2, [swing, pelvis]] = -1.0, 1.0
    S[3, [swing, foot]] = 1.0, -1.0
    return stance.sign * S


_FRONTAL = {stance: _frontal_rows(stance) for stance in Stance}


def resting_base(state: SpaceState, stance: Stance) -> FloatArray:
    """(6,) velocity of the base, in its own axes, at which the stance foot is at rest under the joint rates of a state.

    Args:
        state: evaluated; of its velocity only the joint rates count.
        stance: the foot at rest.
    """
    J = state.feet[stance].J
    return np.asarray(np.linalg.solve(J[:, :BASE], -J[:, BASE:] @ state.v[BASE:]), dtype=np.float64)


def _about_z(angle: float) -> FloatArray:
    """Coordinates in a frame turned about Z by an angle [rad]."""
    c, s = cos(angle), sin(angle)
    return np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])


def _cross(a: list[float], b: list[float]) -> list[float]:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
