r"""The reversal point *with* hybrid invariance: the problem, and the two functions whose zeros are the gaits.

What is free (see `FreeParameters`) stays; the columns that invariance determines, 0 and 1 of both phases, follow the
reversal point. With R the energy that rising to beta takes and F the one that falling from beta brings back, both about
the FRI at the ends where the robot lands, and g the jump of the energy at impact,

.. math:: E(\beta; b) = g F(\beta; b) - R(\beta; b) = Z(\beta) / c(\beta), \qquad
          c = (\delta_a^{FRI})^{-2} \exp\Big(\int_{\beta_r^+}^{\beta} 2\kappa_3/\kappa_1\Big) > 0,

so E and Z of [O] eq. marginalcond have the same zeros and signs, and E has no trivial factor. Two functions of one
angle are made of it:

- E(beta; b) with b fixed, the paper's; off the planned point the two phases do not meet in pose;
- S(beta) = E(beta; b(beta)), invariance imposed at every beta: its zeros are the gaits.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple, Protocol

import numpy as np

from frontal_biped.exceptions import ReversalError
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.virtual_constraints.invariance import FreeParameters, complete, free_parameters
from frontal_biped.virtual_constraints.phase import Phase
from frontal_biped.zero_dynamics.poincare import StepOrbit, step_orbit
from frontal_biped.zero_dynamics.reversal.bracket import beta_maximum

DIFFERENCE = 1e-4
"""Step of the central difference for S', relative to the range of the rising phase."""


class EnergyBalance(NamedTuple):
    """E at one point, and what it rests on.

    Attributes:
        surplus: E = g F - R [kg^2 m^4/s^2]; nan where the zero dynamics is not defined.
        least_inertia: smallest I_P on both phases [kg m^2]; the zero dynamics is defined where it is positive.
        multiplier: delta_f^2 delta_r^2 delta_z^2 of a step reversing there [-].
        drive_ratio: r, drive of the falling over that of the rising phase at the reversal [-].
        slope: dE/dbeta at fixed parameters [kg^2 m^4/(s^2 rad)].
        required: R, the energy that rising takes [kg^2 m^4/s^2].
        drive: kappa_2/kappa_1 of the rising phase at the reversal, negative where the robot turns back (HIP2).
    """

    surplus: float
    least_inertia: float
    multiplier: float
    drive_ratio: float
    slope: float
    required: float
    drive: float


_NOT_DEFINED = float("nan")
UNDEFINED = EnergyBalance(_NOT_DEFINED, -np.inf, *(5 * [_NOT_DEFINED]))
"""Outside the region where the zero dynamics is defined."""

BalanceFunction = Callable[[float, int], EnergyBalance]
"""E at a beta [rad], on a number of quadrature nodes a phase."""


class BalancedProblem(Protocol):
    """What counting the zeros of a balance needs to know of the problem that it belongs to."""

    @property
    def nodes(self) -> int:
        """Quadrature nodes a phase."""

    @property
    def planned(self) -> float:
        """The planned reversal [rad]."""

    @property
    def length(self) -> float:
        """Range of the planned rising phase, the scale of all steps [rad]."""

    def balance(self, beta: float) -> EnergyBalance:
        """The balance at a reversal [rad]."""


def energy_balance(step: StepOrbit) -> EnergyBalance:
    """E and its slope at fixed parameters, of a step through one reversal point."""
    up, down = step.rising, step.falling
    least = float(min(np.min(up.restricted.I_P), np.min(down.restricted.I_P)))
    if not least > 0.0:
        return EnergyBalance(_NOT_DEFINED, least, *(5 * [_NOT_DEFINED]))
    required, gained = float(up.z[-1]), float(down.z[-1])
    jump = step.landing.speed_ratio * up.restricted.I_P[-1] / down.restricted.I_P[-1]
    drive, multiplier = float(up.restricted.drive[0]), float(step.multiplier)
    ratio = float(down.restricted.drive[0]) / drive
    # dR/dbeta = -exp(int from beta to beta_r+ of the rate) drive, and the same for F
    slope = -np.exp(up.log_delta_squared[-1]) * drive * (multiplier * ratio - 1.0)
    return EnergyBalance(float(jump**2 * gained - required), least, multiplier, ratio, float(slope), required, drive)


@dataclass(frozen=True)
class ReversalProblem:
    """Everything the reversal point of one parameter set is sought with.

    Attributes:
        biped: the robot.
        free: what invariance leaves free.
        nodes: quadrature nodes a phase.
    """

    biped: FrontalBiped
    free: FreeParameters
    nodes: int

    @classmethod
    def of_phases(
        cls, biped: FrontalBiped, rising: Phase, falling: Phase, step_width: float, nodes: int
    ) -> "ReversalProblem":
        """The problem whose parameters are those of two phases."""
        return cls(biped, free_parameters(rising, falling, step_width), nodes)

    @property
    def planned(self) -> float:
        """beta_r- of the parameters [rad]."""
        return self.free.beta_reversal

    def phases(self, beta: float) -> tuple[Phase, Phase]:
        """Both phases with invariance imposed at a reversal at beta: the parameters b(beta)."""
        return complete(self.biped, replace(self.free, beta_reversal=beta))

    @cached_property
    def bracket(self) -> tuple[float, float]:
        """beta_r+ (or beta_f-, where that is larger) and beta_r^max [rad].

        The pose and the FRI target at the reversal are free parameters, so beta_r^max, which freezes that pose, is
        the same for every guess.

        Raises:
            ReversalError: the centre of mass never gets over the FRI target.
        """
        rising, falling = self.phases(self.planned)
        return max(rising.beta_start, falling.beta_end), beta_maximum(self.biped, rising)

    def step(self, beta: float, guess: float | None = None) -> StepOrbit:
        """The step reversing at beta with invariance imposed at ``guess``, by default at beta itself."""
        rising, falling = self.phases(beta if guess is None else guess)
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):  # beyond a zero of I_P
            return step_orbit(self.biped, rising, falling, self.free.step_width, self.nodes, beta)

    def balance(self, beta: float, guess: float | None = None) -> EnergyBalance:
        """E(beta; b(guess)), by default S(beta) = E(beta; b(beta)); not defined outside the bracket's lower end."""
        try:
            step = self.step(beta, guess)
        except ReversalError:
            return UNDEFINED
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            return energy_balance(step)

    def at_fixed_parameters(self) -> BalanceFunction:
        """E(beta; b) with b that of the planned reversal, the paper's function."""
        rising, falling = self.phases(self.planned)

        def fixed(beta: float, nodes: int) -> EnergyBalance:
            try:
                with np.errstate(over="ignore", invalid="ignore", divide="ignore"):  # beyond a zero of I_P
                    return energy_balance(step_orbit(self.biped, rising, falling, self.free.step_width, nodes, beta))
            except ReversalError:
                return UNDEFINED

        return fixed

    def S(self, beta: float) -> float:
        """E with invariance imposed at beta, E(beta; b(beta)) [kg^2 m^4/s^2]; nan where not defined."""
        return self.balance(beta).surplus

    @property
    def length(self) -> float:
        """Range of the planned rising phase, the scale of all steps [rad]."""
        return abs(self.planned - self.bracket[0])

    def slope(self, beta: float) -> float:
        """S' by a central difference, truncation and rounding both near 1e-7 of its size [kg^2 m^4/(s^2 rad)]."""
        h = DIFFERENCE * self.length
        return (self.S(beta + h) - self.S(beta - h)) / (2.0 * h)

    def contraction(self, beta: float) -> float:
        """Phi' = 1 - S'/E_beta at a zero of S [-]."""
        return 1.0 - self.slope(beta) / self.balance(beta).slope
