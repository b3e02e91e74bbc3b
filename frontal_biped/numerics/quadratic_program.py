"""Quadratic programs, and the only module that speaks ProxQP.

    minimise 1/2 x'H x + g'x   subject to   A x = b,   l <= C x <= u

Bounds on single variables are rows of C: ProxQP's separate box constraints cannot be warm-started.
"""

from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from proxsuite import proxqp
from scipy.linalg.lapack import dgesv

from frontal_biped.arrays import FloatArray

UNBOUNDED = 1e20  # ProxQP's infinity
DEFAULT_ACCURACY = 1e-9  # ProxQP's own default is too loose to rest a bound on
DEFAULT_MAX_ITERATIONS = 200
RETRY_PENALTY = 1.0  # mu; slower, and solves the two programs in a thousand that smaller ones stall on
REFINED = 1e-10  # by how much a refined solution may overstep a row
MAX_INNER_ITERATIONS = 300  # at each outer one; with the default of 1500 a lost problem may take a quarter of a second
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


def refined(qp: QuadraticProgram, solution: QpSolution) -> QpSolution:
    """The solution to rounding: the linear system of the rows that a solver found active.

    A solver's tolerance on the gradient is one on x only after division by the curvature of the cost. Where the
    active rows are dependent, or the answer would overstep a bound or turn a multiplier's sign, the solution as it is.
    """
    x, y, z = solution.x, solution.y, solution.z
    value = qp.C.dot(x)
    high = qp.u - value < z
    active = np.flatnonzero(high | (value - qp.l < -z))
    n, p = len(x), len(y)
    rows = np.concatenate([qp.A, qp.C[active]])
    KKT = np.zeros((n + len(rows), n + len(rows)))
    KKT[:n, :n], KKT[n:, :n], KKT[:n, n:] = qp.H, rows, rows.T
    right = np.concatenate([-qp.g, qp.b, np.where(high, qp.u, qp.l)[active]])
    *_, exact, singular = dgesv(KKT, right)
    if singular:
        return solution
    new_z = np.zeros_like(z)
    new_z[active] = exact[n + p :]
    new = replace(solution, x=exact[:n], y=exact[n : n + p], z=new_z)
    value = qp.C.dot(new.x)
    kept = np.all(value - qp.l >= -REFINED) and np.all(qp.u - value >= -REFINED)
    signs = np.all(np.where(high, new_z, -new_z)[active] >= 0.0)
    return new if kept and signs else solution


def _largest(values: FloatArray) -> float:
    return float(np.max(np.abs(values), initial=0.0))


class ProxQpSolver:
    """ProxQP's dense solver, kept between calls of one shape and warm-started.

    Args:
        accuracy: absolute tolerance on residuals.
        max_iterations: of the outer loop; ProxQP is slow to give up on an infeasible problem.
        retry: set up afresh and try once more when the accuracy is not reached?
        relative: tolerance on residuals relative to the terms they are made of, beside ``accuracy``.
        penalty_parameter: ProxQP's mu of the inequalities at the start of a solve; None: its default of 0.1.
        max_inner_iterations: at each outer one.
    """

    def __init__(
        self,
        accuracy: float = DEFAULT_ACCURACY,
        max_iterations: int = DEFAULT_MAX_ITERATIONS,
        retry: bool = True,
        relative: float = 0.0,
        penalty_parameter: float | None = None,
        max_inner_iterations: int = MAX_INNER_ITERATIONS,
    ) -> None:
        self.accuracy = accuracy
        self.retry = retry
        self.relative = relative
        self.penalty_parameter = penalty_parameter
        self.max_iterations = max_iterations
        self.max_inner_iterations = max_inner_iterations
        self._solver: Any = None
        self._shape: tuple[int, int, int] | None = None

    def solve(self, qp: QuadraticProgram, guess: FloatArray | None = None, warm: bool = True) -> QpSolution:
        """Solve; a problem of the same shape as the last one starts from that one's answer.

        A warm-started solver can stall on penalties left over from its last problem, so one that does not reach its
        accuracy is set up afresh, with a softer penalty, and tried once more.

        Args:
            qp: the problem.
            guess: (n,) a primal point to start from instead, with zero multipliers.
            warm: start from the last answer? Otherwise from the minimum under the equalities alone.
        """
        shape = (len(qp.g), len(qp.b), len(qp.l))
        fresh = self._solver is None or shape != self._shape
        if fresh:
            self._set_up(qp, shape, self.penalty_parameter)
        solver = self._solver
        if not fresh:
            solver.settings.initial_guess = _START[warm]
            solver.update(*qp)
        if guess is None:
            solver.solve()
        else:
            solver.settings.initial_guess = proxqp.InitialGuess.WARM_START
            solver.solve(guess, np.zeros(shape[1]), np.zeros(shape[2]))
        solution = self._answer(solver, qp)
        if self.retry and not fresh and not solution.solved:
            solver = self._set_up(qp, shape, RETRY_PENALTY)
            solver.solve()
            self._solver = None  # the next problem is not asked of this one
            solution = self._answer(solver, qp)
        return solution

    def _answer(self, solver: Any, qp: QuadraticProgram) -> QpSolution:
        results = solver.results
        status = results.info.status
        solved = status == proxqp.PROXQP_SOLVED
        x, y, z = np.array(results.x), np.array(results.y), np.array(results.z)
        solution = QpSolution(x, y, z, solved, status.name, int(results.info.iter))
        if not solved and max(solution.residuals(qp).values()) <= self.accuracy:
            return replace(solution, solved=True)  # it was waiting for the rounding of its duality gap to vanish
        return solution

    def _set_up(self, qp: QuadraticProgram, shape: tuple[int, int, int], penalty_parameter: float | None) -> Any:
        solver = proxqp.dense.QP(*shape)
        solver.settings.eps_abs = self.accuracy
        solver.settings.eps_rel = self.relative
        solver.settings.max_iter = self.max_iterations
        solver.settings.max_iter_in = self.max_inner_iterations
        solver.settings.check_duality_gap = True
        solver.settings.eps_duality_gap_abs = self.accuracy
        solver.settings.eps_duality_gap_rel = self.relative
        # the default of 1e-4 calls feasible programs infeasible
        solver.settings.eps_primal_inf = INFEASIBILITY
        solver.settings.eps_dual_inf = INFEASIBILITY
        if penalty_parameter is not None:
            solver.settings.default_mu_in = penalty_parameter
        solver.settings.initial_guess = _START[False]
        solver.init(*qp)
        self._solver, self._shape = solver, shape
        return solver
