"""Zeros counted from Chebyshev interpolants: none missed, none invented, and doubt admitted."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.polynomial import Chebyshev

from frontal_biped.numerics.chebyshev import Fit, fit, zeros


def all_zeros(function, low, high, tolerance=1e-11):
    pieces, failed = fit(function, low, high, tolerance)
    found, undecided = zeros(pieces)
    return found, [*failed, *undecided]


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


def test_a_zero_where_two_pieces_meet_is_one_zero():
    low, high = Chebyshev.interpolate(np.sin, 12, [-0.5, 0.0]), Chebyshev.interpolate(np.sin, 12, [0.0, 0.7])
    for gap in (0.0, 1e-12, -1e-12):  # two interpolants of one function differ by their errors where they meet
        found, undecided = zeros([Fit(low, 1e-11, 1e-9), Fit(high + gap, 1e-11, 1e-9)])
        assert not undecided
        assert len(found) == 1
        assert found[0].place == pytest.approx(0.0, abs=1e-11)
        assert found[0].enclosure[0] < 0.0 < found[0].enclosure[1]


@pytest.mark.parametrize("slope", [1.0, -1.0])
@pytest.mark.parametrize("error", [1e-12, 1e-6])
def test_a_zero_within_the_error_of_an_end_is_undecided(slope, error):
    """Half an error inside or outside the interval looks the same; two errors inside or outside does not."""
    for end, inwards in ((0.0, 1.0), (1.0, -1.0)):
        for distance, zero, open_end in (
            (0.5, False, True),
            (-0.5, False, True),
            (2.0, True, False),
            (-2.0, False, False),
        ):
            place = end + inwards * distance * error
            piece = Fit(Chebyshev([slope * (0.5 - place), 0.5 * slope], domain=[0.0, 1.0]), error, 1e-9)
            found, undecided = zeros([piece])
            assert bool(found) == zero
            assert bool(undecided) == open_end


@given(st.floats(-0.9, 0.9), st.floats(-12.0, -1.0), st.floats(-1.0, 1.0))
def test_close_pairs_are_never_stepped_over(middle, log_distance, depth):
    """(x - a)^2 - d: two zeros, none, or doubt; what is said is always true, whatever the distance."""
    square = depth * 10.0**log_distance

    def function(x):
        return ((x - middle) ** 2 - square) * np.exp(0.5 * x)

    found, undecided = all_zeros(function, -1.0, 1.0)
    true = [middle - np.sqrt(square), middle + np.sqrt(square)] if square > 0.0 else []
    if not any(a - 1e-9 <= middle <= b + 1e-9 for a, b in undecided):
        assert len(found) == len([place for place in true if abs(place) < 1.0])
    for zero in found:
        assert min(abs(place - zero.place) for place in true) < 1e-7
    if not undecided and not found:
        assert not [place for place in true if abs(place) < 1.0 - 1e-9]
    if abs(square) > 1e-9:
        assert not [part for part in undecided if part[0] <= middle <= part[1]]  # doubt is for near-double zeros only
