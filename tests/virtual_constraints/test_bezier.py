"""Bernstein polynomials: partition of unity, ends, derivatives and a second way to evaluate them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from random_states import DIFFERENCE_TOLERANCE, assert_close, difference, vectors

from frontal_biped.virtual_constraints import bernstein, bernstein_derivative
from frontal_biped.virtual_constraints.bezier import derivative_columns, elevate, restrict

ROUNDING = 1e-12
"""Relative error of polynomials of degree 8 on [-0.2, 1.2]."""

degrees = st.integers(1, 8)
inside = st.floats(0.0, 1.0)
around = st.floats(-0.2, 1.2)  # a late reversal runs past the end of the planned phase


def casteljau(coefficients, s):
    """A point of a Bezier curve by repeated interpolation."""
    while len(coefficients) > 1:
        coefficients = (1.0 - s) * coefficients[:-1] + s * coefficients[1:]
    return coefficients[0]


@given(degree=degrees, s=around)
def test_sums_to_one(degree, s):
    assert float(bernstein(degree, s).sum()) == pytest.approx(1.0, abs=ROUNDING)


@given(degree=degrees, s=inside)
def test_not_negative_inside(degree, s):
    assert np.all(bernstein(degree, s) >= 0.0)


@given(degree=degrees, s=around, order=st.integers(1, 3))
def test_derivatives_sum_to_zero(degree, s, order):
    values = bernstein_derivative(degree, s, order)
    assert float(values.sum()) == pytest.approx(0.0, abs=ROUNDING * max(1.0, np.abs(values).max()))


@given(coefficients=vectors(-2.0, 2.0, 6), s=around)
def test_is_the_curve_of_de_casteljau(coefficients, s):
    assert_close(bernstein(5, s) @ coefficients, casteljau(coefficients, s), ROUNDING, floor=2.0)


@given(coefficients=vectors(-2.0, 2.0, 6))
def test_ends(coefficients):
    """Value and slope at the ends are those of the control polygon."""
    assert bernstein(5, 0.0) @ coefficients == coefficients[0]
    assert bernstein(5, 1.0) @ coefficients == coefficients[-1]
    slopes = [bernstein_derivative(5, s, 1) @ coefficients for s in (0.0, 1.0)]
    polygon = 5.0 * np.diff(coefficients)[[0, -1]]
    assert_close(slopes, polygon, ROUNDING, floor=1.0)


@given(degree=degrees, s=around, order=st.integers(1, 3))
def test_derivatives_against_differences(degree, s, order):
    values = bernstein_derivative(degree, s, order)
    differences = difference(lambda at: bernstein_derivative(degree, at, order - 1), s)
    assert_close(values, differences, DIFFERENCE_TOLERANCE, floor=10.0)


def test_derivative_of_order_zero_is_the_value():
    s = np.linspace(0.0, 1.0, 7)
    assert_close(bernstein_derivative(4, s, 0), bernstein(4, s), ROUNDING)


def test_derivative_beyond_the_degree_is_zero():
    assert np.array_equal(bernstein_derivative(2, np.linspace(0.0, 1.0, 5), 3), np.zeros((5, 3)))


@given(coefficients=vectors(-2.0, 2.0, 4), s=around, degree=st.integers(3, 7))
def test_degree_elevation_keeps_the_curve(coefficients, s, degree):
    elevated = elevate(coefficients, degree)
    assert elevated.shape == (degree + 1,)
    assert_close(bernstein(degree, s) @ elevated, bernstein(3, s) @ coefficients, ROUNDING, floor=2.0)


def test_arrays_are_evaluated_point_by_point():
    s = np.linspace(-0.1, 1.1, 6).reshape(2, 3)
    assert bernstein(4, s).shape == (2, 3, 5)
    assert np.array_equal(bernstein(4, s)[1, 2], bernstein(4, s[1, 2]))


@pytest.mark.parametrize("degree", [0, 1, 3, 8])
@pytest.mark.parametrize("start", [0.0, 0.3, 0.95])
def test_restricted_polynomial_is_the_same_polynomial(degree, start):
    coefficients = np.random.default_rng(degree).normal(size=(3, degree + 1))
    t = np.linspace(0.0, 1.0, 7)
    part = bernstein(degree, t) @ restrict(coefficients, start).T
    assert_close(part, bernstein(degree, start + (1.0 - start) * t) @ coefficients.T, ROUNDING, floor=2.0)


@pytest.mark.parametrize("order", [0, 1, 2])
def test_columns_of_a_derivative_are_its_coefficients(order):
    degree, elevated = 6, 8
    coefficients = np.random.default_rng(3).normal(size=(2, degree + 1))
    s = np.linspace(-0.2, 1.2, 9)
    found = bernstein(elevated, s) @ (coefficients @ derivative_columns(degree, order, elevated)).T
    assert_close(found, bernstein_derivative(degree, s, order) @ coefficients.T, 1e-12, floor=10.0)
