"""Half a step in ball arithmetic: the virtual constraints from an impact to the reversal, and the zero dynamics there.

A half step is a curve from where the robot landed, or will land, to the reversal: the rising phase as it is, the
falling phase backwards. The columns that invariance determines depend on the reversal that is imposed; given as a
`Jet`, everything carries its derivatives by that reversal. About a whole interval of reversals at once balls soon grow
wide; the mean value theorem narrows them by those about its middle (`balls.narrowed`), after each of the few steps of
the computation that matter. So a half step goes in pairs: imposed at the middle of an interval, and at all of it.
"""

from dataclasses import dataclass, replace
from itertools import pairwise
from math import comb
from typing import NamedTuple

from frontal_biped.zero_dynamics.proof.balls import (
    ORDER,
    Ball,
    Jet,
    Number,
    arb,
    coefficient,
    each_pair,
    is_positive,
    narrowed,
    narrowed_jet,
    series,
    value_of,
)
from frontal_biped.zero_dynamics.proof.chain import BallChain


class NotEnclosedError(ArithmeticError):
    """The balls are too wide to tell; narrower ones may."""


class OnCurve(NamedTuple):
    """The zero dynamics at a point of a half step, or as series about it.

    Attributes:
        I_P: [kg m^2].
        drive: kappa_2 / kappa_1.
        moving: what the moving FRI brings, the rate 2 kappa_3 / kappa_1 times I_P.
    """

    I_P: Number
    drive: Number
    moving: Number

    @property
    def rate(self) -> Number:
        """2 kappa_3 / kappa_1 [1/rad].

        Raises:
            NotEnclosedError: I_P may vanish.
        """
        if not is_positive(_constant(self.I_P)):
            raise NotEnclosedError("I_P")
        return self.moving / self.I_P

    def narrowed(self, middle: "OnCurve", h: Ball) -> "OnCurve":
        """About all points of a panel, from those about its centre."""
        return OnCurve(
            *(each_pair(lambda a, b: _narrowed_series(a, b, h), a, b) for a, b in zip(middle, self, strict=True))
        )

    def narrowed_by_parameter(self, middle: "OnCurve", w: Ball) -> "OnCurve":
        """About all reversals of an interval, from those about its middle."""
        return OnCurve(*(narrowed_jet(a, b, w) for a, b in zip(middle, self, strict=True)))


class Curve(NamedTuple):
    """A curve by Bezier columns, and its derivative by beta likewise.

    Attributes:
        columns: degree + 1 of them.
        slopes: degree of them, per rad.
    """

    columns: tuple[Number, ...]
    slopes: tuple[Number, ...]

    @classmethod
    def of(cls, columns: list[Number], span: Number) -> "Curve":
        """The curve of some columns over a range of beta [rad]."""
        M = len(columns) - 1
        return cls(tuple(columns), tuple((b - a) * M / span for a, b in pairwise(columns)))

    def narrowed_by_parameter(self, middle: "Curve", w: Ball) -> "Curve":
        """For all reversals of an interval, from its middle."""
        columns, slopes = (
            tuple(narrowed_jet(a, b, w) for a, b in zip(*pair, strict=True)) for pair in zip(middle, self, strict=True)
        )
        return Curve(columns, slopes)


@dataclass(frozen=True)
class HalfStep:
    """The virtual constraints from the impact to the reversal.

    Attributes:
        chain: the robot.
        span: beta at the reversal minus beta at the impact [rad].
        angles: the links' absolute angles [rad].
        fri: the FRI target [m].
    """

    chain: BallChain
    span: Number
    angles: tuple[Curve, ...]
    fri: Curve

    def at(self, s: Number) -> OnCurve:
        """The zero dynamics at s from the impact, 0, to the reversal, 1."""
        curves = [*self.angles, self.fri]
        degrees = {len(curve.columns) - 1 for curve in curves}
        basis = {M: bernstein(M, s) for M in degrees | {M - 1 for M in degrees}}
        values = [_sum_of(curve.columns, basis) for curve in curves]
        slopes = [_sum_of(curve.slopes, basis) for curve in curves]
        return self._of(values, slopes)

    def _of(self, values: list[Number], slopes: list[Number]) -> OnCurve:
        *angles, p = values
        *rates, dp = slopes
        found = self.chain.momenta(angles, rates)
        I_P = found.momentum.ground - p * found.momentum.v
        drive = (p * self.chain.mass - found.moment) * (I_P * self.chain.gravity)
        return OnCurve(I_P, drive, dp * found.momentum.v * -2)

    def narrowed_by_parameter(self, middle: "HalfStep", w: Ball) -> "HalfStep":
        """For all reversals of an interval, from its middle."""
        angles = tuple(b.narrowed_by_parameter(a, w) for a, b in zip(middle.angles, self.angles, strict=True))
        return replace(self, angles=angles, fri=self.fri.narrowed_by_parameter(middle.fri, w))


def _narrowed_series(middle: Ball, wide: Ball, h: Ball) -> Ball:
    a, b = ([coefficient(x, k) for k in range(ORDER + 1)] for x in (middle, wide))
    return series(narrowed(a, b, h))


def bernstein(degree: int, s: Number) -> list[Number]:
    """Bernstein polynomials at s. As sums of them curves are no wider than their columns are, whatever their order."""
    one: Number = s * 0 + 1
    up, down = [one], [one]
    for _ in range(degree):
        up.append(up[-1] * s)
        down.append(down[-1] * (1 - s))
    return [up[k] * down[degree - k] * comb(degree, k) for k in range(degree + 1)]


def _sum_of(columns: tuple[Number, ...], basis: dict[int, list[Number]]) -> Number:
    polynomials = basis[len(columns) - 1]
    total = times(columns[0], polynomials[0])
    for column, polynomial in zip(columns[1:], polynomials[1:], strict=True):
        total = total + times(column, polynomial)
    return total


def times(a: Number, b: Number) -> Number:
    """The product of a number and a series, a `Jet` first."""
    return b * a if isinstance(b, Jet) else a * b


def _constant(x: Number) -> Ball:
    value = value_of(x)
    return value if isinstance(value, arb) else coefficient(value, 0)
