"""Collocation against closed forms and against SciPy's DOP853."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from frontal_biped.numerics.collocation import DEGREE, FIRST, Collocation

RTOL, ATOL = 1e-9, 1e-11
GROWN = 30.0  # errors of single stretches add up, and the oscillator hands them on


def follow(acceleration, q, dq, until, t=0.0, rtol=RTOL, atol=ATOL, like=()):
    """Stretches from t to ``until``."""
    method, stretches = Collocation(acceleration, rtol, atol, t, like), []
    q, dq = np.array(q, dtype=float), np.array(dq, dtype=float)
    while t < until:
        stretch = method.advance(t, q, dq, until)
        assert stretch is not None
        stretches.append(stretch)
        t, q, dq = stretch.end, stretch.q[-1], stretch.dq[-1]
    return stretches


def test_oscillators_of_three_frequencies_follow_their_closed_form():
    omega = np.array([1.0, 5.0, 20.0])
    stretches = follow(lambda q, dq: -(omega**2) * q, [1.0, 0.0, 0.5], [0.0, 5.0, 0.0], 4.0)
    for stretch in stretches:
        t = np.linspace(stretch.start, stretch.end, 7)
        x = stretch.at(t)
        expected = [np.cos(t), np.sin(5.0 * t), 0.5 * np.cos(20.0 * t)]
        assert np.abs(x[:, :3] - np.column_stack(expected)).max() < GROWN * RTOL
        rates = [-np.sin(t), 5.0 * np.cos(5.0 * t), -10.0 * np.sin(20.0 * t)]
        assert np.abs(x[:, 3:] - np.column_stack(rates)).max() < 10.0 * GROWN * RTOL
    assert stretches[-1].end == pytest.approx(4.0, abs=1e-15)
    assert len(stretches) < 40


def test_tighter_tolerances_give_smaller_errors():
    errors = []
    for rtol in (1e-5, 1e-8, 1e-11):
        last = follow(lambda q, dq: -np.sin(q), [2.0], [0.0], 6.0, rtol=rtol, atol=rtol)[-1]
        exact = solve_ivp(lambda _, x: [x[1], -np.sin(x[0])], (0, 6), [2, 0], "DOP853", rtol=1e-13, atol=1e-14)
        errors.append(np.abs([last.q[-1, 0], last.dq[-1, 0]] - exact.y[:, -1]).max())
    assert errors[2] < errors[1] < errors[0]
    assert errors[2] < 1e-10


def test_a_stiff_stretch_is_followed_as_dop853_follows_it():
    """Van der Pol's oscillator: rates that are changing slowly, then by thirty times as much."""

    def acceleration(q, dq):
        return 5.0 * (1.0 - q**2) * dq - q

    stretches = follow(acceleration, [2.0], [0.0], 20.0)
    peer = solve_ivp(
        lambda _, x: np.concatenate([x[1:], acceleration(x[:1], x[1:])]),
        (0.0, 20.0),
        [2.0, 0.0],
        method="DOP853",
        rtol=1e-12,
        atol=1e-13,
        dense_output=True,
    )
    for stretch in stretches:
        middle = np.array([stretch.start + 0.4 * stretch.length])
        assert stretch.at(middle)[0] == pytest.approx(peer.sol(middle)[:, 0], abs=1e-6, rel=1e-7)


def test_points_of_a_stretch_fulfil_the_equation():
    (stretch, *_) = follow(lambda q, dq: -9.0 * q - dq, [1.0, -1.0], [0.0, 2.0], 1.0)
    assert stretch.ddq == pytest.approx(-9.0 * stretch.q - stretch.dq, abs=1e-7)
    assert np.column_stack([stretch.q, stretch.dq]) == pytest.approx(stretch.at(stretch.times), abs=1e-12)


def test_at_one_time_it_is_what_it_is_at_many():
    stretch = follow(lambda q, dq: -np.sin(q), [2.0, 1.0], [0.0, -1.0], FIRST)[0]
    times = np.linspace(stretch.start, stretch.end, 9)
    for t, x in zip(times, stretch.at(times), strict=True):
        assert stretch.at_one(float(t)) == pytest.approx(x, rel=1e-14, abs=1e-15)


def test_a_start_that_is_not_defined_is_asked_once():
    asked = []

    def nowhere(q, dq):
        asked.append(q)

    assert Collocation(nowhere, RTOL, ATOL).advance(0.0, np.ones(2), np.zeros(2), 1.0) is None
    assert len(asked) == 1


def test_it_gives_up_before_a_kink_and_goes_on_behind_it():
    method = Collocation(lambda q, dq: np.where(q > 1e-3, 50.0, -50.0), 1e-10, 1e-12)
    before = method.advance(0.0, np.array([0.0]), np.array([1.0]), FIRST)
    assert before is None
    behind = method.advance(0.0, np.array([0.1]), np.array([1.0]), FIRST)
    assert behind is not None
    assert behind.q[-1, 0] == pytest.approx(0.1 + FIRST + 25.0 * FIRST**2, abs=1e-12)


@pytest.mark.parametrize("undefined", [lambda q, dq: None, lambda q, dq: np.full_like(q, np.nan)])
def test_an_acceleration_that_is_not_defined_is_given_up(undefined):
    assert Collocation(undefined, RTOL, ATOL).advance(0.0, np.zeros(2), np.ones(2), 1.0) is None


def states_asked(acceleration):
    """The function, and a list that grows by the number of states of each call."""
    asked = []

    def counted(q, dq):
        asked.append(len(q))
        return acceleration(q, dq)

    return counted, asked


@pytest.mark.parametrize("start", [0.0, 3.7])
def test_a_solution_that_repeats_takes_one_evaluation_a_stretch(start):
    acceleration, asked = states_asked(lambda q, dq: -np.sin(q) - 0.1 * dq)
    first = follow(acceleration, [2.0], [0.5], 3.0)
    asked.clear()
    again = follow(acceleration, [2.0], [0.5], start + 3.0, t=start, like=first)
    assert [s.start - start for s in again] == pytest.approx([s.start for s in first], abs=1e-12)
    assert again[-1].q[-1] == pytest.approx(first[-1].q[-1], abs=GROWN * ATOL)
    assert asked == [DEGREE + 1] * len(first)


@pytest.mark.parametrize("moved", [1e-9, 1e-4, 0.03, 0.5, 3.0])
def test_where_newtons_method_begins_does_not_move_what_it_finds(moved):
    """A guess from another start, near or of another motion altogether, is worth its evaluations or nothing."""
    other = follow(lambda q, dq: -np.sin(q), [2.0], [0.0], 6.0)
    last = follow(lambda q, dq: -np.sin(q), [2.0 - moved], [0.3 * moved], 6.0, like=other)[-1]
    start = [2.0 - moved, 0.3 * moved]
    exact = solve_ivp(lambda _, x: [x[1], -np.sin(x[0])], (0, 6), start, "DOP853", rtol=1e-13, atol=1e-14)
    assert [last.q[-1, 0], last.dq[-1, 0]] == pytest.approx(exact.y[:, -1], abs=GROWN * RTOL)


def test_a_guess_of_another_equation_is_given_up():
    """Its matrix is of other forces, its accelerations are far too large, and it overflows beyond its start."""
    other = follow(lambda q, dq: 40.0 * q, [1.0], [2.0], 2.0)
    last = follow(lambda q, dq: -4.0 * q, [1.0], [0.0], 2.0, like=other)[-1]
    assert [last.q[-1, 0], last.dq[-1, 0]] == pytest.approx([np.cos(4.0), -2.0 * np.sin(4.0)], abs=GROWN * RTOL)


def test_a_guess_of_a_shorter_solution_serves_as_far_as_it_goes():
    shorter = follow(lambda q, dq: -np.sin(q), [2.0], [0.0], 1.0)
    stretches = follow(lambda q, dq: -np.sin(q), [2.0], [0.0], 3.0, like=shorter)
    assert [s.end for s in stretches[: len(shorter)]] == pytest.approx([s.end for s in shorter], abs=1e-12)
    alone = follow(lambda q, dq: -np.sin(q), [2.0], [0.0], 3.0)
    assert stretches[-1].q[-1] == pytest.approx(alone[-1].q[-1], abs=GROWN * RTOL)


def test_all_points_are_asked_for_together():
    acceleration, asked = states_asked(lambda q, dq: -q)
    stretches = follow(acceleration, [1.0, 0.0], [0.0, 1.0], 3.0)
    assert len(asked) < 8 * len(stretches)
    assert max(asked) > 17
