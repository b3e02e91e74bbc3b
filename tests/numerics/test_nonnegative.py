"""Non-negative least squares with and without SciPy's checks: the same digits."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from frontal_biped.numerics.nonnegative import NOT_ENDED, checked, finite_nnls, for_numbers, unchecked

MOST = 200


@given(seed=st.integers(0, 2**32 - 1))
def test_the_checks_change_no_digit(seed):
    rng = np.random.default_rng(seed)
    E, t = rng.normal(size=(int(rng.integers(1, 12)), int(rng.integers(1, 40)))), np.zeros(0)
    t = rng.normal(size=len(E))
    given_E, given_t = E.copy(), t.copy()
    w, distance, verdict = finite_nnls(E, t, MOST)
    theirs, their_distance, _ = checked(E, t, MOST)
    assert verdict != NOT_ENDED
    assert np.array_equal(w, theirs)
    assert distance == their_distance
    assert np.array_equal(E, given_E)  # what it is given stays as it is
    assert np.array_equal(t, given_t)


def test_it_is_found_where_this_scipy_has_it():
    pytest.importorskip("scipy.optimize._slsqplib")
    assert finite_nnls is not checked


@pytest.mark.parametrize("module", ["scipy.no_such_module", "scipy.linalg", "math"])
def test_the_public_function_stands_in(module):
    assert unchecked(module) is checked


@pytest.mark.parametrize("answer", [None, (np.zeros(2), 0.0, 1), (np.array([3.0, 0.0]), 4.0, NOT_ENDED)])
def test_one_that_answers_otherwise_is_not_used(monkeypatch, answer):
    module = type("module", (), {"nnls": staticmethod(lambda *_: answer)})
    monkeypatch.setattr("frontal_biped.numerics.nonnegative.import_module", lambda _: module)
    assert unchecked() is checked


@pytest.mark.parametrize("method", [checked, finite_nnls])
def test_one_that_is_stopped_says_so(method):
    rng = np.random.default_rng(0)
    assert method(rng.normal(size=(20, 20)), rng.normal(size=20), 1)[2] == NOT_ENDED


@pytest.mark.parametrize("broken", [np.nan, np.inf])
def test_what_is_not_a_number_is_told(broken):
    E = np.array([[1.0, broken], [0.0, 1.0]])
    with pytest.raises(ValueError, match="infs or NaNs"):
        for_numbers(E)(E, np.ones(2), MOST)
