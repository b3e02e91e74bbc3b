r"""The energy along half a step in ball arithmetic.

With e the end at the impact and beta the reversal, both halves take the same integral,

.. math:: W(\beta) = -\int_e^\beta e^{-K(x)}\, drive(x)\, dx, \qquad K(x) = \int_e^x rate,

(`reversal.problem`: R is the W of the rising half, F that of the falling one), so that with the jump g at the impact

.. math:: E = g W_f - W_r, \qquad \frac{\partial E}{\partial \beta} = e^{-K_r} drive_r - g\, e^{-K_f} drive_f, \qquad
          m = g\, e^{K_r - K_f}.

**Enclosures.** A half step is cut into panels. On a panel of centre c and half width h a function f is enclosed by
sum_{k<N} a_k t^k + A_N t^N, |t| <= h: a_k its Taylor coefficients at c, and A_N the N-th coefficient at the whole
panel as a ball, which contains Lagrange's remainder. Integrals of that from the centre are exact but for A_N, since t^N
has one sign on either side of it.
"""

from itertools import pairwise
from typing import NamedTuple

from frontal_biped.zero_dynamics.proof.balls import (
    ORDER,
    Ball,
    Number,
    arb,
    coefficient,
    each,
    each_pair,
    exp,
    narrowed_jet,
    series,
)
from frontal_biped.zero_dynamics.proof.half_step import HalfStep, NotEnclosedError, OnCurve, times


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
