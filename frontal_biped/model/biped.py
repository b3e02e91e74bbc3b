"""The biped in stance coordinates: dynamics, centre of mass, ground reaction, FRI and soles, all from Pinocchio.

Pinned dynamics, stance foot flat and at rest ([O] eq. pinnedmodel):

    D(q) ddq + C(q, dq) dq + G(q) = u,    u = (u_1, u_b)

The floating model adds the three freedoms of the stance foot. Its inverse dynamics with the foot at rest returns
in one call the ground reaction (F_h, F_v), its moment N_0 about the ground point below the stance ankle, and u.
"""

from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import RobotError
from frontal_biped.files.shown import ShownAsPage
from frontal_biped.model.chain import GRAVITY, UPRIGHT
from frontal_biped.model.many_states import ManyStates
from frontal_biped.model.robot import Robot
from frontal_biped.model.urdf.reduction import FrontalReduction, reduce_to_frontal_plane

BASE = 3  # freedoms of the stance foot in the floating model


class Posture(NamedTuple):
    """Where the centre of mass and the swing sole are, in (h, v).

    Attributes:
        com_h: centre of mass, from the stance ankle [m].
        com_v: its height above the ground under the stance foot [m].
        inner_v: height of the inner end of the swing sole above that ground [m].
        outer_v: height of its outer end [m].
    """

    com_h: float
    com_v: float
    inner_v: float
    outer_v: float


class FrontalBiped(ShownAsPage):
    """A robot in its frontal plane, in stance coordinates q = (stance ankle, stance hip, swing hip, swing ankle).

    All angles in rad, frame (h, v): h horizontal from the stance foot towards the swing foot, v up, origin on the
    ground below the stance ankle. Instances own Pinocchio work data and are not thread-safe; what they return is the
    caller's own, for Pinocchio hands out copies.

    Args:
        robot: the whole robot of which this is the view from the front.
        reduction: its reduction to the plane, or that changed since; None: reduced here.
        fingerprint: of a changed reduction; None: the robot's.

    Raises:
        HypothesisError: the robot is no open chain of two mirrored legs with four actuated roll joints in the
            frontal plane (HR1 to HR5).
    """

    def __init__(self, robot: Robot, reduction: FrontalReduction | None = None, fingerprint: str | None = None) -> None:
        self._made_of = (robot, reduction, fingerprint)
        reduction = reduce_to_frontal_plane(robot) if reduction is None else reduction
        self.robot = robot
        self.reduction = reduction
        self.description = robot.description
        self.fingerprint = robot.fingerprint if fingerprint is None else fingerprint
        self.chain = reduction.chain
        self.stance_map = reduction.stance_map
        self.spatial_model = reduction.model
        self.spatial_reference = reduction.reference
        self.measured = reduction.measured
        self.asymmetry = reduction.asymmetry
        self.pinned = self.chain.pinned_model()
        self.floating = self.chain.floating_model()
        self._data = self.pinned.createData()
        self._floating_data = self.floating.createData()
        ends = [f"swing_sole_{end}" for end in ("inner", "outer")]
        self._sole_frames = [self.pinned.getFrameId(end) for end in ends]
        soles = [self.floating.frames[self.floating.getFrameId(end)] for end in ends]
        # views of Pinocchio's work data: reading them costs a tenth of asking for them
        self._sole_ends = [self._data.oMf[frame].translation for frame in self._sole_frames]
        swing_foot = self._floating_data.oMi[soles[0].parentJoint]
        self._swing_turn, self._swing_place = swing_foot.rotation, swing_foot.translation
        self._sole_in_foot = [tuple(sole.placement.translation[:2].tolist()) for sole in soles]
        self._q = np.zeros(self.floating.nv)
        self._dq = np.zeros(self.floating.nv)
        self._ddq = np.zeros(self.floating.nv)
        self._joints = self._q[BASE:]

    def __repr__(self) -> str:
        outer, inner = (1e3 * end for end in self.sole)
        return (
            f"{type(self).__name__} {self.name!r}: {self.mass:.1f} kg, legs {self.leg_length:.3g} m, hips"
            f" {self.hip_width:.3g} m apart, sole {outer:+.0f} to {inner:+.0f} mm from the ankle,\n  at most"
            f" {self.max_torque[0]:g} N m at the ankles, {self.max_torque[1]:g} N m at the hips; {self.path.name}"
        )

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle by what it is made of: a worker process builds its own Pinocchio data."""
        return FrontalBiped, self._made_of

    # ------------------------------------------------------------------ the same robot, changed
    def with_mass(self, mass: float | Mapping[str, float]) -> "FrontalBiped":
        """The robot with another total mass [kg], or other masses of links by URDF name [kg]: see `Robot.with_mass`.

        Raises:
            RobotError: as there, or this robot has errors of its own (`perturbed`).
            HypothesisError: the legs are no longer mirror images (HR3); change the links of both.
        """
        return FrontalBiped(self._as_read.with_mass(mass))

    def with_posture(self, posture: Mapping[str, float]) -> "FrontalBiped":
        """The robot locked at another posture, angles by URDF name [rad]: see `Robot.with_posture`.

        Raises:
            RobotError: as there, or this robot has errors of its own (`perturbed`).
            HypothesisError: there the robot is no frontal biped (HR1 to HR5); the message says what breaks.
        """
        return FrontalBiped(self._as_read.with_posture(posture))

    @property
    def _as_read(self) -> Robot:
        if self.fingerprint != self.robot.fingerprint:
            raise RobotError(f"{self.name}: has errors of its own (ModelErrors); change the robot they were put on")
        return self.robot

    # ------------------------------------------------------------------ parameters
    @property
    def name(self) -> str:
        """What the description calls the robot."""
        return self.description.name

    @property
    def path(self) -> Path:
        """The description file."""
        return self.description.path

    @property
    def mass(self) -> float:
        """Total mass, both feet included [kg]."""
        return self.chain.mass

    @property
    def weight(self) -> float:
        """M g [N]."""
        return self.mass * GRAVITY

    @property
    def ankle_height(self) -> float:
        """Height of the ankles above the soles, h_a [m]."""
        return self.chain.ankle_height

    @property
    def sole(self) -> tuple[float, float]:
        """Ends of the stance sole on the h axis, (outer < 0, inner > 0) [m]."""
        return -self.chain.sole_outer, self.chain.sole_inner

    @property
    def max_torque(self) -> FloatArray:
        """(4,) torque limits [N m]."""
        return self.chain.max_torque

    @property
    def joint_lower(self) -> FloatArray:
        """(4,) lowest q every joint may take, whichever foot stands [rad]; -inf where the URDF has no limit."""
        return np.maximum(self.chain.lower, self.chain.lower[::-1])

    @property
    def joint_upper(self) -> FloatArray:
        """(4,) highest q every joint may take, whichever foot stands [rad]; inf where the URDF has no limit."""
        return np.minimum(self.chain.upper, self.chain.upper[::-1])

    @property
    def joint_max_velocity(self) -> FloatArray:
        """(4,) largest |dq| of every joint, whichever foot stands [rad/s]; inf where the URDF has no limit."""
        return np.minimum(self.chain.max_velocity, self.chain.max_velocity[::-1])

    @property
    def leg_length(self) -> float:
        """Distance from hip to ankle [m]."""
        return float(np.linalg.norm(self.chain.joints[1] - self.chain.joints[0]))

    @property
    def hip_width(self) -> float:
        """Distance between the hips [m]."""
        return float(np.linalg.norm(self.chain.joints[2] - self.chain.joints[1]))

    # ------------------------------------------------------------------ pinned dynamics
    @cached_property
    def many(self) -> ManyStates:
        """The same dynamics at many states in one call."""
        return ManyStates(self.pinned, self.planar_base)

    @cached_property
    def planar_base(self) -> pin.Model:
        """The floating model with its foot on one joint (`FrontalChain.planar_base_model`): cheaper where it rests."""
        return self.chain.planar_base_model()

    def D(self, q: FloatArray) -> FloatArray:
        """(4, 4) mass matrix [kg m^2]."""
        return pin.crba(self.pinned, self._data, q)

    def C(self, q: FloatArray, dq: FloatArray) -> FloatArray:
        """(4, 4) Coriolis matrix with dD/dt - 2 C skew [kg m^2/s]."""
        return pin.computeCoriolisMatrix(self.pinned, self._data, q, dq)

    def G(self, q: FloatArray) -> FloatArray:
        """(4,) gravity torques [N m]."""
        return pin.computeGeneralizedGravity(self.pinned, self._data, q)

    def bias(self, q: FloatArray, dq: FloatArray) -> FloatArray:
        """(4,) C(q, dq) dq + G(q) [N m]."""
        return pin.nonLinearEffects(self.pinned, self._data, q, dq)

    def forward_dynamics(self, q: FloatArray, dq: FloatArray, u: FloatArray) -> FloatArray:
        """(4,) ddq [rad/s^2] under the torques u (4,) [N m], stance foot held."""
        return pin.aba(self.pinned, self._data, q, dq, u)

    def inverse_dynamics(self, q: FloatArray, dq: FloatArray, ddq: FloatArray) -> FloatArray:
        """(7,) rows F_h, F_v [N], N_0 [N m], u_1..u_4 [N m] of a motion with the stance foot at rest.

        N_0 is the moment of the ground reaction about the ground point below the stance ankle.
        """
        self._q[BASE:], self._dq[BASE:], self._ddq[BASE:] = q, dq, ddq
        return pin.rnea(self.floating, self._floating_data, self._q, self._dq, self._ddq)

    def momentum_map(self, q: FloatArray) -> FloatArray:
        """(7, 4) matrix from dq to m dp_cm_h, m dp_cm_v, sigma_0 and the joint momenta."""
        self._q[BASE:] = q
        return pin.crba(self.floating, self._floating_data, self._q)[:, BASE:].copy()

    def floating_mass_matrix(self, q: FloatArray) -> FloatArray:
        """(7, 7) mass matrix with the stance foot free."""
        self._q[BASE:] = q
        return pin.crba(self.floating, self._floating_data, self._q)

    def energy(self, q: FloatArray, dq: FloatArray) -> float:
        """Kinetic plus potential energy, the stance foot's constant share included [J]."""
        self._q[BASE:], self._dq[BASE:] = q, dq
        return float(pin.computeMechanicalEnergy(self.floating, self._floating_data, self._q, self._dq))

    # ------------------------------------------------------------------ centre of mass and momentum
    def com(self, q: FloatArray) -> FloatArray:
        """(2,) centre of mass of the whole robot in (h, v) [m]."""
        self._q[BASE:] = q
        return pin.centerOfMass(self.floating, self._floating_data, self._q)[:2]

    def com_velocity(self, q: FloatArray, dq: FloatArray) -> FloatArray:
        """(2,) velocity of the centre of mass [m/s]."""
        return (self.momentum_map(q)[:2] @ dq) / self.mass

    def sigma(self, q: FloatArray, dq: FloatArray, p: float = 0.0) -> float:
        """Angular momentum about the ground point (p, 0), counter-clockwise positive [kg m^2/s].

        Of the bodies only: reflected rotor inertia does not enter.
        """
        momentum = self.momentum_map(q)[:3] @ dq
        return float(momentum[2] - p * momentum[1])

    # ------------------------------------------------------------------ ground reaction and FRI
    def ground_reaction(self, q: FloatArray, dq: FloatArray, ddq: FloatArray) -> FloatArray:
        """(2,) force of the ground on the stance foot, F = m (a_cm + (0, g)) [N]."""
        return self.inverse_dynamics(q, dq, ddq)[:2]

    def fri(self, q: FloatArray, dq: FloatArray, ddq: FloatArray) -> float:
        """Foot rotation indicator p_FRI of a motion: where the ground reaction acts, from the ankle [m]."""
        _, F_v, N_0 = self.inverse_dynamics(q, dq, ddq)[:3]
        return float(N_0 / F_v)

    def fri_from_torque(self, u_1: float, force: FloatArray, ddq_1: float = 0.0) -> float:
        """FRI [m] of an ankle torque u_1 [N m] under a ground reaction (2,) [N].

        Equilibrium of the resting foot about the ankle, h_a above the sole, foot's centre of mass at offset c_f:
        u_1 - armature ddq_1 = p_FRI F_v + h_a F_h - m_f g c_f.

        Args:
            u_1: ankle torque.
            force: ground reaction.
            ddq_1: stance ankle acceleration [rad/s^2]; matters only with a reflected rotor inertia.
        """
        joint_moment = u_1 - self.chain.armature[0] * ddq_1
        return float((joint_moment - self.ankle_height * force[0] + self._foot_weight_moment) / force[1])

    def torque_from_fri(self, p_fri: float, force: FloatArray, ddq_1: float = 0.0) -> float:
        """Ankle torque u_1 [N m] that puts the FRI at p_fri [m]; inverse of `fri_from_torque`."""
        joint_moment = p_fri * force[1] + self.ankle_height * force[0] - self._foot_weight_moment
        return float(joint_moment + self.chain.armature[0] * ddq_1)

    @property
    def _foot_weight_moment(self) -> float:
        foot = self.chain.bodies[0]
        return foot.mass * GRAVITY * float(foot.com[0])

    # ------------------------------------------------------------------ soles and posture
    def swing_sole(self, q: FloatArray) -> FloatArray:
        """(2, 2) inner and outer end of the swing sole in (h, v) [m]."""
        pin.framesForwardKinematics(self.pinned, self._data, q)
        return np.array([end[:2] for end in self._sole_ends])

    def swing_clearance(self, q: FloatArray) -> float:
        """Height of the lowest point of the swing sole above the ground under the stance foot [m]."""
        pin.framesForwardKinematics(self.pinned, self._data, q)
        inner, outer = self._sole_ends
        return min(inner.item(1), outer.item(1))

    def posture(self, q: FloatArray) -> Posture:
        """What tells events apart, from one pass over the kinematics."""
        self._joints[:] = q
        com = pin.centerOfMass(self.floating, self._floating_data, self._q)
        sin, cos, height = self._swing_turn.item(3), self._swing_turn.item(4), self._swing_place.item(1)
        (inner_x, inner_y), (outer_x, outer_y) = self._sole_in_foot
        inner, outer = height + sin * inner_x + cos * inner_y, height + sin * outer_x + cos * outer_y
        return Posture(com.item(0), com.item(1), inner, outer)

    def swing_sole_heights(self, q: FloatArray) -> FloatArray:
        """(2, n) heights of the inner and the outer end of the swing sole at q (n, 4) [m]."""
        inner, outer = (self._data.oMf[frame].translation for frame in self._sole_frames)  # views of Pinocchio's data
        heights = np.empty((2, len(q)))
        for i, at in enumerate(q):
            pin.framesForwardKinematics(self.pinned, self._data, at)
            heights[0, i], heights[1, i] = inner[1], outer[1]
        return heights

    def swing_sole_jacobian(self, q: FloatArray) -> FloatArray:
        """(2, 2, 4) derivative of `swing_sole` with respect to q: [end, (h, v), joint] [m/rad]."""
        pin.computeJointJacobians(self.pinned, self._data, q)
        pin.updateFramePlacements(self.pinned, self._data)
        frames = self._sole_frames
        return np.array([pin.getFrameJacobian(self.pinned, self._data, f, pin.LOCAL_WORLD_ALIGNED)[:2] for f in frames])

    def joint_positions(self, q: FloatArray) -> FloatArray:
        """(4, 2) stance ankle, stance hip, swing hip, swing ankle in (h, v) [m]."""
        pin.forwardKinematics(self.pinned, self._data, q)
        return np.array([self._data.oMi[joint].translation[:2] for joint in range(1, 5)])

    @staticmethod
    def pelvis_roll(q: FloatArray) -> FloatArray:
        """Absolute rotation of the pelvis from the reference, counter-clockwise in (h, v) [rad]; q (..., 4)."""
        return q[..., 0] + q[..., 1] - 2.0 * UPRIGHT

    @staticmethod
    def swing_foot_rotation(q: FloatArray) -> FloatArray:
        """Absolute rotation of the swing foot, zero when flat [rad]; q (..., 4)."""
        return q[..., 0] + q[..., 1] + q[..., 2] + q[..., 3] - 4.0 * UPRIGHT
