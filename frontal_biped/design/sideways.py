"""Design a gait that travels sideways: from the gait on the spot, step by step along the travel.

Two equal steps are a solution without travel. The travel grows from there, every pair of steps starting the next one;
where none is found half as much is tried. What is found is closed to rounding, checked on a grid forty times denser,
judged like every gait (`gait.sideways_verdict`), and simulated for two steps in the full model.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.design.closing import CLOSED, NEWTON_STEPS
from frontal_biped.design.optimise import OPTIMISER_NODES, SAFETY
from frontal_biped.design.search import FINER, FINEST, NEARLY, ROUNDS, WORTH_FINER, WORTH_FINEST, Progress
from frontal_biped.design.trust_region_sqp import SqpResult, SqpSettings, minimise
from frontal_biped.design.two_step_problem import TwoStepProblem
from frontal_biped.exceptions import ReversalError, UnreachablePoseError
from frontal_biped.gait.check import ConstraintReport
from frontal_biped.gait.gait import RobotReference
from frontal_biped.gait.robot_path import named_description
from frontal_biped.gait.sideways import SidewaysGait, SidewaysStep, quadrature_of, two_step_numbers
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.gait.two_step_constraints import TwoPhases, check_two_steps
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.zero_dynamics.poincare import step_orbit
from frontal_biped.zero_dynamics.two_steps import TwoSteps

STRIDE, SHORTEST = 0.1, 0.0025
"""Travel added from one pair of steps to the next, and the least that is tried [m]."""


class ClosedSteps(NamedTuple):
    """Two steps on the converged quadrature.

    Attributes:
        x: (2 P - 1,) variables.
        phases: of both.
        steps: both through their planned reversals.
    """

    x: FloatArray
    phases: TwoPhases
    steps: TwoSteps


class Candidate(NamedTuple):
    """Where one start led.

    Attributes:
        problem: as tightened.
        result: of the optimiser, in the last round.
        closed: both steps; None where they do not exist.
        report: on the dense grid; None likewise.
        obstacle: why there are none; empty where there are.
    """

    problem: TwoStepProblem
    result: SqpResult
    closed: ClosedSteps | None
    report: ConstraintReport | None
    obstacle: str

    @property
    def good(self) -> bool:
        """Do the steps keep every constraint?"""
        return self.result.violation <= NEARLY and self.report is not None and self.report.satisfied


class TwoStepSearch:
    """Looks for pairs of steps, and counts what it takes.

    Args:
        biped: the robot.
        on_progress: called with iteration, J [N^2 m s] and largest scaled violation.

    Attributes:
        iterations: of the optimiser, all rounds and starts.
        evaluations: of objective and constraints, all rounds and starts.
    """

    def __init__(self, biped: FrontalBiped, on_progress: Progress | None = None) -> None:
        self.biped, self.on_progress = biped, on_progress
        self.iterations = self.evaluations = 0

    def cheapest(self, problem: TwoStepProblem, x: FloatArray) -> Candidate:
        """The cheapest pair of steps in reach of x; nodes and bounds are refined as `Search.cheapest` does."""
        x = before = problem.restored(x)
        coarse = problem.nodes
        for _ in range(ROUNDS):
            result = self._minimise(problem, x)
            candidate = _checked(problem, result)
            report, size = candidate.report, problem.nodes
            if report is None or candidate.good:
                break
            if result.violation > NEARLY:
                if not problem.tightened or size >= FINEST:
                    break
                problem, x = problem.on_nodes(FINER * size, problem.tighten_by), before
                continue
            assert candidate.closed is not None
            before = x = candidate.closed.x
            if size < FINEST and max(report.shortfall.values()) > (WORTH_FINER if size == coarse else WORTH_FINEST):
                problem = problem.on_nodes(FINER * size, problem.tighten_by)
            else:
                problem.tighten(report.shortfall)
        return candidate

    def along(self, specification: GaitSpecification, x: FloatArray, begin: float = 0.0) -> Iterator[Candidate]:
        """The cheapest pairs of steps on the way to a travel, the last one at it or, no good, where the way ends.

        Args:
            specification: whose travel is the end of the way.
            x: (2 P - 1,) variables at its beginning.
            begin: travel there [m].
        """
        end = specification.travel or 0.0
        reached, stride = begin, STRIDE
        while True:
            ahead = end if end - reached < 1.2 * stride else reached + stride
            problem = TwoStepProblem(self.biped, replace(specification, travel=ahead), OPTIMISER_NODES, SAFETY)
            candidate = self.cheapest(problem, problem.carried(x, reached))
            if candidate.good:
                assert candidate.closed is not None
                yield candidate
                if ahead == end:
                    return
                reached, x, stride = ahead, candidate.closed.x, STRIDE
            elif ahead - reached <= SHORTEST:
                yield candidate
                return
            else:
                stride = max(0.5 * min(stride, ahead - reached), SHORTEST)

    def _minimise(self, problem: TwoStepProblem, x: FloatArray) -> SqpResult:
        low, high = problem.bounds()
        done, told = self.iterations, self.on_progress
        show = None if told is None else lambda count, cost, violation: told(done + count, cost, violation)
        result = minimise(problem.evaluate, x, low, high, problem.scale(), SqpSettings(), show)
        self.iterations += result.iterations
        self.evaluations += result.evaluations
        return result


def _checked(problem: TwoStepProblem, result: SqpResult) -> Candidate:
    """The optimiser's answer on the dense grid, its equalities taken to rounding where they nearly hold."""
    try:
        closed = close_steps(problem, result.x, newton=result.violation <= NEARLY)
    except (ReversalError, UnreachablePoseError) as error:
        return Candidate(problem, result, None, None, str(error))
    report = check_two_steps(problem.biped, problem.specification, closed.phases, closed.steps)
    return Candidate(problem, result, closed, report, "")


def close_steps(problem: TwoStepProblem, x: FloatArray, newton: bool = True) -> ClosedSteps:
    """The steps at x (2 P - 1,) on as many quadrature nodes as they need, as `close_step` for one.

    Raises:
        UnreachablePoseError: a final pose does not exist.
        ReversalError: a phase has no range of beta.
    """
    biped, phases = problem.biped, problem.phases(x)
    nodes = quadrature_of(biped, phases, problem.widths(x)).nodes
    if newton:
        x = _newton(problem.on_nodes(nodes), x)
        phases = problem.phases(x)
    of_steps = zip(phases, problem.widths(x), strict=True)
    return ClosedSteps(x, phases, TwoSteps(*(step_orbit(biped, *own, width, nodes) for own, width in of_steps)))


def _newton(problem: TwoStepProblem, x: FloatArray) -> FloatArray:
    """Newton steps of least length on the equalities; variables on or next to their bounds stay where they are."""
    low, high = problem.bounds()
    for _ in range(NEWTON_STEPS):
        point = problem.evaluate(x)
        if np.max(np.abs(point.equality)) < CLOSED:
            break
        room = np.minimum(x - low, high - x)
        scale = np.where(room > 1e-6 * problem.scale(), problem.scale(), 0.0)
        rows = point.equality_jacobian * scale
        x = np.clip(x - scale * np.linalg.lstsq(rows, point.equality, rcond=None)[0], low, high)
    return x


def gait_at(problem: TwoStepProblem, closed: ClosedSteps) -> SidewaysGait:
    """The closed steps as a gait of the problem's robot and specification, without provenance."""
    biped = problem.biped
    reference = RobotReference(biped.name, named_description(biped.path), biped.fingerprint)
    numbers = two_step_numbers(biped, closed.steps)
    of_steps = zip(closed.phases, problem.widths(closed.x), numbers, strict=True)
    a, b = (SidewaysStep(*own, width, orbit, problem.specification) for own, width, orbit in of_steps)
    return SidewaysGait(reference, a, b)
