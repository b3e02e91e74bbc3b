r"""Balls of functions: polynomials in two variables, each with a radius that bounds how far the function is from it.

A `TaylorModel` stands for every function f that is analytic where the variables t and y are of modulus at most 1, with

.. math:: f = \sum_{i, j} c_{ij}\, t^i y^j + r, \qquad \|r\| \le radius, \qquad
          \|r\| = \sum_{i, j} |r_{ij}|,

r_ij the coefficients of r. Such functions form a Banach algebra: ||f g|| <= ||f|| ||g||, so products, and power series
of functions, are enclosed by norms alone, and what is cut off behind the last powers moves to the radius. There it
stays a bound however often the function is used again, where the wide last coefficient of a Taylor polynomial on balls
grows with every product. |f| <= ||f|| at every point; integrals from 0 are no larger, since t^i becomes
t^(i+1) / (i+1); and derivatives by y are bounded inside, see `TaylorModel.slope`.

Coefficients are doubles, their rounding is in the radius too: for a sum or a product of doubles, and for a sum of n
products in any order, rounded to nearest, the error is at most n units of roundoff times the sum of moduli, but for
second order [Higham, Accuracy and Stability of Numerical Algorithms, Sec. 3.1]. Transcendental functions of doubles
are FLINT's. A model holds a batch of functions, one for each panel of an integral, for speed.
"""

from collections.abc import Iterable, Sequence
from functools import cached_property
from typing import Any, Union

import numpy as np
from numpy.typing import NDArray

from frontal_biped.arrays import FloatArray
from frontal_biped.zero_dynamics.proof.balls import Ball, arb

ORDERS = (10, 14)
"""Highest powers of t and y that are kept."""

ROUNDOFF = 2.0**-53
"""Relative error of one operation on doubles."""

UP = 1.0 + 1e-12
"""Makes up for the rounding of a bound: a few thousand operations on numbers of one sign."""

UNDERFLOW = 1e-290
"""Absolute error of an operation whose result is too small for a double, with a wide margin."""

TERMS = 30
"""Of a power series, at most."""

Operand = Union["TaylorModel", Ball, float]
"""A model, a ball, or an exact number."""


class TaylorModel:
    """Functions of t and y near polynomials.

    Attributes:
        terms: (B, I, J) coefficients of t^i y^j, of B functions; B, I and J are 1 where nothing depends on them.
        radius: (B,) norm of what is left; infinite where nothing is known.
    """

    __array_ufunc__ = None

    def __init__(self, terms: FloatArray, radius: FloatArray) -> None:
        self.terms = terms
        self.radius = radius

    # ------------------------------------------------------------------ simple ones
    @classmethod
    def constants(cls, balls: Sequence[Ball]) -> "TaylorModel":
        """One for each ball."""
        middles = np.array([float(ball.mid()) for ball in balls])
        radius = [float(abs(ball - arb(middle)).upper()) for ball, middle in zip(balls, middles, strict=True)]
        return cls(middles[:, None, None], np.array(radius) * UP + UNDERFLOW)

    @classmethod
    def parameter(cls, centre: Ball, reach: Ball) -> "TaylorModel":
        """centre + reach y."""
        both = cls.constants([centre, reach])
        return cls(both.terms.reshape(1, 1, 2), both.radius.sum(keepdims=True) * UP)

    @classmethod
    def along(cls, low: FloatArray, high: FloatArray) -> "TaylorModel":
        """From low at t = -1 to high at t = 1, both (B,), multiples of a power of two, so that halves are exact."""
        terms = np.stack([0.5 * (low + high), 0.5 * (high - low)], axis=1)
        return cls(terms[:, :, None], np.zeros(len(low)))

    @property
    def norm(self) -> FloatArray:
        """(B,) upper bound."""
        return (self._size + self.radius) * UP

    @cached_property
    def _size(self) -> FloatArray:
        return np.asarray(np.abs(self.terms).sum(axis=(1, 2)) * UP)

    @property
    def centre(self) -> FloatArray:
        """(B,) constant terms."""
        return np.asarray(self.terms[:, 0, 0])

    @property
    def surely_positive(self) -> NDArray[np.bool_]:
        """(B,) is the function's real part positive for all t and y of modulus at most 1?"""
        return np.asarray(2.0 * self.centre > self.norm * UP)

    def chosen(self, which: NDArray[np.intp]) -> "TaylorModel":
        """Some of the functions."""
        return TaylorModel(self.terms[which], self.radius[which])

    @classmethod
    def joined(cls, models: Iterable["TaylorModel"]) -> "TaylorModel":
        """Batches one behind the other, of one number of terms."""
        models = tuple(models)
        return cls(np.concatenate([m.terms for m in models]), np.concatenate([m.radius for m in models]))

    # ------------------------------------------------------------------ arithmetic
    def __neg__(self) -> "TaylorModel":
        return TaylorModel(-self.terms, self.radius)

    def __add__(self, other: Operand) -> "TaylorModel":
        other = _model(other)
        terms = _sum(self.terms, other.terms)
        rounding = ROUNDOFF * np.abs(terms).sum(axis=(1, 2))
        return TaylorModel(terms, (self.radius + other.radius + rounding) * UP)

    __radd__ = __add__

    def __sub__(self, other: Operand) -> "TaylorModel":
        return self + -_model(other)

    def __rsub__(self, other: Operand) -> "TaylorModel":
        return -self + other

    def __mul__(self, other: Operand) -> "TaylorModel":
        other = _model(other)
        a, b = self.terms, other.terms
        summed = min(a.shape[1], b.shape[1]) * min(a.shape[2], b.shape[2]) + 1
        rounding = summed * ROUNDOFF * self._size * other._size
        crossed = self._size * other.radius + self.radius * other.norm
        radius = (crossed + _cut_off(a, b) + rounding + UNDERFLOW) * UP
        return TaylorModel(_product(a, b), radius)

    __rmul__ = __mul__

    def __truediv__(self, other: Operand) -> "TaylorModel":
        if isinstance(other, int | float):
            terms = self.terms / other
            radius = (self.radius / abs(other) + ROUNDOFF * np.abs(terms).sum(axis=(1, 2)) + UNDERFLOW) * UP
            return TaylorModel(terms, radius)
        return self * (other.inverse if isinstance(other, TaylorModel) else 1 / other)

    def __rtruediv__(self, other: Operand) -> "TaylorModel":
        return self.inverse * other

    @cached_property
    def inverse(self) -> "TaylorModel":
        """1 / f; where f may vanish at complex t and y of modulus 1 the radius is infinite.

        With any q and ||1 - f q|| = e < 1 the Neumann series tells 1/f = q / (1 - (1 - f q)), within ||q|| e / (1 - e).
        """
        with np.errstate(all="ignore"):
            q = 1.0 / self.terms[:, :1, :1]
            for _ in range(int(sum(ORDERS)).bit_length()):  # Newton's method doubles the degree that is right
                error = -_product(self.terms, q)
                error[:, 0, 0] += 2.0
                q = _product(q, error)
            approximate = TaylorModel(q, np.zeros(len(q)))
            off = (1 - self * approximate).norm
            radius = np.where(off < 1.0, approximate.norm * off / (1.0 - off) * UP, np.inf)
        return TaylorModel(q, radius)

    # ------------------------------------------------------------------ power series
    def sin_cos(self) -> tuple["TaylorModel", "TaylorModel"]:
        """Sine and cosine [f in rad], about those of the constant terms."""
        u, centres = self._about_centre()
        v = u * u
        terms = _terms(float(u.norm.max()))
        sin, cos = (TaylorModel.constants([arb(1)]) for _ in range(2))
        for k in range(terms + terms % 2, 0, -2):
            cos = 1 - v * cos / (k * (k - 1))
            sin = 1 - v * sin / (k * (k + 1))
        sin = u * sin
        left = _left(u.norm, terms)
        sin, cos = (TaylorModel(x.terms, (x.radius + left) * UP) for x in (sin, cos))
        both = [centre.sin_cos() for centre in centres]
        s, c = (TaylorModel.constants([pair[k] for pair in both]) for k in range(2))
        return s * cos + c * sin, c * cos - s * sin

    def exp(self) -> "TaylorModel":
        """The exponential, about that of the constant terms."""
        u, centres = self._about_centre()
        terms = _terms(float(u.norm.max()))
        total = TaylorModel.constants([arb(1)])
        for k in range(terms, 0, -1):
            total = 1 + u * total / k
        total = TaylorModel(total.terms, (total.radius + _left(u.norm, terms)) * UP)
        return total * TaylorModel.constants([centre.exp() for centre in centres])

    def _about_centre(self) -> tuple["TaylorModel", list[Ball]]:
        terms = self.terms.copy()
        terms[:, 0, 0] = 0.0
        return TaylorModel(terms, self.radius), [arb(float(c)) for c in self.centre]

    # ------------------------------------------------------------------ along t, and over the batch
    def antiderivative(self) -> "TaylorModel":
        """From t = 0 to t."""
        powers = np.arange(1, self.terms.shape[1] + 1)[:, None]
        terms = np.concatenate([np.zeros_like(self.terms[:, :1]), self.terms / powers], axis=1)
        cut = np.abs(terms[:, ORDERS[0] + 1 :]).sum(axis=(1, 2))
        rounding = ROUNDOFF * np.abs(terms).sum(axis=(1, 2))
        return TaylorModel(terms[:, : ORDERS[0] + 1], (self.radius + cut + rounding + UNDERFLOW) * UP)

    def at(self, t: int) -> "TaylorModel":
        """At t = -1, 0 or 1, as a function of y."""
        terms = (self.terms * float(t) ** np.arange(self.terms.shape[1])[:, None]).sum(axis=1, keepdims=True)
        rounding = self.terms.shape[1] * ROUNDOFF * self._size
        return TaylorModel(terms, (self.radius + rounding) * UP)

    def before(self) -> "TaylorModel":
        """Of each function in the batch, the sum of all before it."""
        terms, radius = (np.concatenate([0.0 * x[:1], np.cumsum(x, axis=0)[:-1]]) for x in (self.terms, self.norm))
        known = np.concatenate([[0.0], np.cumsum(self.radius)[:-1]])
        return TaylorModel(terms, (known + len(terms) * ROUNDOFF * radius) * UP)

    def total(self) -> "TaylorModel":
        """The sum of all functions in the batch."""
        radius = self.radius.sum() + len(self.terms) * ROUNDOFF * self.norm.sum()
        return TaylorModel(self.terms.sum(axis=0, keepdims=True), np.array([radius * UP]))

    # ------------------------------------------------------------------ along y
    def value(self, y: Ball) -> Ball:
        """Of the first function, which does not depend on t, at |y| <= 1."""
        return _evaluated(self.terms[0, 0], y) + arb(0, float(self.radius[0]))

    def slope(self, y: Ball) -> Ball:
        """Its derivative by y at |y| < 1.

        Of the rest, sum r_j y^j, it is at most the radius times the largest j |y|^(j-1); that is at most 1 / (1 - |y|),
        since j |y|^(j-1) <= 1 + |y| + ... + |y|^(j-1).
        """
        row = self.terms[0, 0]
        derived = [arb(float(c)) * j for j, c in enumerate(row)][1:]
        return _evaluated(derived, y) + arb(0, 1) * (arb(float(self.radius[0])) / (1 - abs(y)))


def _evaluated(coefficients: Any, y: Ball) -> Ball:
    total = arb(0)
    for c in reversed(coefficients):
        total = total * y + (arb(float(c)) if isinstance(c, float) else c)
    return total


def _model(x: Operand) -> TaylorModel:
    return x if isinstance(x, TaylorModel) else TaylorModel.constants([arb(x)])


def _sum(a: FloatArray, b: FloatArray) -> FloatArray:
    """(B, I, J) coefficients of the sums, each rounded once."""
    total = np.zeros(tuple(max(m, n) for m, n in zip(a.shape, b.shape, strict=True)))
    total[:, : a.shape[1], : a.shape[2]] = a
    total[:, : b.shape[1], : b.shape[2]] += b
    return total


def _product(a: FloatArray, b: FloatArray) -> FloatArray:
    """(B, I, J) coefficients of the products, those that are kept."""
    rows, columns = (min(m + n, order + 2) - 1 for m, n, order in zip(a.shape[1:], b.shape[1:], ORDERS, strict=True))
    if a.shape[1] > b.shape[1]:
        a, b = b, a
    own, other = a.shape[2], b.shape[2]
    padded = np.zeros((len(b), b.shape[1], columns + own - 1))
    padded[:, :, own - 1 : own - 1 + other] = b[:, :, :columns]
    # of every row of b all shifts, times every row of a backwards: products by y; then by t, row by row
    shifted = padded[:, :, np.arange(columns)[:, None] + np.arange(own)].reshape(len(b), -1, own)
    by_y = (shifted @ a[:, :, ::-1].transpose(0, 2, 1)).reshape(-1, b.shape[1], columns, a.shape[1])
    found = np.zeros((len(by_y), rows, columns))
    for i in range(a.shape[1]):
        found[:, i : i + b.shape[1]] += by_y[:, : rows - i, :, i]
    return found


def _cut_off(a: FloatArray, b: FloatArray) -> FloatArray | float:
    """(B,) norms of the products' terms that are not kept."""
    total: FloatArray | float = 0.0
    for axis, order in ((1, ORDERS[0]), (2, ORDERS[1])):
        m, n = a.shape[axis], b.shape[axis]
        if m + n - 2 > order:
            behind = np.arange(m)[:, None] + np.arange(n) > order
            x, y = (np.abs(terms).sum(axis=3 - axis) for terms in (a, b))
            total = total + np.einsum("bi,ij,bj->b", x, behind, y)
    return total


def _terms(norm: float) -> int:
    """Of a power series with 1/k! about 0, until what is left is below rounding."""
    left, k = 1.0, 0
    while left > 0.1 * ROUNDOFF and k < TERMS:
        k += 1
        left *= norm / k
    return k


def _left(norm: FloatArray, terms: int) -> FloatArray:
    """Of sum u^k / k! behind so many terms: the first of them times a geometric series."""
    first = np.ones_like(norm)
    for k in range(1, terms + 2):
        first = first * norm / k
    ratio = norm / (terms + 2)
    return np.where(ratio < 1.0, first / np.where(ratio < 1.0, 1.0 - ratio, 1.0) * UP, np.inf)
