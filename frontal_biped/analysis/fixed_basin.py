r"""Speeds from which the paper's fixed transitions return, by walks of the full model at 1 kHz.

They leave Z at once, and no closed form says what remains of a speed error after some steps; it is all but proportional
to it, and a few walks say where `RECOVERED` remains. With the errors e_0, .., e_n of one walk, of which each is rho(e)
times the one before it and log rho grows by c e, a walk from x e_0 should end with

.. math:: x\,e_n\,\bigl(1 + c\,(x - 1) \sum_{k<n} e_k\bigr),

to first order in what rho changes. That is where to look; the edges of the basin are two walks, one that returns and
one that does not.
"""

from bisect import bisect
from collections.abc import Callable, Sequence
from functools import partial
from math import log, sqrt

import numpy as np

from frontal_biped.analysis.push_recovery import RECORDING, RECOVERED, STEPS_TO_DECIDE, held_walk, speed_errors
from frontal_biped.analysis.return_map import Basin
from frontal_biped.gait.gait import Gait
from frontal_biped.model.biped import FrontalBiped

FIXED_ERRORS, FIRST_ERROR = (0.0, 0.02, 0.05, 0.1, 0.2, 0.4), 0.1
"""Relative speed errors that bound the cells of a search, and which of them is tried first: a return passes by the
smaller ones."""

SPEED_RESOLUTION = 0.005

FROM_BELOW = 0.8
"""Where between a return and a fall the next walk is tried: one that falls takes a seventh of another's time."""

Walk = tuple[str, Sequence[float]]
"""What is in the way of a return, empty where there is nothing; and the errors on the way, empty after a fall [-]."""


def fixed_basin(biped: FrontalBiped, gait: Gait) -> Basin:
    """Speeds from which the paper's fixed transitions return."""

    def walked(sense: float, size: float) -> Walk:
        steps, error = STEPS_TO_DECIDE, sense * size
        run = held_walk(biped, gait, "fixed", steps=steps, speed_error=error, simulation_settings=RECORDING)
        if run.fell:
            return run.outcome, ()
        errors = speed_errors(run, gait).tolist()
        return "" if errors[-1] <= RECOVERED else f"not back within {steps} steps", errors

    below, above = (largest_error(partial(walked, sense)) for sense in (-1.0, 1.0))
    return Basin(1.0 - below[0], 1.0 + above[0], below[1], above[1])


def largest_error(walked: Callable[[float], Walk]) -> tuple[float, str]:
    """The largest error that returns, and what is in the way of more, to `SPEED_RESOLUTION`.

    Args:
        walked: a walk from an error [-].
    """
    errors = _cells()
    found: dict[int, Walk] = {0: ("", (0.0,))}
    good, bad, place = 0, len(errors), errors.index(FIRST_ERROR)
    while bad - good > 1:
        found[place] = walked(errors[place])
        good, bad = (good, place) if found[place][0] else (place, bad)
        place = min(max(_next(errors, found, good, bad), good + 1), bad - 1)
    return errors[good], found[bad][0] if bad in found else "nothing up to the end of the search"


def _cells() -> list[float]:
    """The ends of the cells, in order, the first and the last of `FIXED_ERRORS` among them [-]."""
    errors = [FIXED_ERRORS[0]]
    for end in FIXED_ERRORS[1:]:
        cells = 1
        while end - errors[-1] > cells * SPEED_RESOLUTION:
            cells *= 2
        errors += np.linspace(errors[-1], end, cells + 1).tolist()[1:]
    return errors


def _next(errors: list[float], found: dict[int, Walk], good: int, bad: int) -> int:
    """Which error to try between one that returns and one that does not."""
    returned, left = found[good][1], found[bad][1][-1:] if bad in found else ()
    if bad == len(errors):
        expected = returned[0] * growth_to(RECOVERED, returned)
        after = bisect(errors, expected)
        return after - (after == len(errors) or expected - errors[after - 1] < errors[after] - expected)
    if left:  # a share of what remains
        return good + int((RECOVERED - returned[-1]) / (left[0] - returned[-1]) * (bad - good))
    coarse = max(error for error in FIXED_ERRORS if error < errors[bad])
    return errors.index(coarse) if coarse > errors[good] else good + int(FROM_BELOW * (bad - good))


def growth_to(remainder: float, errors: Sequence[float]) -> float:
    """By how much to multiply the first error of a walk that returns, so that a remainder is left at its end [-]."""
    wanted = remainder / max(errors[-1], 1e-12)
    # rho of the second step and of the last one; the first step begins on Z, as no other does
    if not min(errors) > 0.0 or errors[1] <= errors[-2]:
        return wanted
    c = log(errors[2] / errors[1] * errors[-2] / errors[-1]) / (errors[1] - errors[-2])
    bend = c * sum(errors[:-1])
    # of bend x^2 + (1 - bend) x = wanted the root that is ``wanted`` without a bend
    square = (1.0 - bend) ** 2 + 4.0 * bend * wanted
    under = 1.0 - bend + sqrt(max(square, 0.0))
    return 2.0 * wanted / under if square >= 0.0 and under > 0.0 else wanted
