r"""One step in ball arithmetic: hybrid invariance imposed, and the two halves of it on the zero dynamics.

A half step is a curve from where the robot landed, or will land, to the reversal: the rising phase as it is, the
falling phase backwards. With e the end at the impact and beta the reversal, both halves take the same integral,

.. math:: W(\beta) = -\int_e^\beta e^{-K(x)}\, drive(x)\, dx, \qquad K(x) = \int_e^x rate,

(`reversal.problem`: R is the W of the rising half, F that of the falling one), so that with the jump g at the impact

.. math:: E = g W_f - W_r, \qquad \frac{\partial E}{\partial \beta} = e^{-K_r} drive_r - g\, e^{-K_f} drive_f, \qquad
          m = g\, e^{K_r - K_f}.

**Enclosures.** A half step is cut into panels. On a panel of centre c and half width h a function f is enclosed by
sum_{k<N} a_k t^k + A_N t^N, |t| <= h: a_k its Taylor coefficients at c, and A_N the N-th coefficient at the whole
panel as a ball, which contains Lagrange's remainder. Integrals of that from the centre are exact but for A_N, since t^N
has one sign on either side of it.

**The parameter.** The columns that invariance determines depend on the reversal that is imposed. Given as a `Jet`,
everything carries its derivatives by that reversal. About a whole interval of reversals at once balls soon grow wide;
the mean value theorem narrows them by those about its middle (`balls.narrowed`), after each of the few steps of the
computation that matter. So a step goes in pairs: imposed at the middle of an interval, and at all of it.
"""

from dataclasses import dataclass, replace
from itertools import pairwise
from math import comb
from typing import NamedTuple

from frontal_biped.virtual_constraints.invariance import FreeParameters
from frontal_biped.zero_dynamics.proof.balls import (
    ORDER,
    Ball,
    Jet,
    Number,
    arb,
    coefficient,
    each,
    each_pair,
    exp,
    is_negative,
    is_positive,
    narrowed,
    narrowed_jet,
    series,
    sin_cos,
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


# ---------------------------------------------------------------------------- the whole step
@dataclass(frozen=True)
class BallStep:
    """A step whose columns are imposed at a reversal.

    Attributes:
        rising: from the impact to the reversal.
        falling: backwards, from the impact to the reversal.
        speed_ratio: dbeta after the impact over dbeta before it [-].
    """

    rising: HalfStep
    falling: HalfStep
    speed_ratio: Number

    def narrowed_by_parameter(self, middle: "BallStep", w: Ball) -> "BallStep":
        """For all reversals of an interval, from its middle."""
        return BallStep(
            self.rising.narrowed_by_parameter(middle.rising, w),
            self.falling.narrowed_by_parameter(middle.falling, w),
            narrowed_jet(middle.speed_ratio, self.speed_ratio, w),
        )

    def jump(self) -> Number:
        """g [-].

        Raises:
            NotEnclosedError: I_P may vanish at the impact.
        """
        ratio = self.speed_ratio * self.rising.at(arb(0)).I_P / self.falling.at(arb(0)).I_P
        return ratio * ratio


@dataclass(frozen=True)
class BallGait:
    """What invariance leaves free, exactly as stored, and what follows from it whatever the reversal is.

    Attributes:
        chain: the robot.
        free: the parameters; its ``beta_reversal`` is the planned one.
        q_minus: (4,) pose at the impact [rad].
        landed: (4,) velocities after the impact of a unit of dbeta alone, and of the other joints' part of the slope.
    """

    chain: BallChain
    free: FreeParameters
    q_minus: list[Ball]
    landed: tuple[list[Ball], list[Ball]]

    @classmethod
    def of(cls, chain: BallChain, free: FreeParameters) -> "BallGait":
        """The gait of a robot's free parameters.

        Raises:
            NotEnclosedError: the final pose is not known to exist.
        """
        q_minus = double_support_pose(chain, arb(free.beta_impact), arb(free.step_width))
        last = [arb(float(x)) for x in free.falling_columns[:, -1]]
        nothing = arb(0)
        alone = [arb(1), nothing, nothing, nothing]
        others = [nothing, *(q - b for q, b in zip(q_minus[1:], last, strict=True))]
        try:
            first, second = chain.landed_slopes(q_minus, [alone, others])
        except ZeroDivisionError as error:
            raise NotEnclosedError("impact") from error
        return cls(chain, free, q_minus, (first, second))

    @property
    def begin(self) -> Ball:
        """beta_r+ [rad]."""
        return self.q_minus[3]

    @property
    def end(self) -> Ball:
        """beta_f- [rad]."""
        return self.q_minus[0]

    def imposed(self, reversal: Number) -> BallStep:
        """The step with invariance imposed at a reversal [rad]."""
        free, q_minus = self.free, self.q_minus
        degree = free.falling_columns.shape[1] + 2
        steep = arb(degree) / (self.end - reversal)
        plus = [steep * b + a for a, b in zip(*self.landed, strict=True)]
        up, down = reversal - self.begin, reversal - self.end
        rising: list[list[Number]] = []
        falling: list[list[Number]] = []
        for i in range(3):
            first = q_minus[2 - i]
            second = plus[1 + i] / plus[0] * (up / (free.rising_columns.shape[1] + 1)) + first
            columns: list[Number] = [first, second, *(arb(float(x)) for x in free.rising_columns[i])]
            last, before = columns[-1], columns[-2]
            turned = (down / up) * (before - last) + last  # range_f / range_r is negative
            rising.append(columns)
            inner = [arb(float(x)) for x in free.falling_columns[i]]
            falling.append([q_minus[1 + i], *reversed(inner), turned, last])
        fri = [arb(float(x)) for x in free.rising_fri]
        fri_f = [fri[-1], *(arb(float(x)) for x in free.falling_fri)]
        return BallStep(
            HalfStep(self.chain, up, _absolute(self.begin, up, rising), Curve.of(fri, up)),
            HalfStep(self.chain, down, _absolute(self.end, down, falling), Curve.of(fri_f[::-1], down)),
            plus[0],
        )


def _absolute(start: Ball, span: Number, joints: list[list[Number]]) -> tuple[Curve, ...]:
    """Bezier columns of the links' absolute angles, from those of the joints; beta itself is linear."""
    degree = len(joints[0]) - 1
    quarter = arb.pi() / 2
    columns = [span * (arb(k) / degree) + start + quarter for k in range(degree + 1)]
    angles = [columns]
    for joint in joints:
        angles.append([b + a + quarter for a, b in zip(angles[-1], joint, strict=True)])
    return tuple(Curve.of(own, span) for own in angles)


def double_support_pose(chain: BallChain, beta: Ball, width: Ball) -> list[Ball]:
    """(4,) pose with both feet flat, as `invariance.double_support_pose`.

    Raises:
        NotEnclosedError: the pose is not known to exist.
    """
    a, b, c = chain.bodies[0].tip, chain.bodies[1].tip, chain.bodies[2].tip
    quarter = arb.pi() / 2
    leg = beta + quarter
    sin, cos = sin_cos(leg)
    d_h, d_v = width - (cos * a[0] - sin * a[1]), -(sin * a[0] + cos * a[1])
    along, across = b[0] * c[0] + b[1] * c[1], -b[0] * c[1] + b[1] * c[0]
    reach = (along * along + across * across).sqrt()
    cosine = (d_h * d_h + d_v * d_v - _squared(b) - _squared(c)) / (2 * reach)
    centre = arb.atan2(across, along)
    if not (is_positive(1 - cosine * cosine) and (is_positive(centre) or is_negative(centre))):
        raise NotEnclosedError("final pose")
    x = centre - cosine.acos() if is_positive(centre) else centre + cosine.acos()
    sin, cos = sin_cos(x)
    tip_h, tip_v = b[0] + cos * c[0] - sin * c[1], b[1] + sin * c[0] + cos * c[1]
    pelvis = arb.atan2(tip_h * d_v - tip_v * d_h, tip_h * d_h + tip_v * d_v)
    return [beta, pelvis - leg - quarter, x - quarter, -pelvis - x - quarter]


def _squared(x: tuple[Ball, Ball]) -> Ball:
    return x[0] * x[0] + x[1] * x[1]


# ---------------------------------------------------------------------------- integrals
class Passed(NamedTuple):
    """A half step up to a point.

    Attributes:
        W: the energy so far [kg^2 m^4/s^2].
        K: int of the rate.
    """

    W: Number
    K: Number


NOTHING = Passed(arb(0), arb(0))


class Panel(NamedTuple):
    """A half step on a panel.

    Attributes:
        middle: series about its centre.
        wide: about all of its points.
    """

    middle: OnCurve
    wide: OnCurve


def on_panel(half: HalfStep, low: Ball, high: Ball, ratio: Number | None = None) -> Panel:
    """The zero dynamics on a panel.

    Args:
        half: the curve.
        low: left end, share of the way to the point.
        high: right end.
        ratio: s of the point; default: 1, the reversal.
    """
    centre, h = (low + high) / 2, (high - low) / 2
    shares: list[Number] = [series([centre, arb(1)]), series([low.union(high), arb(1)])]
    middle, wide = (half.at(share if ratio is None else times(ratio, share)) for share in shares)
    return Panel(middle, wide.narrowed(middle, h))


def across(panel: Panel, at: Passed, h: Ball, scale: Number) -> Passed:
    """From the left end of a panel to its right end.

    Args:
        panel: the panel.
        at: what was passed before.
        h: half of its width.
        scale: dbeta by the share of the way.

    Raises:
        NotEnclosedError: I_P may vanish on the panel.
    """
    middle, wide = panel
    near, far = middle.rate * scale, wide.rate * scale
    rate = each_pair(_with_remainder, near, far)
    K_middle = at.K - each(lambda s: _integral(s, -h), rate)
    K_wide = at.K + each(lambda s: coefficient(s, 0), far) * arb(0).union(2 * h)
    density = exp(-(_integrated(near) + K_middle)) * (middle.drive * scale)
    widely = exp(-(_integrated(far) + K_wide)) * (wide.drive * scale)
    work = each_pair(_with_remainder, density, widely)
    gained = each(lambda s: _integral(s, h) - _integral(s, -h), work)
    return Passed(at.W - gained, K_middle + each(lambda s: _integral(s, h), rate))


def _integrated(x: Number) -> Number:
    """Antiderivative by the panel's variable, zero at its centre."""
    return each(lambda s: s.integral(), x)


def _with_remainder(middle: Ball, wide: Ball) -> Ball:
    return series([*(coefficient(middle, k) for k in range(ORDER)), coefficient(wide, ORDER)])


def _integral(s: Ball, t: Ball) -> Ball:
    """From the panel's centre to t."""
    total, power = arb(0), t
    for k in range(ORDER + 1):
        total = total + coefficient(s, k) * power / (k + 1)
        power = power * t
    return total


def cuts_of(half: HalfStep, narrow: float) -> list[Ball]:
    """Ends of panels on which a half step is known well, found by halving them.

    Args:
        half: the curve.
        narrow: share of the energy that a panel may widen its ball by.

    Raises:
        NotEnclosedError: I_P may vanish on the way.
    """
    cuts, at = [arb(0)], NOTHING
    todo = [(arb(0), arb(1), 0)]
    while todo:
        low, high, depth = todo.pop()
        try:
            end = across(on_panel(half, low, high), at, (high - low) / 2, half.span)
            fine = end.W.rad() - at.W.rad() <= narrow * (abs(end.W.mid()) + 1)
        except NotEnclosedError:
            if depth == DEEPEST:
                raise
            fine = False
        if fine or depth == DEEPEST:
            at = end
            cuts.append(high)
        else:
            centre = (low + high) / 2
            todo += [(centre, high, depth + 1), (low, centre, depth + 1)]
    return cuts


DEEPEST = 10
"""Halvings of a half step, at most."""


def passed(half: HalfStep, cuts: list[Ball], ratio: Number | None = None) -> Passed:
    """W and K of a half step up to its reversal, or to another point.

    Args:
        half: the curve.
        cuts: ends of the panels.
        ratio: s of the point; default: 1, the reversal.

    Raises:
        NotEnclosedError: I_P may vanish on the way.
    """
    at, scale = NOTHING, half.span if ratio is None else half.span * ratio
    for low, high in pairwise(cuts):
        at = across(on_panel(half, low, high, ratio), at, (high - low) / 2, scale)
    return at


def passed_by_all(
    middle: HalfStep,
    wide: HalfStep,
    w: Ball,
    cuts: list[Ball],
    ratios: tuple[Number, Number] | tuple[None, None] = (None, None),
) -> tuple[Passed, Passed]:
    """W and K up to the reversal, imposed at the middle of an interval of reversals, and at all of it.

    Args:
        middle: invariance imposed at the middle.
        wide: at the whole interval.
        w: half of its width.
        cuts: ends of the panels.
        ratios: s of the point, of either; default: 1, the reversal.

    Raises:
        NotEnclosedError: I_P may vanish on the way.
    """
    at, of_all = NOTHING, NOTHING
    scales = [half.span if r is None else half.span * r for half, r in zip((middle, wide), ratios, strict=True)]
    for low, high in pairwise(cuts):
        h = (high - low) / 2
        own, other = on_panel(middle, low, high, ratios[0]), on_panel(wide, low, high, ratios[1])
        narrow = other.middle.narrowed_by_parameter(own.middle, w)
        other = Panel(narrow, other.wide.narrowed_by_parameter(own.wide, w).narrowed(narrow, h))
        at, of_all = across(own, at, h, scales[0]), across(other, of_all, h, scales[1])
        of_all = Passed(*(narrowed_jet(a, b, w) for a, b in zip(at, of_all, strict=True)))
    return at, of_all
