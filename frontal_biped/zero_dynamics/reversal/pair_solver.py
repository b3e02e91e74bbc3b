"""Where two different steps in turn reverse: at fixed parameters by signs of E_2, with invariance imposed by Newton.

The pair with invariance imposed is *regular*, and so the only one nearby, where the smaller singular value of the
Jacobian, by central differences, is above their error, measured with twice the step.
"""

from dataclasses import dataclass, replace

import numpy as np

from frontal_biped.exceptions import ReversalError
from frontal_biped.numerics.verdict import Verdict, below
from frontal_biped.zero_dynamics.reversal.pair_problem import CONVERGED, NEWTON_STEPS, TwoStepReversal
from frontal_biped.zero_dynamics.reversal.planned import AT_THE_PLAN, find_reversal, zero_between
from frontal_biped.zero_dynamics.reversal.problem import DIFFERENCE


@dataclass(frozen=True)
class PairAnalysis:
    """Where both steps reverse, at fixed parameters.

    Attributes:
        planned: of the phases [rad].
        existence: is there a pair at which the robot turns back?
        at_the_plan: do both lie within `AT_THE_PLAN` of the planned ones?
        betas: the pair nearest to the planned one [rad]; nan where none was found.
        sign_change: two values of beta_A between which E_2 changes sign [rad]; nan likewise.
        accelerations: ddbeta there, negative at a reversal (HIP2) [rad/s^2].
        com_offsets: p_cm_h - p_FRI there, positive at a reversal [m].
    """

    planned: tuple[float, float]
    existence: Verdict
    at_the_plan: Verdict
    betas: tuple[float, float]
    sign_change: tuple[float, float]
    accelerations: tuple[float, float]
    com_offsets: tuple[float, float]

    @property
    def is_reversal(self) -> bool:
        """Do both turn back there?"""
        exists = self.existence is Verdict.CERTIFIED
        return exists and max(self.accelerations) < 0.0 and min(self.com_offsets) > 0.0


def analyse_pair(problem: TwoStepReversal) -> PairAnalysis:
    """Find the pair of reversals and check HIP1 and HIP2, by signs of E_2 beside the plan as `analyse_reversal`."""
    nan = float("nan"), float("nan")
    nothing = PairAnalysis(problem.planned_pair, Verdict.UNDECIDED, Verdict.UNDECIDED, nan, nan, nan, nan)
    try:
        fixed, (low, high) = problem.fixed, problem.brackets[0]
        found = find_reversal(problem, fixed.balance, low, high)
        if found.existence is not Verdict.CERTIFIED:
            return replace(nothing, existence=found.existence, at_the_plan=found.at_the_plan)
        beta = zero_between(problem, fixed.balance, found.sign_change)
        betas = beta, fixed.second(beta, problem.nodes)
        steps = [fixed.step(own, at, problem.nodes) for own, at in zip((fixed.a, fixed.b), betas, strict=True)]
    except ReversalError:
        return nothing
    at_the_plan = found.at_the_plan
    if at_the_plan is Verdict.CERTIFIED and abs(betas[1] - problem.b.beta_reversal) > AT_THE_PLAN:
        at_the_plan = Verdict.REFUTED
    a, b = (float(step.up.ddbeta[0]) for step in steps)
    off_a, off_b = (-float(step.up.restricted.kappa_2[0]) / problem.biped.weight for step in steps)
    return PairAnalysis(
        problem.planned_pair, Verdict.CERTIFIED, at_the_plan, betas, found.sign_change, (a, b), (off_a, off_b)
    )


@dataclass(frozen=True)
class SelfConsistentPair:
    """The pair of reversals with invariance imposed.

    Attributes:
        betas: where Newton's method ended [rad].
        converged: did it?
        residual: largest of S_1, S_2 there, over the energy that rising takes [-].
        regular: is the Jacobian regular there, so that no other pair is nearby?
        least_singular_value: of the Jacobian [kg^2 m^4/(s^2 rad)].
        error: on it, measured.
    """

    betas: tuple[float, float]
    converged: bool
    residual: float
    regular: Verdict
    least_singular_value: float
    error: float


def solve_pair(problem: TwoStepReversal, guess: tuple[float, float] | None = None) -> SelfConsistentPair:
    """Newton's method on S_1 = S_2 = 0, invariance imposed at every pair.

    Args:
        problem: the parameters.
        guess: start; default: the planned pair [rad].
    """
    pair = np.array(problem.planned_pair if guess is None else guess)
    value = problem.surplus((pair[0], pair[1]))
    converged = False
    for _ in range(NEWTON_STEPS):
        J = problem.jacobian((pair[0], pair[1]))
        if not np.all(np.isfinite(J)) or not np.all(np.isfinite(value)) or np.linalg.matrix_rank(J) < 2:
            break
        step = np.clip(-np.linalg.solve(J, value), -0.5 * problem.length, 0.5 * problem.length)
        for _ in range(30):
            trial = problem.surplus((pair[0] + step[0], pair[1] + step[1]))
            if np.all(np.isfinite(trial)) and np.max(np.abs(trial)) <= np.max(np.abs(value)):
                break
            step = 0.5 * step
        else:  # no descent is left: rounding, or no zero
            converged = bool(np.max(np.abs(step)) <= CONVERGED)
            break
        pair, value = pair + step, trial
        if np.max(np.abs(step)) <= CONVERGED:
            converged = True
            break
    betas = float(pair[0]), float(pair[1])
    J, coarser = problem.jacobian(betas), problem.jacobian(betas, 2.0 * DIFFERENCE)
    finite = bool(np.all(np.isfinite(J)) and np.all(np.isfinite(coarser)))
    least = float(np.linalg.svd(J, compute_uv=False)[-1]) if finite else float("nan")
    error = float(np.linalg.norm(J - coarser)) if finite else float("nan")
    regular = below(-least, 0.0, error) if converged else Verdict.UNDECIDED
    required = abs(problem.balance(problem.planned).required)
    return SelfConsistentPair(betas, converged, float(np.max(np.abs(value))) / required, regular, least, error)
