"""The nearest residuals: the conditions of the optimum, near and far, and rows without an answer."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from frontal_biped.control.torques.nearest_residuals import EXACT, FAR, ROOM, distance, nearest_residuals
from frontal_biped.numerics.least_distance import NoFeasiblePointError, UndecidedError

ROUNDING = 1e-9
"""Of the point, relative to the largest of its terms."""


def random_rows(rng, missed):
    """Rows (5, k) that have a point, and are missed at zero by up to about ``missed``."""
    k = int(rng.integers(5, 25))
    G = rng.normal(size=(4, k))
    return np.vstack([G, rng.uniform(0.0, 1.0, k) - missed * rng.normal(size=4) @ G])


@given(seed=st.integers(0, 2**32 - 1), missed=st.sampled_from([0.1, 1.0, 0.3 * FAR, 10.0 * FAR, 1e4 * FAR]))
def test_conditions_of_the_optimum(seed, missed):
    rows = random_rows(np.random.default_rng(seed), missed)
    r, multipliers = nearest_residuals(rows)
    room = r @ rows
    rounding = EXACT + 1e-15 * np.abs(rows[ROOM]).max()
    assert r[ROOM] == 1.0
    assert np.min(multipliers) >= 0.0
    assert np.min(room) >= -rounding
    assert np.max(room[multipliers > 0.0], initial=0.0) <= rounding
    size = 1.0 + np.abs(rows[:ROOM]) @ multipliers
    assert np.max(np.abs(rows[:ROOM] @ multipliers - r[:ROOM]) / size) <= ROUNDING


@pytest.mark.parametrize("far", [0.5, 2.0])
def test_a_far_point_is_as_near_in_its_own_units(far):
    """Across the border beyond which other units are taken."""
    rows = random_rows(np.random.default_rng(1), 1.0)
    rows[ROOM] *= far * FAR / -rows[ROOM].min()
    twice = rows.copy()
    twice[ROOM] *= 4.0
    r, four_r = nearest_residuals(rows)[0], nearest_residuals(twice)[0]
    assert np.max(np.abs(4.0 * r[:ROOM] - four_r[:ROOM])) <= ROUNDING * np.max(np.abs(four_r))


def test_contradicting_rows_have_none():
    rows = np.array([[1.0, -1.0], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0], [-1.0, -1.0]])
    with pytest.raises(NoFeasiblePointError, match="contradict"):
        nearest_residuals(rows)


@pytest.mark.parametrize("broken", [np.nan, np.inf, -np.inf])
def test_what_is_not_a_number_is_undecided(broken):
    rows = random_rows(np.random.default_rng(2), 1.0)
    rows[ROOM, 3] = broken
    with pytest.raises(UndecidedError):
        nearest_residuals(rows)


def test_no_row_asks_for_more_than_the_distance_or_for_less_than_one():
    rows = random_rows(np.random.default_rng(3), 50.0)
    worst = rows[:, rows[ROOM].argmin()]
    assert distance(rows) == pytest.approx(-worst[ROOM] / np.linalg.norm(worst[:ROOM]), rel=1e-14)
    assert distance(np.abs(rows)) == 1.0
