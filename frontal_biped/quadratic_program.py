"""Quadratic programs, and the only module that speaks ProxQP.

    minimise 1/2 x'H x + g'x   subject to   A x = b,   l <= C x <= u

Bounds on single variables are rows of C: ProxQP's separate box constraints cannot be warm-started.
"""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from proxsuite import proxqp

from frontal_biped.arrays import FloatArray

UNBOUNDED = 1e20  # ProxQP's infinity
DEFAULT_ACCURACY = 1e-9  # ProxQP's own default is too loose to rest a bound on
DEFAULT_MAX_ITERATIONS = 200
INFEASIBILITY = 1e-12  # tolerance of the infeasibility certificates
_START = {
    True: proxqp.InitialGuess.WARM_START_WITH_PREVIOUS_RESULT,
    False: proxqp.InitialGuess.EQUALITY_CONSTRAINED_INITIAL_GUESS,
}


class QuadraticProgram(NamedTuple):
    """One problem. Shapes: H (n, n), g (n,), A (p, n), b (p,), C (k, n), l and u (k,)."""

    H: FloatArray
    g: FloatArray
    A: FloatArray
    b: FloatArray
    C: FloatArray
    l: FloatArray
    u: FloatArray


@dataclass(frozen=True)
class QpSolution:
    """Answer of the solver, with its proof.

    Attributes:
        x: (n,) primal solution.
        y: (p,) multipliers of A x = b.
        z: (k,) multipliers of l <= C x <= u, positive at the upper bound.
        solved: did the solver reach its accuracy?
        status: the solver's word.
        iterations: of the inner loop.
    """

    x: FloatArray
    y: FloatArray
    z: FloatArray
    solved: bool
    status: str
    iterations: int

    def residuals(self, qp: QuadraticProgram) -> dict[str, float]:
        """Largest violation of stationarity, of the constraints, and of complementary slackness."""
        x = self.x
        stationarity = qp.H @ x + qp.g + qp.A.T @ self.y + qp.C.T @ self.z
        value = qp.C @ x
        gap = np.where(self.z > 0.0, qp.u - value, value - qp.l)
        return {
            "stationarity": _largest(stationarity),
            "equality": _largest(qp.A @ x - qp.b),
            "inequality": max(_largest(np.maximum(0.0, qp.l - value)), _largest(np.maximum(0.0, value - qp.u))),
            "complementarity": _largest(self.z * np.minimum(np.abs(gap), 1e6)),
        }


def _largest(values: FloatArray) -> float:
    return float(np.max(np.abs(values), initial=0.0))


class ProxQpSolver:
    """ProxQP's dense solver, kept between calls of one shape and warm-started.

    Args:
        accuracy: absolute tolerance on residuals.
        max_iterations: of the outer loop; ProxQP is slow to give up on an infeasible problem.
        retry: set up afresh and try once more when the accuracy is not reached?
        penalty_parameter: ProxQP's mu of the inequalities at the start of a solve; None: its default of 0.1.
    """

    def __init__(
        self,
        accuracy: float = DEFAULT_ACCURACY,
        max_iterations: int = DEFAULT_MAX_ITERATIONS,
        retry: bool = True,
        penalty_parameter: float | None = None,
    ) -> None:
        self.accuracy = accuracy
        self.retry = retry
        self.penalty_parameter = penalty_parameter
        self.max_iterations = max_iterations
        self._solver: Any = None
        self._shape: tuple[int, int, int] | None = None

    def solve(self, qp: QuadraticProgram, guess: FloatArray | None = None, warm: bool = True) -> QpSolution:
        """Solve; a problem of the same shape as the last one starts from that one's answer.

        A warm-started solver can stall on penalties left over from its last problem, so one that does not reach its
        accuracy is set up afresh and tried once more.

        Args:
            qp: the problem.
            guess: (n,) a primal point to start from instead, with zero multipliers.
            warm: start from the last answer? Otherwise from the minimum under the equalities alone.
        """
        shape = (len(qp.g), len(qp.b), len(qp.l))
        fresh = self._solver is None or shape != self._shape
        if fresh:
            self._set_up(qp, shape)
        solver = self._solver
        if not fresh:
            solver.settings.initial_guess = _START[warm]
            solver.update(*qp)
        if guess is None:
            solver.solve()
        else:
            solver.settings.initial_guess = proxqp.InitialGuess.WARM_START
            solver.solve(guess, np.zeros(shape[1]), np.zeros(shape[2]))
        started_warm = not fresh and (warm or guess is not None)
        if self.retry and started_warm and solver.results.info.status != proxqp.PROXQP_SOLVED:
            solver = self._set_up(qp, shape)
            solver.solve()
        results = solver.results
        return QpSolution(
            x=np.array(results.x),
            y=np.array(results.y),
            z=np.array(results.z),
            solved=results.info.status == proxqp.PROXQP_SOLVED,
            status=results.info.status.name,
            iterations=int(results.info.iter),
        )

    def _set_up(self, qp: QuadraticProgram, shape: tuple[int, int, int]) -> Any:
        solver = proxqp.dense.QP(*shape)
        solver.settings.eps_abs = self.accuracy
        solver.settings.eps_rel = 0.0
        solver.settings.max_iter = self.max_iterations
        solver.settings.check_duality_gap = True
        solver.settings.eps_duality_gap_abs = self.accuracy
        solver.settings.eps_duality_gap_rel = 0.0
        # the default of 1e-4 calls feasible programs infeasible
        solver.settings.eps_primal_inf = INFEASIBILITY
        solver.settings.eps_dual_inf = INFEASIBILITY
        if self.penalty_parameter is not None:
            solver.settings.default_mu_in = self.penalty_parameter
        solver.settings.initial_guess = _START[False]
        solver.init(*qp)
        self._solver, self._shape = solver, shape
        return solver
