"""Why a specification cannot be met: which constraints contradict each other, by how much, and what to relax first.

Where the optimiser ends without a gait it has minimised the largest scaled violation t over all constraints. The
multipliers there are the certificate: divided by their sum, periodicity included, they are a combination of constraints
that cannot be improved together, and relaxing bound i by one scaled unit lowers t by its share w_i. A bound relaxed
alone must therefore give way by t / w_i, to first order. The estimate is not left at that: `remedy` tries it.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from frontal_biped.design.problem import DesignProblem
from frontal_biped.design.trust_region_sqp import SqpResult
from frontal_biped.exceptions import SpecificationError
from frontal_biped.gait.check import ROUNDING
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.model.biped import FrontalBiped

SHARE = 0.02
"""A constraint with less than this weight has no part in the contradiction."""

TRIALS = (1.2, 2.0, 4.0)
"""Multiples of the first-order estimate that a remedy is tried with."""


@dataclass(frozen=True)
class Conflict:
    """One constraint of those that cannot be met together.

    Attributes:
        code: C01..C09 or the key of the specification.
        name: what is bounded.
        key: entry of the specification that sets the bound; "" where physics or the robot do.
        unit: of the bound.
        bound: what is asked for.
        shortfall: by how much the nearest point misses it.
        weight: share in the contradiction among all bounds, 0 to 1; periodicity, which is no bound, is left out.
        relief: by how much this bound alone would have to give way, to first order.
    """

    code: str
    name: str
    key: str
    unit: str
    bound: float
    shortfall: float
    weight: float
    relief: float

    def __str__(self) -> str:
        missed = f" missed by {self.shortfall:.2g} {self.unit}".rstrip() if self.shortfall > 0.0 else ""
        return f"{self.code} {self.name} (bound {self.bound:.4g} {self.unit}){missed}".replace(" )", ")")


def conflicts(problem: DesignProblem, result: SqpResult) -> tuple[Conflict, ...]:
    """The constraints that contradict each other where the optimiser ended, the heaviest first."""
    if result.multipliers is None:
        return ()
    margins, equality, box = result.multipliers
    low, high = problem.bounds()
    scale = problem.scale()
    ends = {i: problem.SPECIFIED_VARIABLES[i] for i in problem.SPECIFIED_VARIABLES if box[i] != 0.0}
    total = float(np.sum(margins) + np.sum(np.abs(equality)))
    of_bounds = float(np.sum(margins) + sum(abs(box[i]) for i in ends))
    if total <= 0.0 or of_bounds <= 0.0:
        return ()
    point = problem.evaluate(result.x)
    found = []
    for row in problem.rows():
        price = float(margins[row.entries].sum())
        if price > SHARE * of_bounds:
            missed = -float(np.min(point.margins[row.entries])) - row.distance  # of what is asked, not of more
            shortfall = missed * row.scale if missed > ROUNDING else 0.0
            relief = result.violation * row.scale * total / price
            weight = price / of_bounds
            found.append(Conflict(row.code, row.name, row.key, row.unit, row.bound, shortfall, weight, relief))
    for i, (lower, upper) in ends.items():
        price = abs(float(box[i]))
        if price > SHARE * of_bounds:
            key, bound = (lower, low[i]) if box[i] > 0.0 else (upper, high[i])
            relief = float(result.violation * scale[i] * total / price)
            found.append(Conflict("C09", "step width", key, "m", float(bound), 0.0, price / of_bounds, relief))
    return tuple(sorted(found, key=lambda conflict: -conflict.weight))


@dataclass(frozen=True)
class Remedy:
    """A change of one entry of the specification that was tried and leaves a step.

    Attributes:
        key: entry of the specification.
        old: its value.
        new: a value with which every constraint can be met.
        specification: with that value.
    """

    key: str
    old: float
    new: float
    specification: GaitSpecification

    def __str__(self) -> str:
        return f"relax {self.key} from {self.old:.4g} to {self.new:.4g} first: tried, a gait exists then"


def remedy(
    biped: FrontalBiped,
    specification: GaitSpecification,
    causes: tuple[Conflict, ...],
    feasible: Callable[[GaitSpecification], bool],
) -> Remedy | None:
    """Relax one entry after another, the one that needs the smallest relative change first, until a step exists.

    Args:
        biped: the robot.
        specification: what could not be met.
        causes: the contradiction.
        feasible: does a step exist under a specification?

    Returns:
        The first change that works, or None if none of those tried does.
    """
    candidates: dict[str, float] = {}
    for cause in causes:
        if cause.key:  # several constraints may share an entry
            weight = 1.0 / candidates.get(cause.key, np.inf) + 1.0 / cause.relief
            candidates[cause.key] = 1.0 / weight
    old = {key: _entry(biped, specification, key) for key in candidates}
    order = sorted(candidates, key=lambda key: candidates[key] / max(abs(old[key]), 1e-9))
    for factor in TRIALS:
        for key in order[:2]:
            try:
                changed = _changed(specification, biped, key, factor * candidates[key])
            except SpecificationError:
                continue
            if feasible(changed):
                return Remedy(key, old[key], _entry(biped, changed, key), changed)
    return None


_LARGER = ("max_", "friction", "yaw_friction", "step_duration[1]", "step_width[1]")
"""Entries that are relaxed by making them larger; all others by making them smaller."""


def _split(key: str) -> tuple[str, int | None]:
    name, _, index = key.partition("[")
    return name, int(index[:-1]) if index else None


def _entry(biped: FrontalBiped, specification: GaitSpecification, key: str) -> float:
    name, index = _split(key)
    value: Any = getattr(specification, name)
    if name == "max_torque" and value is None:
        value = biped.max_torque
    return float(value if index is None else value[index])


def _changed(specification: GaitSpecification, biped: FrontalBiped, key: str, amount: float) -> GaitSpecification:
    """The specification with one entry relaxed; numbers rounded to three digits, towards the looser side."""
    name, index = _split(key)
    old = _entry(biped, specification, key)
    looser = 1.0 if key.startswith(_LARGER) else -1.0
    new = old + looser * amount
    digit = 10.0 ** (np.floor(np.log10(max(abs(new), 1e-6))) - 2.0)
    new = float(np.ceil(new / digit) * digit if looser > 0.0 else np.floor(new / digit) * digit)
    new = float(f"{new:.6g}")
    table = specification.as_dict()
    if index is None:
        table[name] = new
    else:
        parts = [float(value) for value in table.get(name, biped.max_torque)]
        parts[index] = new
        table[name] = parts
    return GaitSpecification.from_dict(table)
