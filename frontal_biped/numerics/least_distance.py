"""The point of a polyhedron nearest to the origin, exactly and reproducibly.

    minimise 1/2 y'y   subject to   G'y >= h

Its dual is a non-negative least-squares problem (Lawson and Hanson, Solving Least Squares Problems, Ch. 23), which
SciPy solves by an active-set method. The active set it ends with is then solved to rounding. Unlike an interior or
proximal method there is no tolerance: equal input gives equal digits.
"""

from functools import cache

import numpy as np
from scipy.linalg import LinAlgError, cho_factor, cho_solve

from frontal_biped.arrays import FloatArray
from frontal_biped.numerics.nonnegative import NOT_ENDED, Nnls, finite_nnls, for_numbers

SWEEPS = 20
"""Iterations of the active-set method per constraint that can be active at which it is given up; it needs some two."""

EMPTY = 1e-14
"""1 / (1 + d^2), d the distance of the polyhedron from the origin, below which it is taken for empty."""


class NoFeasiblePointError(ArithmeticError):
    """The inequalities contradict each other, or rounding makes it look so."""


class UndecidedError(NoFeasiblePointError):
    """Rounding does not let tell."""


def nearest_point(G: FloatArray, h: FloatArray) -> FloatArray:
    """Multipliers (k,) of the point y = G multipliers nearest to the origin of those with G'y >= h.

    Args:
        G: (n, k), one column an inequality.
        h: (k,).

    Raises:
        NoFeasiblePointError: there is none.
        UndecidedError: the method did not end.
    """
    n, k = G.shape
    E = np.empty((n + 1, k))
    E[:n], E[n] = G, h
    return nearest_point_of(E, 1.0, 1.0, for_numbers(E))


def nearest_point_of(E: FloatArray, unit: float = 1.0, side: float = -1.0, solve: Nnls = finite_nnls) -> FloatArray:
    """The same with the inequalities E'(y, 1) >= 0, of finite numbers, and the multipliers times a unit.

    Args:
        E: (n + 1, k), G above -h.
        unit: that h and y are in.
        side: 1 for G above h.
        solve: the method for the dual.
    """
    n, k = E.shape
    if k == 0:
        return np.zeros(0)  # SciPy 1.17 frees its memory twice when asked about nothing
    weights, distance, verdict = solve(E, _target(n, side), SWEEPS * n)
    if verdict == NOT_ENDED:
        raise UndecidedError("the active-set method did not end")
    inside = distance * distance  # = 1 - h'weights, but without its rounding where it is small; 0: there is no point
    if inside <= EMPTY:
        raise NoFeasiblePointError("the inequalities contradict each other")
    weights /= inside / unit
    return weights


@cache
def _target(size: int, last: float) -> FloatArray:
    """Zeros (size,) but for the last; never written to."""
    target = np.zeros(size)
    target[-1] = last
    target.flags.writeable = False
    return target


def polished(G: FloatArray, h: FloatArray, multipliers: FloatArray) -> FloatArray:
    """Multipliers (k,) of `nearest_point` with the active constraints met exactly: (G_a' G_a) multipliers_a = h_a."""
    active = multipliers > 0.0
    columns = G[:, active]
    try:
        exact = cho_solve(cho_factor(columns.T @ columns, check_finite=False), h[active], check_finite=False)
    except LinAlgError:  # nearly dependent constraints: keep what the method found
        return multipliers
    if np.min(exact, initial=0.0) < 0.0:
        return multipliers
    polished = np.zeros_like(multipliers)
    polished[active] = exact
    return polished
