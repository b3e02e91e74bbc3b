"""From a start to the cheapest step: optimise, close the orbit, check on the dense grid, tighten where it disagrees."""

from collections.abc import Callable
from typing import NamedTuple

from frontal_biped.arrays import FloatArray
from frontal_biped.design.closing import ClosedStep, close_step
from frontal_biped.design.problem import DesignProblem
from frontal_biped.design.trust_region_sqp import SqpResult, SqpSettings, minimise
from frontal_biped.exceptions import ReversalError, UnreachablePoseError
from frontal_biped.gait.check import ConstraintReport, check_constraints

TIGHTENING_ROUNDS = 8

FEASIBILITY = SqpSettings(stop_when_feasible=True, max_iterations=150)
"""Settings that ask whether a step exists, not what it costs."""

Progress = Callable[[int, float, float], None]


class Candidate(NamedTuple):
    """Where one start led.

    Attributes:
        x: (P,) variables.
        result: of the optimiser, in the last round.
        problem: as tightened.
        closed: the step on converged quadrature nodes; None where there is none.
        report: the constraints on the dense grid; None without a step.
        obstacle: why there is no step; empty where there is one.
    """

    x: FloatArray
    result: SqpResult
    problem: DesignProblem
    closed: ClosedStep | None
    report: ConstraintReport | None
    obstacle: str

    @property
    def good(self) -> bool:
        """Does it keep every constraint?"""
        return self.result.feasible and self.report is not None and self.report.satisfied

    @property
    def figure(self) -> float:
        """What candidates are compared by: cost of a gait, violation of a failure."""
        return self.result.cost if self.good else self.result.violation


class Search:
    """Looks for steps, and counts what it takes.

    Args:
        on_progress: called with iteration, J [N^2 m s] and largest scaled violation.

    Attributes:
        iterations: of the optimiser, all rounds and starts.
        evaluations: of objective and constraints, all rounds and starts.
    """

    def __init__(self, on_progress: Progress | None = None) -> None:
        self.on_progress = on_progress
        self.iterations = self.evaluations = 0

    def cheapest(self, problem: DesignProblem, x: FloatArray) -> Candidate:
        """The cheapest step in reach of x; the problem is tightened where the dense grid finds a violation."""
        x = problem.restored(x)
        for _ in range(TIGHTENING_ROUNDS):
            result = self._minimise(problem, x, SqpSettings(), self._progress())
            x = result.x
            try:
                closed = close_step(problem, x, newton=result.feasible)
            except (ReversalError, UnreachablePoseError) as error:
                return Candidate(x, result, problem, None, None, str(error))
            x = closed.x
            report = check_constraints(
                problem.biped, problem.specification, *closed.phases, closed.step, departure=problem.departing
            )
            if report.satisfied or not result.feasible:
                break
            problem.tighten(report.shortfall)
        return Candidate(x, result, problem, closed, report, "")

    def any_step(self, problem: DesignProblem, x: FloatArray) -> FloatArray | None:
        """Variables of a step that keeps every bound, whatever it costs, in reach of x; None if none was found."""
        result = self._minimise(problem, problem.restored(x), FEASIBILITY)
        return result.x if result.feasible else None

    def _minimise(
        self, problem: DesignProblem, x: FloatArray, settings: SqpSettings, on_progress: Progress | None = None
    ) -> SqpResult:
        low, high = problem.bounds()
        result = minimise(problem.evaluate, x, low, high, problem.scale(), settings, on_progress)
        self.iterations += result.iterations
        self.evaluations += result.evaluations
        return result

    def _progress(self) -> Progress | None:
        on_progress, done = self.on_progress, self.iterations
        if on_progress is None:
            return None
        return lambda count, cost, violation: on_progress(done + count, cost, violation)
