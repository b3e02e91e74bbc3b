"""Forward-mode differentiation of array formulas: a value and its derivatives with respect to P variables.

The closed-form zero dynamics is written once, for arrays. Handed `Dual` arrays instead, the same lines yield exact
derivatives; only the calls into Pinocchio need rules of their own (`design.derivatives`). What is done is written to
the tape of the variables, where they have one (`design.tape`).
"""

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.design.tape import Tape, computed, done, looked_at, written


class Dual:
    """Array of values with their derivatives, kept as one block so that a linear operation is one NumPy call.

    Supports what the formulas of this package use: arithmetic, constant matrix products, slicing, sums and the
    functions registered below. Anything else raises TypeError rather than dropping derivatives.

    Attributes:
        block: (1 + P, ...) the value, followed by its derivative with respect to each variable.
        tape: where operations on it are recorded; None: nowhere.
    """

    __slots__ = ("block", "tape")
    __array_priority__ = 100.0

    def __init__(self, block: FloatArray, tape: Tape | None = None) -> None:
        self.block, self.tape = block, tape

    @classmethod
    def of(cls, value: FloatArray, derivative: FloatArray) -> "Dual":
        """From a value (...) and its derivatives (P, ...)."""
        return cls(np.concatenate([np.asarray(value)[None], derivative]))

    @property
    def value(self) -> FloatArray:
        """(...) values."""
        return self.block[0, ...]

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

    def __iter__(self) -> Iterator["Dual"]:
        return (self[i] for i in range(len(self)))

    def __getitem__(self, key: Any) -> "Dual":
        if isinstance(key, np.ndarray):
            return Dual(done(self.tape, np.take, self.block, key, 1), self.tape)
        of_block = (slice(None), *key) if isinstance(key, tuple) else (slice(None), key)
        return Dual(looked_at(self.tape, self.block, lambda block: block[of_block]), self.tape)

    def __float__(self) -> float:
        if self.tape is not None:
            raise TypeError("a number taken out of a recorded array would stay what it is")
        return float(self.block[0])

    @property
    def T(self) -> "Dual":
        """Transpose."""
        return Dual(self.block.transpose(0, *range(self.block.ndim - 1, 0, -1)), self.tape)

    def reshape(self, *shape: int) -> "Dual":
        """The values in another shape."""
        of_block = (len(self.block), *shape)
        return Dual(looked_at(self.tape, self.block, lambda block: block.reshape(of_block)), self.tape)

    def sum(self, axis: int) -> "Dual":
        """Sum over an axis, counted from the front."""
        return Dual(done(self.tape, np.add.reduce, self.block, axis + 1, None), self.tape)

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
        return Dual(done(self.tape, np.negative, self.block), self.tape)

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


def independent(values: FloatArray, tape: Tape | None = None) -> Dual:
    """(P,) variables to differentiate by."""
    variables = Dual.of(np.asarray(values, dtype=float), np.eye(len(values)))
    variables.tape = tape
    return variables


def chain(value: FloatArray, outer: FloatArray, inner: Dual) -> Dual:
    """A function known by value (k,) and Jacobian (k, m) at a point (m,), applied to a Dual point (m,)."""
    return Dual.of(value, inner.derivative @ outer.T)


def elementwise(a: Dual, value: FloatArray, slope: FloatArray) -> Dual:
    """A function of each element, known by its values and slopes, both of a's shape or repeating it."""
    source = _widened(a.block, np.ndim(slope))
    block = np.empty(np.broadcast_shapes(source.shape, np.shape(slope)))
    written(a.tape, np.copyto, block[0, ...], value)
    written(a.tape, np.multiply, source[1:], slope, block[1:])
    return Dual(block, a.tape)


# ---------------------------------------------------------------------- rules
def _tape(*parts: Any) -> Tape | None:
    """Of the operands: the first that there is."""
    return next((part.tape for part in parts if isinstance(part, Dual) and part.tape is not None), None)


def _aligned(a: FloatArray, b: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Blocks with as many axes: NumPy lines up trailing axes, but the first axis of a block is its own."""
    return _widened(a, b.ndim - 1), _widened(b, a.ndim - 1)


def _widened(block: FloatArray, ndim: int) -> FloatArray:
    """The block of values with at least ``ndim`` axes, new ones in front."""
    missing = ndim + 1 - block.ndim
    return block if missing <= 0 else np.expand_dims(block, tuple(range(1, 1 + missing)))


def _plus_constant(block: FloatArray, constant: Any, tape: Tape | None) -> Dual:
    """Only the value moves; a constant of more axes or elements repeats the derivatives."""
    shape = np.broadcast_shapes(block.shape[1:], np.shape(constant))
    source = np.broadcast_to(_widened(block, len(shape)), (len(block), *shape))
    moved = np.empty(source.shape)
    written(tape, np.copyto, moved, source)
    written(tape, np.add, moved[0, ...], constant, moved[0, ...])
    return Dual(moved, tape)


def _add(a: Any, b: Any) -> Dual:
    if not isinstance(a, Dual):
        a, b = b, a
    tape = _tape(a, b)
    if not isinstance(b, Dual):
        return _plus_constant(a.block, b, tape)
    return Dual(done(tape, np.add, *_aligned(a.block, b.block)), tape)


def _subtract(a: Any, b: Any) -> Dual:
    if not isinstance(b, Dual):
        return _plus_constant(a.block, -np.asarray(b), a.tape)
    if not isinstance(a, Dual):
        return _plus_constant(done(b.tape, np.negative, b.block), a, b.tape)
    tape = _tape(a, b)
    return Dual(done(tape, np.subtract, *_aligned(a.block, b.block)), tape)


def _multiply(a: Any, b: Any) -> Dual:
    if not isinstance(a, Dual):
        a, b = b, a
    tape = _tape(a, b)
    if not isinstance(b, Dual):
        return Dual(done(tape, np.multiply, _widened(a.block, np.ndim(b)), b), tape)
    left, right = _aligned(a.block, b.block)
    block = done(tape, np.multiply, left[0, ...], right)
    other = done(tape, np.multiply, right[0, ...], left[1:])
    written(tape, np.add, block[1:], other, block[1:])
    return Dual(block, tape)


def _divide(a: Any, b: Any) -> Dual:
    if not isinstance(b, Dual):
        return _multiply(a, 1.0 / np.asarray(b))
    tape = _tape(a, b)
    inverse = done(tape, np.divide, 1.0, _aligned(a.block, b.block)[1][0, ...] if isinstance(a, Dual) else b.value)
    if not isinstance(a, Dual):
        quotient = done(tape, np.multiply, a, inverse)
        return elementwise(b, quotient, done(tape, np.multiply, done(tape, np.negative, quotient), inverse))
    left, right = _aligned(a.block, b.block)
    shape = np.broadcast_shapes(left.shape, right.shape)
    block = np.empty_like(left) if left.shape == shape else np.empty(shape)  # in the order of what is divided
    written(tape, np.multiply, left[0, ...], inverse, block[0, ...])
    written(tape, np.multiply, block[0, ...], right[1:], block[1:])
    written(tape, np.subtract, left[1:], block[1:], block[1:])
    written(tape, np.multiply, block[1:], inverse, block[1:])
    return Dual(block, tape)


def _by_value(a: Dual, function: Callable[..., Any], *arguments: Any) -> FloatArray:
    """A block like a's, with values that a function puts there; their derivatives are to come."""
    block = np.empty_like(a.block)
    written(a.tape, function, *arguments, block[0, ...])
    return block


def _power(a: Dual, exponent: float) -> Dual:
    tape, value = a.tape, a.value
    if exponent == 2:
        block = _by_value(a, np.multiply, value, value)
        slope = done(tape, np.multiply, 2.0, value)
    else:
        block = _by_value(a, np.power, value, exponent)
        slope = done(tape, np.multiply, exponent, done(tape, np.power, value, exponent - 1))
    written(tape, np.multiply, a.derivative, slope, block[1:])
    return Dual(block, tape)


def _matmul(a: Any, b: Any) -> Dual:
    if isinstance(a, Dual) and isinstance(b, Dual):
        raise TypeError("the product of two differentiated matrices is not supported")
    tape = _tape(a, b)
    if isinstance(a, Dual):  # rows of all derivatives at once
        columns = a.block.shape[-1]
        rows = looked_at(tape, a.block, lambda block: block.reshape(-1, columns))
        return Dual(done(tape, np.matmul, rows, b).reshape(*a.block.shape[:-1], *b.shape[1:]), tape)
    if b.ndim == 1:
        return Dual(done(tape, np.matmul, b.block, a.T), tape)
    return Dual(done(tape, np.matmul, a, b.block), tape)


def _minimum(a: Any, b: Any) -> Dual:
    """The smaller one with its derivative; where both are equal, the first one's."""
    tape = _tape(a, b)
    left, right = np.broadcast_arrays(*_aligned(*_lift(a, b)))
    return Dual(computed(tape, lambda: np.where(left[0] <= right[0], left, right)), tape)


def _sqrt(a: Dual) -> Dual:
    block = _by_value(a, np.sqrt, a.value)
    written(a.tape, np.multiply, a.derivative, done(a.tape, np.divide, 0.5, block[0, ...]), block[1:])
    return Dual(block, a.tape)


def _exp(a: Dual) -> Dual:
    block = _by_value(a, np.exp, a.value)
    written(a.tape, np.multiply, a.derivative, block[0, ...], block[1:])
    return Dual(block, a.tape)


def _sin(a: Dual) -> Dual:
    return elementwise(a, done(a.tape, np.sin, a.value), done(a.tape, np.cos, a.value))


def _cos(a: Dual) -> Dual:
    slope = done(a.tape, np.negative, done(a.tape, np.sin, a.value))
    return elementwise(a, done(a.tape, np.cos, a.value), slope)


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
    tape = _tape(*parts)
    return Dual(done(tape, np.concatenate, _lift(*parts), axis + 1), tape)


def _stack(parts: Sequence[Any], axis: int = 0) -> Dual:
    tape = _tape(*parts)
    return Dual(
        done(tape, np.concatenate, [np.expand_dims(block, axis + 1) for block in _lift(*parts)], axis + 1), tape
    )


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
    np.sin: _sin,
    np.cos: _cos,
}

_FUNCTIONS: dict[Any, Callable[..., Any]] = {
    np.concatenate: _concatenate,
    np.stack: _stack,
    np.atleast_1d: lambda a: Dual(_widened(a.block, 1), a.tape),
    np.ones_like: lambda a: np.ones_like(a.value),
    np.zeros_like: lambda a: np.zeros_like(a.value),
}
