"""The polynomial of degree 5 between two states."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from frontal_biped.numerics.quintic import Kinematics, Quintic

ROUNDING = 1e-9
"""Of values of about 1 whose coefficients are some hundreds."""

values = st.floats(-2.0, 2.0)
states = st.builds(Kinematics, values, values, values)
durations = st.floats(0.2, 3.0)


@given(start=states, end=states, duration=durations)
def test_both_ends_are_met(start, end, duration):
    path = Quintic.between(start, end, duration)
    assert path.at(0.0) == pytest.approx(start, abs=ROUNDING)
    scale = 1.0 + 1.0 / duration**2
    assert path.at(duration) == pytest.approx(end, abs=ROUNDING * 100.0 * scale)


@given(start=states, end=states, duration=durations, share=st.floats(0.05, 0.95))
def test_rates_are_derivatives(start, end, duration, share):
    path, h = Quintic.between(start, end, duration), 1e-4 * duration
    t = share * duration
    before, at, after = (path.at(t + k * h) for k in (-1.0, 0.0, 1.0))
    largest = 1.0 + float(np.abs(path.c).sum())
    assert (after.x - before.x) / (2.0 * h) == pytest.approx(at.dx, abs=1e-5 * largest / duration)
    assert (after.dx - before.dx) / (2.0 * h) == pytest.approx(at.ddx, abs=1e-5 * largest / duration**2)


def test_from_rest_to_rest_is_the_path_of_least_jerk():
    path = Quintic.between(Kinematics(0.0, 0.0, 0.0), Kinematics(1.0, 0.0, 0.0), 2.0)
    s = np.linspace(0.0, 1.0, 7)
    assert [path.at(2.0 * x).x for x in s.tolist()] == pytest.approx(10.0 * s**3 - 15.0 * s**4 + 6.0 * s**5)


def test_past_the_end_the_rate_stays():
    path = Quintic.between(Kinematics(0.0, 0.0, 0.0), Kinematics(1.0, 0.5, 3.0), 1.0)
    assert path.at(1.2) == pytest.approx(Kinematics(1.1, 0.5, 0.0))
    assert path.at(-1.0) == pytest.approx(Kinematics(0.0, 0.0, 0.0))
