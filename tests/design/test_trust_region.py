"""The optimiser on small problems whose answers are known."""

import numpy as np
import pytest
from optimised_point import Point
from scipy.optimize import minimize as scipy_minimise

from frontal_biped.design.trust_region_sqp import SqpSettings, minimise

ANSWER = 1e-5
"""Accuracy of the variables: the iteration stops at a predicted decrease of 1e-7, the square of this and more."""

FEASIBLE = 1e-7
"""What the optimiser calls feasible."""

SETTINGS = SqpSettings(cost_scale=1.0, tolerance=1e-12)


def problem(residuals, jacobian, equality=None, margins=None, n=2):
    """Evaluation of a least-squares problem; equality and margins return (value, Jacobian)."""
    no_equality, no_margin = (np.zeros(1), np.zeros((1, n))), (np.ones(1), np.zeros((1, n)))

    def evaluate(x):
        r, R = np.asarray(residuals(x), dtype=float), np.asarray(jacobian(x), dtype=float)
        e, E = no_equality if equality is None else map(np.atleast_1d, equality(x))
        m, M = no_margin if margins is None else map(np.atleast_1d, margins(x))
        return Point(
            float(r @ r), 2.0 * R.T @ r, R,
            e.astype(float), np.atleast_2d(E).astype(float), m.astype(float), np.atleast_2d(M).astype(float),
        )  # fmt: skip

    return evaluate


def rosenbrock(**constraints):
    """(1 - x)^2 + 100 (y - x^2)^2, plus one so that the cost is never zero."""
    return problem(
        lambda x: [1.0 - x[0], 10.0 * (x[1] - x[0] ** 2), 1.0],
        lambda x: [[-1.0, 0.0], [-20.0 * x[0], 10.0], [0.0, 0.0]],
        **constraints,
    )


def solve(evaluate, x0, low=-5.0, high=5.0, settings=SETTINGS):
    x0 = np.asarray(x0, dtype=float)
    bounds = np.full(len(x0), low), np.full(len(x0), high)
    result = minimise(evaluate, x0, *bounds, np.ones(len(x0)), settings)
    assert np.all(result.x >= low) and np.all(result.x <= high)
    return result


@pytest.mark.parametrize("start", [(-1.2, 1.0), (3.0, -3.0), (0.0, 0.0)])
def test_unconstrained_valley(start):
    result = solve(rosenbrock(), start)
    assert result.converged and result.feasible
    assert result.x == pytest.approx([1.0, 1.0], abs=ANSWER)
    assert result.cost == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("start", [(-1.2, 1.0), (0.2, 0.1), (3.0, 3.0)])
def test_valley_inside_the_unit_circle(start):
    """The known minimum (0.7864, 0.6177) of the textbook problem lies on the circle."""
    inside = lambda x: (1.0 - x @ x, -2.0 * x)  # noqa: E731
    result = solve(rosenbrock(margins=inside), start)
    reference = scipy_minimise(
        lambda x: (1 - x[0]) ** 2 + 100 * (x[1] - x[0] ** 2) ** 2,
        [0.7, 0.6],
        constraints={"type": "ineq", "fun": lambda x: 1.0 - x @ x},
        method="SLSQP",
        tol=1e-14,
    )
    assert result.feasible
    assert result.violation <= FEASIBLE
    assert result.x == pytest.approx(reference.x, abs=1e-4)
    assert result.x == pytest.approx([0.7864, 0.6177], abs=1e-3)


def test_problem_without_any_constraint():
    """Empty constraint arrays are as good as satisfied ones."""
    inner = rosenbrock()

    def evaluate(x):
        nothing = {"equality": np.zeros(0), "margins": np.zeros(0)}
        return inner(x)._replace(**nothing, equality_jacobian=np.zeros((0, 2)), margins_jacobian=np.zeros((0, 2)))

    assert solve(evaluate, (-1.2, 1.0)).x == pytest.approx([1.0, 1.0], abs=ANSWER)


def test_equality():
    """The point of the circle of radius sqrt(2) nearest to (2, 0.5) lies on the ray towards it."""
    target = np.array([2.0, 0.5])
    circle = lambda x: (x @ x - 2.0, 2.0 * x)  # noqa: E731
    result = solve(problem(lambda x: x - target, lambda x: np.eye(2), equality=circle), (0.3, 1.3))
    assert result.converged and result.feasible
    assert result.x == pytest.approx(np.sqrt(2.0) * target / np.linalg.norm(target), abs=ANSWER)


def test_bounds_are_kept():
    result = solve(rosenbrock(), (-1.0, -1.0), low=-2.0, high=0.5)
    assert result.x == pytest.approx([0.5, 0.25], abs=ANSWER)


def test_start_outside_the_bounds_is_brought_inside():
    result = solve(rosenbrock(), (50.0, -50.0), low=-2.0, high=2.0)
    assert result.x == pytest.approx([1.0, 1.0], abs=ANSWER)


def test_many_inequalities():
    """Largest circle of a polygon's worth of half planes: minimise the distance to a point outside."""
    angles = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    normals = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    outside = 3.0 * np.array([np.cos(0.4), np.sin(0.4)])
    polygon = lambda x: (1.0 - normals @ x, -normals)  # noqa: E731
    result = solve(problem(lambda x: x - outside, lambda x: np.eye(2), margins=polygon), (0.0, 0.0))
    reference = scipy_minimise(
        lambda x: np.sum((x - outside) ** 2),
        [0.5, 0.5],
        constraints={"type": "ineq", "fun": lambda x: 1.0 - normals @ x},
        method="SLSQP",
        tol=1e-14,
    )
    assert result.x == pytest.approx(reference.x, abs=ANSWER)


def test_infeasible_problem_ends_at_the_least_violation():
    """x >= 1 and x <= -1 are violated by at least 1; that is what is reported, without an exception."""
    contradiction = lambda x: (np.array([x[0] - 1.0, -1.0 - x[0]]), np.array([[1.0, 0.0], [-1.0, 0.0]]))  # noqa: E731
    evaluate = problem(lambda x: [x[0], x[1], 1.0], lambda x: np.eye(3)[:, :2], margins=contradiction)
    result = solve(evaluate, (3.0, 2.0))
    assert not result.feasible
    assert result.violation == pytest.approx(1.0, abs=1e-4)
    assert result.x[0] == pytest.approx(0.0, abs=1e-4)


def test_linearisation_without_a_solution_is_survived():
    """At x = 0 the constraint x^2 >= 1 has no slope; the iteration must still leave, or report the violation."""
    outside = lambda x: (x[0] ** 2 - 1.0, np.array([2.0 * x[0], 0.0]))  # noqa: E731
    evaluate = problem(lambda x: [x[0] - 0.5, x[1], 1.0], lambda x: np.eye(3)[:, :2], margins=outside)
    result = solve(evaluate, (0.1, 1.0))
    assert result.feasible
    assert result.x == pytest.approx([1.0, 0.0], abs=ANSWER)


def test_points_without_a_value_are_stepped_back_from():
    """A cost that is nan beyond x = 1.5 must not be entered, nor end the iteration."""
    inner = rosenbrock()

    def evaluate(x):
        point = inner(x)
        return point if x[0] < 1.5 else point._replace(cost=float("nan"))

    result = solve(evaluate, (-1.2, 1.0))
    assert result.x == pytest.approx([1.0, 1.0], abs=ANSWER)


def test_progress_is_reported_and_counted():
    seen = []
    bounds = np.full(2, -5.0), np.full(2, 5.0)
    result = minimise(rosenbrock(), np.array([-1.2, 1.0]), *bounds, np.ones(2), SETTINGS, lambda *row: seen.append(row))
    assert [row[0] for row in seen] == sorted(row[0] for row in seen)
    assert len(seen) <= result.iterations
    assert result.evaluations >= len(seen)
    assert seen[-1][1] == pytest.approx(result.cost)


def test_iteration_limit():
    from dataclasses import replace

    result = solve(rosenbrock(), (-1.2, 1.0), settings=replace(SETTINGS, max_iterations=2))
    assert result.iterations == 2
    assert not result.converged
    assert "iteration limit" in result.message


def test_stop_at_the_first_feasible_point():
    from dataclasses import replace

    inside = lambda x: (1.0 - x @ x, -2.0 * x)  # noqa: E731
    result = solve(rosenbrock(margins=inside), (3.0, 3.0), settings=replace(SETTINGS, stop_when_feasible=True))
    assert result.feasible and not result.converged
    assert result.violation <= FEASIBLE
    assert result.iterations < solve(rosenbrock(margins=inside), (3.0, 3.0)).iterations


@pytest.mark.parametrize("part", ["cost", "margins", "residual_jacobian"])
def test_start_without_a_value_is_a_result(part):
    """Not a number, or a number beyond all sense, at the start: said, not raised."""
    inner = rosenbrock()

    def evaluate(x):
        point = inner(x)
        return point._replace(**{part: getattr(point, part) * float("nan")})

    result = solve(evaluate, (1.0, 1.0))
    assert not result.feasible or not result.converged
    assert "outside the domain" in result.message


def test_violation_beyond_all_floats_is_stepped_back_from():
    """A margin of -1e200 beyond x = 1.5: its square is no number, and the iteration goes on."""
    inner = rosenbrock()

    def evaluate(x):
        point = inner(x)
        return point if x[0] < 1.5 else point._replace(margins=np.array([-1e200]))

    assert solve(evaluate, (-1.2, 1.0)).x == pytest.approx([1.0, 1.0], abs=ANSWER)
