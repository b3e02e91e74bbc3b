"""Design a gait that travels sideways: from the gait on the spot, along the travel where it is far.

Two equal steps are a solution without travel, and are carried over to the travel asked for (`two_step_start`). Where
that leads nowhere half as much is tried first, and so on, every pair of steps starting the next one. What is found is
closed to rounding, checked on a grid forty times denser, judged like every gait (`gait.sideways_verdict`), simulated
for two steps in the full model, and walked under its walker.
"""

import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.design.closing import meet_equalities
from frontal_biped.design.optimise import OPTIMISER_NODES, SAFETY, optimise_gait
from frontal_biped.design.restoration import restored
from frontal_biped.design.search import FINER, FINEST, NEARLY, ROUNDS, WORTH_FINER, WORTH_FINEST, Progress
from frontal_biped.design.trust_region_sqp import SqpResult, SqpSettings, minimise
from frontal_biped.design.two_step_problem import TwoStepProblem
from frontal_biped.design.verification import RETURN_TOLERANCE, SETTINGS, Verification
from frontal_biped.design.walk_trial import STEPS, WalkTrial, try_walk
from frontal_biped.exceptions import ReversalError, SpecificationError, UnreachablePoseError
from frontal_biped.files.counted import counted
from frontal_biped.files.provenance import software_versions
from frontal_biped.files.shown import html_table
from frontal_biped.gait.check import ConstraintReport
from frontal_biped.gait.gait import Gait, RobotReference
from frontal_biped.gait.robot_path import named_description
from frontal_biped.gait.sideways import SidewaysGait, SidewaysStep, quadrature_of, two_step_numbers
from frontal_biped.gait.sideways_verdict import judge_sideways
from frontal_biped.gait.specification import GaitSpecification, default_specification
from frontal_biped.gait.two_step_constraints import TwoPhases, check_two_steps
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.catalogue import RobotLike, biped_of
from frontal_biped.numerics.verdict import Verdict
from frontal_biped.simulation.walking import simulate
from frontal_biped.zero_dynamics.two_steps import TwoSteps

STRIDE, SHORTEST = 0.1, 0.0025
"""Travel added from one pair of steps to the next at most, and at least [m]."""

LEFT_OUT = "left out (quick)"
"""What a gait file says of the walk of a gait that was not walked."""


@dataclass(frozen=True)
class SidewaysResult:
    """Outcome of a design.

    Attributes:
        gait: the gait, or None when the specification could not be met.
        report: C01 to C09 of both steps on the dense grid, where the optimiser stopped; None where no steps exist.
        message: one line: what was reached, or what stands in the way.
        iterations: of the optimiser, all rounds and starts.
        evaluations: of objective and constraints, all rounds and starts.
        seconds: wall time.
        verification: two simulated steps; None where there was no candidate.
        walk: how it walked; None where that was left out.
    """

    gait: SidewaysGait | None
    report: ConstraintReport | None
    message: str
    iterations: int
    evaluations: int
    seconds: float
    verification: Verification | None = None
    walk: WalkTrial | None = None

    @property
    def success(self) -> bool:
        """Was a gait found and certified?"""
        return self.gait is not None

    def __repr__(self) -> str:
        return "SidewaysResult" + "".join(f"\n{name:8} {text}" for name, text in self._rows)

    def _repr_html_(self) -> str:
        report = "" if self.report is None else "\n" + self.report._repr_html_()
        return html_table(self._rows) + report

    @property
    def _rows(self) -> list[tuple[str, str]]:
        work = (
            f"{counted(self.iterations, 'iteration')}, {counted(self.evaluations, 'evaluation')}, {self.seconds:.1f} s"
        )
        rows = [("gait", "none" if self.gait is None else repr(self.gait)), ("message", self.message), ("search", work)]
        return rows if self.walk is None else [*rows, ("walk", str(self.walk))]


# a nearest point without an orbit is told by its values, not by warnings
@np.errstate(over="ignore", invalid="ignore", divide="ignore")
def design_sideways_gait(
    robot: RobotLike,
    specification: GaitSpecification | None = None,
    *,
    quick: bool = False,
    start: Gait | SidewaysGait | None = None,
    on_progress: Progress | None = None,
    on_step: Callable[[str, int], None] | None = None,
) -> SidewaysResult:
    """Two steps in turn of least mean J under C01 to C09 that travel as far as the specification asks.

    Args:
        robot: the robot, in any of its views, or by name or path.
        specification: the bounds, with ``travel``; default: `default_specification`.
        quick: leave out the walk; the gait's provenance says so.
        start: a gait to start from, on the spot or of another travel; default: the cheapest on the spot, or where
            there is none a swayed stand.
        on_progress: called with iteration, J [N^2 m s] and largest scaled violation.
        on_step: called with the engine and the number of completed steps of a walk.

    Returns:
        The gait and its report, or why there is none. A gait that is certified but does not walk is none.

    Raises:
        UnreachablePoseError: no double support pose exists at the start.
        SpecificationError: ``travel`` is not given, or the FRI margin leaves no room in the robot's sole.
    """
    began = time.perf_counter()
    biped = biped_of(robot)
    spec = default_specification(biped) if specification is None else specification
    if spec.travel is None:
        raise SpecificationError("travel is not given: a gait that travels sideways needs it, in metres per two steps")
    search = TwoStepSearch(biped, on_progress)
    x, travel = _start(search, spec, start)
    last: Candidate | None = None
    for candidate in search.along(spec, x, travel):
        last = candidate
    assert last is not None
    result = _conclude(search, spec, last)
    if result.gait is not None and not quick:
        result = _walked(biped, result, on_step)
    elif result.gait is not None:
        provenance = {**result.gait.provenance, "walk": LEFT_OUT}
        result = replace(result, gait=replace(result.gait, provenance=provenance))
    return replace(result, seconds=time.perf_counter() - began)


def _start(
    search: "TwoStepSearch", spec: GaitSpecification, given: Gait | SidewaysGait | None
) -> tuple[FloatArray, float]:
    """Variables to start from, and their travel [m]."""
    problem = TwoStepProblem(search.biped, spec, OPTIMISER_NODES, SAFETY)
    layout = problem.step.layout
    if isinstance(given, SidewaysGait):
        equal = TwoStepProblem(search.biped, replace(spec, travel=given.travel), OPTIMISER_NODES, SAFETY)
        a, b = (layout.of(step) for step in given.steps)
        return equal.joined(a, b), given.travel
    if given is None:
        on_the_spot = optimise_gait(
            search.biped, replace(spec, travel=None), advise=False, on_progress=search.on_progress
        )
        search.iterations += on_the_spot.iterations
        search.evaluations += on_the_spot.evaluations
        given = on_the_spot.gait
    one = problem.step.start() if given is None else layout.of(given)
    equal = TwoStepProblem(search.biped, replace(spec, travel=0.0), OPTIMISER_NODES, SAFETY)
    return equal.joined(one, one), 0.0


def _conclude(search: "TwoStepSearch", spec: GaitSpecification, last: "Candidate") -> SidewaysResult:
    """The verdict and two simulated steps decide whether the last candidate is a gait."""

    def none(message: str, verification: Verification | None = None) -> SidewaysResult:
        return SidewaysResult(None, last.report, message, search.iterations, search.evaluations, 0.0, verification)

    biped, reached = search.biped, last.problem.travel
    if not last.good:
        why = last.obstacle or (
            last.report.tightest
            if last.report is not None and last.report.violated
            else f"{last.result.message}, violation {last.result.violation:.2g}"
        )
        where = f"the search ended at a travel of {reached:.4g} m" if reached != spec.travel else "where it ended"
        return none(f"no gait was found; {where}: {why}; ask for less travel, or relax the specification")
    assert last.closed is not None
    assert last.report is not None
    gait = gait_at(last.problem, last.closed)
    judged = judge_sideways(biped, gait)
    if judged.verdict is not Verdict.CERTIFIED:
        reasons = "; ".join(objection.reason for objection in judged.objections)
        return none(
            f"the steps found are no certified gait ({judged.verdict.value}): {reasons}; try another travel or degree,"
            " or a max_multiplier below 1"
        )
    verification = verify_two_steps(biped, gait)
    if not verification.passed:
        seen = f"outcome {verification.outcome}, return error {verification.return_error:.2g}"
        return none(
            f"two simulated steps do not return within {RETURN_TOLERANCE:g}: {seen}; try another travel or degree",
            verification,
        )
    provenance: dict[str, Any] = {
        "versions": software_versions(),
        "seed": spec.seed,
        "solver": {
            "status": last.result.message,
            "iterations": search.iterations,
            "evaluations": search.evaluations,
        },
        "residuals": judged.residuals,
        "simulated_steps": asdict(verification),
    }
    message = (
        f"J = {gait.cost:.4f} N^2 m s, {gait.travel:.4g} m in {gait.duration:.4g} s, multiplier {gait.multiplier:.4f},"
        " all constraints satisfied"
    )
    found = replace(gait, provenance=provenance)
    return SidewaysResult(found, last.report, message, search.iterations, search.evaluations, 0.0, verification)


def _walked(biped: FrontalBiped, result: SidewaysResult, on_step: Callable[[str, int], None] | None) -> SidewaysResult:
    """The result, its gait walked; no gait where it falls."""
    assert result.gait is not None
    trial = try_walk(biped, result.gait, STEPS, on_step)
    if trial.failure is not None:
        message = (
            f"a certified gait was found, {result.message}, but it does not walk: {trial.failure}; change the"
            " specification, or take it as it is with quick"
        )
        return replace(result, gait=None, message=message, walk=trial)
    provenance = {**result.gait.provenance, "walk": {"engines": trial.as_dict()}}
    gait = replace(result.gait, provenance=provenance)
    return replace(result, gait=gait, message=f"{result.message}; walks {STEPS} steps", walk=trial)


def verify_two_steps(biped: FrontalBiped, gait: SidewaysGait) -> Verification:
    """Simulate two steps in the full model, control in continuous time: they must return to where they began."""
    run = simulate(biped, gait, steps=2, period=None, simulation_settings=SETTINGS, stabiliser="fixed")
    states = run.post_impact_states()
    if run.fell or len(states) < 1:
        return Verification(run.outcome, float("inf"), float("inf"))
    error = float(np.max(np.abs(states[-1] - np.concatenate(gait.state_after_impact()))))
    return Verification(run.outcome, error, float(run.t[-1] - gait.duration))


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
        x = before = restored(problem, x)
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
                reached, x, stride = ahead, candidate.closed.x, min(2.0 * stride, STRIDE)
            elif ahead - reached <= 1.2 * SHORTEST:
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
        x = meet_equalities(problem, x, nodes)
        phases = problem.phases(x)
    return ClosedSteps(x, phases, problem.steps(x, phases, nodes))


def gait_at(problem: TwoStepProblem, closed: ClosedSteps) -> SidewaysGait:
    """The closed steps as a gait of the problem's robot and specification, without provenance."""
    biped = problem.biped
    reference = RobotReference(biped.name, named_description(biped.path), biped.fingerprint)
    numbers = two_step_numbers(biped, closed.steps)
    of_steps = zip(closed.phases, problem.widths(closed.x), numbers, strict=True)
    a, b = (SidewaysStep(*own, width, orbit, problem.specification) for own, width, orbit in of_steps)
    return SidewaysGait(reference, a, b)
