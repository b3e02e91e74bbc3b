"""Constraints as rows of margins: which value stands in which row, and what the row means."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from frontal_biped.arrays import FloatArray
from frontal_biped.gait.constraints import STEP_WIDTH, Constraint


class MarginRow(NamedTuple):
    """A run of margins that belong to one side of one constraint.

    Attributes:
        code: of the constraint.
        name: of the constraint.
        key: entry of the specification that sets the bound, or "".
        unit: of the bound.
        bound: as the specification or the robot has it.
        distance: that the margins keep from it, in scaled units.
        scale: units per scaled unit.
        entries: where in the margins.
    """

    code: str
    name: str
    key: str
    unit: str
    bound: float
    distance: float
    scale: float
    entries: slice


class MarginLayout(NamedTuple):
    """Margins (k,) = (values[picks] - bound) factor.

    Attributes:
        picks: (k,) indices of the values.
        bound: (k,).
        factor: (k,) sign over scale.
        meaning: of the rows.
    """

    picks: NDArray[np.intp]
    bound: FloatArray
    factor: FloatArray
    meaning: tuple[MarginRow, ...]


def lay_out(constraints: Sequence[Constraint], distance: Callable[[Constraint], float]) -> MarginLayout:
    """Rows of margins for the values of all constraints, one after another.

    Args:
        constraints: of one evaluation; they come in the same order and sizes in every other.
        distance: what a constraint keeps from its bounds, in units of its scale.

    Returns:
        The layout, the same for every evaluation until bounds are tightened.
    """
    picks, bounds, factors, meaning = [], [], [], []
    begin = row = 0
    for constraint in constraints:
        picked = np.arange(begin, begin + len(constraint.values))
        begin += len(picked)
        if constraint.name == STEP_WIDTH:
            continue  # a variable, bounded as such
        kept = constraint.sides(distance(constraint))
        for (bound, sign), (asked, _) in zip(kept, constraint.sides(), strict=True):
            picks.append(picked)
            bounds.append(bound)
            factors.append(sign / constraint.scale)
            code, name, unit, scale = constraint.code, constraint.name, constraint.unit, constraint.scale
            entries, row = slice(row, row + len(picked)), row + len(picked)
            key = constraint.keys[0 if sign > 0.0 else 1]
            meaning.append(MarginRow(code, name, key, unit, asked, abs(bound - asked) / scale, scale, entries))
    sizes = [len(picked) for picked in picks]
    return MarginLayout(np.concatenate(picks), np.repeat(bounds, sizes), np.repeat(factors, sizes), tuple(meaning))
