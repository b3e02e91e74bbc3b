r"""The least value of a function on an interval, from Taylor polynomials with remainders on panels.

On a panel of centre c and half width h a function is :math:`\sum_{k<N} a_k t^k + A_N t^N`, |t| <= h (`passage`). N is
even, so the last term lies in A_N [0, h^N] and widens the constant one. The rest is written in Bernstein's basis: the
polynomial lies between the least and the greatest of its coefficients, the first and the last of which are its values
at the ends of the panel. Halved by de Casteljau's rule the gap shrinks with the square of the width, so few halvings
about a minimum are enough.
"""

from collections.abc import Iterable, Sequence
from fractions import Fraction
from functools import cache
from heapq import heapify, heappush, heapreplace
from itertools import count, pairwise
from math import comb
from typing import NamedTuple

from frontal_biped.zero_dynamics.proof.balls import Ball, arb

HALVINGS = 400
"""Halvings after which a range is left as wide as it is."""


class Enclosed(NamedTuple):
    """A number between two, both of them exact.

    Attributes:
        low: not above it.
        high: not below it.
    """

    low: Ball
    high: Ball


def controls(taylor: Sequence[Ball], h: Ball) -> list[Ball]:
    """Bernstein coefficients of a function on a panel, its remainder included.

    Args:
        taylor: N + 1 Taylor coefficients, the last one the remainder's.
        h: half of the width.
    """
    *exact, rest = taylor
    scaled, power = [], arb(1)
    for a in exact:
        scaled.append(a * power)
        power = power * h
    rest = rest * power * arb(0).union(arb(1))
    found = []
    for weights in _weights(len(exact) - 1):
        terms = [a * weight for a, weight in zip(scaled, weights, strict=True)]
        found.append(sum(terms[1:], terms[0]) + rest)
    return found


@cache
def _weights(degree: int) -> list[list[Ball]]:
    """Bernstein coefficients of (2 x - 1)^k for every k up to the degree, by coefficient: none is larger than 1.

    So what a ball of a Taylor coefficient is wide, its share of the Bernstein coefficients is at most.
    """
    in_x = [[comb(k, i) * 2**i * (-1) ** (k - i) for i in range(k + 1)] for k in range(degree + 1)]

    def weight(row: list[int], j: int) -> Ball:
        exact = sum((a * Fraction(comb(j, i), comb(degree, i)) for i, a in enumerate(row)), Fraction(0))
        return arb(exact.numerator) / exact.denominator

    return [[weight(row, j) for row in in_x] for j in range(degree + 1)]


def least(panels: Iterable[Sequence[Ball]], accuracy: float) -> Enclosed:
    """The least value on some panels.

    Args:
        panels: Bernstein coefficients of each.
        accuracy: at which halving ends, unless the balls themselves are wider.
    """
    number = count()
    pieces = [_Piece.of(list(panel), next(number)) for panel in panels]
    heapify(pieces)
    high = min(piece.at_ends for piece in pieces)
    for _ in range(HALVINGS):
        lowest = pieces[0]
        if float(high) - lowest.order <= accuracy + 2 * float(lowest.coefficients[0].rad()):
            break
        halves = [_Piece.of(half, next(number)) for half in _halved(lowest.coefficients)]
        heapreplace(pieces, halves[0])
        heappush(pieces, halves[1])
        high = min(high, *(half.at_ends for half in halves))
    return Enclosed(min(piece.low for piece in pieces), high)


class _Piece(NamedTuple):
    """A polynomial on a piece.

    Attributes:
        order: its least coefficient, rounded; the heap goes by it.
        number: of pieces before; no two are equal.
        low: its least coefficient, an exact number.
        at_ends: the least it can be at its ends, an exact number not below it.
        coefficients: in Bernstein's basis.
    """

    order: float
    number: int
    low: Ball
    at_ends: Ball
    coefficients: list[Ball]

    @classmethod
    def of(cls, coefficients: list[Ball], number: int) -> "_Piece":
        low = min(a.lower() for a in coefficients)
        at_ends = min(coefficients[0].upper(), coefficients[-1].upper())
        return cls(float(low), number, low, at_ends, coefficients)


def _halved(piece: list[Ball]) -> tuple[list[Ball], list[Ball]]:
    """De Casteljau's rule at the middle."""
    left, right, row = [piece[0]], [piece[-1]], piece
    while len(row) > 1:
        row = [(a + b) / 2 for a, b in pairwise(row)]
        left.append(row[0])
        right.append(row[-1])
    return left, right[::-1]
