"""What looking ahead answers at every speed after an impact, as a table that is kept with a gait.

There are finitely many ways to go on (`control.stabilisers.look_ahead`), so that the answer is constant on intervals of
the speed; `control.stabilisers.tabulation` finds them. In a gait file, field ``look_ahead``:

    made_for                 digest of robot, gait and method; of another one the table is left aside
    low, high                ends of the intervals, ascending; speeds after the impact relative to the gait's [-]
    stretch                  of the rising phase, relative to its planned range, a multiple of 1/32 [-]
    way                      of falling: "anchored", "retraced" or "rescaled" (`Way`)
    rejoin                   place in the list of lengths over which an early reversal rejoins its path; null: none
    reversal_low,            where the phase reverses at both ends of an interval after a landing as planned [rad]
    reversal_high
"""

from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import GaitFileError
from frontal_biped.files.quoted import quoted
from frontal_biped.files.toml import as_finite

AROUND = 0.02
"""Distance of a reversal from those tabulated up to which the nearest of them answers [rad]."""

PER_UNIT = 32
"""Stretches are multiples of one over this."""

MOST_INTERVALS = 10_000
"""In a file; gaits have some sixty."""


class Way(Enum):
    """How a falling phase begins."""

    ANCHORED = "anchored"
    """A late reversal retraces the rising phase, an early one rejoins the planned path."""
    RETRACED = "retraced"
    """A late reversal retraces the stretched rising phase; the planned path is rescaled to begin where that ends."""
    RESCALED = "rescaled"
    """The planned path is rescaled to begin at the reversal."""


class Descent(NamedTuple):
    """A falling phase.

    Attributes:
        way: how it begins.
        rejoin: place in `REJOINS` of the length over which an early reversal rejoins its path; None: late, or unknown.
    """

    way: Way
    rejoin: int | None = None


class Choice(NamedTuple):
    """The answers of a step.

    Attributes:
        stretch: of the rising phase, relative to the range of the planned one [-].
        descent: the falling phase.
    """

    stretch: float
    descent: Descent


@dataclass(frozen=True)
class LookAheadTable:
    """The answers on intervals of the speed.

    Attributes:
        made_for: digest of robot, gait and method.
        low: (n,) where each interval begins, ascending; speeds after the impact relative to the gait's [-].
        high: (n,) where it ends [-].
        choices: n answers.
        reversals: (n, 2) where the phase reverses at both ends, after a landing as planned [rad].
    """

    made_for: str
    low: FloatArray
    high: FloatArray
    choices: tuple[Choice, ...]
    reversals: FloatArray

    def stretch(self, ratio: float) -> float | None:
        """Of the rising phase after an impact at a relative speed [-]; None where the table does not know."""
        i = int(self.low.searchsorted(ratio, side="right")) - 1
        return self.choices[i].stretch if i >= 0 and ratio <= self.high[i] else None

    def descent(self, stretch: float, reversal: float) -> Descent | None:
        """The falling phase after a stretched rising one, from a reversal [rad]; None where the table does not know."""
        found, nearest = None, AROUND
        for i, low, high in self._of_stretch.get(round(PER_UNIT * stretch), ()):
            distance = max(low - reversal, reversal - high, 0.0)
            if distance < nearest:
                found, nearest = self.choices[i].descent, distance
        return found

    @cached_property
    def _of_stretch(self) -> dict[int, list[tuple[int, float, float]]]:
        """Place and reversals of the intervals of every stretch."""
        found: dict[int, list[tuple[int, float, float]]] = {}
        for i, (choice, (low, high)) in enumerate(zip(self.choices, self.reversals.tolist(), strict=True)):
            found.setdefault(round(PER_UNIT * choice.stretch), []).append((i, low, high))
        return found


def table_to_dict(table: LookAheadTable) -> dict[str, Any]:
    """The table as a gait file holds it."""
    return {
        "made_for": table.made_for,
        "low": table.low.tolist(),
        "high": table.high.tolist(),
        "stretch": [choice.stretch for choice in table.choices],
        "way": [choice.descent.way.value for choice in table.choices],
        "rejoin": [choice.descent.rejoin for choice in table.choices],
        "reversal_low": table.reversals[:, 0].tolist(),
        "reversal_high": table.reversals[:, 1].tolist(),
    }


def table_from_dict(content: Any, where: str) -> LookAheadTable:
    """The table of a gait file; ``where`` begins every complaint.

    Raises:
        GaitFileError: a field is missing, unknown, of the wrong kind or length, or the intervals overlap.
    """
    if not isinstance(content, dict) or content.keys() != {"made_for", *_NUMBERS, "way", "rejoin"}:
        raise GaitFileError(f"{where}: look_ahead is not a table as it is written; leave it out, and tabulate it again")
    made_for, ways, rejoins = content["made_for"], content["way"], content["rejoin"]
    columns = [*(content[key] for key in _NUMBERS), ways, rejoins]
    if not all(isinstance(column, list) and 0 < len(column) <= MOST_INTERVALS for column in columns):
        raise GaitFileError(f"{where}: look_ahead has a column that is no list of 1 to {MOST_INTERVALS} entries")
    if len({len(column) for column in columns}) != 1 or not isinstance(made_for, str):
        raise GaitFileError(f"{where}: look_ahead has columns of unequal lengths, or made_for is not text")
    for key in _NUMBERS:
        for value in content[key]:
            if as_finite(value) is None:
                raise GaitFileError(f"{where}: look_ahead.{key} holds {quoted(value)}, which is not a finite number")
    known = {way.value for way in Way}
    for way, rejoin in zip(ways, rejoins, strict=True):
        if not isinstance(way, str) or way not in known:
            raise GaitFileError(f"{where}: look_ahead.way holds {quoted(way)}; known: {', '.join(sorted(known))}")
        if rejoin is not None and (isinstance(rejoin, bool) or rejoin not in range(LENGTHS)):
            raise GaitFileError(f"{where}: look_ahead.rejoin holds {quoted(rejoin)}, not null or 0 to {LENGTHS - 1}")
    low, high, stretch, *reversals = (np.array(content[key], dtype=float) for key in _NUMBERS)
    if not (np.all(low <= high) and np.all(high[:-1] <= low[1:])):
        raise GaitFileError(f"{where}: look_ahead.low and look_ahead.high are not intervals one after the other")
    descents = (Descent(Way(way), rejoin) for way, rejoin in zip(ways, rejoins, strict=True))
    choices = tuple(Choice(*pair) for pair in zip(stretch.tolist(), descents, strict=True))
    return LookAheadTable(made_for, low, high, choices, np.stack(reversals, axis=1))


LENGTHS = 5
"""Lengths over which an early reversal may rejoin its path."""

_NUMBERS = ("low", "high", "stretch", "reversal_low", "reversal_high")
