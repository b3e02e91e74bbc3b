"""Chebyshev series on an interval: interpolation, and integration from either end."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.polynomial.chebyshev import chebint, chebval, chebvander
from scipy.fft import dct

from frontal_biped.arrays import FloatArray

DEGREE = 20
"""Of the interpolant on a panel."""


PLACES = -np.cos(np.pi * np.arange(DEGREE + 1) / DEGREE)
"""Where a panel is sampled, on [-1, 1] from its start to its end."""


@dataclass(frozen=True)
class Series:
    """A Chebyshev series on an interval; NumPy's class spends more time on its domain than on the sum.

    Attributes:
        coefficients: (k,).
        middle: of the interval.
        half: half its length.
    """

    coefficients: FloatArray
    middle: float
    half: float

    def __call__(self, x: FloatArray | float) -> FloatArray:
        """Its values, in the shape of x."""
        return np.asarray(chebval((x - self.middle) / self.half, self.coefficients), dtype=float)

    def at(self, x: float) -> float:
        """Its value at one x, in plain numbers: a root finder asks one at a time (Clenshaw's recurrence)."""
        place = (x - self.middle) / self.half
        last, before, *others = self._downwards
        for coefficient in others:
            before, last = coefficient - last, before + 2.0 * place * last
        return before + place * last

    def at_places(self, sense: float) -> FloatArray:
        """(DEGREE + 1,) its values where a panel is sampled, upwards (sense > 0) or downwards; of an `integral`."""
        return (_AT_PLACES if sense > 0.0 else _AT_PLACES_DOWNWARDS) @ self.coefficients

    @cached_property
    def _downwards(self) -> list[float]:
        """Coefficients from the highest degree on; at least two."""
        coefficients: list[float] = self.coefficients[::-1].tolist()
        return coefficients

    def __add__(self, constant: float) -> "Series":
        moved = self.coefficients.copy()
        moved[0] += constant
        return replace(self, coefficients=moved)

    def __neg__(self) -> "Series":
        return replace(self, coefficients=-self.coefficients)


def integral(samples: FloatArray, a: float, b: float) -> Series:
    """Integral from a of the interpolant of samples given in the order from a to b."""
    half = 0.5 * abs(b - a)
    return Series(half * (_UPWARDS if b > a else _DOWNWARDS) @ samples, 0.5 * (a + b), half)


def _integration_matrix(sense: int) -> FloatArray:
    """(DEGREE + 2, DEGREE + 1) from samples in the order of the motion to the series of their integral on [-1, 1]."""
    # DCT order: from the upper end of the domain down
    coefficients = dct(np.eye(DEGREE + 1)[::-sense], type=1, axis=0) / DEGREE
    coefficients[[0, -1]] *= 0.5
    return np.asarray(chebint(coefficients, lbnd=-sense, axis=0), dtype=float)


_UPWARDS, _DOWNWARDS = _integration_matrix(+1), _integration_matrix(-1)
_AT_PLACES, _AT_PLACES_DOWNWARDS = chebvander(PLACES, DEGREE + 1), chebvander(-PLACES, DEGREE + 1)
