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
constant of p and p', taken from the coefficients. Neighbouring monotone parts, across pieces too, are one part; it has
a zero where the signs at its ends are known, beyond the error, and differ. Parts that come to neither end are returned
as undecided: near double zeros, and a zero within the error of an end of the whole interval.
"""

from collections.abc import Callable, Sequence
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
MOST_PARTS = 4096
"""Parts of a piece left open at one time; beyond, as where a function is zero throughout, they are undecided."""

HOPELESS = 100.0
"""Error that is expected at the highest degree, over the tolerance, from which on it is not tried."""

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
            # of a smooth function the error squares as the degree doubles; where even that would not do in the end,
            # halving the interval is cheaper than a higher degree
            largest = max(scale, float(np.max(np.abs(samples))))
            if (error / largest) ** (DEGREES[-1] / degree) > HOPELESS * tolerance:
                return None
        coarse = fine
    return None


@dataclass(frozen=True)
class _Part:
    """A part of one piece, and what is known of the function on all of it.

    Attributes:
        low: lower end.
        high: upper end.
        sign: of the function, beyond the error; 0: not known.
        slope: sign of its derivative, beyond the error; 0: not known.
        piece: the interpolant.
    """

    low: float
    high: float
    sign: int
    slope: int
    piece: Fit


def zeros(pieces: Sequence[Fit]) -> tuple[list[Zero], list[tuple[float, float]]]:
    """Every zero of the interpolated function.

    Args:
        pieces: in order; where one does not end where the next begins, nothing is said about the gap.

    Returns:
        Its simple zeros in order, and the parts on which neither absence nor uniqueness of a zero could be shown.
    """
    found: list[Zero] = []
    undecided: list[tuple[float, float]] = []
    parts = [part for piece in pieces for part in _parts(piece)]
    i = 0
    while i < len(parts):
        first = parts[i]
        end = i + 1
        if first.sign == 0 and first.slope != 0:
            while end < len(parts) and _continues(parts[end - 1], parts[end]):
                end += 1
            run = parts[i:end]
            before, after = _sign_before(parts, i), _sign_after(parts, end - 1)
            if before == -first.slope and after == first.slope:
                found.append(_zero(run))
            elif before != first.slope and after != -first.slope:  # else it is monotone away from zero
                undecided.append((run[0].low, run[-1].high))
        elif first.sign == 0:
            undecided.append((first.low, first.high))
        i = end
    return found, _join(undecided)


def _parts(piece: Fit) -> list[_Part]:
    """A piece divided until on every part the function or its derivative is known to keep its sign."""
    p = piece.polynomial
    first, second = p.deriv(1), p.deriv(2)
    steep, curved = float(np.sum(np.abs(first.coef))), float(np.sum(np.abs(second.coef)))
    done: list[_Part] = []
    open_parts = np.array([piece.interval])
    for depth in range(BISECTIONS):
        middle, half = open_parts.mean(axis=1), 0.5 * (open_parts[:, 1] - open_parts[:, 0])
        values, slopes = p(middle), first(middle)
        away = np.abs(values) - steep * half > piece.error
        monotone = np.abs(slopes) - curved * half > piece.slope_error
        last = depth == BISECTIONS - 1 or np.count_nonzero(~away & ~monotone) > MOST_PARTS
        for k in np.flatnonzero(away | monotone | last):
            sign = int(np.sign(values[k])) if away[k] else 0
            slope = int(np.sign(slopes[k])) if monotone[k] else 0
            done.append(_Part(float(open_parts[k, 0]), float(open_parts[k, 1]), sign, slope, piece))
        left = open_parts[~away & ~monotone]
        if last or not len(left):
            break
        cut = left.mean(axis=1)
        open_parts = np.concatenate([np.stack([left[:, 0], cut], 1), np.stack([cut, left[:, 1]], 1)])
    return sorted(done, key=lambda part: part.low)


def _continues(part: _Part, following: _Part) -> bool:
    """Is the function monotone, in one sense, through both parts, and a zero possible in the second as well?"""
    return _touch(part, following) and following.sign == 0 and following.slope == part.slope


def _touch(part: _Part, following: _Part) -> bool:
    return following.low <= part.high + 1e-15 * max(1.0, abs(part.high))


def _sign_before(parts: list[_Part], i: int) -> int:
    """Sign of the function at the lower end of part i; 0 where it is within the error."""
    if i > 0 and _touch(parts[i - 1], parts[i]) and parts[i - 1].sign:
        return parts[i - 1].sign
    return _sign_at(parts[i].piece, parts[i].low)


def _sign_after(parts: list[_Part], i: int) -> int:
    """Sign of the function at the upper end of part i; 0 where it is within the error."""
    if i + 1 < len(parts) and _touch(parts[i], parts[i + 1]) and parts[i + 1].sign:
        return parts[i + 1].sign
    return _sign_at(parts[i].piece, parts[i].high)


def _sign_at(piece: Fit, place: float) -> int:
    value = float(piece.polynomial(place))
    return int(np.sign(value)) if abs(value) > piece.error else 0


def _zero(run: list[_Part]) -> Zero:
    """The zero of a function that is monotone through neighbouring parts and changes its sign on them."""
    slope = run[0].slope
    low, high = run[0].low, run[-1].high
    # the last part that begins before the zero holds it, or the zero is where it ends and the next piece begins
    holds = max(
        (part for part in run if slope * part.piece.polynomial(part.low) <= 0.0),
        key=lambda part: part.low,
        default=run[0],
    )
    p = holds.piece.polynomial
    if p(holds.low) * p(holds.high) < 0.0:
        place = float(brentq(p, holds.low, holds.high, xtol=1e-16, rtol=8.9e-16))
    else:
        place = min((holds.low, holds.high), key=lambda end: abs(float(p(end))))
    # the enclosure grows until the sign at its ends is known; that at the ends of the run is
    steepness = max(abs(float(p.deriv()(place))) - holds.piece.slope_error, 1e-300)
    width = max(max(part.piece.error for part in run) / steepness, np.spacing(abs(place)))
    while (high - low) > width and not (
        _known_by(run, place - width, -slope, low) and _known_by(run, place + width, slope, high)
    ):
        width *= 2.0
    return Zero(place, (max(low, place - width), min(high, place + width)), float(p.deriv()(place)))


def _known_by(run: list[_Part], place: float, sign: int, end: float) -> bool:
    """Is the function known to have a sign at a place, or does the run end before it?"""
    if (place >= end) if sign == run[0].slope else (place <= end):
        return True
    part = next(part for part in run if part.low <= place <= part.high)
    return _sign_at(part.piece, place) == sign


def _join(parts: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Neighbouring parts made one."""
    joined: list[tuple[float, float]] = []
    for a, b in sorted(parts):
        if joined and a <= joined[-1][1] + 1e-15 * max(1.0, abs(a)):
            joined[-1] = (joined[-1][0], max(b, joined[-1][1]))
        else:
            joined.append((a, b))
    return joined
