r"""Second-order differential equations by collocation: a whole stretch of time at once, right-hand sides in batches.

On a stretch of length h the rates are polynomials of degree N in time that fulfil

.. math:: \ddot q = f(q, \dot q)

at N + 1 Chebyshev points, ends included (Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, II.7).
The unknowns are the accelerations a at the points; rates and positions are their integrals,

.. math:: \dot q = \dot q_0 + \tfrac h2 S a, \qquad q = q_0 + t \dot q_0 + \tfrac{h^2}4 S^2 a,

and Newton's method solves a = f(q(a), dq(a)), with derivatives of f by differences, taken once a stretch. Every
evaluation of f is of all points together: where f is cheap for many states at once, this is far cheaper than a
Runge-Kutta method, which has to ask one state after another.

Where a solution is at hand that this one is thought to resemble, such as the last step of a walk, its stretches and its
accelerations are tried first: they are where Newton's method begins, with its matrix, and no part of what it ends with.

The error is measured by what the last two coefficients of the rates contribute, against the tolerance; the length of
the stretches follows from it. Where f is not smooth that asks for ever shorter ones, and the method gives up: another
one is to go past that place, and this one may go on behind it.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial.chebyshev import chebint, chebvander
from scipy.linalg.lapack import dgetrf, dgetrs

from frontal_biped.arrays import FloatArray

Acceleration = Callable[[FloatArray, FloatArray], FloatArray | None]
"""f of many states, q (m, n), dq (m, n) to (m, n); None where it is not defined at one of them."""

Factors = tuple[FloatArray, FloatArray]
"""LU of a matrix, and its exchanged rows."""

DEGREE = 16
"""N; of those tried on walks at rtol 1e-8, 10 to 24, among the cheapest."""

FIRST = 0.03
"""Length that is tried first [s]."""

TRIES = 3
"""Lengths tried for one stretch before the method gives up."""

MOST_ITERATIONS = 12
"""Of Newton's method on one stretch: about six do."""

EASY = 7
"""Iterations up to which the next stretch may be longer."""

SLOW = 0.25
"""Ratio of two corrections in turn beyond which the derivatives are taken anew."""

DIFFERENCE = 1e-6
"""Step of the differences that Newton's method takes its derivatives from; they steer it, the answer is free of it."""

SMALL = 0.1
"""Share of the tolerance that Newton's last correction may have."""

GROWTH, SHRINKAGE, SAFETY = 2.0, 0.4, 0.9
"""How fast the length may change from one stretch to the next, and how much of what the error permits is used."""

_HAIR = 1e-6
"""Share of a stretch that times of two solutions may differ by and still be the same."""

_PLACES = -np.cos(np.pi * np.arange(DEGREE + 1) / DEGREE)
_TO_SERIES = np.linalg.inv(chebvander(_PLACES, DEGREE))
_ONCE = chebvander(_PLACES, DEGREE + 1) @ chebint(_TO_SERIES, lbnd=-1.0, axis=0)
"""(N + 1, N + 1) S: from values at the points to their integrals from -1 to the points."""
_HALF_ONCE: FloatArray = np.asarray(0.5 * _ONCE, dtype=float)
_QUARTER_TWICE: FloatArray = _HALF_ONCE @ _HALF_ONCE
_SAMPLED = [0, DEGREE // 2, DEGREE]
"""Points at which f is differentiated; between them the derivatives are interpolated."""
_FROM_SAMPLED = chebvander(_PLACES, len(_SAMPLED) - 1) @ np.linalg.inv(chebvander(_PLACES[_SAMPLED], len(_SAMPLED) - 1))
_ELAPSED = 0.5 * (1.0 + _PLACES)[:, None]
"""(N + 1, 1) times of the points, as shares of the stretch."""


@dataclass(frozen=True, eq=False)
class Stretch:
    """A solution on a stretch of time.

    Attributes:
        start: its time [s].
        length: [s].
        q: (N + 1, n) positions at the points, the first of them at the start, the last at the end.
        dq: (N + 1, n) rates there.
        ddq: (N + 1, n) accelerations there.
        factors: of the matrix that Newton's method found them with, as LAPACK's dgetrf leaves them.
    """

    start: float
    length: float
    q: FloatArray
    dq: FloatArray
    ddq: FloatArray
    factors: Factors

    @property
    def end(self) -> float:
        """Time of its end [s]."""
        return self.start + self.length

    @cached_property
    def times(self) -> FloatArray:
        """(N + 1,) times of the points [s]."""
        times = self.start + self.length * _ELAPSED[:, 0]
        times[-1] = self.end
        return times

    @cached_property
    def _series(self) -> FloatArray:
        return _TO_SERIES @ np.concatenate([self.q, self.dq], axis=1)

    def accelerations(self, t: FloatArray) -> FloatArray:
        """(T, n) at times t (T,) [s]."""
        return self._polynomials(t) @ (_TO_SERIES @ self.ddq)

    def at(self, t: FloatArray) -> FloatArray:
        """(T, 2 n) positions and rates at times t (T,) [s]."""
        return self._polynomials(t) @ self._series

    def _polynomials(self, t: FloatArray) -> FloatArray:
        """(T, N + 1) Chebyshev polynomials at times t (T,) [s]."""
        return np.asarray(chebvander(2.0 * (t - self.start) / self.length - 1.0, DEGREE), dtype=float)

    def at_one(self, t: float) -> FloatArray:
        """(2 n,) the same at one time [s], the polynomials in plain numbers: to locate an event takes some twenty."""
        twice = 2.0 * (2.0 * (t - self.start) / self.length - 1.0)
        before, now = 1.0, 0.5 * twice
        polynomials = [before, now]
        for _ in range(DEGREE - 1):
            before, now = now, now * twice - before
            polynomials.append(now)
        values: FloatArray = (np.array([polynomials]) @ self._series)[0]
        return values


class Collocation:
    """Follows a solution stretch by stretch.

    Args:
        acceleration: f.
        rtol: relative tolerance of the rates.
        atol: absolute tolerance of the rates.
        start: when the solution begins [s].
        like: stretches of one that this one may resemble, in order; from when its first one begins.
    """

    def __init__(
        self, acceleration: Acceleration, rtol: float, atol: float, start: float = 0.0, like: Sequence[Stretch] = ()
    ) -> None:
        self._acceleration, self._rtol, self._atol = acceleration, rtol, atol
        self._length, self._iterations = FIRST, 0
        self._like, self._later = like, start - like[0].start if like else 0.0

    def advance(self, t: float, q: FloatArray, dq: FloatArray, until: float) -> Stretch | None:
        """The next stretch, from q (n,), dq (n,) at time t [s], to ``until`` [s] at most.

        None where shorter and shorter ones did not meet the tolerance: something near is not smooth.
        """
        like = self._resembled(t)
        if like is not None and like.end + self._later <= until:
            length = like.end + self._later - t
            guess = like.accelerations(t - self._later + length * _ELAPSED[:, 0])
            as_long = abs(length - like.length) < _HAIR * length
            found = self._tried(t, q, dq, length, guess, like.factors if as_long else None)
            if found is not None:
                return found
        begun = self._acceleration(q[None], dq[None])
        if begun is not None:
            guess = np.repeat(begun, DEGREE + 1, axis=0)
            for _ in range(TRIES):
                found = self._tried(t, q, dq, min(self._length, until - t), guess)
                if found is not None:
                    return found
        self._length = FIRST
        return None

    def _tried(
        self, t: float, q: FloatArray, dq: FloatArray, length: float, guess: FloatArray, factors: Factors | None = None
    ) -> Stretch | None:
        """A stretch of this length, if the tolerance is met; what length the next one may have is noted."""
        solved = self._solved(q, dq, guess, length, factors)
        error = np.inf if solved is None else self._error(solved[1])
        factor = SAFETY * error ** (-1.0 / DEGREE) if error > 0.0 else GROWTH
        most = GROWTH if self._iterations <= EASY else 1.0
        self._length = length * min(max(factor, SHRINKAGE), most)
        return Stretch(t, length, *solved) if solved is not None and error <= 1.0 else None

    def _resembled(self, t: float) -> Stretch | None:
        """The stretch that this solution may resemble from time t [s] on."""
        at = t - self._later
        return next((s for s in self._like if s.start - _HAIR * s.length <= at < s.end - _HAIR * s.length), None)

    def _error(self, dq: FloatArray) -> float:
        """Of rates (N + 1, n): what the end of their series contributes, in units of the tolerance."""
        last = np.abs(_TO_SERIES[-2:] @ dq).max(axis=0)
        return float((last / self._tolerance(dq)).max())

    def _tolerance(self, dq: FloatArray) -> FloatArray:
        """(n,) of the rates."""
        return self._atol + self._rtol * np.maximum(np.abs(dq[0]), np.abs(dq[-1]))

    def _solved(
        self, q_0: FloatArray, dq_0: FloatArray, a: FloatArray, h: float, factors: Factors | None
    ) -> tuple[FloatArray, FloatArray, FloatArray, Factors] | None:
        """Positions, rates and accelerations at the points of a stretch of length h; None where Newton fails.

        Args:
            q_0: (n,) where it begins.
            dq_0: (n,) rates there.
            a: (N + 1, n) accelerations at the points to begin with.
            h: length.
            factors: of the matrix to begin with, or None; also returned, as they are at the end.
        """
        drifting = q_0 + h * _ELAPSED * dq_0
        once: FloatArray = h * _HALF_ONCE
        twice: FloatArray = h * h * _QUARTER_TWICE
        before = np.inf
        for self._iterations in range(1, MOST_ITERATIONS + 1):
            q, dq = drifting + twice @ a, dq_0 + once @ a
            found, slopes = self._linearised(q, dq) if factors is None else (self._acceleration(q, dq), None)
            if found is None:
                return None
            if slopes is not None:
                *lu, singular = dgetrf(_newton_matrix(slopes, once, twice), overwrite_a=True)
                if singular:
                    return None
                factors = lu[0], lu[1]
            assert factors is not None  # with slopes
            solved, _ = dgetrs(*factors, (found - a).ravel())
            step = solved.reshape(a.shape)
            a = a + step
            correction = float((np.abs(once @ step).max(axis=0) / self._tolerance(dq)).max())
            if correction <= SMALL:
                return drifting + twice @ a, dq_0 + once @ a, a, factors
            if not correction < before:  # NaN too
                return None
            if correction > SLOW * before:
                factors = None
            before = correction
        return None

    def _linearised(self, q: FloatArray, dq: FloatArray) -> tuple[FloatArray | None, FloatArray | None]:
        """f at m states, (m, n), and its derivatives (2 n, m, n) with respect to q_1 .. q_n, dq_1 .. dq_n."""
        m, n = q.shape
        states = np.concatenate([q, dq], axis=1)
        moved = np.repeat(states[None, _SAMPLED], 2 * n, axis=0)
        moved[range(2 * n), :, range(2 * n)] += DIFFERENCE
        rows = np.concatenate([states, moved.reshape(-1, 2 * n)])
        found = self._acceleration(rows[:, :n], rows[:, n:])
        if found is None or not np.isfinite(found).all():
            return None, None
        here = found[:m]
        sampled = (found[m:].reshape(2 * n, len(_SAMPLED), n) - here[_SAMPLED]) / DIFFERENCE
        return here, np.asarray(_FROM_SAMPLED @ sampled, dtype=float)


def _newton_matrix(slopes: FloatArray, once: FloatArray, twice: FloatArray) -> FloatArray:
    """(m n, m n) derivative of a - f(q(a), dq(a)) with respect to a."""
    n = slopes.shape[2]
    size = once.shape[0] * n
    by_q, by_dq = slopes[:n].transpose(1, 2, 0), slopes[n:].transpose(1, 2, 0)  # point, of, with respect to
    matrix = by_q[:, :, None, :] * -twice[:, None, :, None] - by_dq[:, :, None, :] * once[:, None, :, None]
    square: FloatArray = matrix.reshape(size, size)
    square.flat[:: size + 1] += 1.0
    return square
