"""Design a gait: search from one or several starts, simulate a step of what was found, or explain why there is none."""

import time
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.design.explanation import Conflict, Remedy, conflicts, remedy
from frontal_biped.design.problem import COLUMN_REACH, DesignProblem
from frontal_biped.design.search import BOLD, FEASIBILITY, Candidate, Progress, Search
from frontal_biped.design.start import LARGEST_LEAN, swayed_stand
from frontal_biped.design.tightening import Tightening
from frontal_biped.design.variables import STEP_WIDTH
from frontal_biped.design.verification import RETURN_TOLERANCE, Verification, verify
from frontal_biped.design.walk_trial import WalkTrial
from frontal_biped.exceptions import SpecificationError, UnreachablePoseError
from frontal_biped.files.counted import counted
from frontal_biped.files.provenance import software_versions
from frontal_biped.files.shown import html_table
from frontal_biped.gait.check import ConstraintReport
from frontal_biped.gait.gait import Gait
from frontal_biped.gait.shipped import load_specification
from frontal_biped.gait.specification import GaitSpecification, default_specification
from frontal_biped.gait.verdict import judge
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.catalogue import RobotLike, biped_of
from frontal_biped.numerics.verdict import Verdict

OPTIMISER_NODES = 16
"""Quadrature nodes a phase in the optimiser: about 1e-7 in J; the result is integrated again until 1e-11."""

SAFETY = 1e-7  # every scaled constraint keeps this distance in the optimiser, against its own tolerance
SPREAD = 0.5
"""Standard deviation of the starts of a multi-start, in units of the variables' scales."""

RESCUES = 2
"""Random starts that are tried, besides the default one, before a specification is called impossible."""


@dataclass(frozen=True)
class DesignResult:
    """Outcome of a design.

    Attributes:
        gait: the gait, or None when the specification could not be met.
        report: C01 to C09 on the dense grid at the point where the optimiser stopped; None where no step exists.
        success: gait found and certified (see `gait.verdict`), and one step of the full model simulated that returns
            to where it began.
        message: one line: what was reached, or which constraints contradict each other and what to relax first.
        iterations: of the optimiser, all rounds and starts.
        evaluations: of objective and constraints, all rounds and starts.
        seconds: wall time.
        conflicts: the contradicting constraints of a specification that could not be met.
        remedy: a change of the specification that was tried and leaves a gait.
        verification: the simulated step; None where there was no candidate.
        walk: how it walked; None where that was left out.
        tightened: what was asked beyond the specification, so that it walks.
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
    walk: WalkTrial | None = None
    tightened: tuple[Tightening, ...] = ()

    def __repr__(self) -> str:
        return "DesignResult" + "".join(f"\n{name:8} {text}" for name, text in self._rows)

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
def optimise_gait(
    biped: RobotLike,
    specification: GaitSpecification | str | Path | None = None,
    *,
    start: Gait | FloatArray | None = None,
    attempts: int = 1,
    fall_back: bool = True,
    advise: bool = True,
    column_reach: float = COLUMN_REACH,
    on_progress: Progress | None = None,
) -> DesignResult:
    """Minimise J under C01 to C09.

    Args:
        biped: the robot, in any of its views, or by name or path.
        specification: the bounds, also by name or path as `load_specification`; default: `default_specification`,
            what the robot's description asks for.
        start: a gait, or (P,) variables of `DesignProblem`, to start from; default: the problem's own start. One that
            keeps every bound is never lost: the gait designed costs no more.
        attempts: designs from as many starts, the second one a stand that leans out far, the further ones drawn at
            random (``seed`` of the specification) around the default; the cheapest gait is kept.
        fall_back: where a start leads nowhere, try the problem's own start and two random ones as well.
        advise: where there is no gait, look for a remedy; it takes a few designs more.
        column_reach: how far a Bezier column may be from that of the problem's own start [rad].
        on_progress: called with iteration, J [N^2 m s] and largest scaled violation.

    Returns:
        The gait and its report, or why there is none.

    Raises:
        UnreachablePoseError: no double support pose exists at the start.
        SpecificationError: the FRI margin leaves no room in the robot's sole, ``attempts`` is below 1, or the
            specification asks for travel or a finite double support.
    """
    biped = biped_of(biped)
    if isinstance(specification, str | Path):
        specification = load_specification(specification)
    spec = default_specification(biped) if specification is None else specification
    outer, inner = biped.sole
    if 2.0 * spec.fri_margin >= inner - outer:
        raise SpecificationError(
            f"fri_margin = {spec.fri_margin:g} m leaves no room in a sole of {inner - outer:g} m; reduce it"
        )
    if spec.travel is not None:
        raise SpecificationError(
            f"travel = {spec.travel:g} m: a gait of equal steps does not travel; use `design_gait`, or leave travel out"
        )
    if spec.double_support is not None:
        raise SpecificationError(
            f"double_support = {list(spec.double_support)}: a gait with impacts has none that lasts; use"
            " `design_support_gait`, or leave double_support out"
        )
    if attempts < 1:
        raise SpecificationError(f"attempts = {attempts} is below 1; a design needs a start")
    began = time.perf_counter()
    design = _Design(biped, spec, column_reach, on_progress, start)
    candidates: list[Candidate] = []
    for number, x in enumerate(design.starts(attempts)):
        if number >= attempts:
            candidates = design.given(candidates) + candidates
            if not fall_back or any(candidate.good for candidate in candidates):
                break  # the default start only stands in for a start that led nowhere
        candidates.append(design.run(x))
    if fall_back and not any(candidate.good for candidate in candidates):
        candidates += design.rescue()
    best = min(candidates, key=lambda candidate: (not candidate.good, candidate.figure))
    result = design.conclude(best) if best.good else design.explain(best, advise)
    return replace(result, seconds=time.perf_counter() - began)


def _drawn(problem: DesignProblem, rng: np.random.Generator) -> FloatArray:
    """A random start around the default one, of any step width."""
    low, high = problem.bounds()
    x = problem.start() + SPREAD * problem.scale() * rng.normal(size=problem.size)
    x[STEP_WIDTH] = rng.uniform(*problem.specification.step_width)
    return np.clip(x, low, high)


class _Design:
    """One specification, designed for from one or several starts."""

    def __init__(
        self,
        biped: FrontalBiped,
        spec: GaitSpecification,
        column_reach: float,
        on_progress: Progress | None,
        start: Gait | FloatArray | None,
    ) -> None:
        self.biped, self.spec, self.column_reach = biped, spec, column_reach
        self.start: FloatArray | None = None
        if start is not None:
            layout = self._problem(spec).layout
            self.start = layout.of(start) if isinstance(start, Gait) else np.asarray(start, dtype=float)
        self.problem = self._problem(spec)
        self.search = Search(on_progress)

    def _problem(self, spec: GaitSpecification) -> DesignProblem:
        return DesignProblem(
            self.biped, spec, OPTIMISER_NODES, SAFETY, column_reach=self.column_reach, within=self.start
        )

    def starts(self, attempts: int) -> Iterator[FloatArray]:
        """The start given or the default one, a far leaning one, random ones, and the default where another was given.

        Random ones seldom leave the valley that the default one leads into; a step that leans farther may.
        """
        default = self.problem.start()
        yield default if self.start is None else np.clip(self.start, *self.problem.bounds())
        if attempts > 1:
            leaning = self.problem.layout.pack(swayed_stand(self.biped, self.spec, LARGEST_LEAN))
            yield np.clip(leaning, *self.problem.bounds())
        rng = np.random.default_rng(self.spec.seed)
        for _ in range(attempts - 2):
            yield _drawn(self.problem, rng)
        if self.start is not None:
            yield default

    def given(self, others: Sequence[Candidate]) -> list[Candidate]:
        """The start itself where it keeps every bound: the optimiser may lose it, or end dearer.

        Args:
            others: what the optimiser has found; where one of these is a gait and cheaper, the start need not be one.
        """
        if self.start is None:
            return []
        x = np.clip(self.start, *self.problem.bounds())
        try:
            cost = self.problem.evaluate(x).cost
            if any(other.good and other.figure < cost for other in others):
                return []
            candidate = self.search.as_it_is(self.problem, x)
        except UnreachablePoseError:
            return []
        return [candidate] if candidate.good else []

    def run(self, x: FloatArray) -> Candidate:
        """The cheapest step in reach of x."""
        return self.search.cheapest(self.problem.untightened(), x)

    def rescue(self) -> list[Candidate]:
        """Before a specification is called impossible: look for any step from a few more starts, and go on from there.

        Ends with the first gait.
        """
        rng = np.random.default_rng([self.spec.seed, 1])
        drawn = [_drawn(self.problem, rng) for _ in range(RESCUES)]
        trials = [(self.problem.start(), BOLD), *((x, way) for x in drawn for way in (FEASIBILITY, BOLD))]
        found = []
        for start, settings in trials:
            x = self.search.any_step(self.problem, start, settings)
            if x is not None:
                found.append(self.run(x))
                if found[-1].good:
                    break
        return found

    def conclude(self, candidate: Candidate) -> DesignResult:
        """The verdict and a simulated step decide whether the candidate is a gait."""
        closed, report = candidate.closed, candidate.report
        assert closed is not None
        assert report is not None
        gait = closed.gait(self.problem)
        judged = judge(self.biped, gait, checked=(closed.step, report), quadrature=closed.quadrature)
        if judged.verdict is not Verdict.CERTIFIED:
            reasons = "; ".join(objection.reason for objection in judged.objections)
            message = f"the step found is no certified gait ({judged.verdict.value}): {reasons}"
            return self._result(None, candidate, f"{message}; try another degree, or a max_multiplier below 1")
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
                "iterations": self.search.iterations,
                "evaluations": self.search.evaluations,
            },
            "residuals": judged.residuals,
            "simulated_step": asdict(verification),
        }
        orbit = gait.orbit
        message = f"J = {orbit.cost:.4f} N^2 m s, multiplier {orbit.multiplier:.4f}, all constraints satisfied"
        return self._result(replace(gait, provenance=provenance), candidate, message, verification)

    def explain(self, candidate: Candidate, advise: bool) -> DesignResult:
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
        return self.search.any_step(self._problem(changed), x) is not None

    def _result(
        self, gait: Gait | None, candidate: Candidate, message: str, verification: Verification | None = None
    ) -> DesignResult:
        return DesignResult(
            gait,
            candidate.report,
            gait is not None,
            message,
            self.search.iterations,
            self.search.evaluations,
            0.0,
            verification=verification,
        )


def _nearest(candidate: Candidate) -> str:
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
