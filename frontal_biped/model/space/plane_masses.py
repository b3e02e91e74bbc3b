r"""What the ground must hold while a robot in space moves in its frontal plane, in closed form.

With the four roll joints alone moving and the stance foot flat, every point of the robot keeps its x. The ground
reaction is then made of five integrals over its mass, (h, v) the place of dm, x its distance ahead of the stance ankle:

.. math::
    F_h &= \int \ddot h \,dm, & F_v &= \int (\ddot v + g) \,dm, & N_0 &= \int h (\ddot v + g) - v \ddot h \,dm, \\
    S_h &= \int x \ddot h \,dm, & S_v &= \int x (\ddot v + g) \,dm.

The first three are those of the planar model. The last two are all that the plane does not see: the forces of the same
motion, each mass weighted by its x. They complete the ground's wrench about the point below the ankle: there is no
force along x, the moment about the axis to the left is -S_v, and about the vertical S_h, positive from x towards h.

A body turned by theta_i about X carries its mass along as R(theta_i); so every integral but N_0 is a sum of five
constant vectors, each turned by one theta_i. Along a curve q(beta) all five are affine in (ddbeta, dbeta^2), as the
planar forces are (`zero_dynamics.restricted`).
"""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.chain import GRAVITY, UPRIGHT
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.urdf.description import ROLL_JOINTS
from frontal_biped.model.urdf.whole_model import ROOT

F_H, F_V, N_0, S_H, S_V = range(5)  # rows

BODIES = 5
"""Stance foot, stance leg, pelvis with all it carries, swing leg, swing foot."""

_ANGLES = np.triu(np.ones((BODIES, BODIES)), k=1)[:-1]
"""(4, 5) sums of the joint angles: absolute angles of the bodies; the stance foot's is zero."""


class PlaneDynamics(NamedTuple):
    """Inverse dynamics in space along a curve in the frontal plane: A ddbeta + B dbeta^2 + G.

    Rows F_h, F_v [N], N_0 [N m], S_h, S_v [N m]; see the module.

    Attributes:
        A: (5, n) coefficient of ddbeta.
        B: (5, n) coefficient of dbeta^2.
        G: (5, n) weight.
    """

    A: FloatArray
    B: FloatArray
    G: FloatArray

    def at(self, ddbeta: FloatArray, dbeta_squared: FloatArray) -> FloatArray:
        """(5, n) rows at ddbeta (n,) [rad/s^2] and dbeta^2 (n,) [rad^2/s^2]."""
        return self.A * ddbeta + self.B * dbeta_squared + self.G


@dataclass(frozen=True, eq=False)
class PlaneMasses:
    """A robot in space as a motion in its frontal plane feels it, standing on one foot; legs as the URDF has them.

    At the upright reference, in (h, v), origin on the ground below the stance ankle; bodies in the order of `BODIES`.

    Attributes:
        stance: the foot it stands on.
        joints: (4, 2) stance ankle, stance hip, swing hip, swing ankle [m].
        mass: (5,) [kg].
        com: (5, 2) centres of mass [m].
        inertia: (5,) about the centre of mass, out of the plane [kg m^2].
        depth: (5,) integral of x dm [kg m], x from the stance ankle.
        depth_moment: (5, 2) integral of x (h, v) dm [kg m^2].
        swing_ahead: x of the swing ankle [m].
    """

    stance: Stance
    joints: FloatArray
    mass: FloatArray
    com: FloatArray
    inertia: FloatArray
    depth: FloatArray
    depth_moment: FloatArray
    swing_ahead: float

    @classmethod
    def of(cls, biped: FrontalBiped, stance: Stance) -> "PlaneMasses":
        """Of the robot of a URDF, neither averaged nor perturbed; with virtual legs, each leg turns as one body."""
        model, data = biped.spatial_model, biped.spatial_model.createData()
        pin.forwardKinematics(model, data, biped.spatial_reference)
        order = ROLL_JOINTS if stance is Stance.LEFT else ROLL_JOINTS[::-1]
        joints = [model.getJointId(biped.description.joints[key]) for key in order]
        origin = data.oMi[joints[0]].translation - np.array([0.0, 0.0, biped.description.sole.ankle_height])
        from_ankle = pin.SE3(np.eye(3), -origin)
        to_plane = np.array([-stance.sign, 1.0])  # (h, v) of (y, z)
        places = np.array([data.oMi[joint].translation - origin for joint in joints])
        moved_by = [*joints[:2], model.getJointId(ROOT), *joints[2:]]
        bodies = [(from_ankle * data.oMi[joint]).act(model.inertias[joint]) for joint in moved_by]
        mass = np.array([body.mass for body in bodies])
        com = np.array([body.lever for body in bodies])
        products = np.array([body.inertia[0, 1:] for body in bodies])  # minus the integral of x (y, z) about the CoM
        return cls(
            stance=stance,
            joints=places[:, 1:] * to_plane,
            mass=mass,
            com=com[:, 1:] * to_plane,
            inertia=np.array([body.inertia[0, 0] for body in bodies]),
            depth=mass * com[:, 0],
            depth_moment=((mass * com[:, 0])[:, None] * com[:, 1:] - products) * to_plane,
            swing_ahead=float(places[-1, 0]),
        )

    def along(self, q: FloatArray, dq: FloatArray, ddq: FloatArray) -> PlaneDynamics:
        """Inverse dynamics along a curve in the frontal plane.

        Written with what arrays that carry derivatives can do; see `design.forward_mode`.

        Args:
            q: (n, 4) configurations [rad].
            dq: (n, 4) dq/dbeta [-].
            ddq: (n, 4) d2q/dbeta2 [1/rad].
        """
        theta, rate, second = (q - UPRIGHT) @ _ANGLES, dq @ _ANGLES, ddq @ _ANGLES
        cos, sin = np.cos(theta), np.sin(theta)
        squared = rate * rate
        com_h, com_v, _, _ = self._turned(cos, sin)
        height = com_v + self.joints[0, 1]

        def coefficient(dcos: FloatArray, dsin: FloatArray, spin: FloatArray) -> FloatArray:
            a_h, a_v, S_h, S_v = self._turned(dcos, dsin)
            moment = (com_h * a_v - height * a_h) @ self.mass + spin @ self.inertia
            return np.stack([a_h @ self.mass, a_v @ self.mass, moment, S_h, S_v])

        nothing = np.zeros_like(theta[:, 0])
        weight = [nothing, nothing + self.mass.sum(), com_h @ self.mass, nothing, nothing + self.depth.sum()]
        return PlaneDynamics(
            A=coefficient(-sin * rate, cos * rate, rate),
            B=coefficient(-sin * second - cos * squared, cos * second - sin * squared, second),
            G=GRAVITY * np.stack(weight),
        )

    def _turned(self, cos: FloatArray, sin: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """(n, 5) h and v of the centres of mass from the stance ankle, (n,) those of the integral of x dm."""
        H, V = self._levers
        h, v = self._depth_levers.T
        return cos @ H.T - sin @ V.T, sin @ H.T + cos @ V.T, cos @ h - sin @ v, sin @ h + cos @ v

    @cached_property
    def _levers(self) -> FloatArray:
        """(2, 5, 5) h and v of the vectors, one a body (last axis), that lead from the ankle to each centre of mass."""
        links = np.concatenate([np.zeros((1, 2)), np.diff(self.joints, axis=0), np.zeros((1, 2))])
        levers = np.tril(np.ones((BODIES, BODIES)), k=-1)[:, :, None] * links
        levers[np.arange(BODIES), np.arange(BODIES)] = self.com - self._inner
        return np.ascontiguousarray(levers.transpose(2, 0, 1))

    @cached_property
    def _depth_levers(self) -> FloatArray:
        """(5, 2) what each body, turned, adds to the integral of x (h, v) dm, from the stance ankle [kg m^2]."""
        own = self.depth_moment - self.depth[:, None] * self._inner
        beyond = np.append(np.cumsum(self.depth[::-1])[::-1][1:], 0.0)  # carried by the outer joint
        links = np.concatenate([np.zeros((1, 2)), np.diff(self.joints, axis=0), np.zeros((1, 2))])
        return own + beyond[:, None] * links

    @property
    def _inner(self) -> FloatArray:
        """(5, 2) the joint about which each body turns; of the stance foot its ankle."""
        return self.joints[[0, 0, 1, 2, 3]]
