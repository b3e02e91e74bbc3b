"""Poincare map of the hybrid zero dynamics in closed form: [O] eq. pcr, pcf, pcc and fixedp.

The section is the end of the falling phase, the coordinate zeta_f- = sigma^2/2 about the stance ankle.

    rho_r(zeta_f-) = delta_r^2 delta_z^2 zeta_f- - (delta_FRI^a(beta_r-))^2 V_zr
    rho_f(zeta_r-) = delta_f^2 zeta_r-           - (delta_FRI^a(beta_f-))^2 V_zf

delta_FRI^a = sigma_a / sigma_FRI converts from the FRI to the ankle at one point of Z. At a fixed reversal point the
map is affine, its slope is the multiplier delta_f^2 delta_r^2 delta_z^2, and the gait is stable iff it is below one.
The same slope is the derivative of the true return map, whose reversal point moves with the energy: a reversal
displaced by d beta changes zeta on both sides of it by the same drive, because pose, slope and FRI are continuous.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.impact import Landing, impact
from frontal_biped.model.stance_map import relabel
from frontal_biped.virtual_constraints.phase import Phase, StepPhase
from frontal_biped.zero_dynamics.orbit import PhaseOrbit, phase_orbit


class StepOrbit(NamedTuple):
    """A step of the zero dynamics through a reversal point: the candidate periodic orbit.

    Attributes:
        rising: from impact to reversal, integrated backwards from the reversal.
        falling: from reversal to impact.
        landing: the impact, per unit of dbeta_f-, which is negative.
        step_width: distance between the ankles [m].
    """

    rising: PhaseOrbit
    falling: PhaseOrbit
    landing: Landing
    step_width: float

    @property
    def duration(self) -> float:
        """Time from impact to impact [s]."""
        return self.rising.duration + self.falling.duration

    @property
    def cost(self) -> float:
        """J = (1/L_s) int u'u dt over a step ([O] eq. cost), all four torques [N^2 m s]."""
        return (self.rising.squared_torque + self.falling.squared_torque) / self.step_width

    @property
    def multiplier(self) -> float:
        """delta_f^2 delta_r^2 delta_z^2, the slope of the Poincare map [-].

        The ankle-FRI conversions at the reversal cancel; what is left are the exponentials and the jump at impact.
        """
        decay = np.exp(self.falling.log_delta_squared[-1] - self.rising.log_delta_squared[-1])
        jump = self.landing.speed_ratio * self.rising.restricted.I_P[-1] / self.falling.restricted.I_P[-1]
        return decay * jump**2

    @property
    def periodicity(self) -> float:
        """dbeta_r+^2 - (speed ratio dbeta_f-)^2 [rad^2/s^2]: zero on a periodic orbit, where Z(beta_r-) = 0."""
        before = self.landing.speed_ratio / self.falling.restricted.I_P[-1]
        return 2.0 * (self.rising.z[-1] / self.rising.restricted.I_P[-1] ** 2 - self.falling.z[-1] * before**2)


def step_orbit(
    biped: FrontalBiped,
    rising: Phase,
    falling: Phase,
    step_width: float,
    size: int,
    beta_reversal: float | None = None,
) -> StepOrbit:
    """The step through a reversal point, by default the planned one, on ``size`` quadrature nodes a phase."""
    up = phase_orbit(biped, rising, StepPhase.RISING, size, beta_reversal)
    down = phase_orbit(biped, falling, StepPhase.FALLING, size, beta_reversal)
    landing = impact(biped, down.motion.q[-1], down.motion.dq[-1])
    return StepOrbit(up, down, landing, step_width)


@dataclass(frozen=True)
class HybridZeroDynamics:
    """Closed-form return map of a step through one reversal point.

    Attributes:
        biped: the robot.
        step: the step.
    """

    biped: FrontalBiped
    step: StepOrbit

    def _fri_to_ankle(self, orbit: PhaseOrbit, node: int) -> float:
        """delta_FRI^a = sigma_a / sigma_FRI at the reversal (node 0) or the impact (node -1) [-]."""
        return float(orbit.restricted.I_ankle(self.biped.ankle_height)[node] / orbit.restricted.I_P[node])

    @property
    def delta_z(self) -> float:
        """sigma_r+ / sigma_f- about the respective stance ankles ([O] eq. restimpactsimp) [-]."""
        falling = self.step.falling
        ankle = falling.restricted.I_ankle(self.biped.ankle_height)[-1]
        dq_plus = self.step.landing.dq_plus
        q_plus = relabel(falling.motion.q[-1])
        momentum = self.biped.momentum_map(q_plus)[:3] @ dq_plus
        return float((momentum[2] + self.biped.ankle_height * momentum[0]) / ankle)

    @property
    def delta_r(self) -> float:
        """Homogeneous growth of sigma_a over the rising phase [-]."""
        rising = self.step.rising
        growth = np.exp(-0.5 * rising.log_delta_squared[-1])
        return float(self._fri_to_ankle(rising, 0) * growth / self._fri_to_ankle(rising, -1))

    @property
    def delta_f(self) -> float:
        """Homogeneous growth of sigma_a over the falling phase [-]."""
        falling = self.step.falling
        growth = np.exp(0.5 * falling.log_delta_squared[-1])
        return float(self._fri_to_ankle(falling, -1) * growth / self._fri_to_ankle(falling, 0))

    @property
    def barrier_r(self) -> float:
        """(delta_FRI^a)^2 V_zr(beta_r-): the energy the rising phase takes [kg^2 m^4/s^2]."""
        return float(self._fri_to_ankle(self.step.rising, 0) ** 2 * self.step.rising.V_Z[0])

    @property
    def barrier_f(self) -> float:
        """(delta_FRI^a)^2 V_zf(beta_f-): negative, the falling phase returns energy [kg^2 m^4/s^2]."""
        return float(self._fri_to_ankle(self.step.falling, -1) ** 2 * self.step.falling.V_Z[-1])

    def rho_r(self, zeta_f: float) -> float:
        """zeta_r- at the reversal point of a step that ends its falling phase with zeta_f- ([O] eq. pcr)."""
        return (self.delta_r * self.delta_z) ** 2 * zeta_f - self.barrier_r

    def rho_f(self, zeta_r: float) -> float:
        """zeta_f- at the impact, from zeta_r- at the reversal point ([O] eq. pcf)."""
        return self.delta_f**2 * zeta_r - self.barrier_f

    def rho(self, zeta_f: float) -> float:
        """Poincare map, rho_f after rho_r ([O] eq. pcc)."""
        return self.rho_f(self.rho_r(zeta_f))

    @cached_property
    def multiplier(self) -> float:
        """delta_f^2 delta_r^2 delta_z^2 [-]."""
        return (self.delta_f * self.delta_r * self.delta_z) ** 2

    @property
    def fixed_point(self) -> float:
        """zeta_f* ([O] eq. fixedp) [kg^2 m^4/s^2]."""
        return -(self.delta_f**2 * self.barrier_r + self.barrier_f) / (1.0 - self.multiplier)

    @property
    def is_stable(self) -> bool:
        """0 < multiplier < 1."""
        return bool(0.0 < self.multiplier < 1.0)

    @property
    def marginal_condition(self) -> float:
        """Z(beta_r-) of [O] eq. marginalcond, zero where the fixed point reverses exactly here [kg^2 m^4/s^2]."""
        return -((self.delta_r * self.delta_z) ** 2) * self.barrier_f - self.barrier_r

    @property
    def in_domain(self) -> bool:
        """Is the fixed point in the domain of rho: positive, zeta >= 0 in both phases, ddbeta < 0 at the reversal?"""
        exists = bool(np.all(self.step.rising.z > 0.0) and np.all(self.step.falling.z > 0.0))
        return exists and self.fixed_point > 0.0 and bool(self.step.rising.ddbeta[0] < 0.0)

    @property
    def speed_after_impact(self) -> float:
        """dbeta_r+ on the periodic orbit [rad/s]."""
        return float(self.step.rising.dbeta[-1])
