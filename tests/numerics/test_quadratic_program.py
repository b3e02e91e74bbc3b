"""The quadratic program solver, judged by its KKT conditions."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from frontal_biped.numerics.quadratic_program import UNBOUNDED, ProxQpSolver, QuadraticProgram

KKT_TOLERANCE = 1e-8
"""Absolute; the solver is asked for 1e-9 on data of order one to ten."""

SCALED_TOLERANCE = 1e-7
"""The same times numbers of order ten: multipliers in the complementarity, the inverse of H in the answer."""

seeds = st.integers(0, 2**32 - 1)


def random_program(seed, n=None):
    """A strictly convex program with a feasible point; about half of its inequalities cut off the free minimum."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 9)) if n is None else n
    p, k = int(rng.integers(0, n)), int(rng.integers(1, 2 * n))
    root = rng.normal(size=(n, n))
    A, C = rng.normal(size=(p, n)), rng.normal(size=(k, n))
    feasible = rng.normal(size=n)
    room = rng.exponential(size=(2, k)) * rng.choice([0.1, 1.0], size=(2, k))
    l, u = C @ feasible - room[0], C @ feasible + room[1]
    l[rng.random(k) < 0.3] = -UNBOUNDED
    u[rng.random(k) < 0.3] = UNBOUNDED
    return QuadraticProgram(root @ root.T + 0.1 * np.eye(n), 3.0 * rng.normal(size=n), A, A @ feasible, C, l, u)


def check(qp, solution):
    assert solution.solved, solution.status
    residuals = solution.residuals(qp)
    assert residuals.pop("complementarity") < SCALED_TOLERANCE
    assert max(residuals.values()) < KKT_TOLERANCE, residuals
    # and by hand
    value = qp.C @ solution.x
    assert np.all(value >= qp.l - KKT_TOLERANCE) and np.all(value <= qp.u + KKT_TOLERANCE)
    assert np.all(np.abs(qp.A @ solution.x - qp.b) < KKT_TOLERANCE)
    gradient = qp.H @ solution.x + qp.g + qp.A.T @ solution.y + qp.C.T @ solution.z
    assert np.all(np.abs(gradient) < KKT_TOLERANCE)
    inside = (value > qp.l + 1e-4) & (value < qp.u - 1e-4)
    assert np.all(np.abs(solution.z[inside]) < 1e-3)  # complementary: a free row presses on nothing
    assert np.all(solution.z[value < qp.u - 1e-4] < 1e-3)  # a multiplier is positive at the upper bound only
    assert np.all(solution.z[value > qp.l + 1e-4] > -1e-3)


@given(seed=seeds)
def test_kkt_conditions(seed):
    qp = random_program(seed)
    check(qp, ProxQpSolver().solve(qp))


@given(seed=seeds)
def test_no_feasible_point_is_better(seed):
    """Convexity: the minimum lies below every feasible point, here below points on segments to it."""
    qp = random_program(seed)
    x = ProxQpSolver().solve(qp).x
    rng = np.random.default_rng(seed)
    null = np.linalg.svd(qp.A)[2][len(qp.b) :] if len(qp.b) else np.eye(len(x))

    def cost(at):
        return 0.5 * at @ qp.H @ at + qp.g @ at

    for _ in range(20):
        other = x + null.T @ rng.normal(size=len(null)) * 10.0 ** rng.uniform(-4, 0)
        if np.all(qp.C @ other >= qp.l) and np.all(qp.C @ other <= qp.u):
            assert cost(other) >= cost(x) - KKT_TOLERANCE


@given(seed=seeds)
def test_warm_started_solver_forgets_the_last_problem(seed):
    solver = ProxQpSolver()
    for shift in range(3):
        qp = random_program(seed + shift, n=5)
        first = solver.solve(qp)
        check(qp, first)
        check(qp, solver.solve(qp))
        check(qp, solver.solve(qp, guess=first.x + 0.1))


def test_projection_on_a_box():
    solution = ProxQpSolver().solve(
        QuadraticProgram(
            np.eye(3), -np.array([2.0, 0.3, -5.0]), np.zeros((0, 3)), np.zeros(0),
            np.eye(3), np.full(3, -1.0), np.full(3, 1.0),
        )
    )  # fmt: skip
    assert solution.x == pytest.approx([1.0, 0.3, -1.0], abs=KKT_TOLERANCE)
    assert solution.z == pytest.approx([1.0, 0.0, -4.0], abs=KKT_TOLERANCE)


def test_without_inequalities_the_answer_is_linear_algebra():
    rng = np.random.default_rng(1)
    root, A = rng.normal(size=(4, 4)), rng.normal(size=(2, 4))
    H, g, b = root @ root.T + np.eye(4), rng.normal(size=4), rng.normal(size=2)
    kkt = np.block([[H, A.T], [A, np.zeros((2, 2))]])
    expected = np.linalg.solve(kkt, np.concatenate([-g, b]))
    solution = ProxQpSolver().solve(QuadraticProgram(H, g, A, b, np.zeros((0, 4)), np.zeros(0), np.zeros(0)))
    assert np.concatenate([solution.x, solution.y]) == pytest.approx(expected, abs=SCALED_TOLERANCE)


def test_infeasible_problem_is_not_called_solved():
    C = np.array([[1.0, 0.0], [1.0, 0.0]])
    qp = QuadraticProgram(
        np.eye(2), np.zeros(2), np.zeros((0, 2)), np.zeros(0), C, np.array([1.0, -2.0]), np.array([2.0, -1.0])
    )
    solution = ProxQpSolver().solve(qp)
    assert not solution.solved
    assert solution.residuals(qp)["inequality"] > 0.1


@pytest.mark.parametrize(
    ("part", "value", "residual"),
    [("x", [0.5, 0.3], "stationarity"), ("x", [1.5, 0.3], "inequality"), ("z", [0.0, 1.0], "complementarity")],
)
def test_residuals_see_a_wrong_answer(part, value, residual):
    """Minimise |x - (2, 0.3)|^2/2 with |x_i| <= 1: the answer is (1, 0.3), multipliers (1, 0)."""
    from dataclasses import replace

    qp = QuadraticProgram(
        np.eye(2), -np.array([2.0, 0.3]), np.zeros((0, 2)), np.zeros(0), np.eye(2), -np.ones(2), np.ones(2)
    )
    solution = ProxQpSolver().solve(qp)
    assert max(solution.residuals(qp).values()) < KKT_TOLERANCE
    assert replace(solution, **{part: np.array(value)}).residuals(qp)[residual] > 0.1
