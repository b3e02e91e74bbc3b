r"""The path of half a step in ball arithmetic: poses, sole, and the coefficients of the dynamics on Z along it.

With y the share of the way from the reversal, 0, to the impact, 1; forces as `zero_dynamics.restricted` has them,
w = A ddbeta + B dbeta^2 + G, and, ddbeta inserted from N_0 = p_FRI F_v, w = base + gain dbeta^2.
"""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
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
    series,
    sin_cos,
    value_of,
)
from frontal_biped.zero_dynamics.proof.chain import BallChain, Vector
from frontal_biped.zero_dynamics.proof.half_step import Curve, HalfStep, NotEnclosedError, bernstein


class Projected(NamedTuple):
    """A half step at y, or as series about it, without its energy: what is polynomial in the links' sines and cosines.

    Attributes:
        I_P: [kg m^2].
        A: (7,) coefficients of ddbeta in F_h, F_v, N_0, u_1 to u_4 (`zero_dynamics.restricted`).
        B: (7,) those of dbeta^2.
        G: (7,) weight [N], [N m].
        p_fri: [m].
        dp_fri: its derivative by beta [m/rad].
        q: (4,) joints [rad].
        slopes: (4,) dq/dbeta [-].
        tilts: (2,) absolute angles of pelvis and swing foot [rad].
        heights: (2,) of the swing sole's inner and outer end [m].
        lifts: (2,) their derivatives by the share of the way from the impact [m].
    """

    I_P: Number
    A: list[Number]
    B: list[Number]
    G: list[Number]
    p_fri: Number
    dp_fri: Number
    q: list[Number]
    slopes: list[Number]
    tilts: list[Number]
    heights: list[Number]
    lifts: list[Number]


class OnZ(NamedTuple):
    """The zero dynamics there.

    Attributes:
        drive: kappa_2 / kappa_1.
        rate: 2 kappa_3 / kappa_1 [1/rad].
        base: (7,) forces F_h, F_v [N], N_0, u_1 to u_4 [N m] at rest.
        gain: (7,) what dbeta^2 adds.
    """

    drive: Number
    rate: Number
    base: list[Number]
    gain: list[Number]

    @classmethod
    def of(cls, at: Projected) -> "OnZ":
        """By the equation of motion N_0 = p_FRI F_v.

        Raises:
            NotEnclosedError: I_P may vanish.
        """
        I_P, A, B, G, p_fri = at[:5]
        require_positive(I_P, "I_P")
        kappa_2 = p_fri * G[1] - G[2]
        at_rest, bent = kappa_2 / I_P, (B[2] - p_fri * B[1]) / I_P
        return cls(
            kappa_2 * I_P,
            at.dp_fri * A[1] * -2 / I_P,
            [G_i + A_i * at_rest for G_i, A_i in zip(G, A, strict=True)],
            [B_i - A_i * bent for B_i, A_i in zip(B, A, strict=True)],
        )


class Shape(NamedTuple):
    """The virtual constraints at y, or as series about it, with first and second derivatives by beta.

    Attributes:
        alphas: (4,) absolute angles of the links [rad].
        rates: (4,) their first derivatives [-].
        turns: (4,) their second [1/rad].
        q: (4,) joints [rad].
        slopes: (4,) their first derivatives [-].
        bends: (4,) their second [1/rad].
        p_fri: FRI target [m].
        dp_fri: its derivative [m/rad].
    """

    alphas: list[Number]
    rates: list[Number]
    turns: list[Number]
    q: list[Number]
    slopes: list[Number]
    bends: list[Number]
    p_fri: Number
    dp_fri: Number


@dataclass(frozen=True)
class Path(ABC):
    """A way from a reversal down to smaller beta, ready to be asked at any share y of it.

    Attributes:
        chain: the robot.
        sole: ends of the stance sole on the h axis, (outer < 0, inner > 0) [m].
        span: beta at the reversal minus beta where it ends [rad].
    """

    chain: BallChain
    sole: tuple[float, float]
    span: Ball

    @abstractmethod
    def shape(self, y: Number) -> Shape:
        """The virtual constraints at a share of the way from the reversal, 0, to the end, 1."""

    def at(self, y: Number) -> Projected:
        """The dynamics along them there."""
        chain, shape = self.chain, self.shape(y)
        pose = chain.pose(shape.alphas)
        none: list[Number] = [arb(0)] * 4
        G = chain.asked_by(pose, [(arb(0), chain.gravity)] * 4, none, none)
        G[1], G[2] = G[1] + chain.foot_mass * chain.gravity, G[2] + chain.foot_moment * chain.gravity
        A = chain.asked_by(pose, chain.accelerations(pose, none, shape.rates), shape.rates, shape.slopes)
        B = chain.asked_by(pose, chain.accelerations(pose, shape.rates, shape.turns), shape.turns, shape.bends)
        heights, lifts = [], []
        ankle_v, ankle_lift = pose.joints[3][1], _lift_of_ankle(pose.levers, shape.rates)
        (sin, cos), down = sin_cos(shape.alphas[3]), -chain.ankle[1]
        # of the sole's ends, fixed to the foot: inner lies towards the stance foot
        for along in (-self.sole[1], -self.sole[0]):
            heights.append(ankle_v + sin * arb(along) + cos * down)
            lifts.append((ankle_lift + shape.rates[3] * (cos * arb(along) - sin * down)) * self.span)
        I_P = A[2] - shape.p_fri * A[1]
        tilts = [shape.alphas[1], shape.alphas[3]]
        return Projected(I_P, A, B, G, shape.p_fri, shape.dp_fri, shape.q, shape.slopes, tilts, heights, lifts)

    def on_panel(self, y: tuple[Ball, Ball], h: Ball) -> tuple[tuple[Projected, Projected], tuple[OnZ, OnZ]]:
        """The path and the zero dynamics about the centre of a panel and about all of its points.

        Args:
            y: the share of the way, as a series about either.
            h: half of the panel's width.

        Raises:
            NotEnclosedError: I_P may vanish.
        """
        places = self.at(y[0]), self.at(y[1])
        places = places[0], Projected(*narrowed_each(*places, h))
        return places, zero_dynamics_at(places, h)


def zero_dynamics_at(places: tuple[Projected, Projected], h: Ball) -> tuple[OnZ, OnZ]:
    """The zero dynamics about the centre of a panel and about all of its points.

    Args:
        places: the path there.
        h: half of the panel's width.

    Raises:
        NotEnclosedError: I_P may vanish.
    """
    middle, wide = (OnZ.of(place) for place in places)
    return middle, OnZ(*narrowed_each(middle, wide, h))


@dataclass(frozen=True)
class HalfPath(Path):
    """The path of a half step.

    Attributes:
        half: the virtual constraints.
    """

    half: HalfStep

    @classmethod
    def of(cls, half: HalfStep, sole: tuple[float, float]) -> "HalfPath":
        """The path of a half step whose stance sole has the given ends [m]."""
        return cls(half.chain, sole, half.span, half)

    @cached_property
    def _curves(self) -> list[list[tuple[Number, ...]]]:
        """Bezier columns of absolute angles, joints and FRI, and of their first and second derivatives by beta."""
        half, quarter = self.half, arb.pi() / 2
        angles = [list(curve.columns) for curve in half.angles]
        before: list[list[Number]] = [[arb(0)] * len(angles[0]), *angles[:-1]]
        joints = [[b - a - quarter for a, b in zip(*pair, strict=True)] for pair in zip(before, angles, strict=True)]
        first = [Curve.of(columns, half.span) for columns in (*angles, *joints)]
        second = [Curve.of(list(curve.slopes), half.span) for curve in first]
        return [
            [*(curve.columns for curve in first), half.fri.columns],
            [*(curve.slopes for curve in first), half.fri.slopes],
            [curve.slopes for curve in second],
        ]

    def shape(self, y: Number) -> Shape:
        """The virtual constraints at a share of the way from the reversal, 0, to the impact, 1."""
        s = 1 - y
        basis: dict[int, list[Number]] = {}
        found = []
        for curves in self._curves:
            for degree in {len(columns) - 1 for columns in curves} - basis.keys():
                basis[degree] = bernstein(degree, s)
            found.append([combined(columns, basis[len(columns) - 1]) for columns in curves])
        (*values, p_fri), (*rates, dp_fri), turns = found
        return Shape(values[:4], rates[:4], turns[:4], values[4:], rates[4:], turns[4:], p_fri, dp_fri)


def _lift_of_ankle(levers: list[tuple[Vector, Vector]], rates: list[Number]) -> Number:
    """Vertical velocity of the swing ankle per unit of dbeta [m]."""
    leg, pelvis, swing = (rate * tip[0] for (_, tip), rate in zip(levers[:3], rates[:3], strict=True))
    return leg + pelvis + swing


def narrowed_series(middle: Ball, wide: Ball, h: Ball) -> Ball:
    """`narrowed`, of series."""
    a, b = ([coefficient(x, k) for k in range(ORDER + 1)] for x in (middle, wide))
    return series(narrowed(a, b, h))


def narrowed_each(middle: Number, wide: Number, h: Ball) -> Number:
    """`narrowed_series` of each of many; what is no series stays as it is."""
    if isinstance(middle, list | tuple):
        return [narrowed_each(a, b, h) for a, b in zip(middle, wide, strict=True)]
    if isinstance(wide, Jet):
        return each_pair(lambda a, b: narrowed_each(a, b, h), middle, wide)
    return wide if isinstance(wide, arb) else narrowed_series(middle, wide, h)


def combined(columns: Sequence[Number], polynomials: Sequence[Number]) -> Number:
    """A sum of polynomials, series, by columns."""
    total = polynomials[0] * columns[0]
    for column, polynomial in zip(columns[1:], polynomials[1:], strict=True):
        total = total + polynomial * column
    return total


def require_positive(x: Number, name: str) -> None:
    """Refuse a series, or a ball, to divide by unless it is known to be positive.

    Raises:
        NotEnclosedError: it may vanish; the name says what.
    """
    value = value_of(x)
    if not is_positive(value if isinstance(value, arb) else coefficient(value, 0)):
        raise NotEnclosedError(name)
