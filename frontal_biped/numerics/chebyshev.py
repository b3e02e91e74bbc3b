r"""All zeros of a smooth function of one variable on an interval, none missed below a measured error bound.

The function is interpolated at Chebyshev points of degrees n and 2 n. The points are nested, so the n new values
measure the error of the smaller interpolant, and the sum of the changes of the coefficients,

.. math:: \varepsilon = \sum_k |c_k^{(2n)} - c_k^{(n)}|, \qquad
          \varepsilon' = \frac{2}{b - a} \sum_k k^2 |c_k^{(2n)} - c_k^{(n)}|,

bounds the change of the interpolant and of its derivative everywhere (|T_k| <= 1, |T_k'| <= k^2). For a smooth
function the interpolant of degree 2 n, which is the one used, is far closer than that; where the coefficients do not
fall off, the interval is halved.

Zeros are then *counted*, not searched: the interval is divided until on every part either |p| > eps (no zero) or
|p'| > eps' (at most one, and one exactly where the ends differ in sign). The bounds on a part are those of a Lipschitz
constant of p and p', taken from the coefficients. Parts that come to neither end are returned as undecided.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Chebyshev
from scipy.fft import dct
from scipy.optimize import brentq

from frontal_biped.arrays import FloatArray

DEGREES = (8, 16, 32, 64)
SMALLEST_PART = 1e-7
"""Parts of the whole interval below which bisection gives up."""

BISECTIONS = 40
MAX_EVALUATIONS = 4000


@dataclass(frozen=True)
class Fit:
    """Chebyshev interpolant of a function on one interval.

    Attributes:
        polynomial: the interpolant.
        error: measured bound on its error, in units of the function.
        slope_error: the same for the derivative.
    """

    polynomial: Chebyshev
    error: float
    slope_error: float

    @property
    def interval(self) -> tuple[float, float]:
        """Its ends."""
        low, high = self.polynomial.domain
        return float(low), float(high)

    def widened(self, error: float) -> "Fit":
        """The same fit of a function known to ``error`` only; the derivative's bound grows by Markov's inequality."""
        low, high = self.interval
        slope = 2.0 * self.polynomial.degree() ** 2 * error / (high - low)
        return Fit(self.polynomial, self.error + error, self.slope_error + slope)


@dataclass(frozen=True)
class Zero:
    """One simple zero.

    Attributes:
        place: where.
        enclosure: an interval that contains it, and no other zero.
        slope: derivative there.
    """

    place: float
    enclosure: tuple[float, float]
    slope: float


def fit(
    function: Callable[[float], float],
    low: float,
    high: float,
    tolerance: float,
    scale: float = 0.0,
    max_evaluations: int = MAX_EVALUATIONS,
) -> tuple[list[Fit], list[tuple[float, float]]]:
    """Piecewise Chebyshev interpolation.

    Args:
        function: smooth, nan where it is not defined.
        low: lower end.
        high: upper end.
        tolerance: largest measured error of a piece, relative to the largest value on it or to ``scale``.
        scale: size of the terms the function is a difference of; rounding is relative to them.
        max_evaluations: of the function, after which the remaining parts are given up.

    Returns:
        The pieces in order, and the parts on which the function could not be interpolated.
    """
    pieces: list[Fit] = []
    failed: list[tuple[float, float]] = []
    todo = [(low, high)]
    count = 0

    def counted(x: float) -> float:
        nonlocal count
        count += 1
        return function(x)

    while todo:
        a, b = todo.pop()
        piece = _fit_once(counted, a, b, tolerance, scale) if count < max_evaluations else None
        if piece is not None:
            pieces.append(piece)
        elif b - a <= SMALLEST_PART * (high - low) or count >= max_evaluations:
            failed.append((a, b))
        else:
            middle = 0.5 * (a + b)
            todo += [(middle, b), (a, middle)]
    return pieces, failed


def _fit_once(function: Callable[[float], float], a: float, b: float, tolerance: float, scale: float) -> Fit | None:
    values: dict[float, float] = {}
    coarse: FloatArray | None = None
    for degree in DEGREES:
        places = np.cos(np.pi * np.arange(degree + 1) / degree)
        samples = np.empty(degree + 1)
        for i, x in enumerate(places):
            key = round(float(x), 14)
            if key not in values:
                values[key] = function(0.5 * (a + b) + 0.5 * (b - a) * float(x))
                if not np.isfinite(values[key]):
                    return None
            samples[i] = values[key]
        fine = dct(samples, type=1) / degree
        fine[[0, -1]] *= 0.5
        if coarse is not None:
            change = fine.copy()
            change[: len(coarse)] -= coarse
            error = float(np.sum(np.abs(change)))
            if error <= tolerance * max(scale, float(np.max(np.abs(samples)))):
                k = np.arange(len(change))
                slope_error = float(2.0 / (b - a) * np.sum(k**2 * np.abs(change)))
                return Fit(Chebyshev(fine, domain=[a, b]), error, slope_error)
            # algebraic decay: halving the interval is cheaper than a higher degree
            if degree >= 32 and error > 1e-2 * float(np.max(np.abs(samples))):
                return None
        coarse = fine
    return None


def zeros(piece: Fit) -> tuple[list[Zero], list[tuple[float, float]]]:
    """Every zero of the interpolated function on one piece.

    Returns:
        Its simple zeros in order, and the parts on which neither absence nor uniqueness of a zero could be shown.
    """
    p = piece.polynomial
    first, second = p.deriv(1), p.deriv(2)
    low, high = piece.interval
    steep, curved = float(np.sum(np.abs(first.coef))), float(np.sum(np.abs(second.coef)))
    found: list[tuple[float, float]] = []
    undecided: list[tuple[float, float]] = []
    parts = np.array([[low, high]])
    for depth in range(BISECTIONS):
        middle, half = parts.mean(axis=1), 0.5 * (parts[:, 1] - parts[:, 0])
        without = np.abs(p(middle)) - steep * half > piece.error
        monotone = ~without & (np.abs(first(middle)) - curved * half > piece.slope_error)
        found += [(float(a), float(b)) for a, b in parts[monotone]]
        left = parts[~without & ~monotone]
        if not len(left):
            break
        if depth == BISECTIONS - 1 or len(left) > 4096:
            undecided += [(float(a), float(b)) for a, b in left]
            break
        cut = left.mean(axis=1)
        parts = np.concatenate([np.stack([left[:, 0], cut], 1), np.stack([cut, left[:, 1]], 1)])
    result = []
    for a, b in _join(found):
        if p(a) * p(b) > 0.0 and min(abs(p(a)), abs(p(b))) > piece.error:
            continue  # monotone, and of one sign
        reach = 2.0 * piece.error
        a_out, b_out = _outside(p, a, b, low, high, reach)
        if p(a_out) * p(b_out) < 0.0:
            place = float(brentq(p, a_out, b_out, xtol=1e-16, rtol=8.9e-16))
            slope = float(first(place))
            width = piece.error / max(abs(slope) - piece.slope_error, 1e-300)
            result.append(Zero(place, (max(low, place - width), min(high, place + width)), slope))
        else:
            undecided.append((a, b))  # at the very end of the piece
    return _distinct(sorted(result, key=lambda zero: zero.place)), _join(undecided)


def _outside(p: Chebyshev, a: float, b: float, low: float, high: float, reach: float) -> tuple[float, float]:
    """Widen a monotone part until both ends exceed the error, or the piece ends."""
    width = b - a
    for _ in range(60):
        if abs(p(a)) <= reach and a > low:
            a = max(low, a - width)
        elif abs(p(b)) <= reach and b < high:
            b = min(high, b + width)
        else:
            break
    return a, b


def _join(parts: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Neighbouring parts made one."""
    joined: list[tuple[float, float]] = []
    for a, b in sorted(parts):
        if joined and a <= joined[-1][1] + 1e-15 * max(1.0, abs(a)):
            joined[-1] = (joined[-1][0], max(b, joined[-1][1]))
        else:
            joined.append((a, b))
    return joined


def _distinct(found: list[Zero]) -> list[Zero]:
    kept: list[Zero] = []
    for zero in found:
        if not kept or zero.enclosure[0] > kept[-1].enclosure[1]:
            kept.append(zero)
    return kept
