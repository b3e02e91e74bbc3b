"""Second derivatives of the optimiser, on a problem whose Hessian is known."""

import numpy as np
import pytest
from optimised_point import Point
from random_states import assert_close

from frontal_biped.design.curvature import LEAST_PIVOT, REGULAR, gauss_newton, updated
from frontal_biped.design.local_model import Model, Multipliers

SIZE = 4
COST_SCALE = 0.5
SCALE = np.array([1.0, 0.5, 2.0, 0.1])
"""Of the variables."""

SAME = 1e-12
"""Relative difference of the same sums in another order."""

RNG = np.random.default_rng(0)
SLOPES = RNG.normal(size=(6, SIZE))
BENT = RNG.normal(size=(SIZE, SIZE))
PRICE = Multipliers(np.array([0.7]), np.zeros(0), np.zeros(SIZE))


def at(x, bend):
    """Linear residuals, and one margin -x' M x / 2 with M = bend M'M."""
    r, M = SLOPES @ x + 1.0, bend * BENT.T @ BENT
    none, no_slope = np.zeros(0), np.zeros((0, SIZE))
    margin = np.array([-0.5 * x @ M @ x])
    return Point(float(r @ r), 2.0 * r @ SLOPES, SLOPES, none, no_slope, margin, -(M @ x)[None])


def model_at(x, bend):
    point = at(x, bend)
    return Model(point, gauss_newton(point, SCALE, COST_SCALE), 10.0, SCALE, COST_SCALE)


def test_gauss_newton_is_the_hessian_of_linear_residuals():
    expected = 2.0 * COST_SCALE * SCALE[:, None] * (SLOPES.T @ SLOPES) * SCALE + REGULAR * np.eye(SIZE)
    assert_close(gauss_newton(at(np.zeros(SIZE), 1.0), SCALE, COST_SCALE), expected, SAME)


@pytest.mark.parametrize("seed", range(3))
def test_an_update_has_the_lagrangian_s_curvature_along_the_step(seed):
    """The Hessian of the Lagrangian is constant here, so the secant along the step is its product with it."""
    x, step = np.random.default_rng(seed).normal(size=(2, SIZE))
    model = model_at(x, 1.0)
    found = updated(model, np.zeros((SIZE, SIZE)), step, at(x + SCALE * step, 1.0), PRICE)
    lagrangian = 2.0 * COST_SCALE * SLOPES.T @ SLOPES + PRICE.margins[0] * BENT.T @ BENT
    assert_close(found @ step, SCALE * (lagrangian @ (SCALE * step)), 1e-9)
    assert np.min(np.linalg.eigvalsh(found)) > 0.0


def test_an_update_stays_convex_where_the_lagrangian_is_not():
    x, step = np.random.default_rng(5).normal(size=(2, SIZE))
    model = model_at(x, -100.0)
    found = updated(model, np.zeros((SIZE, SIZE)), step, at(x + SCALE * step, -100.0), PRICE)
    assert np.min(np.linalg.eigvalsh(found)) > 0.0
    assert step @ found @ step < step @ model.hessian @ step  # what it could take of it


def test_an_update_that_would_be_singular_is_left_out():
    """A curvature of 1e12 along one direction: what is left beside it is rounding."""
    x, step = np.zeros(SIZE), np.eye(SIZE)[0]
    model = model_at(x, 1e12)
    assert updated(model, np.zeros((SIZE, SIZE)), step, at(x + SCALE * step, 1e12), PRICE) is model.hessian
    pivots = np.diagonal(np.linalg.cholesky(model.hessian)) ** 2
    assert np.min(pivots) > LEAST_PIVOT * np.max(pivots)
