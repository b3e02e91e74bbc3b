r"""Paths of steps that reverse elsewhere than planned, as `virtual_constraints.anchoring` answers them, in balls.

**Late**, x past the planned reversal: the continuation, on which slopes and curvatures die out, followed back.

**Early**, by d: the falling path plus a mismatch that dies out over lambda = c d. With pose and slope of both phases
equal at the planned reversal the mismatch is d^2 nu(d) in pose, d mu(d) in slope and d pi(d) in the FRI target, nu, mu
and pi polynomials; and with x = 1 at the reversal, 0 where it has died out,

.. math:: q = h_f + d^2\, C(x), \qquad q' = h_f' + \frac{d}{c}\, C'(x), \qquad q'' = h_f'' + \frac{1}{c^2}\, C''(x),

C of the columns 0, 0, 0, nu - 0.4 c mu, nu - 0.2 c mu, nu (`RejoiningPhase`). Nothing divides by d: one ball of d may
reach down to 0.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

from frontal_biped.zero_dynamics.proof.ball_gait import BallStep
from frontal_biped.zero_dynamics.proof.balls import ORDER, Ball, Number, arb, coefficient, series, value_of
from frontal_biped.zero_dynamics.proof.chain import sums
from frontal_biped.zero_dynamics.proof.half_path import HalfPath, Path, Shape, combined
from frontal_biped.zero_dynamics.proof.half_step import NotEnclosedError, bernstein


class Tapers(NamedTuple):
    """Lengths of a continuation (`piecewise.ContinuedPhase`) [rad].

    Attributes:
        slope: over which slopes die out.
        curvature: over which the curvature at the end dies out.
        fri: over which the slope of the FRI target dies out.
    """

    slope: float
    curvature: float
    fri: float


@dataclass(frozen=True)
class LatePath(Path):
    """From a late reversal back to the planned one.

    Attributes:
        tapers: of the continuation.
        end: the rising half at its planned reversal.
    """

    tapers: Tapers
    end: Shape

    @classmethod
    def of(cls, rising: HalfPath, tapers: Tapers, beyond: float) -> "LatePath":
        """Of a reversal so far beyond the planned one [rad]."""
        return cls(rising.chain, rising.sole, arb(beyond), tapers, rising.shape(arb(0)))

    def shape(self, y: Number) -> Shape:
        """The continuation at a share of the way back."""
        end, (l, m, l_fri) = self.end, map(arb, self.tapers)
        x = (1 - y) * self.span
        slow, fast, fri = ((-x / length).exp() for length in (l, m, l_fri))

        def tapered(value: Ball, slope: Ball, bend: Ball) -> tuple[Number, Number, Number]:
            growth = bend + slope / l
            return (
                (1 - slow) * (slope * l) + (m - (x + m) * fast) * (growth * m) + value,
                slow * slope + x * fast * growth,
                (1 - x / m) * fast * growth - slow * (slope / l),
            )

        joints = [tapered(*of_joint) for of_joint in list(zip(end.q, end.slopes, end.bends, strict=True))[1:]]
        # beta itself goes on, and every link with it
        links = [tapered(a, rate - 1, turn) for a, rate, turn in zip(end.alphas, end.rates, end.turns, strict=True)]
        nothing = x * 0
        return Shape(
            [value + x for value, _, _ in links],
            [rate + 1 for _, rate, _ in links],
            [turn for _, _, turn in links],
            [end.q[0] + x, *(value for value, _, _ in joints)],
            [nothing + 1, *(slope for _, slope, _ in joints)],
            [nothing, *(bend for _, _, bend in joints)],
            end.p_fri + (1 - fri) * (end.dp_fri * l_fri),
            fri * end.dp_fri,
        )


@dataclass(frozen=True)
class Mismatch:
    """Of the rising and the falling phase short of the planned reversal, as polynomials in how far.

    Attributes:
        rising: the rising half.
        falling: the falling half.
    """

    rising: HalfPath
    falling: HalfPath

    @classmethod
    def of(cls, step: BallStep, sole: tuple[float, float]) -> "Mismatch":
        """Of a step whose stance sole has the given ends [m]."""
        return cls(HalfPath.of(step.rising, sole), HalfPath.of(step.falling, sole))

    @cached_property
    def _polynomials(self) -> tuple[list[list[Ball]], list[list[Ball]], list[Ball]]:
        """Coefficients of nu and mu of the three joints after the first, and of pi.

        Raises:
            NotEnclosedError: the degree is too high for a series.
        """
        if max(len(angle.columns) for angle in (*self.rising.half.angles, self.rising.half.fri)) > ORDER + 1:
            raise NotEnclosedError("degree")
        up, down = (path.shape(series([arb(0), 1 / path.span])) for path in (self.rising, self.falling))

        def difference(a: Ball, b: Ball, first: int) -> list[Ball]:
            # what invariance makes zero is left out
            return [coefficient(a, k) - coefficient(b, k) for k in range(first, ORDER + 1)]

        nu = [difference(a, b, 2) for a, b in zip(up.q[1:], down.q[1:], strict=True)]
        mu = [difference(a, b, 1) for a, b in zip(up.slopes[1:], down.slopes[1:], strict=True)]
        return nu, mu, difference(up.p_fri, down.p_fri, 1)

    def at(self, d: Number) -> tuple[list[Number], list[Number], Number]:
        """nu (3,), mu (3,) and pi for all d of a ball, or a `Jet` of it [rad]."""
        nu, mu, pi = self._polynomials
        return [polynomial_at(p, d) for p in nu], [polynomial_at(p, d) for p in mu], polynomial_at(pi, d)


@dataclass(frozen=True)
class EarlyPath(Path):
    """From an early reversal down to where the falling phase has rejoined its path.

    Attributes:
        falling: the falling half.
        d: how early [rad].
        c: lambda over d.
        columns: C of the three joints after the first, from x = 0 on [1/rad].
        pi: FRI mismatch over d [m/rad].
    """

    falling: HalfPath
    d: Number
    c: float
    columns: list[list[Number]]
    pi: Number

    @classmethod
    def of(cls, mismatch: Mismatch, d: Number, c: float) -> "EarlyPath":
        """Of all reversals so early.

        Raises:
            NotEnclosedError: the way to the impact may be shorter, or the degree is too high.
        """
        falling = mismatch.falling
        if not falling.span > (1 + arb(c)) * value_of(d):
            raise NotEnclosedError("way left")
        nu, mu, pi = mismatch.at(d)
        nothing, steep = arb(0), arb(c) / 5
        columns = [
            [nothing, nothing, nothing, a - steep * 2 * b, a - steep * b, a] for a, b in zip(nu, mu, strict=True)
        ]
        return cls(falling.chain, falling.sole, arb(c) * d, falling, d, c, columns, pi)

    def share(self, y: Number) -> Number:
        """The share of the way of the falling half at a share of this one."""
        return (y * arb(self.c) + 1) * (self.d / self.falling.span)

    def shape(self, y: Number) -> Shape:
        """The falling path with what is left of the mismatch."""
        path, d, c = self.falling.shape(self.share(y)), self.d, arb(self.c)
        bases = [bernstein(5 - k, 1 - y) for k in range(3)]
        nothing: Number = y * 0
        more: list[list[Number]] = [[nothing], [nothing], [nothing]]
        for columns in self.columns:
            for k, scale in enumerate((d * d, d / c, 1 / (c * c))):
                more[k].append(combined(derived(columns, k), bases[k]) * scale)
        links = [sums(part) for part in more]
        fri = [arb(0)] * 3 + [self.pi] * 3
        angles = [_added(a, b) for a, b in zip(path[:3], links, strict=True)]
        joints = [_added(a, b) for a, b in zip(path[3:6], more, strict=True)]
        p_fri = path.p_fri + combined(fri, bases[0]) * d
        dp_fri = path.dp_fri + combined(derived(fri, 1), bases[1]) / c
        return Shape(angles[0], angles[1], angles[2], joints[0], joints[1], joints[2], p_fri, dp_fri)


def _added(x: Sequence[Number], y: Sequence[Number]) -> list[Number]:
    return [a + b for a, b in zip(x, y, strict=True)]


def derived(columns: Sequence[Number], times: int) -> list[Number]:
    """Bezier columns of a derivative by x."""
    found = list(columns)
    for _ in range(times):
        degree = len(found) - 1
        found = [(b - a) * degree for a, b in pairwise(found)]
    return found


def polynomial_at(polynomial: Sequence[Ball], x: Number) -> Number:
    """The value of a polynomial, by coefficients from the constant on."""
    total: Number = arb(0)
    for a in reversed(polynomial):
        total = total * x + a
    return total
