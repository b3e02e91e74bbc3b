"""Forward-mode differentiation of array formulas: a value and its derivatives with respect to P variables.

The closed-form zero dynamics is written once, for arrays. Handed `Dual` arrays instead, the same lines yield exact
derivatives; only the calls into Pinocchio need rules of their own (`design.derivatives`).
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray


class Dual:
    """Array of values with their derivatives, kept as one block so that a linear operation is one NumPy call.

    Supports what the formulas of this package use: arithmetic, constant matrix products, slicing, sums and the
    functions registered below. Anything else raises TypeError rather than dropping derivatives.

    Attributes:
        block: (1 + P, ...) the value, followed by its derivative with respect to each variable.
    """

    __slots__ = ("block",)
    __array_priority__ = 100.0

    def __init__(self, block: FloatArray) -> None:
        self.block = block

    @classmethod
    def of(cls, value: FloatArray, derivative: FloatArray) -> "Dual":
        """From a value (...) and its derivatives (P, ...)."""
        return cls(np.concatenate([np.asarray(value)[None], derivative]))

    @property
    def value(self) -> FloatArray:
        """(...) values."""
        return self.block[0]

    @property
    def derivative(self) -> FloatArray:
        """(P, ...) derivative with respect to each variable."""
        return self.block[1:]

    # ------------------------------------------------------------------ shape
    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the values."""
        return self.block.shape[1:]

    @property
    def ndim(self) -> int:
        """Number of axes of the values."""
        return self.block.ndim - 1

    def __len__(self) -> int:
        return self.block.shape[1]

    def __getitem__(self, key: Any) -> "Dual":
        return Dual(self.block[(slice(None), *key) if isinstance(key, tuple) else (slice(None), key)])

    def __float__(self) -> float:
        return float(self.block[0])

    @property
    def T(self) -> "Dual":
        """Transpose."""
        return Dual(self.block.transpose(0, *range(self.block.ndim - 1, 0, -1)))

    def reshape(self, *shape: int) -> "Dual":
        """The values in another shape."""
        return Dual(self.block.reshape(len(self.block), *shape))

    def sum(self, axis: int) -> "Dual":
        """Sum over an axis, counted from the front."""
        return Dual(self.block.sum(axis=axis + 1))

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
        return _subtract(self, other)

    def __rsub__(self, other: Any) -> "Dual":
        return _subtract(other, self)

    def __neg__(self) -> "Dual":
        return Dual(-self.block)

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
    return Dual.of(np.asarray(values, dtype=float), np.eye(len(values)))


def chain(value: FloatArray, outer: FloatArray, inner: Dual) -> Dual:
    """A function known by value (k,) and Jacobian (k, m) at a point (m,), applied to a Dual point (m,)."""
    return Dual.of(value, inner.derivative @ outer.T)


def elementwise(a: Dual, value: FloatArray, slope: FloatArray) -> Dual:
    """A function of each element, known by its values and slopes, both of a's shape or repeating it."""
    block = _widened(a.block, np.ndim(slope)) * slope
    block[0] = value
    return Dual(block)


# ---------------------------------------------------------------------- rules
def _aligned(a: FloatArray, b: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Blocks with as many axes: NumPy lines up trailing axes, but the first axis of a block is its own."""
    return _widened(a, b.ndim - 1), _widened(b, a.ndim - 1)


def _widened(block: FloatArray, ndim: int) -> FloatArray:
    """The block of values with at least ``ndim`` axes, new ones in front."""
    missing = ndim + 1 - block.ndim
    return block if missing <= 0 else block.reshape(len(block), *(1,) * missing, *block.shape[1:])


def _plus_constant(block: FloatArray, constant: Any) -> Dual:
    """Only the value moves; a constant of more axes or elements repeats the derivatives."""
    shape = np.broadcast_shapes(block.shape[1:], np.shape(constant))
    if shape == block.shape[1:]:
        block = block.copy()
    else:
        block = np.broadcast_to(_widened(block, len(shape)), (len(block), *shape)).copy()
    block[0] += constant
    return Dual(block)


def _add(a: Any, b: Any) -> Dual:
    if not isinstance(a, Dual):
        a, b = b, a
    if not isinstance(b, Dual):
        return _plus_constant(a.block, b)
    left, right = _aligned(a.block, b.block)
    return Dual(left + right)


def _subtract(a: Any, b: Any) -> Dual:
    if not isinstance(b, Dual):
        return _plus_constant(a.block, -np.asarray(b))
    if not isinstance(a, Dual):
        return _plus_constant(-b.block, a)
    left, right = _aligned(a.block, b.block)
    return Dual(left - right)


def _multiply(a: Any, b: Any) -> Dual:
    if not isinstance(a, Dual):
        a, b = b, a
    if not isinstance(b, Dual):
        return Dual(_widened(a.block, np.ndim(b)) * b)
    left, right = _aligned(a.block, b.block)
    block = left[0] * right
    block[1:] += right[0] * left[1:]
    return Dual(block)


def _divide(a: Any, b: Any) -> Dual:
    if not isinstance(b, Dual):
        return _multiply(a, 1.0 / np.asarray(b))
    if not isinstance(a, Dual):
        inverse = 1.0 / b.value
        quotient = a * inverse
        return elementwise(b, quotient, -quotient * inverse)
    left, right = _aligned(a.block, b.block)
    inverse = 1.0 / right[0]
    quotient = left[0] * inverse
    block = left - quotient * right
    block *= inverse
    block[0] = quotient
    return Dual(block)


def _power(a: Dual, exponent: float) -> Dual:
    value = a.value
    if exponent == 2:
        return elementwise(a, value * value, 2.0 * value)
    return elementwise(a, value**exponent, exponent * value ** (exponent - 1))


def _matmul(a: Any, b: Any) -> Dual:
    if isinstance(a, Dual) and isinstance(b, Dual):
        raise TypeError("the product of two differentiated matrices is not supported")
    if isinstance(a, Dual):  # rows of all derivatives at once
        product = a.block.reshape(-1, a.block.shape[-1]) @ b
        return Dual(product.reshape(*a.block.shape[:-1], *b.shape[1:]))
    if b.ndim == 1:
        return Dual(b.block @ a.T)
    return Dual(a @ b.block)


def _minimum(a: Any, b: Any) -> Dual:
    """The smaller one with its derivative; where both are equal, the first one's."""
    left, right = np.broadcast_arrays(*_aligned(*_lift(a, b)))
    return Dual(np.where(left[0] <= right[0], left, right))


def _sqrt(a: Dual) -> Dual:
    root = np.sqrt(a.value)
    return elementwise(a, root, 0.5 / root)


def _exp(a: Dual) -> Dual:
    value = np.exp(a.value)
    return elementwise(a, value, value)


def _lift(*parts: Any) -> list[FloatArray]:
    """Every part as a block, constants with zero derivative."""
    size = next(len(part.block) for part in parts if isinstance(part, Dual))
    lifted = []
    for part in parts:
        if isinstance(part, Dual):
            lifted.append(part.block)
        else:
            block = np.zeros((size, *np.shape(part)))
            block[0] = part
            lifted.append(block)
    return lifted


def _concatenate(parts: Sequence[Any], axis: int = 0) -> Dual:
    return Dual(np.concatenate(_lift(*parts), axis=axis + 1))


def _stack(parts: Sequence[Any], axis: int = 0) -> Dual:
    return Dual(np.stack(_lift(*parts), axis=axis + 1))


_UFUNCS: dict[np.ufunc, Callable[..., Any]] = {
    np.add: _add,
    np.subtract: _subtract,
    np.multiply: _multiply,
    np.true_divide: _divide,
    np.negative: lambda a: -a,
    np.square: lambda a: _power(a, 2),
    np.power: _power,
    np.matmul: _matmul,
    np.minimum: _minimum,
    np.sqrt: _sqrt,
    np.exp: _exp,
    np.sin: lambda a: elementwise(a, np.sin(a.value), np.cos(a.value)),
    np.cos: lambda a: elementwise(a, np.cos(a.value), -np.sin(a.value)),
}

_FUNCTIONS: dict[Any, Callable[..., Any]] = {
    np.concatenate: _concatenate,
    np.stack: _stack,
    np.ones_like: lambda a: np.ones_like(a.value),
    np.zeros_like: lambda a: np.zeros_like(a.value),
}
