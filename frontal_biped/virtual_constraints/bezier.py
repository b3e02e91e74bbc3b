"""Bezier polynomials in Bernstein form: values and derivatives as matrices acting on the coefficients."""

from functools import lru_cache
from math import comb

import numpy as np

from frontal_biped.arrays import FloatArray


@lru_cache(maxsize=64)
def _binomials(degree: int) -> tuple[FloatArray, FloatArray]:
    exponents = np.arange(degree + 1.0)
    return np.array(_plain_binomials(degree)), exponents


@lru_cache(maxsize=64)
def _plain_binomials(degree: int) -> tuple[float, ...]:
    return tuple(float(comb(degree, k)) for k in range(degree + 1))


def bernstein(degree: int, s: FloatArray | float) -> FloatArray:
    """(..., degree + 1) Bernstein polynomials at s (...).

    They are polynomials in s: outside [0, 1] the same polynomial goes on, without a break.
    """
    binomials, k = _binomials(degree)
    s = np.asarray(s)[..., None]
    return binomials * s**k * (1.0 - s) ** (degree - k)


def bernstein_at(degree: int, s: float) -> FloatArray:
    """(degree + 1,) Bernstein polynomials at one s, in plain numbers: a control tick has one."""
    t, up, down = 1.0 - s, 1.0, 1.0
    values = list(_plain_binomials(degree))
    for k in range(1, degree + 1):
        up *= s
        down *= t
        values[k] *= up
        values[degree - k] *= down
    return np.array(values)


def bernstein_derivative(degree: int, s: FloatArray | float, order: int) -> FloatArray:
    """(..., degree + 1) derivative of the given order of the Bernstein polynomials with respect to s."""
    if order > degree:
        return np.zeros((*np.shape(s), degree + 1))
    differences = np.eye(degree + 1)
    factor = 1.0
    for step in range(order):
        factor *= degree - step
        differences = np.diff(differences, axis=0)
    return factor * bernstein(degree - order, s) @ differences


@lru_cache(maxsize=64)
def derivative_columns(degree: int, order: int, elevated: int) -> FloatArray:
    """(degree + 1, elevated + 1) from coefficients to those of a derivative in s, in a basis of another degree.

    Args:
        degree: of the polynomials.
        order: of the derivative, at most ``degree``.
        elevated: degree of the basis, at least ``degree - order``.
    """
    columns = np.eye(degree + 1)
    for step in range(order):
        columns = (degree - step) * np.diff(columns, axis=1)
    return elevate(columns, elevated)


def elevate(coefficients: FloatArray, degree: int) -> FloatArray:
    """(..., degree + 1) coefficients of the same polynomials in the Bernstein basis of a higher degree."""
    while coefficients.shape[-1] <= degree:
        n = coefficients.shape[-1]  # the new degree
        weight = np.arange(n + 1) / n
        padded = np.zeros((*coefficients.shape[:-1], n + 1))
        padded[..., :-1] = coefficients
        shifted = np.zeros_like(padded)
        shifted[..., 1:] = coefficients
        coefficients = weight * shifted + (1.0 - weight) * padded
    return coefficients


def restrict(coefficients: FloatArray, s: float) -> FloatArray:
    """(..., degree + 1) coefficients of the same polynomials on [s, 1] instead of [0, 1] (de Casteljau)."""
    columns = np.array(coefficients, dtype=float)
    for last in range(columns.shape[-1] - 1, 0, -1):
        columns[..., :last] = (1.0 - s) * columns[..., :last] + s * columns[..., 1 : last + 1]
    return columns
