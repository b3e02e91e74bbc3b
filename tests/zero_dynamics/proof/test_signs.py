"""Counting zeros by signs of balls: functions whose zeros are known."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from frontal_biped.zero_dynamics.proof.balls import arb, working
from frontal_biped.zero_dynamics.proof.half_step import NotEnclosedError
from frontal_biped.zero_dynamics.proof.signs import Kind, Known, Piece, count, cut


def counted(function, slope, low, high, least=1e-6):
    """The zeros of a function of balls."""

    def on(a, b):
        x = arb(a).union(arb(b))
        return Known(function(x), slope(x))

    with working():
        return count(cut(on, low, high, least, 10_000), lambda x: function(arb(x)))


def product(roots):
    def function(x):
        value = arb(1)
        for root in roots:
            value = value * (x - root)
        return value

    def slope(x):
        total = arb(0)
        for left_out in range(len(roots)):
            term = arb(1)
            for i, root in enumerate(roots):
                if i != left_out:
                    term = term * (x - root)
            total = total + term
        return total

    return function, slope


@given(st.lists(st.integers(-95, 95), min_size=0, max_size=4, unique=True))
@settings(max_examples=40, deadline=None)
def test_every_zero_is_found_once(tens):
    roots = sorted(0.01 * ten + 0.003 for ten in tens)
    found = counted(*product(roots), -1.0, 1.0)
    assert found.exact
    assert len(found.zeros) == len(roots)
    for (low, high), root in zip(found.zeros, roots, strict=True):
        assert low <= root <= high


def test_a_double_zero_is_undecided_and_no_other():
    found = counted(*product([0.3, 0.3, -0.5]), -1.0, 1.0)
    assert not found.exact
    assert all(low <= 0.3 <= high for low, high in found.undecided)
    assert len(found.zeros) == 1


def test_nearly_double_zeros_are_two_or_none():
    assert len(counted(*product([0.3, 0.301]), -1.0, 1.0).zeros) == 2
    close = counted(lambda x: (x - 0.3) * (x - 0.3) + 1e-9, lambda x: 2 * (x - 0.3), -1.0, 1.0)
    assert close.exact
    assert close.zeros == ()


@pytest.mark.parametrize("end", [-1.0, 1.0])
def test_a_zero_at_an_end_is_undecided(end):
    found = counted(*product([end]), -1.0, 1.0)
    assert not found.exact


def test_where_nothing_is_known_nothing_is_said():
    def on(a, b):
        if b > 0.5:
            raise NotEnclosedError("I_P")
        return Known(arb(1), arb(0))

    with working():
        found = count(cut(on, 0.0, 1.0, 1e-3, 10_000), lambda _: arb(1))
    assert not found.exact
    assert found.undecided[0][0] == pytest.approx(0.5, abs=1e-3)
    assert found.undecided[-1][1] == 1.0


def test_effort_is_bounded():
    looked = 0

    def on(a, b):
        nonlocal looked
        looked += 1
        return Known(arb(0, 1), arb(0, 1))

    with working():
        found = count(cut(on, 0.0, 1.0, 1e-9, 50), lambda _: arb(0, 1))
    assert looked == 50
    assert not found.exact


def test_the_sign_at_the_meeting_of_two_runs_decides():
    """Down, then up: no zero, two, or open if the lowest point may be one."""
    pieces = (Piece(0.0, 1.0, Kind.DECREASING), Piece(1.0, 2.0, Kind.INCREASING))
    for bottom, zeros, exact in ((0.5, 0, True), (-0.5, 2, True), (0.0, 0, False)):
        found = count(pieces, lambda x, bottom=bottom: arb(1 if x != 1.0 else bottom))
        assert (len(found.zeros), found.exact) == (zeros, exact)
