r"""Solvers for the reversal point: the paper's successive approximation, and a safeguarded Newton method.

The paper's algorithm is Phi: guess -> the zero of E(.; b(guess)). By the implicit function theorem, at a gait

.. math:: \Phi' = 1 - S' / E_\beta, \qquad E_\beta = e^{-\int 2\kappa_3/\kappa_1} \, |\kappa_2/\kappa_1| \, (m r - 1),

m the multiplier, r the ratio of the drives kappa_2/kappa_1 of both phases, 1 at a gait (proof in
`reversal.certificate`). It converges locally iff 0 < S'/E_beta < 2, and then linearly; Newton's method on S does not
care.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from frontal_biped.exceptions import ReversalError
from frontal_biped.files.counted import counted
from frontal_biped.zero_dynamics.poincare import step_orbit
from frontal_biped.zero_dynamics.reversal.problem import (
    DIFFERENCE,
    UNDEFINED,
    EnergyBalance,
    ReversalProblem,
    energy_balance,
)

CONVERGED = 1e-12
"""[rad] change of the reversal point at which an iteration stops."""

MAX_ITERATIONS = 1000
NEWTON_ITERATIONS = 30
SCAN = 48
"""Points of the scan for a change of sign where Newton's method leaves the region."""


@dataclass(frozen=True)
class Iterations:
    """How a solver went.

    Attributes:
        method: "successive approximation", "Newton" or "Newton, then bracketing".
        converged: did it?
        beta: the last point [rad].
        history: every point, the start first [rad].
        evaluations: of E.
        message: one line.
    """

    method: str
    converged: bool
    beta: float
    history: tuple[float, ...]
    evaluations: int
    message: str

    @property
    def count(self) -> int:
        """Iterations done."""
        return len(self.history) - 1

    def contraction(self, solution: float) -> float:
        """Measured contraction factor: ratio of successive distances from the solution [-].

        Taken over the steps whose distance is small enough for Phi to be linear, and large against rounding.
        """
        errors = np.array(self.history) - solution
        useful = np.flatnonzero((np.abs(errors) < 1e-5) & (np.abs(errors) > 1e-9))
        useful = useful[useful + 1 < len(errors)]
        return float(np.median(errors[useful + 1] / errors[useful])) if len(useful) else float("nan")


def successive_approximation(
    problem: ReversalProblem,
    guess: float | None = None,
    *,
    tolerance: float = CONVERGED,
    max_iterations: int = MAX_ITERATIONS,
) -> Iterations:
    """The paper's algorithm ([O] Sec. III-D): impose invariance at a guess, find the zero of Z, repeat.

    Args:
        problem: the parameters.
        guess: first reversal point; default: the planned one [rad].
        tolerance: change at which it stops [rad].
        max_iterations: after which it gives up.
    """
    beta = problem.planned if guess is None else guess
    history, evaluations = [beta], 0

    def end(converged: bool, message: str) -> Iterations:
        return Iterations("successive approximation", converged, history[-1], tuple(history), evaluations, message)

    for _ in range(max_iterations):
        following, used = _zero_at_fixed_parameters(problem, beta)
        evaluations += used
        if not np.isfinite(following):
            return end(False, f"Z has no zero that can be reached with invariance imposed at {beta:.9g} rad")
        history.append(following)
        if abs(following - beta) <= tolerance:
            return end(True, f"converged in {counted(len(history) - 1, 'iteration')}")
        beta = following
    return end(False, f"not converged after {counted(max_iterations, 'iteration')}")


def _zero_at_fixed_parameters(problem: ReversalProblem, guess: float) -> tuple[float, int]:
    """Phi(guess): the zero of E(.; b(guess)) nearest to the guess, by safeguarded Newton steps, and evaluations."""
    rising, falling = problem.phases(guess)

    def balance(beta: float) -> EnergyBalance:
        try:
            with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
                step = step_orbit(problem.biped, rising, falling, problem.free.step_width, problem.nodes, beta)
                return energy_balance(step)
        except ReversalError:
            return UNDEFINED

    beta, point = guess, balance(guess)
    evaluations = 1
    for _ in range(NEWTON_ITERATIONS):
        if not np.isfinite(point.surplus):
            return float("nan"), evaluations
        step = float(np.clip(-point.surplus / point.slope, -0.2 * problem.length, 0.2 * problem.length))
        if abs(step) < 1e-15:
            return beta, evaluations
        for _ in range(30):
            trial = balance(beta + step)
            evaluations += 1
            if np.isfinite(trial.surplus) and abs(trial.surplus) < abs(point.surplus):
                break
            step *= 0.5
        else:
            # no descent left: rounding, or a minimum of |E| that is no zero
            close = abs(point.surplus) <= 1e-10 * point.required
            return (beta if close else float("nan")), evaluations
        beta, point = beta + step, trial
    return beta, evaluations


def solve_reversal(problem: ReversalProblem, guess: float | None = None, *, tolerance: float = CONVERGED) -> Iterations:
    """Safeguarded Newton on S(beta) = E(beta; b(beta)), with bracketing where Newton leaves the region.

    Args:
        problem: the parameters.
        guess: start; default: the planned reversal [rad].
        tolerance: change at which it stops [rad].

    Returns:
        The zero it found. ``converged`` is False only if neither Newton's method nor a scan of the whole bracket saw
        one; `reversal.certificate` proves absence.
    """
    start = problem.planned if guess is None else guess
    history, count = [start], 0

    def S(beta: float) -> float:
        nonlocal count
        count += 1
        return problem.S(beta)

    beta, value = start, S(start)
    for _ in range(NEWTON_ITERATIONS):
        if not np.isfinite(value):
            break
        h = DIFFERENCE * problem.length
        slope = (S(beta + h) - S(beta - h)) / (2.0 * h)
        step = -value / slope if np.isfinite(slope) and slope != 0.0 else float("nan")
        if not np.isfinite(step):
            break
        step = float(np.clip(step, -0.5 * problem.length, 0.5 * problem.length))
        for _ in range(8):
            trial = S(beta + step)
            if np.isfinite(trial) and abs(trial) < abs(value):
                break
            step *= 0.5
        else:
            if abs(step) < 1e-6 * problem.length:  # rounding: the zero itself
                return Iterations("Newton", True, beta, tuple(history), count, _converged(len(history) - 1))
            break
        beta, value = beta + step, trial
        history.append(beta)
        if abs(step) <= tolerance or value == 0.0:
            return Iterations("Newton", True, beta, tuple(history), count, _converged(len(history) - 1))
    found = _bracket(problem, S, start)
    method = "Newton, then bracketing"
    if found is None:
        return Iterations(method, False, beta, tuple(history), count, "no change of sign of S on the bracket")
    low, high = found

    def recorded(x: float) -> float:
        history.append(x)
        return S(x)

    beta = float(brentq(recorded, low, high, xtol=1e-15, rtol=8.9e-16))
    return Iterations(method, True, beta, (*history, beta), count, _converged(len(history)))


def _bracket(problem: ReversalProblem, S: Callable[[float], float], near: float) -> tuple[float, float] | None:
    """A change of sign of S, the nearest to a point of those a scan of the bracket sees."""
    low, high = problem.bracket
    steps = np.linspace(0.0, 1.0, SCAN + 2)[1:-1]
    # quadratically denser at the lower end, where the rising phase is short
    grid = np.unique(np.concatenate([low + (high - low) * steps**2, low + 3.0 * problem.length * steps]))
    grid = grid[(grid > low) & (grid < high)]
    values = np.array([S(float(x)) for x in grid])
    pairs = [(float(grid[i]), float(grid[i + 1])) for i in range(len(grid) - 1) if values[i] * values[i + 1] < 0.0]
    return min(pairs, key=lambda pair: abs(0.5 * (pair[0] + pair[1]) - near)) if pairs else None


def _converged(steps: int) -> str:
    return f"converged in {counted(steps, 'step')}"
