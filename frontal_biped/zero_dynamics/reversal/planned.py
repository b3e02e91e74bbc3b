"""Does the step reverse where it is planned to? Asked of E(beta; b) at fixed parameters, see `reversal.problem`.

[O] Sec. III-E looks for a change of sign of Z in ]beta_r+, beta_r^max[. A scan for one steps over a close pair of
zeros, and the second zero of a gait can be closer to the planned one than any spacing: just beyond the reversal the
zero dynamics may end (I_P = 0). So the planned point is asked first, and by signs alone: E is evaluated on both sides
of it, with its error measured by doubling the nodes, and where the signs are known and differ a zero lies between. How
close the two points may be follows from the error of E, which is far below that of any interpolant. Where the planned
point is no zero, all zeros are counted (`reversal.zeros`), and existence is what the count says.
"""

from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from frontal_biped.exceptions import ReversalError
from frontal_biped.numerics.verdict import Verdict
from frontal_biped.zero_dynamics.reversal.bracket import ROOT_TOLERANCE
from frontal_biped.zero_dynamics.reversal.problem import (
    BalancedProblem,
    BalanceFunction,
    ReversalProblem,
    energy_balance,
)
from frontal_biped.zero_dynamics.reversal.zeros import REGULAR, count_zeros

AT_THE_PLAN = 1e-9
"""[rad] distance from the planned reversal within which the step reverses where it is planned to."""

REACHES = (1.0, 10.0, 100.0, 1e3, 1e4)
"""Multiples of `AT_THE_PLAN` on either side of the plan where the sign of E is asked, until it is known."""

SAFETY = 4.0
"""Factor on the error that is measured at the plan and used beside it."""

ROUNDING = 1e-13
"""Rounding error of E over the energy R that rising takes; measured, E vanishes at planned reversals to 1e-14 R."""


@dataclass(frozen=True)
class ReversalAnalysis:
    """Where the step reverses.

    Attributes:
        bracket: beta_r+ and beta_r^max [rad]; the latter nan where the centre of mass does not get over the target.
        planned: beta_r- of the phases [rad].
        existence: is there a zero of Z at which the robot turns back?
        at_the_plan: does a zero lie within `AT_THE_PLAN` of the planned reversal?
        beta: the zero nearest to the planned reversal [rad]; nan where none was found.
        sign_change: two values of beta between which Z changes sign, the zero between them [rad]; nan likewise.
        zeta_residual: |zeta| left at ``beta`` over the energy that rising takes (HIP1) [-].
        acceleration: ddbeta at ``beta``, negative at a reversal (HIP2) [rad/s^2].
        com_offset: p_cm_h - p_FRI at ``beta``, positive at a reversal [m].
    """

    bracket: tuple[float, float]
    planned: float
    existence: Verdict
    at_the_plan: Verdict
    beta: float
    sign_change: tuple[float, float]
    zeta_residual: float
    acceleration: float
    com_offset: float

    @property
    def exists(self) -> bool:
        """Was a zero of Z found?"""
        return self.existence is Verdict.CERTIFIED

    @property
    def is_reversal(self) -> bool:
        """HIP1 and HIP2: halted there, and turning back."""
        return bool(self.exists and self.zeta_residual < 1e-9 and self.acceleration < 0.0 and self.com_offset > 0.0)


def analyse_reversal(problem: ReversalProblem) -> ReversalAnalysis:
    """Find the reversal point and check HIP1 and HIP2.

    Args:
        problem: the parameters.
    """
    rising, falling = problem.phases(problem.planned)
    low = max(rising.beta_start, falling.beta_end)
    try:
        low, high = problem.bracket
    except ReversalError:  # the planned point can be asked all the same
        high = float("nan")
    balance = problem.at_fixed_parameters()
    existence, at_the_plan, sign_change = find_reversal(problem, balance, low, high)
    nan = float("nan")
    if existence is not Verdict.CERTIFIED:
        return ReversalAnalysis((low, high), problem.planned, existence, at_the_plan, nan, (nan, nan), nan, nan, nan)
    beta = zero_between(problem, balance, sign_change)
    step = problem.step(beta, problem.planned)
    at = energy_balance(step)
    # kappa_2 = -m g (p_cm_h - p_FRI)
    offset = -float(step.rising.restricted.kappa_2[0]) / problem.biped.weight
    return ReversalAnalysis(
        bracket=(low, high),
        planned=problem.planned,
        existence=existence,
        at_the_plan=at_the_plan,
        beta=beta,
        sign_change=sign_change,
        zeta_residual=abs(at.surplus / at.required),
        acceleration=float(step.rising.ddbeta[0]),
        com_offset=offset,
    )


class FoundReversal(NamedTuple):
    """Whether there is a zero of E at which the robot turns back.

    Attributes:
        existence: is there one?
        at_the_plan: is there one within `AT_THE_PLAN` of the planned reversal?
        sign_change: ends of an interval with a zero, the nearest to the planned one that was found [rad]; or nan.
    """

    existence: Verdict
    at_the_plan: Verdict
    sign_change: tuple[float, float]


def find_reversal(problem: BalancedProblem, balance: BalanceFunction, low: float, high: float) -> FoundReversal:
    """Look beside the planned reversal, and where there is no zero, on the whole region around it.

    Args:
        problem: the parameters.
        balance: E at fixed parameters.
        low: lower end of the bracket [rad].
        high: upper end [rad]; nan: only beside the plan.
    """
    found = _beside_the_plan(problem, balance)
    if found.existence is Verdict.CERTIFIED or not np.isfinite(high):
        return found
    existence, sign_change = _anywhere(problem, balance, low, high)
    return FoundReversal(existence, found.at_the_plan, sign_change)


def _beside_the_plan(problem: BalancedProblem, balance: BalanceFunction) -> FoundReversal:
    nowhere = (float("nan"), float("nan"))
    own, finer = (balance(problem.planned, size) for size in (problem.nodes, 2 * problem.nodes))
    if not np.isfinite(own.surplus) or not np.isfinite(finer.surplus):
        return FoundReversal(Verdict.UNDECIDED, Verdict.UNDECIDED, nowhere)
    error = SAFETY * abs(finer.surplus - own.surplus) + ROUNDING * abs(own.required)
    # E is its tangent but for terms of second order: beyond twice the tolerance the zero is not at the plan
    elsewhere = abs(own.surplus) - error > 2.0 * AT_THE_PLAN * abs(own.slope)
    for reach in REACHES:
        ends = problem.planned - reach * AT_THE_PLAN, problem.planned + reach * AT_THE_PLAN
        left, right = (balance(end, problem.nodes).surplus for end in ends)
        if not (np.isfinite(left) and np.isfinite(right)):
            break
        if left * right < 0.0 and min(abs(left), abs(right)) > error:
            at = Verdict.CERTIFIED if reach <= 1.0 else Verdict.REFUTED if elsewhere else Verdict.UNDECIDED
            return FoundReversal(Verdict.CERTIFIED, at, ends)
    return FoundReversal(Verdict.UNDECIDED, Verdict.REFUTED if elsewhere else Verdict.UNDECIDED, nowhere)


def _anywhere(
    problem: BalancedProblem, balance: BalanceFunction, low: float, high: float
) -> tuple[Verdict, tuple[float, float]]:
    """Is there a zero on the interval around the planned point, and what encloses the one nearest to it?"""
    own = balance(problem.planned, problem.nodes)
    nowhere = (float("nan"), float("nan"))
    if not np.isfinite(own.surplus) or not own.drive < 0.0:
        return Verdict.UNDECIDED, nowhere
    count, _, _ = count_zeros(balance, low, high, problem, REGULAR * own.least_inertia, connected=True)
    if not count.zeros:
        return count.existence, nowhere
    nearest = min(count.zeros, key=lambda zero: abs(zero.place - problem.planned))
    return Verdict.CERTIFIED, nearest.enclosure


def zero_between(problem: BalancedProblem, balance: BalanceFunction, sign_change: tuple[float, float]) -> float:
    """The zero between two points."""

    @cache
    def surplus(beta: float) -> float:
        return balance(beta, problem.nodes).surplus

    left, right = sign_change
    if surplus(left) * surplus(right) > 0.0:  # an enclosure by an interpolant, one side of it within the error
        return 0.5 * (left + right)
    return float(brentq(surplus, left, right, xtol=ROOT_TOLERANCE, rtol=4.0 * np.finfo(float).eps))
