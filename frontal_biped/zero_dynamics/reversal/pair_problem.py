r"""The two reversals of two different steps in turn: the equations, and their elimination to one angle.

With R_i(beta) the energy that step i takes to rise to a reversal at beta, F_i(beta) what falling from it brings back,
and g_i the jump of the energy at the impact that ends step i (all about the FRI at the ends), an orbit is a pair with

.. math:: g_A F_A(\beta_A) = R_B(\beta_B), \qquad g_B F_B(\beta_B) = R_A(\beta_A).

**At fixed parameters** the second reversal is eliminated: R_B' = -exp(-int rate) drive_B > 0 where the drive
kappa_2/kappa_1 of B's rising phase is negative, so the first equation has at most one solution beta_B(beta_A), and

.. math:: E_2(\beta_A) = g_B F_B(\beta_B(\beta_A)) - R_A(\beta_A)

is a function of one angle, whose zeros are counted as those of one step are (`reversal.zeros`). With
g_i F_i' = (m_i r_i) R_i', m_i the growth of the energy over step i and the impact that ends it, r_i the ratio of the
drives at its reversal (1 at a gait),

.. math:: E_2' = g_B F_B' \, \frac{g_A F_A'}{R_B'} - R_A' = -R_A' \, \bigl(1 - (m_A r_A)(m_B r_B)\bigr).

Two equal steps: E_2 and E of one step have the planned zero in common, and there E_2' = E' (1 + m).

**With invariance imposed** either step's first columns depend on the slope in which the other one lands, and so on both
reversals: S_1 = g_A F_A - R_B and S_2 = g_B F_B - R_A are functions of the pair.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import ReversalError, UnreachablePoseError
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.impact import impact
from frontal_biped.virtual_constraints.invariance import FreeParameters, complete_in_turn, free_parameters
from frontal_biped.virtual_constraints.phase import Phase, StepPhase
from frontal_biped.zero_dynamics.orbit import PhaseOrbit, phase_orbit
from frontal_biped.zero_dynamics.poincare import step_orbit
from frontal_biped.zero_dynamics.restricted import restrict
from frontal_biped.zero_dynamics.reversal.bracket import beta_maximum
from frontal_biped.zero_dynamics.reversal.problem import DIFFERENCE, UNDEFINED, EnergyBalance
from frontal_biped.zero_dynamics.two_steps import TwoSteps

Phases = tuple[Phase, Phase]

CONVERGED = 1e-12
"""[rad] change of a reversal, or of a pair of them, at which Newton's method stops."""

NEWTON_STEPS, HALVINGS = 40, 12


class _HalfPair(NamedTuple):
    """One of the two steps at a reversal.

    Attributes:
        up: rising.
        down: falling.
    """

    up: PhaseOrbit
    down: PhaseOrbit

    @property
    def least_inertia(self) -> float:
        return float(min(np.min(self.up.restricted.I_P), np.min(self.down.restricted.I_P)))

    @property
    def drive(self) -> float:
        return float(self.up.restricted.drive[0])

    @property
    def drive_ratio(self) -> float:
        return float(self.down.restricted.drive[0]) / self.drive

    @property
    def growth(self) -> float:
        """Of the energy over the step, without an impact [-]."""
        return float(np.exp(self.down.log_delta_squared[-1] - self.up.log_delta_squared[-1]))

    @property
    def required_slope(self) -> float:
        """R' [kg^2 m^4/(s^2 rad)]."""
        return -float(np.exp(self.up.log_delta_squared[-1])) * self.drive


@dataclass(frozen=True)
class FixedPair:
    """Both steps at fixed parameters: E_2, and beta_B as a function of beta_A.

    Attributes:
        biped: the robot.
        a: phases of step A.
        b: phases of step B.
    """

    biped: FrontalBiped
    a: Phases
    b: Phases

    @cached_property
    def jumps(self) -> tuple[float, float]:
        """g_A, g_B [-]: they do not depend on the reversals."""
        return self._jump(self.a, self.b), self._jump(self.b, self.a)

    def _jump(self, own: Phases, following: Phases) -> float:
        end = own[1].motion(np.array([own[1].beta_end]))
        landing = impact(self.biped, end.q[0], end.dq[0])
        I_start = restrict(self.biped, following[0], np.array([following[0].beta_start])).I_P[0]
        I_end = restrict(self.biped, own[1], np.array([own[1].beta_end])).I_P[0]
        return float((landing.speed_ratio * I_start / I_end) ** 2)

    def step(self, phases: Phases, beta: float, nodes: int) -> _HalfPair:
        """One of the steps through a reversal [rad].

        Raises:
            ReversalError: the reversal is not above both ends.
        """
        kinds = StepPhase.RISING, StepPhase.FALLING
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):  # beyond a zero of I_P
            orbits = (
                phase_orbit(self.biped, phase, kind, nodes, beta) for phase, kind in zip(phases, kinds, strict=True)
            )
            return _HalfPair(*orbits)

    def second(self, beta: float, nodes: int) -> float:
        """beta_B where the energy that step A, reversing at beta, leaves is spent [rad].

        By Newton's method from the planned reversal, its steps halved where they leave the region in which R_B grows.

        Raises:
            ReversalError: there is none in that region, or step A does not get to its impact.
        """
        gained = self.jumps[0] * float(self.step(self.a, beta, nodes).down.z[-1])
        if not gained > 0.0:
            raise ReversalError("step A brings no energy to the impact")
        rising = self.b[0]
        second, (spent, slope) = rising.beta_end, self._spent(rising.beta_end, nodes)
        for _ in range(NEWTON_STEPS):
            change = float(np.clip((gained - spent) / slope, -abs(rising.range), abs(rising.range)))
            for _ in range(HALVINGS):
                spent, slope = self._spent(second + change, nodes)
                if slope > 0.0:
                    break
                change *= 0.5
            else:
                raise ReversalError("step B does not reverse: R_B does not grow so far")
            second += change
            if abs(change) <= CONVERGED:
                return second
        raise ReversalError("step B does not reverse where it was looked for")

    def _spent(self, beta: float, nodes: int) -> tuple[float, float]:
        """R_B and its slope at a reversal of step B [rad]; a slope of nan where it is not defined or does not grow."""
        nothing = float("nan"), float("nan")
        if beta <= self.b[0].beta_start:
            return nothing
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            up = phase_orbit(self.biped, self.b[0], StepPhase.RISING, nodes, beta)
            slope = -float(np.exp(up.log_delta_squared[-1]) * up.restricted.drive[0])
        defined = bool(np.all(up.restricted.I_P > 0.0)) and slope > 0.0 and np.isfinite(up.z[-1])
        return (float(up.z[-1]), slope) if defined else nothing

    def balance(self, beta: float, nodes: int) -> EnergyBalance:
        """E_2 at beta_A [rad]; multiplier and drive ratio are the products over both steps, the inertia is the least.

        Its drive is A's or B's, whichever is nearer to zero in units of its own at the planned pair, in units of A's.
        """
        try:
            with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
                second = self.second(beta, nodes)
                a, b = self.step(self.a, beta, nodes), self.step(self.b, second, nodes)
                least = min(a.least_inertia, b.least_inertia)
                if not least > 0.0:
                    return UNDEFINED._replace(least_inertia=least)
                required = float(a.up.z[-1])
                m = self.jumps[0] * a.growth * self.jumps[1] * b.growth
                r = a.drive_ratio * b.drive_ratio
                own_a, own_b = self._own_drives
                drive = max(a.drive / abs(own_a), b.drive / abs(own_b)) * abs(own_a)
                slope = -a.required_slope * (1.0 - m * r)
                surplus = self.jumps[1] * float(b.down.z[-1]) - required
        except ReversalError:
            return UNDEFINED
        return EnergyBalance(surplus, least, m, r, slope, required, drive)

    @cached_property
    def _own_drives(self) -> tuple[float, float]:
        a, b = (
            float(restrict(self.biped, rising, np.array([rising.beta_end])).drive[0])
            for rising in (self.a[0], self.b[0])
        )
        return a, b


@dataclass(frozen=True)
class TwoStepReversal:
    """Everything the pair of reversals of two parameter sets is sought with; `planned` and `length` are step A's.

    Attributes:
        biped: the robot.
        a: what invariance leaves free of step A.
        b: of step B.
        nodes: quadrature nodes a phase.
    """

    biped: FrontalBiped
    a: FreeParameters
    b: FreeParameters
    nodes: int

    @classmethod
    def of_phases(
        cls, biped: FrontalBiped, phases: tuple[Phases, Phases], widths: tuple[float, float], nodes: int
    ) -> "TwoStepReversal":
        """The problem whose parameters are those of the phases of two steps that land ``widths`` [m] apart."""
        a, b = (free_parameters(*own, width) for own, width in zip(phases, widths, strict=True))
        return cls(biped, a, b, nodes)

    @property
    def planned(self) -> float:
        """beta_r- of step A [rad]."""
        return self.a.beta_reversal

    @property
    def planned_pair(self) -> tuple[float, float]:
        """beta_r- of both [rad]."""
        return self.a.beta_reversal, self.b.beta_reversal

    def phases(self, pair: tuple[float, float]) -> tuple[Phases, Phases]:
        """Phases of both steps with invariance imposed at a pair of reversals [rad]."""
        a, b = replace(self.a, beta_reversal=pair[0]), replace(self.b, beta_reversal=pair[1])
        return complete_in_turn(self.biped, a, b)

    @cached_property
    def brackets(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """For each step where its reversal can lie [rad]: above both ends, below beta_r^max.

        Raises:
            ReversalError: the centre of mass never gets over the FRI target.
        """
        a, b = (
            (max(rising.beta_start, falling.beta_end), beta_maximum(self.biped, rising))
            for rising, falling in self.phases(self.planned_pair)
        )
        return a, b

    @property
    def length(self) -> float:
        """Range of step A's shorter phase, the scale of all steps [rad]."""
        return abs(self.planned - self.brackets[0][0])

    @cached_property
    def fixed(self) -> FixedPair:
        """Both steps at the planned parameters."""
        return FixedPair(self.biped, *self.phases(self.planned_pair))

    def balance(self, beta: float) -> EnergyBalance:
        """E_2 at fixed parameters, at a reversal of step A [rad]."""
        return self.fixed.balance(beta, self.nodes)

    # ------------------------------------------------------------------ invariance imposed
    def surplus(self, pair: tuple[float, float], nodes: int | None = None) -> FloatArray:
        """(2,) S_1, S_2 with invariance imposed at a pair of reversals [kg^2 m^4/s^2]; nan where not defined."""
        try:
            phases = self.phases(pair)
            with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
                widths = self.a.step_width, self.b.step_width
                steps = TwoSteps(
                    *(
                        step_orbit(self.biped, *own, width, nodes or self.nodes)
                        for own, width in zip(phases, widths, strict=True)
                    )
                )
        except (ReversalError, UnreachablePoseError):
            return np.full(2, np.nan)
        if not all(np.all(orbit.restricted.I_P > 0.0) for step in steps for orbit in (step.rising, step.falling)):
            return np.full(2, np.nan)
        # S_1 is about the impact that ends A, before B's rising phase: periodicity in units of energy
        of_a, of_b = steps.periodicity
        inertias = (step.rising.restricted.I_P[-1] for step in (steps.b, steps.a))
        return np.array([-0.5 * lost * I_P**2 for lost, I_P in zip((of_b, of_a), inertias, strict=True)], dtype=float)

    def jacobian(self, pair: tuple[float, float], share: float = DIFFERENCE) -> FloatArray:
        """(2, 2) derivatives of S by the reversals, by central differences of a share of the length."""
        h = share * self.length
        columns = []
        for i in range(2):
            up, down = list(pair), list(pair)
            up[i], down[i] = up[i] + h, down[i] - h
            columns.append((self.surplus((up[0], up[1])) - self.surplus((down[0], down[1]))) / (2.0 * h))
        return np.array(columns).T
