"""General-purpose solvers on the package's design problem, for `benchmark_design`.

Every solver gets the same scaled problem: y = (x - start) / (3 scale), objective 1e-2 J, equality and margins as the
package scales them, and the package's own bounds, which are about three units wide on either side. Without that box
SLSQP leaves the domain in its first step; it does so inside the box as well, and gets large finite numbers there.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import casadi as ca
import numpy as np
from scipy.optimize import BFGS, Bounds, NonlinearConstraint, minimize
from scipy.sparse import csr_array

from frontal_biped.arrays import FloatArray
from frontal_biped.design.evaluation import Evaluation
from frontal_biped.design.optimise import OPTIMISER_NODES
from frontal_biped.design.problem import FLOOR_Z, DesignProblem
from frontal_biped.design.trust_region_sqp import SqpSettings
from frontal_biped.design.trust_region_sqp import minimise as trust_region_sqp
from frontal_biped.exceptions import ReversalError, UnreachablePoseError
from frontal_biped.gait.constraints import STEP_WIDTH, SoleHeights, step_constraints
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.virtual_constraints import complete
from frontal_biped.zero_dynamics.orbit import PhaseOrbit
from frontal_biped.zero_dynamics.poincare import step_orbit

UNIT = 3.0  # scaled unit, in the package's scales: 0.3 rad of a joint
COST_SCALE = 1e-2
FAR = 1e3  # SLSQP does not recover from nan: outside the domain it sees scaled violations of this size ...
DEAR = 1e6  # ... and this J [N^2 m s]
FEASIBLE = 1e-6  # scaled violation at which an answer counts as feasible
OPTIMAL = 1e-3  # relative excess over the best J known at which it counts as the optimum


class SolverRow(NamedTuple):
    """Where a solver ended.

    Attributes:
        name: of the solver.
        iterations: its own count.
        evaluations: of values, with or without derivatives.
        seconds: CPU time.
        cost: J at the end [N^2 m s], by the package.
        violation: largest scaled violation there, by the package.
        message: the solver's last word.
    """

    name: str
    iterations: int
    evaluations: int
    seconds: float
    cost: float
    violation: float
    message: str

    def reached(self, best: float) -> bool:
        """Is this the optimum ``best``, or a better one, and feasible?"""
        return self.violation <= FEASIBLE and self.cost <= best * (1.0 + OPTIMAL)


class _OutOfTime(Exception):  # noqa: N818 - a signal, not an error
    pass


@dataclass
class Values:
    cost: float
    equality: FloatArray
    margins: FloatArray


def _guarded(values: Values) -> Values:
    """Finite numbers everywhere, a cost that is never below zero."""
    cost = min(values.cost, DEAR) if values.cost > 0.0 else DEAR
    equality = np.clip(np.nan_to_num(values.equality, nan=FAR), -FAR, FAR)
    return Values(cost, equality, np.clip(np.nan_to_num(values.margins, nan=-FAR), -FAR, FAR))


class ScaledProblem:
    """The package's design problem in scaled variables, evaluated once a point.

    Args:
        biped: the robot.
        specification: bounds of C01 to C09.
        limit: CPU seconds after which a solver is stopped.
    """

    def __init__(self, biped: FrontalBiped, specification: GaitSpecification, limit: float) -> None:
        self.biped, self.specification, self.limit = biped, specification, limit
        self.problem = DesignProblem(biped, specification, OPTIMISER_NODES)
        self.start = self.problem.start()
        self.unit = UNIT * self.problem.scale()
        low, high = self.problem.bounds()
        self.low, self.high = (low - self.start) / self.unit, (high - self.start) / self.unit
        self.size = self.problem.size
        first = self.problem.evaluate(self.start)
        self.equalities, self.inequalities = len(first.equality), len(first.margins)
        self.reset()

    def reset(self) -> None:
        """Forget evaluations and start the clock."""
        self.evaluations, self.stops = 0, True
        self.began = time.process_time()
        self._at: FloatArray | None = None
        self._point: Evaluation | None = None
        self._plain_at: FloatArray | None = None
        self._plain: Values | None = None
        self.iterate, self.iterations = np.zeros(self.size), 0

    def _count(self) -> None:
        self.evaluations += 1
        if self.stops and time.process_time() - self.began > self.limit:
            raise _OutOfTime

    def x(self, y: FloatArray) -> FloatArray:
        return self.start + self.unit * np.clip(y, self.low, self.high)

    # ------------------------------------------------------------------ with exact derivatives
    def point(self, y: FloatArray) -> Evaluation:
        """Values and derivatives at y (P,), with respect to x; nan where the final pose cannot be reached."""
        if self._at is None or not np.array_equal(y, self._at):
            self._count()
            self._at = np.array(y, dtype=float)
            try:
                with np.errstate(all="ignore"):
                    self._point = self.problem.evaluate(self.x(y))
            except UnreachablePoseError:
                assert self._point is not None
                nothing = {key: np.full_like(value, np.nan) for key, value in vars(self._point).items()}
                self._point = Evaluation(**nothing)
        assert self._point is not None
        return self._point

    def cost(self, y: FloatArray) -> float:
        return COST_SCALE * self.point(y).cost

    def gradient(self, y: FloatArray) -> FloatArray:
        return COST_SCALE * self.point(y).cost_gradient * self.unit

    def equality(self, y: FloatArray) -> FloatArray:
        return self.point(y).equality

    def equality_jacobian(self, y: FloatArray) -> FloatArray:
        return self.point(y).equality_jacobian * self.unit

    def margins(self, y: FloatArray) -> FloatArray:
        return self.point(y).margins

    def margins_jacobian(self, y: FloatArray) -> FloatArray:
        return self.point(y).margins_jacobian * self.unit

    # ------------------------------------------------------------------ values alone, for finite differences
    def values(self, y: FloatArray) -> Values:
        """J, equality and margins at y (P,), without derivatives, through the package's public functions."""
        if self._plain_at is None or not np.array_equal(y, self._plain_at):
            self._count()
            self._plain_at = np.array(y, dtype=float)
            with np.errstate(all="ignore"):
                self._plain = _guarded(self.values_at(self.x(y)))
        assert self._plain is not None
        return self._plain

    def values_at(self, x: FloatArray) -> Values:
        """J, equality and margins at x (P,), without derivatives; nan where there is no step."""
        width = float(x[2])
        try:
            rising, falling = complete(self.biped, self.problem.unpack(x))
            step = step_orbit(self.biped, rising, falling, width, OPTIMISER_NODES)
        except (ReversalError, UnreachablePoseError):
            return Values(np.nan, np.full(self.equalities, np.nan), np.full(self.inequalities, np.nan))
        periodicity, z = step.periodicity, (step.rising.z, step.falling.z)
        step = step._replace(rising=_floored(step.rising), falling=_floored(step.falling))
        soles = SoleHeights(*(self._soles(orbit) for orbit in (step.rising, step.falling)))
        margins = []
        for constraint in step_constraints(self.biped, self.specification, step, soles):
            if constraint.name != STEP_WIDTH:  # a variable, bounded as such
                sides = constraint.sides()
                margins += [sign * (constraint.values - bound) / constraint.scale for bound, sign in sides]
        margins += [(part - FLOOR_Z) / 10.0 for part in z]
        return Values(step.cost, np.array([periodicity / 0.1]), np.concatenate(margins))

    def _soles(self, orbit: PhaseOrbit) -> FloatArray:
        return np.array([self.biped.swing_sole(q)[:, 1] for q in orbit.motion.q]).T

    # ------------------------------------------------------------------ solutions
    def run(self, name: str, solve: Callable[["ScaledProblem"], tuple[FloatArray, int, str]]) -> SolverRow:
        """Time a solver from the default start; where it runs out of time, report its last iterate."""
        self.reset()
        try:
            y, iterations, message = solve(self)
        except _OutOfTime:
            y, iterations, message = self.iterate, self.iterations, f"stopped after {self.limit:.0f} s"
        seconds, evaluations = time.process_time() - self.began, self.evaluations
        point = self.problem.evaluate(self.x(y))
        violation = max(0.0, float(-np.min(point.margins)), float(np.max(np.abs(point.equality))))
        return SolverRow(name, iterations, evaluations, seconds, point.cost, violation, message)

    def follow(self, y: FloatArray, *_: Any) -> None:
        """Callback: remember the iterate."""
        self.iterate = np.array(y, dtype=float)
        self.iterations += 1


def _floored(orbit: PhaseOrbit) -> PhaseOrbit:
    """The orbit with z > 0, continued below the floor as `DesignProblem` does."""
    below = FLOOR_Z**2 / (2.0 * FLOOR_Z - np.minimum(orbit.z, FLOOR_Z))
    return replace(orbit, z=np.where(orbit.z < FLOOR_Z, below, orbit.z))


# ---------------------------------------------------------------------- the solvers
def package_sqp(scaled: ScaledProblem) -> tuple[FloatArray, int, str]:
    """The package's trust-region SQP, in its own scales."""
    problem = scaled.problem
    low, high = problem.bounds()

    def evaluate(x: FloatArray) -> Evaluation:
        scaled._count()
        return problem.evaluate(x)

    result = trust_region_sqp(evaluate, scaled.start, low, high, problem.scale(), SqpSettings())
    return (result.x - scaled.start) / scaled.unit, result.iterations, result.message


def slsqp(scaled: ScaledProblem, iterations: int = 500) -> tuple[FloatArray, int, str]:
    """SciPy SLSQP with the package's exact gradients."""

    def values(y: FloatArray) -> Values:
        point = scaled.point(y)
        return _guarded(Values(point.cost, point.equality, point.margins))

    constraints = [
        {
            "type": "eq",
            "fun": lambda y: values(y).equality,
            "jac": lambda y: np.nan_to_num(scaled.equality_jacobian(y)),
        },
        {
            "type": "ineq",
            "fun": lambda y: values(y).margins,
            "jac": lambda y: np.nan_to_num(scaled.margins_jacobian(y)),
        },
    ]

    def gradient(y: FloatArray) -> FloatArray:
        return np.nan_to_num(scaled.gradient(y))

    return _slsqp(scaled, lambda y: COST_SCALE * values(y).cost, gradient, constraints, iterations)


def slsqp_differences(scaled: ScaledProblem, iterations: int = 200) -> tuple[FloatArray, int, str]:
    """SciPy SLSQP with forward differences of the package's value functions; every value computed once."""
    step, unit = 1e-7, np.eye(scaled.size)
    last: dict[bytes, tuple[FloatArray, FloatArray, FloatArray]] = {}

    def derivatives(y: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        key = y.tobytes()
        if key not in last:
            last.clear()
            at = scaled.values(y)
            cost, equality, margins = [], [], []
            for i in range(scaled.size):
                # inwards at the upper bound
                h = step if y[i] + step <= scaled.high[i] else -step
                there = scaled.values(y + h * unit[i])
                cost.append(COST_SCALE * (there.cost - at.cost) / h)
                equality.append((there.equality - at.equality) / h)
                margins.append((there.margins - at.margins) / h)
            last[key] = np.array(cost), np.array(equality).T, np.array(margins).T
        return last[key]

    def cost(y: FloatArray) -> float:
        return COST_SCALE * scaled.values(y).cost

    constraints = [
        {"type": "eq", "fun": lambda y: scaled.values(y).equality, "jac": lambda y: derivatives(y)[1]},
        {"type": "ineq", "fun": lambda y: scaled.values(y).margins, "jac": lambda y: derivatives(y)[2]},
    ]
    return _slsqp(scaled, cost, lambda y: derivatives(y)[0], constraints, iterations)


def _slsqp(
    scaled: ScaledProblem,
    cost: Callable[[FloatArray], float],
    gradient: Callable[[FloatArray], FloatArray],
    constraints: list[dict[str, Any]],
    iterations: int,
) -> tuple[FloatArray, int, str]:
    answer = minimize(
        cost,
        np.zeros(scaled.size),
        jac=gradient,
        method="SLSQP",
        bounds=list(zip(scaled.low, scaled.high, strict=True)),
        constraints=constraints,
        callback=scaled.follow,
        options={"maxiter": iterations, "ftol": 1e-9},
    )
    return answer.x, int(answer.nit), str(answer.message)


def trust_constr(scaled: ScaledProblem, iterations: int = 3000) -> tuple[FloatArray, int, str]:
    """SciPy trust-constr with the package's exact gradients, BFGS for the Hessian of the objective."""

    def equality_jacobian(y: FloatArray) -> csr_array:
        return csr_array(scaled.equality_jacobian(y))

    def margins_jacobian(y: FloatArray) -> csr_array:
        return csr_array(scaled.margins_jacobian(y))

    constraints = [
        NonlinearConstraint(scaled.equality, 0.0, 0.0, jac=equality_jacobian, hess=BFGS()),
        NonlinearConstraint(scaled.margins, 0.0, np.inf, jac=margins_jacobian, hess=BFGS()),
    ]
    answer = minimize(
        scaled.cost,
        np.zeros(scaled.size),
        jac=scaled.gradient,
        hess=BFGS(),
        method="trust-constr",
        bounds=Bounds(scaled.low, scaled.high),
        constraints=constraints,
        callback=scaled.follow,
        options={"maxiter": iterations},
    )
    return answer.x, int(answer.nit), str(answer.message)


def ipopt(scaled: ScaledProblem, iterations: int = 1000) -> tuple[FloatArray, int, str]:
    """IPOPT, limited-memory Hessian, with the package's exact gradients through a CasADi callback."""
    scaled.stops = False  # IPOPT keeps the limit itself
    nlp = _PackageNlp(scaled)
    y = ca.MX.sym("y", scaled.size)
    cost, rows = nlp(y)
    options = {
        "print_time": False,
        "show_eval_warnings": False,
        "ipopt.print_level": 0,
        "ipopt.sb": "yes",
        "ipopt.hessian_approximation": "limited-memory",
        "ipopt.mu_strategy": "adaptive",
        "ipopt.max_iter": iterations,
        "ipopt.max_cpu_time": scaled.limit,
    }
    solver = ca.nlpsol("package", "ipopt", {"x": y, "f": cost, "g": rows}, options)
    low = np.zeros(scaled.equalities + scaled.inequalities)
    high = np.where(np.arange(len(low)) < scaled.equalities, 0.0, np.inf)
    answer = solver(x0=np.zeros(scaled.size), lbx=scaled.low, ubx=scaled.high, lbg=low, ubg=high)
    stats = solver.stats()
    return np.array(answer["x"]).ravel(), int(stats["iter_count"]), str(stats["return_status"])


class _PackageNlp(ca.Callback):
    """y -> objective, equality and margins; the package supplies the Jacobians."""

    def __init__(self, scaled: ScaledProblem) -> None:
        ca.Callback.__init__(self)
        self.scaled, self.rows = scaled, scaled.equalities + scaled.inequalities
        self.construct("package_nlp", {})

    def get_n_in(self) -> int:
        return 1

    def get_n_out(self) -> int:
        return 2

    def get_sparsity_in(self, _: int) -> ca.Sparsity:
        return ca.Sparsity.dense(self.scaled.size, 1)

    def get_sparsity_out(self, i: int) -> ca.Sparsity:
        return ca.Sparsity.dense((1, self.rows)[i], 1)

    def eval(self, arguments: list[ca.DM]) -> list[Any]:
        point = self.scaled.point(np.array(arguments[0]).ravel())
        return [COST_SCALE * point.cost, np.concatenate([point.equality, point.margins])]

    def has_jacobian(self) -> bool:
        return True

    def get_jacobian(self, name: str, inames: list[str], onames: list[str], options: dict[str, Any]) -> ca.Function:
        self.derivative = _PackageJacobian(self.scaled, self.rows, name, options)
        return self.derivative


class _PackageJacobian(ca.Callback):
    def __init__(self, scaled: ScaledProblem, rows: int, name: str, options: dict[str, Any]) -> None:
        ca.Callback.__init__(self)
        self.scaled, self.rows = scaled, rows
        self.construct(name, options)

    def get_n_in(self) -> int:
        return 3  # y and the two nominal outputs

    def get_n_out(self) -> int:
        return 2

    def get_sparsity_in(self, i: int) -> ca.Sparsity:
        return ca.Sparsity.dense(self.scaled.size, 1) if i == 0 else ca.Sparsity((1, self.rows)[i - 1], 1)

    def get_sparsity_out(self, i: int) -> ca.Sparsity:
        return ca.Sparsity.dense((1, self.rows)[i], self.scaled.size)

    def eval(self, arguments: list[ca.DM]) -> list[Any]:
        y = np.array(arguments[0]).ravel()
        scaled = self.scaled
        rows = np.concatenate([scaled.equality_jacobian(y), scaled.margins_jacobian(y)])
        return [scaled.gradient(y)[None], rows]
