"""Forward-mode differentiation of array formulas: a value and its derivatives with respect to P variables.

The closed-form zero dynamics is written once, for arrays. Handed `Dual` arrays instead, the same lines yield exact
derivatives; only the calls into Pinocchio need rules of their own (`design.derivatives`).
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray


class Dual:
    """Array of values (shape) with derivatives (shape, P).

    Supports what the formulas of this package use: arithmetic, constant matrix products, slicing, sums and the
    functions registered below. Anything else raises TypeError rather than dropping derivatives.
    """

    __slots__ = ("derivative", "value")
    __array_priority__ = 100.0

    def __init__(self, value: FloatArray, derivative: FloatArray) -> None:
        self.value = value
        self.derivative = derivative

    # ------------------------------------------------------------------ shape
    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the values."""
        return self.value.shape

    @property
    def ndim(self) -> int:
        """Number of axes of the values."""
        return self.value.ndim

    def __len__(self) -> int:
        return len(self.value)

    def __getitem__(self, key: Any) -> "Dual":
        keys = key if isinstance(key, tuple) else (key,)
        rest = () if any(part is Ellipsis for part in keys) else (Ellipsis,)
        return Dual(np.asarray(self.value[key]), self.derivative[(*keys, *rest, slice(None))])

    def __float__(self) -> float:
        return float(self.value)

    @property
    def T(self) -> "Dual":
        """Transpose."""
        axes = (*reversed(range(self.ndim)), self.ndim)
        return Dual(self.value.T, self.derivative.transpose(axes))

    def sum(self, axis: int) -> "Dual":
        """Sum over an axis, counted from the front."""
        return Dual(self.value.sum(axis=axis), self.derivative.sum(axis=axis))

    # ------------------------------------------------------------------ dispatch from NumPy
    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **kwargs: Any) -> Any:
        rule = _UFUNCS.get(ufunc)
        if method != "__call__" or kwargs or rule is None:
            return NotImplemented
        return rule(*inputs)

    def __array_function__(self, func: Any, types: Any, args: Any, kwargs: Any) -> Any:
        rule = _FUNCTIONS.get(func)
        return NotImplemented if rule is None else rule(*args, **kwargs)

    # ------------------------------------------------------------------ arithmetic
    def __add__(self, other: Any) -> "Dual":
        return _add(self, other)

    __radd__ = __add__

    def __sub__(self, other: Any) -> "Dual":
        return _add(self, -other)

    def __rsub__(self, other: Any) -> "Dual":
        return _add(-self, other)

    def __neg__(self) -> "Dual":
        return Dual(-self.value, -self.derivative)

    def __mul__(self, other: Any) -> "Dual":
        return _multiply(self, other)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> "Dual":
        return _divide(self, other)

    def __rtruediv__(self, other: Any) -> "Dual":
        return _divide(other, self)

    def __pow__(self, exponent: float) -> "Dual":
        return _power(self, exponent)

    def __matmul__(self, constant: FloatArray) -> "Dual":
        return _matmul(self, constant)

    def __rmatmul__(self, constant: FloatArray) -> "Dual":
        return _matmul(constant, self)


def independent(values: FloatArray) -> Dual:
    """(P,) variables to differentiate by."""
    return Dual(np.asarray(values, dtype=float), np.eye(len(values)))


def chain(value: FloatArray, outer: FloatArray, inner: Dual) -> Dual:
    """A function known by value (..., ) and Jacobian (..., k) at a point (k,), applied to a Dual point (k,)."""
    return Dual(value, outer @ inner.derivative)


# ---------------------------------------------------------------------- rules
def _add(a: Any, b: Any) -> Dual:
    if not isinstance(a, Dual):
        a, b = b, a
    if isinstance(b, Dual):
        return Dual(a.value + b.value, a.derivative + b.derivative)
    value = a.value + b
    derivative = a.derivative
    if value.shape != a.value.shape:
        derivative = np.broadcast_to(derivative, (*value.shape, derivative.shape[-1]))
    return Dual(value, derivative)


def _multiply(a: Any, b: Any) -> Dual:
    if not isinstance(a, Dual):
        a, b = b, a
    if isinstance(b, Dual):
        return Dual(a.value * b.value, a.derivative * b.value[..., None] + b.derivative * a.value[..., None])
    return Dual(a.value * b, a.derivative * np.asarray(b)[..., None])


def _divide(a: Any, b: Any) -> Dual:
    if not isinstance(b, Dual):
        return _multiply(a, 1.0 / np.asarray(b))
    value = (a.value if isinstance(a, Dual) else a) / b.value
    slope = -b.derivative * (value / b.value)[..., None]
    return Dual(value, slope + a.derivative / b.value[..., None] if isinstance(a, Dual) else slope)


def _power(a: Dual, exponent: float) -> Dual:
    return _elementwise(a, a.value**exponent, exponent * a.value ** (exponent - 1))


def _matmul(a: Any, b: Any) -> Dual:
    if isinstance(b, Dual):
        if isinstance(a, Dual):
            raise TypeError("the product of two differentiated matrices is not supported")
        return Dual(a @ b.value, np.tensordot(a, b.derivative, axes=1))
    if a.ndim == 1:
        return Dual(a.value @ b, np.tensordot(b.T, a.derivative, axes=1))
    raise TypeError("only a differentiated vector may stand left of a constant matrix")


def _elementwise(a: Dual, value: FloatArray, slope: FloatArray) -> Dual:
    return Dual(np.asarray(value), a.derivative * np.asarray(slope)[..., None])


def _sqrt(a: Dual) -> Dual:
    root = np.sqrt(a.value)
    return _elementwise(a, root, 0.5 / root)


def _exp(a: Dual) -> Dual:
    value = np.exp(a.value)
    return _elementwise(a, value, value)


def _arctan2(y: Any, x: Any) -> Dual:
    y, x = _lift(y, x)
    squared = x.value**2 + y.value**2
    derivative = (y.derivative * x.value[..., None] - x.derivative * y.value[..., None]) / squared[..., None]
    return Dual(np.arctan2(y.value, x.value), derivative)


def _lift(*parts: Any) -> list[Dual]:
    """Every part as a Dual, constants with zero derivative."""
    size = next(part.derivative.shape[-1] for part in parts if isinstance(part, Dual))
    lifted = []
    for part in parts:
        array = part if isinstance(part, Dual) else np.asarray(part, dtype=float)
        lifted.append(array if isinstance(array, Dual) else Dual(array, np.zeros((*array.shape, size))))
    return lifted


def _concatenate(parts: Sequence[Any], axis: int = 0) -> Dual:
    lifted = _lift(*parts)
    return Dual(
        np.concatenate([part.value for part in lifted], axis=axis),
        np.concatenate([part.derivative for part in lifted], axis=axis),
    )


def _stack(parts: Sequence[Any], axis: int = 0) -> Dual:
    lifted = _lift(*parts)
    return Dual(
        np.stack([part.value for part in lifted], axis=axis),
        np.stack([part.derivative for part in lifted], axis=axis),
    )


_UFUNCS: dict[np.ufunc, Callable[..., Any]] = {
    np.add: _add,
    np.subtract: lambda a, b: _add(a, -b),
    np.multiply: _multiply,
    np.true_divide: _divide,
    np.negative: lambda a: -a,
    np.square: lambda a: a * a,
    np.power: _power,
    np.matmul: _matmul,
    np.sqrt: _sqrt,
    np.exp: _exp,
    np.sin: lambda a: _elementwise(a, np.sin(a.value), np.cos(a.value)),
    np.cos: lambda a: _elementwise(a, np.cos(a.value), -np.sin(a.value)),
    np.arccos: lambda a: _elementwise(a, np.arccos(a.value), -1.0 / np.sqrt(1.0 - a.value**2)),
    np.arctan2: _arctan2,
    np.absolute: lambda a: np.abs(a.value),  # for tests of domain only
}

_FUNCTIONS: dict[Any, Callable[..., Any]] = {
    np.concatenate: _concatenate,
    np.stack: _stack,
    np.ones_like: lambda a: np.ones_like(a.value),
    np.zeros_like: lambda a: np.zeros_like(a.value),
}
