r"""Dynamics along the double-support family: one freedom, seven equations, ten unknowns.

With both feet at rest inverse dynamics gives the total that the ground does, about the ground point below the stance
ankle, and what the joints would take were it all on the stance foot. The swing foot's wrench W_2 = (F_2h, F_2v, N_2),
about the ground point below the swing ankle, goes off both:

.. math:: W_1 = (A \ddot\beta + B \dot\beta^2 + G)_{F, N} - X W_2, \qquad
          u   = (A \ddot\beta + B \dot\beta^2 + G)_{u} - J^T W_2,

X moving a wrench by the width, J the Jacobian of that point and of the foot's rotation. Four numbers, ddbeta and W_2,
are free: the motion along the family is *chosen*. What bounds it is linear in them: neither foot is pulled
(F_v >= 0), each stays in its friction cone and its centre of pressure inside its sole, torques keep their limits. The
least and the greatest ddbeta at a given beta and dbeta^2 are two small linear programs.

The torques alone fix everything: along the family q' J^T = 0, so

.. math:: \ddot\beta = (q' \cdot u - q' \cdot (B \dot\beta^2 + G)_u) / (q' \cdot A_u),

and four rows determine the three of W_2. That is what a simulator needs.

Where all of the weight is on one foot the total acts inside its sole: the ordinary zero dynamics of single support at
that FRI. A double support is a phase whose FRI crosses from one sole to the other.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.optimize import linprog

from frontal_biped.arrays import FloatArray
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.chain import JOINTS
from frontal_biped.virtual_constraints.double_support import DoubleSupportFamily, FamilyPoint
from frontal_biped.virtual_constraints.phase import ConstrainedMotion
from frontal_biped.zero_dynamics.restricted import F_H, F_V, N_0, TORQUES, project_dynamics

WRENCH = 3
"""Components of what the ground does to a foot: F_h, F_v [N] and a moment about the point below its ankle [N m]."""

CONTACT_ROWS = 5
"""Inequalities of one foot: it is not pulled, two sides of the friction cone, two ends of the sole."""


@dataclass(frozen=True)
class SupportLimits:
    """What both soles and the motors carry.

    Attributes:
        friction: coefficient of friction [-].
        margin: distance of the centres of pressure from the ends of the soles [m].
        max_torque: (4,) [N m].
    """

    friction: float
    margin: float
    max_torque: FloatArray


class SupportForces(NamedTuple):
    """What acts at one instant of double support.

    Attributes:
        stance: (3,) F_h, F_v [N] and moment about the ground point below the stance ankle [N m].
        swing: (3,) the same of the other foot, about the point below its own ankle, in the same frame.
        u: (4,) torques [N m].
    """

    stance: FloatArray
    swing: FloatArray
    u: FloatArray


class SupportRows(NamedTuple):
    """Inequalities C x >= c of x = (ddbeta, F_2h, F_2v, N_2): five of each foot, then both sides of each torque."""

    C: FloatArray
    c: FloatArray


@dataclass(frozen=True)
class SupportPoint:
    """The dynamics at one pose of the family.

    Attributes:
        biped: the robot.
        width: distance between the ankles [m].
        at: pose, slope and curvature.
        A: (7,) coefficient of ddbeta in the inverse dynamics with the swing foot unloaded, rows as `ProjectedDynamics`.
        B: (7,) coefficient of dbeta^2.
        G: (7,) weight.
        J: (3, 4) Jacobian of the ground point below the swing ankle, h and v, and of the foot's rotation.
    """

    biped: FrontalBiped
    width: float
    at: FamilyPoint
    A: FloatArray
    B: FloatArray
    G: FloatArray
    J: FloatArray

    @classmethod
    def of(cls, family: DoubleSupportFamily, beta: float) -> "SupportPoint":
        """The dynamics of a family at the stance ankle angle beta [rad]."""
        at, biped = family.at(beta), family.biped
        one = np.zeros(1)
        motion = ConstrainedMotion(at.q[None], at.dq[None], at.ddq[None], one, one)
        A, B, G = (part[:, 0] for part in project_dynamics(biped, motion))
        inner, outer = biped.swing_sole_jacobian(at.q)
        share = biped.chain.sole_outer / (biped.chain.sole_inner + biped.chain.sole_outer)
        point = outer + share * (inner - outer)
        return cls(biped, family.width, at, A, B, G, np.vstack([point, np.ones(len(JOINTS))]))

    # ------------------------------------------------------------------ forces
    def total(self, acceleration: float, speed_squared: float) -> FloatArray:
        """(7,) inverse dynamics with the swing foot unloaded."""
        return self.A * acceleration + self.B * speed_squared + self.G

    def forces(self, acceleration: float, speed_squared: float, swing: FloatArray) -> SupportForces:
        """What acts, given ddbeta [rad/s^2], dbeta^2 [rad^2/s^2] and the swing foot's wrench (3,)."""
        total = self.total(acceleration, speed_squared)
        return SupportForces(total[:WRENCH] - _moved(swing, self.width), swing, total[TORQUES] - self.J.T @ swing)

    def under(self, u: FloatArray, speed_squared: float) -> tuple[float, SupportForces]:
        """ddbeta [rad/s^2] and what acts under the torques u (4,) [N m] at dbeta^2 [rad^2/s^2]."""
        dq = self.at.dq
        resting = self.total(0.0, speed_squared)[TORQUES]
        acceleration = float(dq @ (u - resting) / (dq @ self.A[TORQUES]))
        missing = self.total(acceleration, speed_squared)[TORQUES] - u
        swing: FloatArray = np.linalg.lstsq(self.J.T, missing, rcond=None)[0].astype(float)
        return acceleration, self.forces(acceleration, speed_squared, swing)._replace(u=u)

    def pressure_point(self, acceleration: float, speed_squared: float) -> float:
        """Where the total of both feet acts, from the stance ankle towards the swing foot [m]."""
        total = self.total(acceleration, speed_squared)
        return float(total[N_0] / total[F_V])

    def acceleration(self, p: float, speed_squared: float) -> float:
        """ddbeta [rad/s^2] with the total of both feet at p [m]: inverse of `pressure_point`."""
        moment = self.B * speed_squared + self.G
        return float(-(moment[N_0] - p * moment[F_V]) / (self.A[N_0] - p * self.A[F_V]))

    def shared(self, acceleration: float, speed_squared: float, p_fri: float) -> FloatArray:
        """(3,) wrench of the swing foot if it loads as the total crosses from one single support's FRI to the other's.

        Both feet carry their share at the same distance ``p_fri`` [m] inwards from their ankles.
        """
        total = self.total(acceleration, speed_squared)
        share = (total[N_0] / total[F_V] - p_fri) / (self.width - 2.0 * p_fri)
        return np.array([share * total[F_H], share * total[F_V], -p_fri * share * total[F_V]])

    # ------------------------------------------------------------------ what is possible
    def rows(self, limits: SupportLimits, speed_squared: float) -> SupportRows:
        """The inequalities at dbeta^2 [rad^2/s^2]."""
        inner, outer = self.biped.chain.sole_inner - limits.margin, self.biped.chain.sole_outer - limits.margin
        rest = self.total(0.0, speed_squared)
        on_swing = np.hstack([np.zeros((WRENCH, 1)), np.eye(WRENCH)])
        on_stance = np.hstack([self.A[:WRENCH, None], -_moved(np.eye(WRENCH), self.width)])
        torque = np.hstack([self.A[TORQUES, None], -self.J.T])
        stance, swing = (_contact(limits.friction, *ends) for ends in ((-outer, inner), (-inner, outer)))
        C = np.vstack([stance @ on_stance, swing @ on_swing, torque, -torque])
        c = np.concatenate(
            [
                -stance @ rest[:WRENCH],
                np.zeros(CONTACT_ROWS),
                -limits.max_torque - rest[TORQUES],
                -limits.max_torque + rest[TORQUES],
            ]
        )
        return SupportRows(C, c)

    def acceleration_range(self, limits: SupportLimits, speed_squared: float) -> tuple[float, float] | None:
        """Least and greatest ddbeta [rad/s^2] that soles and motors allow at dbeta^2; None where none is."""
        C, c = self.rows(limits, speed_squared)
        scale = np.array([1.0, *np.full(WRENCH, self.biped.weight)])
        ends = []
        for sign in (1.0, -1.0):
            cost = np.array([sign, 0.0, 0.0, 0.0])
            found = linprog(cost, A_ub=-C * scale / self.biped.weight, b_ub=-c / self.biped.weight, bounds=(None, None))
            if not found.success or found.x is None:
                return None
            ends.append(float(found.x[0]))
        return ends[0], ends[1]


def _moved(wrench: FloatArray, width: float) -> FloatArray:
    """Wrenches (3, ...) about a point ``width`` [m] further along h, taken about the origin."""
    moved = np.array(wrench, dtype=float)
    moved[N_0] = moved[N_0] + width * moved[F_V]
    return moved


def _contact(friction: float, low: float, high: float) -> FloatArray:
    """(5, 3) rows that are >= 0 on wrenches (F_h, F_v, N) which a foot at rest may take."""
    return np.array(
        [
            [0.0, 1.0, 0.0],
            [1.0, friction, 0.0],
            [-1.0, friction, 0.0],
            [0.0, -low, 1.0],
            [0.0, high, -1.0],
        ]
    )
