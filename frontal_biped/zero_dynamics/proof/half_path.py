r"""The path of half a step in ball arithmetic: poses, sole, and the coefficients of the dynamics on Z along it.

With y the share of the way from the reversal, 0, to the impact, 1; forces as `zero_dynamics.restricted` has them,
w = A ddbeta + B dbeta^2 + G, and, ddbeta inserted from N_0 = p_FRI F_v, w = base + gain dbeta^2.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from frontal_biped.zero_dynamics.proof.balls import Ball, Number, arb, coefficient, is_positive
from frontal_biped.zero_dynamics.proof.chain import Vector
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


@dataclass(frozen=True)
class HalfPath:
    """The path of a half step, ready to be asked at any y.

    Attributes:
        half: the virtual constraints.
        sole: ends of the stance sole on the h axis, (outer < 0, inner > 0) [m].
    """

    half: HalfStep
    sole: tuple[float, float]

    @cached_property
    def _curves(self) -> dict[int, list[tuple[Number, ...]]]:
        """Bezier columns of absolute angles, joints and FRI, and of their first and second derivatives by beta."""
        half, quarter = self.half, arb.pi() / 2
        angles = [list(curve.columns) for curve in half.angles]
        before: list[list[Number]] = [[arb(0)] * len(angles[0]), *angles[:-1]]
        joints = [[b - a - quarter for a, b in zip(*pair, strict=True)] for pair in zip(before, angles, strict=True)]
        first = [Curve.of(columns, half.span) for columns in (*angles, *joints)]
        second = [Curve.of(list(curve.slopes), half.span) for curve in first]
        return {
            0: [*(curve.columns for curve in first), half.fri.columns],
            1: [*(curve.slopes for curve in first), half.fri.slopes],
            2: [curve.slopes for curve in second],
        }

    def at(self, y: Number) -> Projected:
        """At a share of the way from the reversal, 0, to the impact, 1."""
        chain = self.half.chain
        s = 1 - y
        basis: dict[int, list[Number]] = {}
        found = []
        for order in range(3):
            values = []
            for columns in self._curves[order]:
                degree = len(columns) - 1
                if degree not in basis:
                    basis[degree] = bernstein(degree, s)
                values.append(_combined(columns, basis[degree]))
            found.append(values)
        alphas, q, (p_fri,) = found[0][:4], found[0][4:8], found[0][8:]
        rates, slopes, (dp_fri,) = found[1][:4], found[1][4:8], found[1][8:]
        turns, bends = found[2][:4], found[2][4:8]

        pose = chain.pose(alphas)
        none: list[Number] = [arb(0)] * 4
        G = chain.asked_by(pose, [(arb(0), chain.gravity)] * 4, none, none)
        G[1], G[2] = G[1] + chain.foot_mass * chain.gravity, G[2] + chain.foot_moment * chain.gravity
        A = chain.asked_by(pose, chain.accelerations(pose, none, rates), rates, slopes)
        B = chain.asked_by(pose, chain.accelerations(pose, rates, turns), turns, bends)
        # of the sole's ends, fixed to the foot: inner lies towards the stance foot
        heights, lifts = [], []
        ankle_v, ankle_lift = pose.joints[3][1], self._lift_of_ankle(pose.levers, rates)
        (sin, cos), down = alphas[3].sin_cos(), -chain.ankle[1]
        for along in (-self.sole[1], -self.sole[0]):
            heights.append(ankle_v + sin * arb(along) + cos * down)
            lifts.append((ankle_lift + rates[3] * (cos * arb(along) - sin * down)) * self.half.span)
        I_P = A[2] - p_fri * A[1]
        return Projected(I_P, A, B, G, p_fri, dp_fri, q, slopes, [alphas[1], alphas[3]], heights, lifts)

    @staticmethod
    def _lift_of_ankle(levers: list[tuple[Vector, Vector]], rates: list[Number]) -> Number:
        """Vertical velocity of the swing ankle per unit of dbeta [m]."""
        parts = [rate * tip[0] for (_, tip), rate in zip(levers[:3], rates[:3], strict=True)]
        return parts[0] + parts[1] + parts[2]


def _combined(columns: Sequence[Number], polynomials: Sequence[Number]) -> Number:
    total = polynomials[0] * columns[0]
    for column, polynomial in zip(columns[1:], polynomials[1:], strict=True):
        total = total + polynomial * column
    return total


def require_positive(x: Ball, name: str) -> None:
    """Refuse a series, or a ball, to divide by unless it is known to be positive.

    Raises:
        NotEnclosedError: it may vanish; the name says what.
    """
    if not is_positive(x if isinstance(x, arb) else coefficient(x, 0)):
        raise NotEnclosedError(name)
