r"""Two different steps in turn: the return map of a robot that travels sideways, in closed form.

Step A begins with the ankles w_1 apart and lands with them w_2 apart, step B begins w_2 and lands w_1 apart. A stands
on the trailing foot, so that two steps take the robot w_2 - w_1 towards A's swing foot. Either rising phase begins with
the relabelled landing of the *other* step, pose and slope, and its energy is what the other step's impact leaves.

The section is the end of a falling phase, the coordinate zeta_f- = sigma^2/2 about the stance ankle ([O] eq. pcr, pcf,
pcc, for one step). At fixed reversal points a step is affine in it,

.. math:: \rho_i(\zeta) = m_i \zeta - c_i, \qquad m_i = (\delta_{f,i} \delta_{r,i} \delta_{z,j})^2, \qquad
          c_i = \delta_{f,i}^2 V_{r,i} + V_{f,i},

with delta_z,j of the impact that ends the other step and V the barriers about the ankle (`HybridZeroDynamics`). Two
steps from the end of B to the end of B are

.. math:: \rho = \rho_B \circ \rho_A, \qquad \rho' = m_A m_B, \qquad
          \zeta^* = -\frac{m_B c_A + c_B}{1 - m_A m_B},

and the orbit is stable iff 0 < m_A m_B < 1: one of the two steps may be unstable alone. As for one step the slope is
also that of the true map, whose reversals move with the energy. Two equal steps give back the map of one, twice.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.zero_dynamics.poincare import HybridZeroDynamics, StepOrbit


class TwoSteps(NamedTuple):
    """Two steps of the zero dynamics through their reversals, each beginning where the other lands.

    Attributes:
        a: step A; of a robot that travels the one that lands wide.
        b: step B.
    """

    a: StepOrbit
    b: StepOrbit

    @property
    def in_turn(self) -> tuple[tuple[StepOrbit, StepOrbit], tuple[StepOrbit, StepOrbit]]:
        """Either step, and the one before it."""
        return (self.a, self.b), (self.b, self.a)

    @property
    def periodicity(self) -> tuple[FloatArray | float, FloatArray | float]:
        """dbeta_r+^2 of A, of B, less what the impact of the step before leaves [rad^2/s^2]; zero on the orbit."""
        a, b = (_begun(step) - _landed(before) for step, before in self.in_turn)
        return a, b

    @property
    def multipliers(self) -> tuple[FloatArray | float, FloatArray | float]:
        """Growth of zeta about the FRI from landing to landing, over step A and over step B [-]."""
        a, b = (_growth(step, before) for step, before in self.in_turn)
        return a, b

    @property
    def multiplier(self) -> FloatArray | float:
        """m_A m_B, the slope of the two-step map [-]."""
        a, b = self.multipliers
        return a * b

    @property
    def duration(self) -> float:
        """Of both steps [s]."""
        return self.a.duration + self.b.duration

    @property
    def cost(self) -> float:
        """Mean of J over the two steps: J itself where they are equal [N^2 m s]."""
        return 0.5 * (self.a.cost + self.b.cost)

    @property
    def travel(self) -> float:
        """Of two steps, towards A's swing foot [m]."""
        return self.a.step_width - self.b.step_width


def _begun(step: StepOrbit) -> float:
    """Squared speed that the rising phase begins with [rad^2/s^2]."""
    rising = step.rising
    return 2.0 * rising.z[-1] / rising.restricted.I_P[-1] ** 2


def _landed(step: StepOrbit) -> float:
    """Squared speed that the impact leaves [rad^2/s^2]."""
    before = step.landing.speed_ratio / step.falling.restricted.I_P[-1]
    return 2.0 * step.falling.z[-1] * before**2


def _growth(step: StepOrbit, before: StepOrbit) -> float:
    decay = np.exp(step.falling.log_delta_squared[-1] - step.rising.log_delta_squared[-1])
    jump = before.landing.speed_ratio * step.rising.restricted.I_P[-1] / before.falling.restricted.I_P[-1]
    return decay * jump**2


class AffineMap(NamedTuple):
    """rho(zeta) = m zeta - c.

    Attributes:
        m: slope [-].
        c: [kg^2 m^4/s^2].
    """

    m: float
    c: float

    def __call__(self, zeta: float) -> float:
        """zeta_f- of the next landing [kg^2 m^4/s^2]."""
        return self.m * zeta - self.c

    def then(self, after: "AffineMap") -> "AffineMap":
        """This map and then another."""
        return AffineMap(after.m * self.m, after.m * self.c + after.c)

    @property
    def fixed_point(self) -> float:
        """-c / (1 - m) [kg^2 m^4/s^2]."""
        return -self.c / (1.0 - self.m)


@dataclass(frozen=True)
class TwoStepMap:
    """Closed-form return map of two steps in turn, each through one reversal point.

    Attributes:
        biped: the robot.
        steps: both.
    """

    biped: FrontalBiped
    steps: TwoSteps

    @cached_property
    def rho_a(self) -> AffineMap:
        """zeta_f- at the end of step B to zeta_f- at the end of the step A that follows."""
        return self._rho(self.steps.a, self.steps.b)

    @cached_property
    def rho_b(self) -> AffineMap:
        """zeta_f- at the end of step A to zeta_f- at the end of the step B that follows."""
        return self._rho(self.steps.b, self.steps.a)

    def _rho(self, step: StepOrbit, before: StepOrbit) -> AffineMap:
        own, landed = HybridZeroDynamics(self.biped, step), HybridZeroDynamics(self.biped, before)
        m = (own.delta_f * own.delta_r * landed.delta_z) ** 2
        return AffineMap(float(m), float(own.delta_f**2 * own.barrier_r + own.barrier_f))

    @property
    def rho(self) -> AffineMap:
        """From the end of step B to the end of the next step B."""
        return self.rho_a.then(self.rho_b)

    @property
    def multiplier(self) -> float:
        """m_A m_B [-]."""
        return self.rho.m

    @property
    def fixed_points(self) -> tuple[float, float]:
        """zeta_f* at the end of step A, and at the end of step B [kg^2 m^4/s^2]."""
        end_of_b = self.rho.fixed_point
        return self.rho_a(end_of_b), end_of_b

    @property
    def energy_balance(self) -> tuple[float, float]:
        """zeta_r- that is left at the reversal of A and of B, over what rising there takes [-]; zero on the orbit.

        Of a robot that was released at rest from the reversal of the step before.
        """
        a, b = (self._left(step, before) for step, before in self.steps.in_turn)
        return a, b

    def _left(self, step: StepOrbit, before: StepOrbit) -> float:
        own, landed = HybridZeroDynamics(self.biped, step), HybridZeroDynamics(self.biped, before)
        zeta_r = (own.delta_r * landed.delta_z) ** 2 * landed.rho_f(0.0) - own.barrier_r
        return abs(zeta_r) / abs(own.barrier_r)

    @property
    def is_stable(self) -> bool:
        """0 < m_A m_B < 1."""
        return bool(0.0 < self.multiplier < 1.0)

    @property
    def in_domain(self) -> bool:
        """Is the orbit in the domain of the map: zeta > 0 along all four phases, ddbeta < 0 at both reversals?"""
        orbits = [orbit for step in self.steps for orbit in (step.rising, step.falling)]
        exists = all(bool(np.all(orbit.z > 0.0)) for orbit in orbits)
        return exists and min(self.fixed_points) > 0.0 and all(bool(step.rising.ddbeta[0] < 0.0) for step in self.steps)
