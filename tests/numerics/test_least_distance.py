"""The nearest point of a polyhedron: its optimality conditions, and problems without an answer."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from frontal_biped.numerics.least_distance import NoFeasiblePointError, nearest_point, nearest_point_of, polished

OPTIMAL = 1e-9
"""Residuals of the optimality conditions, relative to the data."""


@given(seed=st.integers(0, 2**32 - 1))
def test_optimality_conditions(seed):
    rng = np.random.default_rng(seed)
    n, k = int(rng.integers(1, 12)), int(rng.integers(1, 60))
    G = rng.normal(size=(n, k))
    h = G.T @ rng.normal(size=n) - rng.uniform(0.0, 1.0, k)
    multipliers = polished(G, h, nearest_point(G, h))
    slack = G.T @ (G @ multipliers) - h
    size = 1.0 + np.max(np.abs(h)) + np.max(multipliers)
    assert np.min(multipliers) >= 0.0
    assert np.min(slack) > -OPTIMAL * size
    assert np.max(np.abs(multipliers * slack)) < OPTIMAL * size**2


def test_contradiction_is_told():
    with pytest.raises(NoFeasiblePointError, match="contradict"):
        nearest_point(np.array([[1.0, -1.0]]), np.array([1.0, 1.0]))


def test_no_inequality_is_no_problem():
    assert nearest_point(np.zeros((3, 0)), np.zeros(0)).shape == (0,)


@given(seed=st.integers(0, 2**32 - 1))
def test_in_homogeneous_coordinates_and_in_other_units(seed):
    """A far point, sought in units in which it is near."""
    rng = np.random.default_rng(seed)
    n, k, unit = 4, int(rng.integers(1, 30)), 10.0 ** rng.uniform(0.0, 4.0)
    G = rng.normal(size=(n, k))
    h = G.T @ rng.normal(size=n) - rng.uniform(0.0, 1.0, k)
    multipliers = nearest_point_of(np.vstack([G, -h]), unit)
    assert np.max(np.abs(multipliers - unit * nearest_point(G, h)), initial=0.0) <= OPTIMAL * unit * k


def test_what_is_not_a_number_is_told():
    with pytest.raises(ValueError, match="infs or NaNs"):
        nearest_point(np.array([[1.0, np.nan]]), np.ones(2))
