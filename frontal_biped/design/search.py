"""From a start to the cheapest step: optimise, close the orbit, check on the dense grid, tighten where it disagrees."""

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

from frontal_biped.arrays import FloatArray
from frontal_biped.design.closing import ClosedStep, close_step
from frontal_biped.design.local_model import largest_violation
from frontal_biped.design.problem import DesignProblem
from frontal_biped.design.restoration import restored
from frontal_biped.design.trust_region_sqp import SqpResult, SqpSettings, minimise
from frontal_biped.exceptions import ReversalError, UnreachablePoseError
from frontal_biped.gait.check import ConstraintReport, check_constraints

ROUNDS = 16
"""Runs of the optimiser from one start, each on nodes or bounds that the dense grid has asked for."""

FINER = 2
"""How many times more nodes the optimiser gets once the dense grid finds a violation between them: moving a bound
inwards costs J in proportion to the violation, which falls with the square of the nodes' distance."""

FINEST = 64
"""Most nodes a phase."""

WORTH_FINER = 1e-4
"""Scaled violation between the first nodes from which on finer ones pay."""

WORTH_FINEST = 5e-3
"""The same between finer nodes: bounds moved inwards by more may throw the optimiser to a far and dear minimum."""

NEARLY = 1e-3
"""Scaled violation up to which the answer of an optimiser that stopped short is closed and checked all the same."""

FEASIBILITY = SqpSettings(stop_when_feasible=True, max_iterations=150)
"""Settings that ask whether a step exists, not what it costs."""

BOLD = replace(FEASIBILITY, cost_scale=1e-4, radius=1.0)
"""The same with long first steps that hardly look at the cost: small ones may creep into a corner that has no step."""

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
        """Does it keep every constraint? The dense grid decides, once the orbit can be closed."""
        return self.result.violation <= NEARLY and self.report is not None and self.report.satisfied

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
        """The cheapest step in reach of x.

        Where the dense grid finds a violation between the optimiser's nodes, these become finer, and what is left of
        it tightens the bounds. Bounds that contradict each other only when tightened are put back, on finer nodes.
        """
        x = restored(problem, x)
        coarse = problem.rule.tau.size
        before = x
        for _ in range(ROUNDS):
            result = self._minimise(problem, x, SqpSettings(), self._progress())
            candidate = self._checked(problem, result)
            report, size = candidate.report, problem.rule.tau.size
            if report is None or candidate.good:
                break
            if result.violation > NEARLY:
                if not problem.tightened or size >= FINEST:
                    break
                problem, x = problem.on_nodes(FINER * size, problem.tighten_by), before
                continue
            before = x = candidate.x
            if size < FINEST and max(report.shortfall.values()) > (WORTH_FINER if size == coarse else WORTH_FINEST):
                problem = problem.on_nodes(FINER * size, problem.tighten_by)
            else:
                problem.tighten(report.shortfall)
        return candidate

    def as_it_is(self, problem: DesignProblem, x: FloatArray) -> Candidate:
        """x itself, closed and checked where its constraints nearly hold."""
        point = problem.evaluate(x)
        violation = largest_violation(point)
        result = SqpResult(x, point.cost, violation, 0, 1, True, violation <= NEARLY, "the start itself")
        self.evaluations += 1
        if violation > NEARLY:
            return Candidate(x, result, problem, None, None, "the start keeps not every constraint")
        return self._checked(problem, result)

    def _checked(self, problem: DesignProblem, result: SqpResult) -> Candidate:
        """The optimiser's answer on the dense grid, its equalities taken to rounding where they nearly hold."""
        try:
            closed = close_step(problem, result.x, newton=result.violation <= NEARLY)
        except (ReversalError, UnreachablePoseError) as error:
            return Candidate(result.x, result, problem, None, None, str(error))
        report = check_constraints(
            problem.biped, problem.specification, *closed.phases, closed.step, departure=problem.departing
        )
        return Candidate(closed.x, result, problem, closed, report, "")

    def any_step(self, problem: DesignProblem, x: FloatArray, settings: SqpSettings = FEASIBILITY) -> FloatArray | None:
        """Variables of a step that keeps every bound, whatever it costs, in reach of x; None if none was found."""
        result = self._minimise(problem, restored(problem, x), settings)
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
