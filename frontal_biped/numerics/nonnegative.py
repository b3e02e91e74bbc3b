"""Non-negative least squares by SciPy, and the only module that knows how to ask for them without its checks.

    minimise |E w - t|   subject to   w >= 0

Of a dozen columns the checks around SciPy's compiled function take longer than its work. Its place and its signature
are not promised, so it is tried once, on a problem of two numbers, and SciPy's public function stands in wherever it is
not found or not as it was. The digits are the same.
"""

from collections.abc import Callable
from importlib import import_module
from math import isfinite

import numpy as np
from scipy.optimize import nnls

from frontal_biped.arrays import FloatArray

Nnls = Callable[[FloatArray, FloatArray, int], tuple[FloatArray, float, int]]
"""Of E (n, k), t (n,) and the most iterations: w (k,), the distance left, and `NOT_ENDED` or another number."""

NOT_ENDED = 3
"""SciPy's number for a method that was stopped."""


def checked(E: FloatArray, t: FloatArray, most: int) -> tuple[FloatArray, float, int]:
    """By SciPy's public function.

    Raises:
        ValueError: an entry is not finite.
    """
    try:
        return *nnls(E, t, maxiter=most), 0
    except RuntimeError:
        return np.zeros(E.shape[1]), 0.0, NOT_ENDED


def unchecked(module: str = "scipy.optimize._slsqplib") -> Nnls:
    """What the public function calls after its checks, from where SciPy has it; else `checked`."""
    try:
        found: Nnls = import_module(module).nnls
        w, distance, verdict = found(np.diag([1.0, 2.0]), np.array([3.0, -4.0]), 9)
    except (ImportError, AttributeError, TypeError, ValueError):
        return checked
    return found if (w.tolist(), distance, verdict != NOT_ENDED) == ([3.0, 0.0], 4.0, True) else checked


finite_nnls: Nnls = unchecked()
"""For finite numbers; what it is given stays as it is."""


def for_numbers(E: FloatArray) -> Nnls:
    """The method for a matrix that may hold numbers that are not finite: then it says so."""
    return finite_nnls if isfinite(np.vdot(E, E)) else checked
