"""A gait is called one when it walks: design, walk, and where it falls ask more of what governs the fall.

The closed form certifies the orbit of the model under control in continuous time. What a robot meets is a walker that
sees sensors only and holds its torques for a millisecond. Where that does not walk `STEPS` steps, in our simulator and,
where it is installed, in MuJoCo, the specification is tightened (`tightening`) as long as the gait costs no more than a
stated share beyond the one that was asked for.
"""

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from frontal_biped.arrays import FloatArray
from frontal_biped.design.optimise import DesignResult, optimise_gait
from frontal_biped.design.search import Progress
from frontal_biped.design.sideways import LEFT_OUT, SidewaysResult, design_sideways_gait
from frontal_biped.design.tightening import Tightening, tightenings
from frontal_biped.design.walk_trial import STEPS, WalkTrial, try_walk
from frontal_biped.exceptions import SpecificationError
from frontal_biped.gait.gait import Gait
from frontal_biped.gait.shipped import load_specification
from frontal_biped.gait.sideways import AnyGait, SidewaysGait
from frontal_biped.gait.specification import GaitSpecification, default_specification
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.catalogue import RobotLike, biped_of

BUDGET = 0.25
"""Share of J that may be given away for a gait that walks [-]."""

DEAR = 0.02
"""Share of J from which on a tightened gait is looked for from a second start [-]."""

MOST_DESIGNS = 8
"""Tightened designs that are tried."""

Tell = Callable[[str], None]
"""Called with a line that says what is being done."""


def design_gait(
    biped: RobotLike,
    specification: GaitSpecification | str | Path | None = None,
    *,
    quick: bool = False,
    start: AnyGait | FloatArray | None = None,
    attempts: int = 1,
    advise: bool = True,
    budget: float = BUDGET,
    on_progress: Progress | None = None,
    on_step: Callable[[str, int], None] | None = None,
    tell: Tell | None = None,
) -> DesignResult | SidewaysResult:
    """A gait of least J under C01 to C09 that walks; with ``travel`` in the specification one that travels sideways.

    Args:
        biped: the robot, in any of its views, or by name or path.
        specification: the bounds, also by name or path as `load_specification`; default: `default_specification`.
        quick: leave out the walk; the gait's provenance says so.
        start: see `optimise_gait`; with travel a gait, see `design_sideways_gait`.
        attempts: see `optimise_gait`; with travel there is one.
        advise: see `optimise_gait`.
        budget: share of J that may be given away [-].
        on_progress: see `optimise_gait`.
        on_step: called with the engine and the number of completed steps of a walk.
        tell: called with a line on every walk that failed and what is tried against it.

    Returns:
        With travel as `design_sideways_gait`; otherwise as `optimise_gait`; ``walk`` and ``tightened`` say how it
        walked, and what was asked beyond the specification.
        No gait where none of those tried walks; the message says why.

    Raises:
        UnreachablePoseError: no double support pose exists at the start.
        SpecificationError: the FRI margin leaves no room in the robot's sole, ``attempts`` is below 1 or ``budget``
            negative.
    """
    if not budget >= 0.0:
        raise SpecificationError(f"budget = {budget:g} of J is negative; give the share that may be given away")
    biped = biped_of(biped)
    if isinstance(specification, str | Path):
        specification = load_specification(specification)
    spec = default_specification(biped) if specification is None else specification
    if spec.travel is not None:
        if attempts != 1 or not isinstance(start, Gait | SidewaysGait | None):
            raise SpecificationError(
                "travel: a gait that travels sideways is designed once, from a gait; leave out attempts and variables"
            )
        return design_sideways_gait(biped, spec, quick=quick, start=start, on_progress=on_progress, on_step=on_step)
    if isinstance(start, SidewaysGait):
        raise SpecificationError(
            "start: two steps in turn start no gait of equal steps; give one on the spot, or travel"
        )
    first = optimise_gait(biped, spec, start=start, attempts=attempts, advise=advise, on_progress=on_progress)
    if first.gait is None:
        return first
    if quick:
        return replace(first, gait=replace(first.gait, provenance={**first.gait.provenance, "walk": LEFT_OUT}))
    search = _Search(biped, first, budget, on_progress, on_step, tell or (lambda line: None))
    return search.run(spec)


class _Search:
    """Looks for a gait that walks, from one that is certified."""

    def __init__(
        self,
        biped: FrontalBiped,
        first: DesignResult,
        budget: float,
        on_progress: Progress | None,
        on_step: Callable[[str, int], None] | None,
        tell: Tell,
    ) -> None:
        assert first.gait is not None
        self.biped, self.first, self.budget = biped, first, budget
        self.cheapest = first.gait.orbit.cost
        self.on_progress, self.on_step, self.tell = on_progress, on_step, tell
        self.designs = 0
        self.seconds, self.iterations, self.evaluations = first.seconds, first.iterations, first.evaluations

    def run(self, spec: GaitSpecification) -> DesignResult:
        """The first gait that walks, or why there is none."""
        assert self.first.gait is not None
        trial = self._walk(self.first.gait)
        if trial.walked:
            return self._done(self.first, trial, ())
        found = self._tightened(spec, self.first.gait, trial, ())
        if found is not None:
            return found
        failure = trial.failure
        message = (
            f"a certified gait was found, J = {self.cheapest:.4f} N^2 m s, but it does not walk: {failure}; of"
            f" {self.designs} tighter ones within {100.0 * self.budget:.0f} % of its J none does; change the"
            " specification, allow a larger budget, or take it as it is with quick"
        )
        return self._counted(replace(self.first, gait=None, success=False, message=message, walk=trial))

    def _tightened(
        self, spec: GaitSpecification, gait: Gait, trial: WalkTrial, before: tuple[Tightening, ...]
    ) -> DesignResult | None:
        """Depth first: against the event that ended the walk, and where another one ends the next, against that."""
        failure = trial.failure
        assert failure is not None
        self.tell(f"does not walk: {failure}")
        for change in tightenings(spec, failure.outcome):
            if self.designs >= MOST_DESIGNS:
                return None
            change = replace(change, event=failure.outcome, engine=failure.engine)
            try:
                tighter = change.of(spec)
                self.designs += 1
                result = self._cheapest(tighter, gait)
            except SpecificationError:
                continue  # no room for that in the sole
            if result.gait is None or result.gait.orbit.cost > (1.0 + self.budget) * self.cheapest:
                self.tell(f"with {change.key} = {change.new} {'no gait' if result.gait is None else 'too dear'}")
                continue
            self.tell(f"tightened: {change}; J {100.0 * (result.gait.orbit.cost / self.cheapest - 1.0):+.2f} %")
            again = self._walk(result.gait)
            changes = (*before, change)
            if again.walked:
                return self._done(result, again, changes)
            if again.failure is not None and again.failure.outcome != failure.outcome:
                found = self._tightened(tighter, result.gait, again, changes)
                if found is not None:
                    return found
        return None

    def _cheapest(self, spec: GaitSpecification, gait: Gait) -> DesignResult:
        """From the problem's own start, and where that leads to none or to a dear one from the gait before as well."""
        results: list[DesignResult] = []
        for start in (None, gait):
            result = optimise_gait(
                self.biped, spec, start=start, fall_back=start is not None, advise=False, on_progress=self.on_progress
            )
            self.seconds += result.seconds
            self.iterations += result.iterations
            self.evaluations += result.evaluations
            results.append(result)
            if result.gait is not None and result.gait.orbit.cost < (1.0 + DEAR) * self.cheapest:
                break
        return min(results, key=lambda result: math.inf if result.gait is None else result.gait.orbit.cost)

    def _walk(self, gait: Gait) -> WalkTrial:
        return try_walk(self.biped, gait, STEPS, self.on_step)

    def _done(self, result: DesignResult, trial: WalkTrial, changes: tuple[Tightening, ...]) -> DesignResult:
        assert result.gait is not None
        given_away = result.gait.orbit.cost / self.cheapest - 1.0
        record: dict[str, Any] = {
            "engines": trial.as_dict(),
            "tightened": [str(change) for change in changes],
            "cost_given_away": given_away,
        }
        gait = replace(result.gait, provenance={**result.gait.provenance, "walk": record})
        message = f"{result.message}; walks {STEPS} steps"
        if changes:
            message += f", for {100.0 * given_away:.2f} % of J: {'; '.join(str(change) for change in changes)}"
        return self._counted(replace(result, gait=gait, message=message, walk=trial, tightened=changes))

    def _counted(self, result: DesignResult) -> DesignResult:
        return replace(result, seconds=self.seconds, iterations=self.iterations, evaluations=self.evaluations)
