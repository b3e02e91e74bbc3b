"""What the arrays of a kind of archive are to be, each said once: shape and values, checked where a file is read.

Sizes are judged before any number is read; then every number.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.files.npz import Head

MOST_BYTES = 2_000_000_000
"""Of all arrays of a file, as doubles. 3000 steps in space of a robot with 40 joints, each of 0.7 s and recorded at
250 Hz, are 525 000 samples of 186 numbers: 0.8 GB."""

FREELY = 256_000_000
"""Bytes that a file of any size may hold; above, not more than `MOST_EXPANSION` times its own."""

MOST_EXPANSION = 20
"""A walk that was simulated is compressed to three quarters, one that repeats itself exactly to a hundredth."""

LARGEST = 1e12
"""Size of a number, in whatever unit, that can be meant."""


@dataclass(frozen=True)
class ArraySchema:
    """What one array is to be. Real numbers; NaN, where it is allowed, is where there is none.

    Attributes:
        row: shape of a row.
        rows: how many there are; None: as many as the first array has, and at least one.
        least: no number is below it.
        most: none is above it.
        among: no number is another than these, if there are any.
        whole: all are whole numbers.
        ordered: none is below the one before it.
        gaps: NaN is allowed.
        posture: where it is out of its range, the robot has diverged; nothing is asked of that row any more, nor of
            those behind it, which are all out of their range.
    """

    row: tuple[int, ...] = ()
    rows: int | None = None
    least: float = -LARGEST
    most: float = LARGEST
    among: tuple[float, ...] = ()
    whole: bool = False
    ordered: bool = False
    gaps: bool = False
    posture: bool = False

    @property
    def always(self) -> bool:
        """Is it asked of all rows, those in which the robot has diverged among them?"""
        return self.rows is not None or bool(self.among) or self.whole or self.ordered


def require_shapes(heads: Mapping[str, Head], schema: Mapping[str, ArraySchema], file_size: int) -> None:
    """Raise ValueError, saying which array is wrong, before any is read.

    Args:
        heads: of the arrays of a schema.
        schema: what they are to be.
        file_size: of the archive [bytes].
    """
    samples = next(iter(heads.values())).shape[:1] or (1,)
    numbers = 0
    for name, wanted in schema.items():
        head, rows = heads[name], samples if wanted.rows is None else (wanted.rows,)
        if not head.are_numbers or head.shape != (*rows, *wanted.row):
            raise ValueError(
                f"{name} is {np.dtype(head.dtype)} of shape {head.shape}, not numbers of shape {(*rows, *wanted.row)}"
            )
        numbers += math.prod(head.shape)
    if samples == (0,):
        raise ValueError("there is not one sample")
    most = min(MOST_BYTES, max(FREELY, MOST_EXPANSION * file_size))
    if 8 * numbers > most:
        raise ValueError(f"its {samples[0]} samples are {8 * numbers} bytes, more than {most} of a file of its size")


def require_values(arrays: Mapping[str, FloatArray], schema: Mapping[str, ArraySchema]) -> None:
    """Raise ValueError, saying which number is wrong; shapes are as in `require_shapes`."""
    kept = _rows_before_divergence(arrays, schema)
    for name, wanted in schema.items():
        _require(name, arrays[name][: None if wanted.always else kept], wanted)


def _rows_before_divergence(arrays: Mapping[str, FloatArray], schema: Mapping[str, ArraySchema]) -> int:
    postures = [name for name, wanted in schema.items() if wanted.posture]
    sane = np.ones(len(arrays[postures[0]]), dtype=bool)
    for name in postures:
        flat = arrays[name].reshape(len(sane), -1)
        sane &= ((flat >= schema[name].least) & (flat <= schema[name].most)).all(axis=1)
    kept = int(sane.sum())
    if not kept or not sane[:kept].all():  # at the start, or a hole: tell it
        for name in postures:
            _require(name, arrays[name][: int(np.argmin(sane)) + 1], schema[name])
    return kept


def _require(name: str, array: FloatArray, wanted: ArraySchema) -> None:
    """Raise ValueError for the first number that is not as wanted."""
    if not array.size:
        return
    if not wanted.gaps and np.isnan(array.min()):
        _refuse(name, array, np.isnan(array), "is no number")
    low, high = np.fmin.reduce(array, axis=None), np.fmax.reduce(array, axis=None)  # of what is not NaN
    if low < wanted.least or high > wanted.most:
        outside = (array < wanted.least) | (array > wanted.most)
        _refuse(name, array, outside, f"is not from {wanted.least:g} to {wanted.most:g}")
    if wanted.among and not (sane := np.isin(array, wanted.among)).all():
        _refuse(name, array, ~sane, f"is none of {', '.join(f'{value:g}' for value in wanted.among)}")
    if wanted.whole and not (sane := array == np.floor(array)).all():
        _refuse(name, array, ~sane, "is no whole number")
    if wanted.ordered and (falls := np.diff(array) < 0.0).any():
        _refuse(name, array, np.concatenate([[False], falls]), "is less than the one before it")


def _refuse(name: str, array: FloatArray, wrong: "np.ndarray[Any, np.dtype[np.bool_]]", why: str) -> None:
    at = np.unravel_index(int(np.argmax(wrong)), array.shape)
    raise ValueError(f"{name}[{', '.join(map(str, at))}] = {array[at]:g} {why}")
