"""Chebyshev series on an interval: interpolation, and integration from either end."""

from dataclasses import dataclass
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

    @cached_property
    def _downwards(self) -> list[float]:
        """Coefficients from the highest degree on; at least two."""
        coefficients: list[float] = self.coefficients[::-1].tolist()
        return coefficients


def integrals(samples: FloatArray, upwards: bool) -> FloatArray:
    """(m, DEGREE + 2) series of the integrals of interpolants on [-1, 1], from where each begins.

    Args:
        samples: (m, DEGREE + 1) at `PLACES`, in the order from its beginning to its end.
        upwards: does the order go up, from -1, or down, from 1?
    """
    return samples @ (_UPWARDS if upwards else _DOWNWARDS)


def at_places(series: FloatArray, upwards: bool) -> FloatArray:
    """(m, DEGREE + 1) values of `integrals` where they are sampled, in the same order."""
    return series @ (_AT_PLACES if upwards else _AT_PLACES_DOWNWARDS)


def _integration_matrix(sense: int) -> FloatArray:
    """(DEGREE + 1, DEGREE + 2) from samples in the order of the motion to the series of their integral on [-1, 1]."""
    # DCT order: from the upper end of the domain down
    coefficients = dct(np.eye(DEGREE + 1)[::-sense], type=1, axis=0) / DEGREE
    coefficients[[0, -1]] *= 0.5
    return np.ascontiguousarray(chebint(coefficients, lbnd=-sense, axis=0).T)


_UPWARDS, _DOWNWARDS = _integration_matrix(+1), _integration_matrix(-1)
_AT_PLACES, _AT_PLACES_DOWNWARDS = (chebvander(places, DEGREE + 1).T.copy() for places in (PLACES, -PLACES))
