"""Hypothesis strategies for random states of a biped, and finite differences with a stated accuracy."""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

FloatArray = npt.NDArray[np.float64]

UPRIGHT = -0.5 * np.pi

DIFFERENCE_STEP = 1e-5
"""Step of central differences: rounding 1e-16/1e-5 and truncation 1e-10 are about equally small."""

DIFFERENCE_TOLERANCE = 1e-7
"""Relative accuracy of a central difference with that step, third derivatives up to 1000 times the value."""


def vectors(low: float, high: float, size: int = 4) -> st.SearchStrategy[FloatArray]:
    """(size,) numbers between low and high."""
    return arrays(np.float64, size, elements=st.floats(low, high, allow_subnormal=False))


angles = vectors(-0.5, 0.5).map(lambda lean: UPRIGHT + lean)
"""(4,) configurations up to 0.5 rad from upright in every joint: well beyond what a gait uses [rad]."""

rates = vectors(-3.0, 3.0)
"""(4,) joint velocities [rad/s]."""

accelerations = vectors(-10.0, 10.0)
"""(4,) joint accelerations [rad/s^2]."""


def difference(
    function: Callable[[float], npt.ArrayLike], at: float = 0.0, step: float = DIFFERENCE_STEP
) -> FloatArray:
    """Central difference of a function of one number."""
    return (np.asarray(function(at + step)) - np.asarray(function(at - step))) / (2.0 * step)


def assert_close(actual: npt.ArrayLike, expected: npt.ArrayLike, tolerance: float, floor: float = 0.0) -> None:
    """Largest difference is within the tolerance of the largest expected entry (at least ``floor``)."""
    actual, expected = np.asarray(actual, dtype=float), np.asarray(expected, dtype=float)
    assert actual.shape == expected.shape
    size = max(float(np.max(np.abs(expected), initial=0.0)), floor)
    error = float(np.max(np.abs(actual - expected), initial=0.0))
    assert error <= tolerance * size, f"error {error:.3g} against {expected} exceeds {tolerance:g} of {size:.3g}"
