"""Orbits of the zero dynamics through a reversal, where zeta = 0 and time is singular in beta ([O] eq. soledo)."""

from dataclasses import dataclass
from functools import cached_property
from typing import cast

import numpy as np
from scipy.interpolate import BarycentricInterpolator

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import ReversalError
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.numerics.quadrature import ReversalQuadrature, reversal_quadrature
from frontal_biped.virtual_constraints.phase import ConstrainedMotion, Phase, StepPhase
from frontal_biped.zero_dynamics.restricted import TORQUES, RestrictedDynamics, on_constraints


@dataclass(frozen=True)
class PhaseOrbit:
    """Orbit of the zero dynamics through a reversal, at the points beta = beta_r- - Delta tau^2.

    tau = 0 is the reversal and tau = 1 the impact: where a rising phase starts and a falling phase ends.

    Attributes:
        tau: (n,) [-].
        weights: (n,) quadrature weights of int_0^1 f dtau [-].
        kind: rising or falling.
        Delta: |beta_r- - beta_impact| [rad].
        motion: configuration, its derivatives and the FRI target.
        restricted: the scalar dynamics.
        log_delta_squared: (n,) int from the reversal to beta of 2 kappa_3/kappa_1; its exponential is delta_FRI^2.
        z: (n,) zeta / tau^2, smooth and positive through the reversal of a gait [kg^2 m^4/s^2].
    """

    tau: FloatArray
    weights: FloatArray
    kind: StepPhase
    Delta: float
    motion: ConstrainedMotion
    restricted: RestrictedDynamics
    log_delta_squared: FloatArray
    z: FloatArray

    @property
    def beta(self) -> FloatArray:
        """(n,) [rad]."""
        return self.motion.q[:, 0]

    @property
    def zeta(self) -> FloatArray:
        """(n,) sigma_FRI^2 / 2 [kg^2 m^4/s^2]."""
        return self.tau**2 * self.z

    @property
    def V_Z(self) -> FloatArray:
        """(n,) V_Z = delta_FRI^2 zeta+ - zeta, integrated from the start of the phase ([O] eq. soledo)."""
        start = -1 if self.kind is StepPhase.RISING else 0
        delta_squared = np.exp(self.log_delta_squared - self.log_delta_squared[start])
        return delta_squared * self.zeta[start] - self.zeta

    @cached_property
    def root_two_z(self) -> FloatArray:
        """(n,) |sigma_FRI| / tau; nan where the orbit does not exist."""
        with np.errstate(invalid="ignore"):
            return np.sqrt(2.0 * self.z)

    @cached_property
    def dbeta(self) -> FloatArray:
        """(n,) [rad/s]."""
        return self.kind.sign * self.tau * self.root_two_z / self.restricted.I_P

    @cached_property
    def ddbeta(self) -> FloatArray:
        """(n,) [rad/s^2]."""
        return self.restricted.acceleration(self.dbeta**2)

    @cached_property
    def velocities(self) -> FloatArray:
        """(n, 4) joint velocities on the orbit [rad/s]."""
        return self.motion.dq * self.dbeta[:, None]

    @cached_property
    def generalized_forces(self) -> FloatArray:
        """(7, n) rows F_h, F_v [N], N_0, u_1..u_4 [N m] on the orbit."""
        return self.restricted.forces(self.dbeta**2)

    @cached_property
    def time_density(self) -> FloatArray:
        """(n,) dt/dtau [s]: finite at the reversal, where dt/dbeta is not."""
        return 2.0 * self.Delta * self.restricted.I_P / self.root_two_z

    @property
    def duration(self) -> float:
        """Time between the reversal and the impact [s]."""
        return cast("float", self.weights @ self.time_density)

    @property
    def squared_torque(self) -> float:
        """Int u'u dt over the phase [N^2 m^2 s]."""
        u = self.generalized_forces[TORQUES]
        return self.weights @ ((u**2).sum(axis=0) * self.time_density)


def integrate_from_reversal(
    rule: ReversalQuadrature, kind: StepPhase, Delta: float, motion: ConstrainedMotion, restricted: RestrictedDynamics
) -> PhaseOrbit:
    """Solve dzeta/dbeta = drive + rate zeta with zeta = 0 at the reversal.

    zeta(beta) = int from beta_r- to beta of exp(int_x^beta rate) drive(x) dx, with dx = -2 Delta r dr.

    Args:
        rule: quadrature nodes.
        kind: rising or falling.
        Delta: |beta_r- - beta_impact| [rad].
        motion: the virtual constraints at the nodes.
        restricted: the scalar dynamics at the nodes.

    Returns:
        The orbit at the nodes.
    """
    way = -2.0 * Delta
    exponent = way * rule.tau**2 * (rule.Q @ restricted.rate)
    growth = np.exp(exponent)
    z = way * growth * (rule.Q @ (restricted.drive / growth))
    return PhaseOrbit(rule.tau, rule.weights, kind, Delta, motion, restricted, exponent, z)


def phase_orbit(
    biped: FrontalBiped, phase: Phase, kind: StepPhase, size: int, beta_reversal: float | None = None
) -> PhaseOrbit:
    """Orbit of a phase through a reversal.

    Args:
        biped: the robot.
        phase: virtual constraints.
        kind: whether it rises or falls; the ends of a phase do not say, where a design has gone astray.
        size: number of quadrature nodes.
        beta_reversal: where it reverses; default: where the phase plans it.

    Returns:
        The orbit between the reversal and the impact end of the phase.

    Raises:
        ReversalError: the reversal lies on the wrong side of the impact.
    """
    ends = phase.beta_start, phase.beta_end
    impact_end, planned = ends if kind is StepPhase.RISING else ends[::-1]
    reversal = planned if beta_reversal is None else beta_reversal
    Delta = reversal - impact_end
    if Delta <= 0.0:
        raise ReversalError(f"reversal at beta = {reversal:.6g} rad is not above the impact at {impact_end:.6g} rad")
    rule = reversal_quadrature(size)
    motion, restricted = on_constraints(biped, phase, reversal - Delta * rule.tau**2)
    return integrate_from_reversal(rule, kind, Delta, motion, restricted)


def resample(biped: FrontalBiped, phase: Phase, orbit: PhaseOrbit, tau: FloatArray) -> PhaseOrbit:
    """An orbit on quadrature nodes, at other points tau (n,) in [0, 1], increasing.

    zeta is interpolated by the polynomial through the quadrature nodes; configuration, dynamics and FRI are
    evaluated afresh. The weights are those of the trapezoidal rule.
    """
    values = np.stack([orbit.z, orbit.log_delta_squared], axis=1)
    rule = reversal_quadrature(len(orbit.tau))
    z, exponent = BarycentricInterpolator(rule.tau, values, wi=rule.barycentric)(tau).T
    motion, restricted = on_constraints(biped, phase, orbit.beta[0] - orbit.Delta * tau**2)
    weights = np.gradient(tau)
    weights[[0, -1]] *= 0.5
    return PhaseOrbit(tau, weights, orbit.kind, orbit.Delta, motion, restricted, exponent, z)
