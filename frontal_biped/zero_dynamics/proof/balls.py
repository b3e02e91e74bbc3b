"""Ball arithmetic: numbers known to lie within a radius of a midpoint, and power series of them.

Everything here is FLINT's (package ``python-flint``, extra ``proof``): a ball `arb` is a midpoint and a radius, and
every operation returns a ball that contains all results for all numbers in its arguments, rounding included. A series
`arb_series` is a polynomial of balls, cut off behind `ORDER` powers. What FLINT does not have is a number that carries
its derivatives by one parameter along, which the proofs about the reversal point need: `Jet`.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from frontal_biped.files.extras import missing_extra

try:
    from flint import arb, arb_mat, arb_series, ctx
except ImportError as error:
    raise missing_extra("proofs need python-flint", "proof") from error

__all__ = ["ORDER", "PRECISION", "Ball", "Jet", "Number", "arb", "arb_mat", "arb_series", "working"]

PRECISION = 80
"""Bits that midpoints are rounded to."""

ORDER = 10
"""Power of the remainder of a Taylor polynomial."""

Ball = Any
"""`arb`, or `arb_series`."""


class Jet:
    """Taylor coefficients by one parameter, each a ball or a series: arithmetic of polynomials, cut off behind ORDER.

    Attributes:
        parts: coefficients, the constant first; as many as a jet of this computation has.
    """

    __slots__ = ("parts",)

    def __init__(self, parts: Sequence[Ball]) -> None:
        self.parts = tuple(parts)

    def __add__(self, other: "Number") -> "Jet":
        if isinstance(other, Jet):
            return Jet([a + b for a, b in zip(self.parts, other.parts, strict=True)])
        return Jet([self.parts[0] + other, *self.parts[1:]])

    __radd__ = __add__

    def __neg__(self) -> "Jet":
        return Jet([-a for a in self.parts])

    def __sub__(self, other: "Number") -> "Jet":
        if isinstance(other, Jet):
            return Jet([a - b for a, b in zip(self.parts, other.parts, strict=True)])
        return Jet([self.parts[0] - other, *self.parts[1:]])

    def __rsub__(self, other: Ball) -> "Jet":
        return -self + other

    def __mul__(self, other: "Number") -> "Jet":
        if not isinstance(other, Jet):
            return Jet([a * other for a in self.parts])
        a, b = self.parts, other.parts
        parts = []
        for k in range(len(a)):
            total = a[0] * b[k]
            for i in range(1, k + 1):
                total = total + a[i] * b[k - i]
            parts.append(total)
        return Jet(parts)

    __rmul__ = __mul__

    def __truediv__(self, other: "Number") -> "Jet":
        if not isinstance(other, Jet):
            return Jet([a / other for a in self.parts])
        return _divided(self.parts, other.parts)

    def __rtruediv__(self, other: Ball) -> "Jet":
        nothing = other * 0
        return _divided((other, *([nothing] * (len(self.parts) - 1))), self.parts)


def _divided(a: Sequence[Ball], b: Sequence[Ball]) -> Jet:
    parts: list[Ball] = []
    for k in range(len(a)):
        total = a[k]
        for i in range(k):
            total = total - parts[i] * b[k - i]
        parts.append(total / b[0])
    return Jet(parts)


Number = Any
"""A ball, a series of balls, or a `Jet` of either: what the formulas of this package are written in."""


def sin_cos(x: Number) -> tuple[Number, Number]:
    """Sine and cosine [x in rad]."""
    if not isinstance(x, Jet):
        return x.sin_cos()
    # k s_k = sum i x_i c_(k-i), k c_k = - sum i x_i s_(k-i)
    first, second = x.parts[0].sin_cos()
    sin, cos = [first], [second]
    for k in range(1, len(x.parts)):
        terms = [(x.parts[i] * i, k - i) for i in range(1, k + 1)]
        sin_k = sum((dx * cos[j] for dx, j in terms[1:]), terms[0][0] * cos[k - 1]) / k
        cos_k = sum((dx * sin[j] for dx, j in terms[1:]), terms[0][0] * sin[k - 1]) / -k
        sin.append(sin_k)
        cos.append(cos_k)
    return Jet(sin), Jet(cos)


def exp(x: Number) -> Number:
    """The exponential."""
    if not isinstance(x, Jet):
        return x.exp()
    parts = [x.parts[0].exp()]
    for k in range(1, len(x.parts)):
        terms = [x.parts[i] * i * parts[k - i] for i in range(1, k + 1)]
        parts.append(sum(terms[1:], terms[0]) / k)
    return Jet(parts)


def each(function: Callable[[Ball], Ball], x: Number) -> Number:
    """A linear function of every coefficient alike."""
    return Jet([function(part) for part in x.parts]) if isinstance(x, Jet) else function(x)


def each_pair(function: Callable[[Ball, Ball], Ball], x: Number, y: Number) -> Number:
    """A linear function of two numbers' coefficients alike."""
    if isinstance(x, Jet):
        return Jet([function(a, b) for a, b in zip(x.parts, y.parts, strict=True)])
    return function(x, y)


def value_of(x: Number) -> Ball:
    """The ball, or the series, without its derivatives."""
    return x.parts[0] if isinstance(x, Jet) else x


@contextmanager
def working(order: int = ORDER) -> Iterator[None]:
    """FLINT's precision, and the length of its series: one more than the order of the remainder."""
    before = ctx.prec, ctx.cap
    ctx.prec, ctx.cap = PRECISION, order + 1
    try:
        yield
    finally:
        ctx.prec, ctx.cap = before


@contextmanager
def working_precision(bits: int) -> Iterator[None]:
    """Midpoints rounded to another number of bits."""
    before = ctx.prec
    ctx.prec = bits
    try:
        yield
    finally:
        ctx.prec = before


def within(number: float | Ball, relative: float) -> Ball:
    """The ball of a number that is known to a relative error; one that is a ball already stays as it is."""
    return number if isinstance(number, arb) else arb(number, abs(number) * relative)


def narrowed(middle: Sequence[Ball], wide: Sequence[Ball], h: Ball) -> list[Ball]:
    """Taylor coefficients about all points within h of a centre, by the mean value theorem from those about the centre.

    The k-th coefficient at a point c + t is that at c plus (k + 1) times the next one, somewhere between, times t.

    Args:
        middle: about the centre.
        wide: about all points at once, wider than they need be.
        h: half of the width.
    """
    reach = arb(0, h.upper())
    found = list(wide)
    for k in range(len(wide) - 2, -1, -1):
        found[k] = wide[k].intersection(middle[k] + (k + 1) * found[k + 1] * reach)
    return found


def narrowed_jet(middle: Number, wide: Number, w: Ball) -> Number:
    """`narrowed`, by the parameter: balls, or the series of balls, of a `Jet`; what is no jet does not depend on it."""
    if not isinstance(wide, Jet) or not isinstance(middle, Jet):
        return wide
    if isinstance(wide.parts[0], arb):
        return Jet(narrowed(middle.parts, wide.parts, w))
    powers = range(ORDER + 1)
    columns = [narrowed([a[k] for a in middle.parts], [b[k] for b in wide.parts], w) for k in powers]
    return Jet([arb_series(list(part)) for part in zip(*columns, strict=True)])


def series(coefficients: list[Ball]) -> Ball:
    """A series of given coefficients, the constant first."""
    return arb_series(coefficients)


def coefficient(s: Ball, k: int) -> Ball:
    """The k-th coefficient of a series."""
    return s[k]


def is_positive(x: Ball) -> bool:
    """Is every number of the ball positive?"""
    return bool(x > 0)


def is_negative(x: Ball) -> bool:
    """Is every number of the ball negative?"""
    return bool(x < 0)


def as_text(x: Ball) -> dict[str, str]:
    """A ball for JSON: midpoint and radius, each exactly, as mantissa and power of two."""
    return {"mid": _exactly(x.mid()), "rad": _exactly(x.rad())}


def from_text(table: dict[str, str]) -> Ball:
    """The ball that `as_text` wrote."""
    return _read(table["mid"]) + arb(0, _read(table["rad"]))


def _exactly(x: Ball) -> str:
    mantissa, power = x.man_exp()
    return f"{mantissa}*2^{power}"


def _read(text: str) -> Ball:
    mantissa, power = text.split("*2^")
    return arb((int(mantissa), int(power)))
