"""Design a gait: optimise, close the orbit, check on a dense grid, tighten where it disagrees, simulate a step."""

import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.design.closing import ClosedStep, close_step
from frontal_biped.design.explanation import Conflict, Remedy, conflicts, remedy
from frontal_biped.design.problem import DesignProblem
from frontal_biped.design.trust_region_sqp import SqpResult, SqpSettings, minimise
from frontal_biped.design.verification import RETURN_TOLERANCE, Verification, verify
from frontal_biped.exceptions import ReversalError, SpecificationError, UnreachablePoseError
from frontal_biped.files.provenance import software_versions
from frontal_biped.gait.check import ConstraintReport, check_constraints
from frontal_biped.gait.gait import Gait
from frontal_biped.gait.specification import GaitSpecification, default_specification
from frontal_biped.model.biped import FrontalBiped

OPTIMISER_NODES = 16
"""Quadrature nodes a phase in the optimiser: about 1e-7 in J; the result is integrated again until 1e-11."""

TIGHTENING_ROUNDS = 8
SAFETY = 1e-7  # every scaled constraint keeps this distance in the optimiser, against its own tolerance
RESIDUAL_TOLERANCE = 1e-9
SPREAD = 0.5
"""Standard deviation of the starts of a multi-start, in units of the variables' scales."""

FEASIBILITY = SqpSettings(stop_when_feasible=True, max_iterations=150)
"""Settings that ask whether a step exists, not what it costs."""

RESCUES = 2
"""Further starts that are tried before a specification is called impossible."""

Progress = Callable[[int, float, float], None]


@dataclass(frozen=True)
class DesignResult:
    """Outcome of a design.

    Attributes:
        gait: the gait, or None when the specification could not be met.
        report: C01 to C09 on the dense grid at the point where the optimiser stopped; None where no step exists.
        success: gait found, every constraint satisfied on the grid, every residual below 1e-9, and one step of the
            full model simulated that returns to where it began.
        message: one line: what was reached, or which constraints contradict each other and what to relax first.
        iterations: of the optimiser, all rounds and starts.
        evaluations: of objective and constraints, all rounds and starts.
        seconds: wall time.
        conflicts: the contradicting constraints of a specification that could not be met.
        remedy: a change of the specification that was tried and leaves a gait.
        verification: the simulated step; None where there was no candidate.
    """

    gait: Gait | None
    report: ConstraintReport | None
    success: bool
    message: str
    iterations: int
    evaluations: int
    seconds: float
    conflicts: tuple[Conflict, ...] = ()
    remedy: Remedy | None = None
    verification: Verification | None = None


# a nearest point without an orbit is told by its values, not by warnings
@np.errstate(over="ignore", invalid="ignore", divide="ignore")
def design_gait(
    biped: FrontalBiped,
    specification: GaitSpecification | None = None,
    *,
    start: Gait | FloatArray | None = None,
    attempts: int = 1,
    fall_back: bool = True,
    advise: bool = True,
    on_progress: Progress | None = None,
) -> DesignResult:
    """Minimise J under C01 to C09.

    Args:
        biped: the robot.
        specification: the bounds; default: `default_specification`, what the robot's description asks for.
        start: a gait, or (P,) variables of `DesignProblem`, to start from; default: the problem's own start.
        attempts: designs from as many starts, the further ones drawn at random (``seed`` of the specification) around
            the default; the cheapest gait is kept.
        fall_back: where a start leads nowhere, try the problem's own start and two random ones as well.
        advise: where there is no gait, look for a remedy; it takes a few designs more.
        on_progress: called with iteration, J [N^2 m s] and largest scaled violation.

    Returns:
        The gait and its report, or why there is none.

    Raises:
        UnreachablePoseError: no double support pose exists at the start.
        SpecificationError: the FRI margin leaves no room in the robot's sole, or ``attempts`` is below 1.
    """
    spec = default_specification(biped) if specification is None else specification
    outer, inner = biped.sole
    if 2.0 * spec.fri_margin >= inner - outer:
        raise SpecificationError(
            f"fri_margin = {spec.fri_margin:g} m leaves no room in a sole of {inner - outer:g} m; reduce it"
        )
    if attempts < 1:
        raise SpecificationError(f"attempts = {attempts} is below 1; a design needs a start")
    began = time.perf_counter()
    design = _Design(biped, spec, on_progress)
    candidates: list[_Candidate] = []
    for number, x in enumerate(_starts(design.problem, spec, start, attempts)):
        if number >= attempts and (not fall_back or any(candidate.good for candidate in candidates)):
            break  # the default start only stands in for a start that led nowhere
        candidates.append(design.run(x))
    if fall_back and not any(candidate.good for candidate in candidates):
        candidates += design.rescue()
    best = min(candidates, key=lambda candidate: (not candidate.good, candidate.figure))
    result = design.conclude(best) if best.good else design.explain(best, advise)
    return replace(result, seconds=time.perf_counter() - began)


def _starts(
    problem: DesignProblem, spec: GaitSpecification, start: Gait | FloatArray | None, attempts: int
) -> Iterator[FloatArray]:
    default = problem.start()
    low, high = problem.bounds()
    if start is not None:
        yield np.clip(
            problem.variables(start) if isinstance(start, Gait) else np.asarray(start, dtype=float), low, high
        )
    else:
        yield default
    rng = np.random.default_rng(spec.seed)
    for _ in range(attempts - 1):
        yield _drawn(problem, rng)
    if start is not None:
        yield default


def _drawn(problem: DesignProblem, rng: np.random.Generator) -> FloatArray:
    """A random start around the default one, of any step width."""
    low, high = problem.bounds()
    x = problem.start() + SPREAD * problem.scale() * rng.normal(size=problem.size)
    x[2] = rng.uniform(*problem.specification.step_width)
    return np.clip(x, low, high)


class _Candidate(NamedTuple):
    """Where one start led."""

    x: FloatArray
    result: SqpResult
    problem: DesignProblem
    closed: ClosedStep | None
    report: ConstraintReport | None
    obstacle: str

    @property
    def good(self) -> bool:
        return self.result.feasible and self.report is not None and self.report.satisfied

    @property
    def figure(self) -> float:
        """What candidates are compared by: cost of a gait, violation of a failure."""
        return self.result.cost if self.good else self.result.violation


class _Design:
    """One specification, designed for from one or several starts."""

    def __init__(self, biped: FrontalBiped, spec: GaitSpecification, on_progress: Progress | None) -> None:
        self.biped, self.spec, self.on_progress = biped, spec, on_progress
        self.problem = DesignProblem(biped, spec, OPTIMISER_NODES, SAFETY)
        self.iterations = self.evaluations = 0

    def run(self, x: FloatArray) -> _Candidate:
        """Optimise from x; tighten and repeat where the dense grid finds a violation between the nodes."""
        problem = DesignProblem(self.biped, self.spec, OPTIMISER_NODES, SAFETY)
        low, high = problem.bounds()
        x = problem.restored(x)
        for _ in range(TIGHTENING_ROUNDS):
            result = minimise(problem.evaluate, x, low, high, problem.scale(), SqpSettings(), self._progress())
            self.iterations += result.iterations
            self.evaluations += result.evaluations
            x = result.x
            try:
                closed = close_step(problem, x, newton=result.feasible)
            except (ReversalError, UnreachablePoseError) as error:
                return _Candidate(x, result, problem, None, None, str(error))
            x = closed.x
            report = check_constraints(self.biped, self.spec, *closed.phases, closed.step)
            if report.satisfied or not result.feasible:
                break
            problem.tighten(report.shortfall)
        return _Candidate(x, result, problem, closed, report, "")

    def rescue(self) -> list[_Candidate]:
        """Before a specification is called impossible: look for any step from a few more starts, and go on from there.

        Ends with the first gait.
        """
        rng = np.random.default_rng([self.spec.seed, 1])
        found = []
        for _ in range(RESCUES):
            x = self._step_from(self.problem, _drawn(self.problem, rng))
            if x is not None:
                found.append(self.run(x))
                if found[-1].good:
                    break
        return found

    def _step_from(self, problem: DesignProblem, x: FloatArray) -> FloatArray | None:
        """Variables of a step that keeps every bound, whatever it costs, in reach of x; None if none was found."""
        low, high = problem.bounds()
        result = minimise(problem.evaluate, problem.restored(x), low, high, problem.scale(), FEASIBILITY)
        self.iterations += result.iterations
        self.evaluations += result.evaluations
        return result.x if result.feasible else None

    def _progress(self) -> Progress | None:
        on_progress, done = self.on_progress, self.iterations
        if on_progress is None:
            return None
        return lambda count, cost, violation: on_progress(done + count, cost, violation)

    def conclude(self, candidate: _Candidate) -> DesignResult:
        """Residuals and a simulated step decide whether the candidate is a gait."""
        assert candidate.closed is not None
        gait = candidate.closed.gait(self.problem)
        residuals = gait.residuals(self.biped, candidate.closed.step)
        name = max(residuals, key=lambda key: residuals[key])
        if residuals[name] > RESIDUAL_TOLERANCE:
            bound = f"{residuals[name]:.2g}, above {RESIDUAL_TOLERANCE:g}"
            return self._result(None, candidate, f"the gait's residual {name} is {bound}; try another degree")
        verification = verify(self.biped, gait)
        if not verification.passed:
            seen = f"outcome {verification.outcome}, return error {verification.return_error:.2g}"
            message = f"a simulated step of the candidate does not return within {RETURN_TOLERANCE:g}: {seen}"
            return self._result(None, candidate, f"{message}; try another degree", verification)
        provenance: dict[str, Any] = {
            "versions": software_versions(),
            "seed": self.spec.seed,
            "solver": {
                "status": candidate.result.message,
                "iterations": self.iterations,
                "evaluations": self.evaluations,
            },
            "residuals": residuals,
            "simulated_step": asdict(verification),
        }
        orbit = gait.orbit
        message = f"J = {orbit.cost:.4f} N^2 m s, multiplier {orbit.multiplier:.4f}, all constraints satisfied"
        return self._result(replace(gait, provenance=provenance), candidate, message, verification)

    def explain(self, candidate: _Candidate, advise: bool) -> DesignResult:
        """Which constraints contradict each other where the optimiser ended, and what to relax first."""
        causes = conflicts(candidate.problem, candidate.result)
        if not causes or candidate.result.feasible:
            return self._result(None, candidate, _nearest(candidate))
        cure = None
        if advise:
            cure = remedy(self.biped, self.spec, causes, lambda changed: self._feasible(changed, candidate.x))
        listed = "; ".join(str(cause) for cause in causes[:4])
        more = f" and {len(causes) - 4} more" if len(causes) > 4 else ""
        advice = f"; {cure}" if cure else "; no single one of those tried is enough to relax" if advise else ""
        together = "these contradict each other" if len(causes) > 1 else "this contradicts the other constraints"
        message = f"no gait was found; where the search ended {together}: {listed}{more}{advice}"
        return replace(self._result(None, candidate, message), conflicts=causes, remedy=cure)

    def _feasible(self, changed: GaitSpecification, x: FloatArray) -> bool:
        """Does a step exist under another specification, in reach of x?"""
        return self._step_from(DesignProblem(self.biped, changed, OPTIMISER_NODES, SAFETY), x) is not None

    def _result(
        self, gait: Gait | None, candidate: _Candidate, message: str, verification: Verification | None = None
    ) -> DesignResult:
        return DesignResult(
            gait,
            candidate.report,
            gait is not None,
            message,
            self.iterations,
            self.evaluations,
            0.0,
            verification=verification,
        )


def _nearest(candidate: _Candidate) -> str:
    """What stands in the way where no multipliers tell: no step at all, or one that the dense grid refuses."""
    if candidate.obstacle:
        return f"no step exists where the optimiser stopped: {candidate.obstacle}; relax the specification"
    report, result = candidate.report, candidate.result
    if report is None or not report.violated:
        violation = f"{result.message}, violation {result.violation:.2g}"
        return f"no periodic orbit found: {violation}; widen step_duration or step_width"
    worst = [
        f"{check.code} {check.name}: {check.value:.4g} {check.unit}, bound {check.bound:.4g}"
        for check in report.violated[:4]
    ]
    more = f" and {len(report.violated) - 4} more" if len(report.violated) > 4 else ""
    return f"the specification could not be met, nearest point violates {'; '.join(worst)}{more}; relax one of these"
