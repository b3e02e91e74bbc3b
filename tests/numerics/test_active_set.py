"""The active-set solver against ProxQP, non-negative least squares and its own optimality conditions."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from frontal_biped.numerics.active_set import ConvexProgram, IndefiniteError
from frontal_biped.numerics.least_distance import NoFeasiblePointError, nearest_point
from frontal_biped.numerics.quadratic_program import UNBOUNDED, ProxQpSolver, QuadraticProgram

OPTIMAL = 1e-9
"""Residuals of the optimality conditions, relative to the data: rounding times the condition of the Hessian."""

SAME = 1e-6
"""Distance from ProxQP's answer, whose own tolerance is 1e-9 on residuals, times the condition of the Hessian."""

ROUNDING = 1e-9
"""Relative difference of answers to the same problem by two ways, times the condition of the Hessian."""

seeds = st.integers(0, 2**32 - 1)


def random_problem(seed, condition=1e4):
    """Strictly convex, with a point inside: (H, g, C, c)."""
    rng = np.random.default_rng(seed)
    n, k = int(rng.integers(1, 12)), int(rng.integers(1, 60))
    Q = np.linalg.qr(rng.normal(size=(n, n)))[0]
    H = (Q * condition ** rng.uniform(-0.5, 0.5, n)) @ Q.T
    C, inside = rng.normal(size=(k, n)), rng.normal(size=n)
    return 0.5 * (H + H.T), 10.0 * rng.normal(size=n), C, C @ inside - rng.uniform(0.0, 1.0, k)


def solved(H, g, C, c):
    """Minimiser and multipliers."""
    return ConvexProgram(H, g, C).solve(c)[:2]


@given(seed=seeds)
def test_optimality_conditions(seed):
    H, g, C, c = random_problem(seed)
    x, multipliers = solved(H, g, C, c)
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
    assert solved(H, g, C, c)[0] == pytest.approx(other.x, abs=SAME, rel=SAME)


@given(seed=seeds)
def test_equal_input_gives_equal_digits(seed):
    """Wherever the arrays lie in memory."""
    H, g, C, c = random_problem(seed)
    first = solved(H, g, C, c)
    for offset in (1, 2, 3):
        moved = []
        for part in (H, g, C, c):
            block = np.empty(part.size + offset)
            view = block[offset:].reshape(part.shape)
            view[...] = part
            moved.append(view)
        again = solved(*moved)
        assert np.array_equal(first[0], again[0])
        assert np.array_equal(first[1], again[1])


def test_without_active_constraints_the_answer_is_the_minimum():
    H, g = np.diag([1.0, 4.0]), np.array([-1.0, -4.0])
    x, multipliers = solved(H, g, np.eye(2), np.full(2, -10.0))
    assert x == pytest.approx([1.0, 1.0], abs=OPTIMAL)
    assert np.array_equal(multipliers, np.zeros(2))


def test_repeated_constraints():
    """A hundred copies of one plane: the answer is on it, and the multipliers add up to the right force."""
    C, c = np.tile([[1.0, 1.0]], (100, 1)), np.full(100, 2.0)
    x, multipliers = solved(np.eye(2), np.zeros(2), C, c)
    assert x == pytest.approx([1.0, 1.0], abs=OPTIMAL)
    assert multipliers.sum() == pytest.approx(1.0, abs=OPTIMAL)


def test_contradiction_is_told():
    with pytest.raises(NoFeasiblePointError, match="contradict"):
        solved(np.eye(1), np.zeros(1), np.array([[1.0], [-1.0]]), np.array([1.0, 1.0]))


def test_indefinite_hessian_is_refused():
    with pytest.raises(IndefiniteError, match="positive definite"):
        solved(-np.eye(1), np.zeros(1), np.eye(1), np.zeros(1))


@given(seed=seeds)
def test_against_non_negative_least_squares(seed):
    """Another method, SciPy's, on the dual problem."""
    H, g, C, c = random_problem(seed)
    inverse = np.linalg.inv(np.linalg.cholesky(H))
    lowest = -inverse.T @ inverse @ g
    y = (inverse @ C.T) @ nearest_point(inverse @ C.T, c - C @ lowest)
    x = solved(H, g, C, c)[0]
    assert x == pytest.approx(lowest + inverse.T @ y, abs=ROUNDING * (1.0 + np.max(np.abs(lowest))))


@given(seed=seeds, guess=seeds)
def test_what_is_expected_changes_no_answer(seed, guess):
    H, g, C, c = random_problem(seed)
    program, rng = ConvexProgram(H, g, C), np.random.default_rng(guess)
    plain = program.solve(c)
    guesses = rng.permutation(len(c))[: rng.integers(0, len(c) + 1)].tolist()
    for expected in (guesses, plain.active):
        other = program.solve(c, expected)
        assert other.x == pytest.approx(plain.x, abs=ROUNDING * (1.0 + np.max(np.abs(plain.x))))


@given(seed=seeds)
def test_bounds_that_move(seed):
    """One program for several bounds, from the answer of the last to the next, as from nothing."""
    H, g, C, c = random_problem(seed)
    program, rng, active = ConvexProgram(H, g, C), np.random.default_rng(seed), ()
    for _ in range(3):
        c = c - rng.uniform(0.0, 0.3, len(c))
        answer = program.solve(c, active)
        active = answer.active
        assert answer.x == pytest.approx(solved(H, g, C, c)[0], abs=ROUNDING * (1.0 + np.max(np.abs(answer.x))))


def test_opposed_constraints_leave_a_slab():
    """Two parallel planes, the nearer one binds; an active one that another makes idle is dropped."""
    program = ConvexProgram(np.eye(2), np.array([-1.0, 0.0]), np.array([[1.0, 0.0], [-1.0, 0.0], [1.0, 1e-3]]))
    low = program.solve(np.array([2.0, -3.0, 1.5]))
    assert low.x == pytest.approx([2.0, 0.0]) and low.active == (0,)
    high = program.solve(np.array([-3.0, -0.5, -9.0]), expected=(0, 1))
    assert high.x == pytest.approx([0.5, 0.0]) and high.active == (1,)
    with pytest.raises(NoFeasiblePointError):
        program.solve(np.array([2.0, -1.0, 0.0]))


def test_no_inequality_is_no_problem():
    x, multipliers = solved(np.eye(2), np.array([1.0, -2.0]), np.zeros((0, 2)), np.zeros(0))
    assert np.array_equal(x, [-1.0, 2.0]) and multipliers.shape == (0,)
