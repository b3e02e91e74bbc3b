"""The shift of the FRI target that brings a wanted speed, enclosed: where the next speed is on either side of it."""

from collections.abc import Callable
from typing import NamedTuple

from frontal_biped.zero_dynamics.proof.balls import Ball, arb
from frontal_biped.zero_dynamics.proof.half_step import NotEnclosedError

PROBE = 1e-4
"""Shift by which it is first seen what a shift does to the next speed [m]."""

SECANTS = 5
"""Steps of the secant rule towards the shift that brings the planned speed."""

CLOSE = 0.1
"""Share of what is not known anyway, to which the planned speed is met."""

WIDENINGS = (1.1, 2.0, 4.0)
"""By which the radius about that shift is multiplied in turn, until signs at its ends tell that it is inside."""

LEAST_RADIUS = 1e-9
"""Of what is not known about a shift [m]."""


class Room(NamedTuple):
    """Shifts that the sole allows; 0 always is [m].

    Attributes:
        low: the farthest outwards.
        high: the farthest inwards.
    """

    low: Ball
    high: Ball


def secants(next_: Callable[[Ball], Ball], low: float, high: float) -> tuple[float, float]:
    """About where the next speed is the planned one, within two shifts, and within what radius [m]."""
    at, known = 0.0, next_(arb(0))
    before, value = (PROBE if high > PROBE else -PROBE), float(known.mid()) - 1.0
    slope = (float(next_(arb(before)).mid()) - 1.0 - value) / (before - at)
    for _ in range(SECANTS):
        last, last_value = at, value
        if slope == 0.0:
            raise NotEnclosedError("what a shift does")
        at = min(max(at - value / slope, low), high)
        if abs(at - last) < LEAST_RADIUS:
            break
        known = next_(arb(at))
        value = float(known.mid()) - 1.0
        slope = (value - last_value) / (at - last)
        if abs(value) < CLOSE * float(known.rad()):
            break
    return at, (float(known.rad()) + abs(value)) / abs(slope) + LEAST_RADIUS


def side(next_: Callable[[Ball], Ball], near: float, radius: float, end: Ball) -> tuple[Ball, Ball]:
    """An end of all shifts that may be chosen, and the square of the next speed beyond the planned one there.

    Args:
        next_: that square by the shift: the farther inwards, the slower.
        near: about where it is the planned one [m].
        radius: of what is not known about that, negative on the side outwards [m].
        end: of the room on that side.
    """
    for widening in WIDENINGS:
        at = arb(near + widening * radius)
        if not (at > end if radius < 0.0 else at < end):
            break
        if next_(at) > 1 if radius < 0.0 else next_(at) < 1:
            return at, arb(1)
    found = next_(end)
    if radius < 0.0:
        return end.lower(), found.lower()
    return end.upper(), found.upper()
