"""Zeros counted from Chebyshev interpolants: none missed, none invented, and doubt admitted."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from frontal_biped.numerics.chebyshev import fit, zeros


def all_zeros(function, low, high, tolerance=1e-11):
    pieces, failed = fit(function, low, high, tolerance)
    found, undecided = [], list(failed)
    for piece in pieces:
        simple, doubtful = zeros(piece)
        found += simple
        undecided += doubtful
    return found, undecided


@given(st.lists(st.floats(-0.97, 0.97), min_size=1, max_size=6))
def test_every_zero_of_a_product_is_enclosed(places):
    places = np.unique(np.round(places, 3))

    def product(x):
        return float(np.prod(x - places) * np.exp(0.3 * x))

    found, undecided = all_zeros(product, -1.0003, 1.0007)
    doubtful = [p for p in places if any(a - 1e-9 <= p <= b + 1e-9 for a, b in undecided)]
    assert len(found) + len(doubtful) >= len(places)
    assert len(found) <= len(places)
    for zero in found:
        assert np.min(np.abs(places - zero.place)) < 1e-8
        assert zero.enclosure[0] <= zero.place <= zero.enclosure[1]


def test_two_near_zeros_are_told_apart():
    found, undecided = all_zeros(lambda x: (x - 0.3) * (x - 0.3001), -1.0, 1.0)
    assert not undecided
    assert [zero.place for zero in found] == pytest.approx([0.3, 0.3001], abs=1e-9)


def test_a_double_zero_is_left_undecided():
    found, undecided = all_zeros(lambda x: (x - 0.3) ** 2, -1.0, 1.0)
    assert not found
    assert any(a <= 0.3 <= b for a, b in undecided)


def test_a_near_miss_is_no_zero():
    found, undecided = all_zeros(lambda x: (x - 0.3) ** 2 + 1e-6, -1.0, 1.0)
    assert not found
    assert not undecided


def test_measured_error_bounds_the_true_one():
    pieces, _ = fit(lambda x: float(np.sin(20.0 * x) * np.exp(x)), -1.0, 2.0, 1e-6)
    for piece in pieces:
        x = np.linspace(*piece.interval, 501)
        exact = np.sin(20.0 * x) * np.exp(x)
        slope = 20.0 * np.cos(20.0 * x) * np.exp(x) + exact
        assert np.max(np.abs(piece.polynomial(x) - exact)) <= piece.error
        assert np.max(np.abs(piece.polynomial.deriv()(x) - slope)) <= piece.slope_error


def test_a_jump_is_not_interpolated():
    pieces, failed = fit(lambda x: float(np.sign(x - 0.1)), -1.0, 1.0, 1e-9)
    assert any(a <= 0.1 <= b for a, b in failed)
    assert sum(b - a for a, b in failed) < 1e-5
    assert pieces
