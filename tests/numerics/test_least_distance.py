"""The active-set solver against ProxQP, against its own optimality conditions, and on problems without an answer."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from frontal_biped.numerics.least_distance import (
    IndefiniteError,
    NoFeasiblePointError,
    nearest_point,
    solve_least_distance,
)
from frontal_biped.numerics.quadratic_program import UNBOUNDED, ProxQpSolver, QuadraticProgram

OPTIMAL = 1e-9
"""Residuals of the optimality conditions, relative to the data: rounding times the condition of the Hessian."""

SAME = 1e-6
"""Distance from ProxQP's answer, whose own tolerance is 1e-9 on residuals, times the condition of the Hessian."""

seeds = st.integers(0, 2**32 - 1)


def random_problem(seed, condition=1e4):
    """Strictly convex, with a point inside: (H, g, C, c)."""
    rng = np.random.default_rng(seed)
    n, k = int(rng.integers(1, 12)), int(rng.integers(1, 60))
    Q = np.linalg.qr(rng.normal(size=(n, n)))[0]
    H = (Q * condition ** rng.uniform(-0.5, 0.5, n)) @ Q.T
    C, inside = rng.normal(size=(k, n)), rng.normal(size=n)
    return 0.5 * (H + H.T), 10.0 * rng.normal(size=n), C, C @ inside - rng.uniform(0.0, 1.0, k)


@given(seed=seeds)
def test_optimality_conditions(seed):
    H, g, C, c = random_problem(seed)
    x, multipliers = solve_least_distance(H, g, C, c)
    size = 1.0 + np.max(np.abs(H @ x)) + np.max(np.abs(g)) + np.max(multipliers)
    assert np.max(np.abs(H @ x + g - C.T @ multipliers)) < OPTIMAL * size
    assert np.min(C @ x - c) > -OPTIMAL * (1.0 + np.max(np.abs(C @ x)))
    assert np.min(multipliers) >= 0.0
    assert np.max(np.abs(multipliers * (C @ x - c))) < OPTIMAL * size


@given(seed=seeds)
def test_against_proxqp(seed):
    H, g, C, c = random_problem(seed, condition=100.0)
    n, k = C.shape[1], len(c)
    qp = QuadraticProgram(H, g, np.zeros((0, n)), np.zeros(0), C, c, np.full(k, UNBOUNDED))
    other = ProxQpSolver().solve(qp)
    assert other.solved
    assert solve_least_distance(H, g, C, c).x == pytest.approx(other.x, abs=SAME, rel=SAME)


@given(seed=seeds)
def test_equal_input_gives_equal_digits(seed):
    """Wherever the arrays lie in memory."""
    H, g, C, c = random_problem(seed)
    first = solve_least_distance(H, g, C, c)
    for offset in (1, 2, 3):
        moved = []
        for part in (H, g, C, c):
            block = np.empty(part.size + offset)
            view = block[offset:].reshape(part.shape)
            view[...] = part
            moved.append(view)
        again = solve_least_distance(*moved)
        assert np.array_equal(first.x, again.x)
        assert np.array_equal(first.multipliers, again.multipliers)


def test_without_active_constraints_the_answer_is_the_minimum():
    H, g = np.diag([1.0, 4.0]), np.array([-1.0, -4.0])
    x, multipliers = solve_least_distance(H, g, np.eye(2), np.full(2, -10.0))
    assert x == pytest.approx([1.0, 1.0], abs=OPTIMAL)
    assert np.array_equal(multipliers, np.zeros(2))


def test_repeated_constraints():
    """A hundred copies of one plane: the answer is on it, and the multipliers add up to the right force."""
    C, c = np.tile([[1.0, 1.0]], (100, 1)), np.full(100, 2.0)
    x, multipliers = solve_least_distance(np.eye(2), np.zeros(2), C, c)
    assert x == pytest.approx([1.0, 1.0], abs=OPTIMAL)
    assert multipliers.sum() == pytest.approx(1.0, abs=OPTIMAL)


def test_contradiction_is_told():
    with pytest.raises(NoFeasiblePointError, match="contradict"):
        solve_least_distance(np.eye(1), np.zeros(1), np.array([[1.0], [-1.0]]), np.array([1.0, 1.0]))


def test_indefinite_hessian_is_refused():
    with pytest.raises(IndefiniteError, match="positive definite"):
        solve_least_distance(-np.eye(1), np.zeros(1), np.eye(1), np.zeros(1))


def test_no_inequality_is_no_problem():
    assert nearest_point(np.zeros((3, 0)), np.zeros(0)).shape == (0,)
