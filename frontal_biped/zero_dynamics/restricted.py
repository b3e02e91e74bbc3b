r"""Zero dynamics of one phase in closed form: [O] eq. zerodyn1, zerodyn2, edo2 and soledo.

On the zero dynamics manifold Z the robot follows q = (beta, h_d(beta)), so dq = q' dbeta and
ddq = q'' dbeta^2 + q' ddbeta (primes: derivatives with respect to beta). Inverse dynamics is linear in ddbeta and
dbeta^2 there; with w = (F_h, F_v, N_0, u_1..u_4),

.. math:: w = A(\beta)\,\ddot\beta + B(\beta)\,\dot\beta^2 + G(\beta).

The rows of A are the momentum map: A_h = m p_cm_h', A_v = m p_cm_v', A_N = I_0, the angular momentum about the
ground point below the ankle per unit of dbeta. The ground reaction acts at the FRI, N_0 = p_FRI F_v: one scalar
equation of motion, and the whole zero dynamics. With I_P = A_N - p_FRI A_v (so sigma_FRI = I_P dbeta):

    kappa_1 = 1 / I_P
    kappa_2 = -(G_N - p_FRI G_v)           = -m g (p_cm_h - p_FRI)
    kappa_3 = -p_FRI' A_v / I_P^2          = -m p_FRI' p_cm_v' kappa_1^2
    dzeta/dbeta = kappa_2/kappa_1 + 2 (kappa_3/kappa_1) zeta,      zeta = sigma_FRI^2 / 2

kappa_3 is what remains of the moving FRI: d(sigma_P)/dt = moment - dp/dt m dp_cm_v.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.virtual_constraints.contract import VirtualConstraints
from frontal_biped.virtual_constraints.phase import ConstrainedMotion

F_H, F_V, N_0 = 0, 1, 2  # rows of w
TORQUES = slice(3, 7)


class ProjectedDynamics(NamedTuple):
    """Inverse dynamics along a curve in the configuration space, w = A ddbeta + B dbeta^2 + G.

    Attributes:
        A: (7, n) coefficient of ddbeta.
        B: (7, n) coefficient of dbeta^2.
        G: (7, n) weight.
    """

    A: FloatArray
    B: FloatArray
    G: FloatArray


def project_dynamics(biped: FrontalBiped, motion: ConstrainedMotion) -> ProjectedDynamics:
    """Project the full dynamics on a curve q(beta) given with its first two derivatives."""
    q, dq, ddq = motion[:3]
    # what is asked of inverse dynamics: the weight; dq as an acceleration from rest; the curvature at unit speed
    none = np.zeros_like(q)
    velocity, acceleration = np.concatenate([none, none, dq]), np.concatenate([none, dq, ddq])
    asked = biped.many.inverse_dynamics(np.concatenate([q, q, q]), velocity, acceleration)
    G, A, B = asked.T.reshape(asked.shape[1], 3, len(q)).swapaxes(0, 1)
    return ProjectedDynamics(A - G, B - G, G)


@dataclass(frozen=True)
class RestrictedDynamics:
    """The scalar dynamics on Z at n points.

    Attributes:
        projected: inverse dynamics along the virtual constraints.
        p_fri: (n,) FRI target [m].
        dp_fri: (n,) its derivative with respect to beta [m/rad].
    """

    projected: ProjectedDynamics
    p_fri: FloatArray
    dp_fri: FloatArray

    @cached_property
    def I_P(self) -> FloatArray:
        """(n,) angular momentum about the FRI per unit of dbeta [kg m^2]; zero where decoupling is lost (C03)."""
        return self.projected.A[N_0] - self.p_fri * self.projected.A[F_V]

    def I_ankle(self, ankle_height: float) -> FloatArray:
        """(n,) angular momentum about the stance ankle per unit of dbeta [kg m^2]."""
        return self.projected.A[N_0] + ankle_height * self.projected.A[F_H]

    @property
    def kappa_1(self) -> FloatArray:
        """(n,) [1/(kg m^2)]."""
        return 1.0 / self.I_P

    @cached_property
    def kappa_2(self) -> FloatArray:
        """(n,) moment of the weight about the FRI [N m]."""
        return -(self.projected.G[N_0] - self.p_fri * self.projected.G[F_V])

    @cached_property
    def B_P(self) -> FloatArray:
        """(n,) moment about the FRI that the motion wants at constant speed, per unit of dbeta^2 [kg m^2]."""
        return self.projected.B[N_0] - self.p_fri * self.projected.B[F_V]

    @property
    def kappa_3(self) -> FloatArray:
        """(n,) [1/(kg m^2)]."""
        return -self.dp_fri * self.projected.A[F_V] / self.I_P**2

    @cached_property
    def drive(self) -> FloatArray:
        """(n,) kappa_2 / kappa_1, the right-hand side of the equation in zeta."""
        return self.kappa_2 * self.I_P

    @cached_property
    def rate(self) -> FloatArray:
        """(n,) 2 kappa_3 / kappa_1, its linear coefficient [1/rad]."""
        return -2.0 * self.dp_fri * self.projected.A[F_V] / self.I_P

    def acceleration(self, dbeta_squared: FloatArray) -> FloatArray:
        """(n,) ddbeta [rad/s^2] at the given dbeta^2 (n,) [rad^2/s^2], from N_0 = p_FRI F_v."""
        return (self.kappa_2 - self.B_P * dbeta_squared) / self.I_P

    def forces(self, dbeta_squared: FloatArray) -> FloatArray:
        """(7, n) rows F_h, F_v [N], N_0, u_1..u_4 [N m] at the given dbeta^2 (n,) [rad^2/s^2]."""
        A, B, G = self.projected
        return A * self.acceleration(dbeta_squared) + B * dbeta_squared + G


def on_constraints(
    biped: FrontalBiped, phase: VirtualConstraints, beta: FloatArray
) -> tuple[ConstrainedMotion, RestrictedDynamics]:
    """Virtual constraints of a phase at beta (n,) [rad], and the zero dynamics there."""
    motion = phase.motion(beta)
    return motion, RestrictedDynamics(project_dynamics(biped, motion), motion.p_fri, motion.dp_fri)


def restrict(biped: FrontalBiped, phase: VirtualConstraints, beta: FloatArray) -> RestrictedDynamics:
    """Zero dynamics of a phase at beta (n,) [rad]."""
    return on_constraints(biped, phase, beta)[1]
