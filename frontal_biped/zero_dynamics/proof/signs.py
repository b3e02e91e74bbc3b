"""How many zeros a function has on an interval, from signs of balls: its own, or its slope's.

An interval is cut until on every piece the function has one sign, or its slope has. Neighbouring pieces with a slope of
one sign make a run on which the function is monotone: one zero if its signs at the two ends differ, none if they agree.
Nothing is assumed and nothing sampled: what balls cannot tell stays undecided, and says where.
"""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

from frontal_biped.zero_dynamics.proof.balls import Ball, is_negative, is_positive
from frontal_biped.zero_dynamics.proof.half_step import NotEnclosedError


class Kind(Enum):
    """What is known of a function on a piece."""

    POSITIVE = "positive"
    NEGATIVE = "negative"
    INCREASING = "increasing"
    DECREASING = "decreasing"
    UNDECIDED = "undecided"

    @property
    def decided(self) -> bool:
        """Is anything known?"""
        return self is not Kind.UNDECIDED

    @property
    def monotone(self) -> bool:
        """Is it known that the function is?"""
        return self in (Kind.INCREASING, Kind.DECREASING)


class Known(NamedTuple):
    """A function on a piece.

    Attributes:
        value: ball of its values.
        slope: ball of its derivatives.
    """

    value: Ball
    slope: Ball

    @property
    def kind(self) -> Kind:
        """What they tell."""
        for ball, positive, negative in (
            (self.value, Kind.POSITIVE, Kind.NEGATIVE),
            (self.slope, Kind.INCREASING, Kind.DECREASING),
        ):
            if is_positive(ball):
                return positive
            if is_negative(ball):
                return negative
        return Kind.UNDECIDED


class Piece(NamedTuple):
    """An interval and what the function is on it.

    Attributes:
        low: left end, an exact number.
        high: right end.
        kind: of the function.
    """

    low: float
    high: float
    kind: Kind


@dataclass(frozen=True)
class ProvedCount:
    """The zeros of a function on an interval.

    Attributes:
        pieces: that cover it.
        zeros: intervals that contain exactly one each.
        undecided: intervals of which it is not known how many they contain.
    """

    pieces: tuple[Piece, ...]
    zeros: tuple[tuple[float, float], ...]
    undecided: tuple[tuple[float, float], ...]

    @property
    def exact(self) -> bool:
        """Is the number of zeros known?"""
        return not self.undecided


def cut(on: Callable[[float, float], Known], low: float, high: float, least: float, most: int) -> tuple[Piece, ...]:
    """Pieces of an interval, halved until they tell something.

    Args:
        on: encloses the function on an interval.
        low: left end.
        high: right end.
        least: width below which a piece stays undecided.
        most: intervals that may be looked at; what is left then is undecided.
    """
    pieces: list[Piece] = []
    todo, looked = [(low, high)], 0
    while todo:
        a, b = todo.pop()
        looked += 1
        kind = Kind.UNDECIDED
        if looked <= most:
            with suppress(NotEnclosedError):
                kind = on(a, b).kind
            if kind is Kind.UNDECIDED and b - a > least:
                middle = 0.5 * (a + b)
                todo += [(middle, b), (a, middle)]
                continue
        pieces.append(Piece(a, b, kind))
    return tuple(pieces)


def count(pieces: tuple[Piece, ...], at: Callable[[float], Ball]) -> ProvedCount:
    """The zeros on the pieces.

    Args:
        pieces: from left to right, each beginning where the one before ends.
        at: encloses the function at a point.
    """
    zeros: list[tuple[float, float]] = []
    undecided: list[tuple[float, float]] = []
    for low, high, kind in _runs(pieces):
        if kind is Kind.UNDECIDED:
            undecided.append((low, high))
        elif kind.monotone:
            signs = [sign_at(at, end) for end in (low, high)]
            if 0 in signs:
                undecided.append((low, high))
            elif signs[0] != signs[1]:
                zeros.append((low, high))
    return ProvedCount(pieces, tuple(zeros), tuple(undecided))


def _runs(pieces: tuple[Piece, ...]) -> list[Piece]:
    """Neighbours of one kind together."""
    runs: list[Piece] = []
    for piece in pieces:
        if runs and runs[-1].kind is piece.kind:
            runs[-1] = Piece(runs[-1].low, piece.high, piece.kind)
        else:
            runs.append(piece)
    return runs


def sign_throughout(pieces: tuple[Piece, ...], at: Callable[[float], Ball]) -> int:
    """The one sign that a function has on all of the pieces: 1 or -1; 0 where that is not known.

    Args:
        pieces: from left to right, each beginning where the one before ends.
        at: encloses the function at a point.
    """
    found = count(pieces, at)
    return sign_at(at, pieces[0].low) if found.exact and not found.zeros else 0


def place_of_zero(at: Callable[[float], Ball], low: float, high: float, width: float) -> tuple[float, float]:
    """An interval of a width, if possible, with a zero that is known to lie between two points, by bisection.

    Args:
        at: encloses the function at a point.
        low: left end.
        high: right end, where the function has the other sign.
        width: that will do.
    """
    sign = sign_at(at, low)
    while high - low > width:
        middle = 0.5 * (low + high)
        found = sign_at(at, middle)
        if found == 0:
            break
        low, high = (middle, high) if found == sign else (low, middle)
    return low, high


def sign_at(at: Callable[[float], Ball], point: float) -> int:
    """1 or -1; 0 where balls do not tell, or there is none."""
    try:
        value = at(point)
    except NotEnclosedError:
        return 0
    return 1 if is_positive(value) else -1 if is_negative(value) else 0
