"""Tabulates what looking ahead answers, so that a robot looks it up within its millisecond.

After a landing as planned a step depends on one number, the speed. `LookAheadTransitions.foreseen` is asked on a grid
outwards from the gait's speed, as far as steps keep the limits; between two grid points that differ the change is found
by bisection. An answer that holds on less than a cell of the grid, between equal ones, is not seen.

Only what is chosen is tabulated. The phases are anchored to where the robot is, on the planned pose or off it.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from frontal_biped.control.stabilisers.look_ahead import Foreseen, LookAheadTransitions, made_for
from frontal_biped.gait.gait import Gait
from frontal_biped.gait.look_ahead_table import Choice, LookAheadTable
from frontal_biped.model.biped import FrontalBiped

CELL = 0.002
"""Of the grid: relative speed [-]."""

ENDS = 1e-8
"""Accuracy of the ends of an interval, relative speed [-]; speeds are not known better, after a walk of some steps."""

SLOWEST, FASTEST = 0.3, 3.0
"""Relative speeds beyond which nobody looks: robots that return from there are not known [-]."""

GAP = 0.02
"""Relative speeds on end at which limits are broken, after which they are taken to be broken for good [-]."""

Known = tuple[float, Foreseen]
"""A relative speed [-], and what is foreseen there."""


def tabulated(
    biped: FrontalBiped,
    gait: Gait,
    slowest: float = SLOWEST,
    fastest: float = FASTEST,
    on_speed: Callable[[float], None] | None = None,
) -> Gait:
    """The gait with the table of its answers, which `save_gait` keeps; takes a minute or so.

    Args:
        biped: the robot.
        gait: the gait.
        slowest: relative speed below which nobody looks [-], below 1.
        fastest: relative speed beyond which nobody looks [-], above 1.
        on_speed: called with every relative speed that is asked for [-].
    """
    stabiliser = LookAheadTransitions(biped, gait, look_up=False)

    def foreseen(ratio: float) -> Foreseen | None:
        if on_speed is not None:
            on_speed(ratio)
        return stabiliser.foreseen(ratio)

    at_gait = foreseen(1.0)
    assert at_gait is not None  # a gait reverses
    known: list[Known] = [(1.0, at_gait)]
    for sense, end in ((-1.0, slowest), (1.0, fastest)):
        known += _outwards(foreseen, sense, end)
    known.sort(key=lambda at: at[0])
    points = [known[0]]
    for at in known[1:]:
        points += [*_changes(foreseen, points[-1], at), at]
    return replace(gait, look_ahead=_table(points, made_for(biped, gait)))


def _outwards(ask: Callable[[float], Foreseen | None], sense: float, end: float) -> list[Known]:
    """Grid points on one side of the gait's speed, up to `GAP` past the last that keeps the limits."""
    found: list[Known] = []
    kept = 0
    for k in range(1, int(abs(end - 1.0) / CELL) + 1):
        ratio = 1.0 + sense * k * CELL
        foreseen = ask(ratio)
        if foreseen is not None:
            found.append((ratio, foreseen))
            if foreseen.keeps_limits:
                kept = len(found)
        if kept < len(found) - GAP / CELL or (foreseen is None and k > len(found) + GAP / CELL):
            break
    return found


def _changes(ask: Callable[[float], Foreseen | None], a: Known, b: Known) -> list[Known]:
    """Between two speeds, the pairs of neighbouring speeds with different answers."""
    if a[1].choice == b[1].choice:
        return []
    middle = 0.5 * (a[0] + b[0])
    if b[0] - a[0] < ENDS:
        return []
    foreseen = ask(middle)
    if foreseen is None:
        return []
    at = (middle, foreseen)
    return [*_changes(ask, a, at), at, *_changes(ask, at, b)]


def _table(points: list[Known], digest: str) -> LookAheadTable:
    """Runs of equal answers."""
    low: list[float] = []
    high: list[float] = []
    choices: list[Choice] = []
    reversals: list[list[float]] = []
    for ratio, foreseen in points:
        if choices and choices[-1] == foreseen.choice:
            high[-1], reversals[-1][1] = ratio, foreseen.reversal
            continue
        low.append(0.5 * (high[-1] + ratio) if high else ratio)
        if high:
            high[-1] = low[-1]
        high.append(ratio)
        choices.append(foreseen.choice)
        reversals.append([foreseen.reversal, foreseen.reversal])
    return LookAheadTable(digest, np.array(low), np.array(high), tuple(choices), np.array(reversals))
