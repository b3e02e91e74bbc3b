"""The design problem: exact derivatives against differences, and its numbers against the closed form."""

import copy

import numpy as np
import pytest
from random_states import assert_close

from frontal_biped.design.forward_mode import Dual, independent
from frontal_biped.design.landing import DifferentiableLanding
from frontal_biped.design.problem import DesignProblem
from frontal_biped.exceptions import UnreachablePoseError
from frontal_biped.gait import GaitSpecification
from frontal_biped.model import impact
from frontal_biped.virtual_constraints import complete, double_support_pose, invariance_residuals
from frontal_biped.zero_dynamics.poincare import HybridZeroDynamics, step_orbit

NODES = 16
"""Quadrature nodes of the optimiser."""

STEP = 2e-6
"""Step of differences, in units of the variables' scales (0.02 to 0.1): 1e-7 of an angle."""

GRADIENT_TOLERANCE = 1e-6
"""Relative to the largest derivative of the same quantity: rounding of 1e-13/1e-7 and truncation of 1e-7 squared."""

SAME = 1e-10
"""Relative difference between two evaluations of the same formulas."""

SPECIFICATIONS = {
    "default": GaitSpecification(),
    "level pelvis": GaitSpecification(max_pelvis_roll=0.0872664626, degree=6, fri_degree=2),
    "robust": GaitSpecification(
        degree=(5, 4, 6), max_multiplier=0.7, min_energy_margin=1.0, max_reversal_shift=1e-3, max_pelvis_roll=0.1
    ),
    "cubic": GaitSpecification(degree=4, fri_degree=4, max_torque=(40.0, 90.0, 90.0, 40.0)),
}

POINTS = 3
"""Random points for each robot and specification."""


def points(problem, seed):
    """Points a tenth of the variables' scales around the start, closer where no orbit exists; FRI on the move."""
    rng = np.random.default_rng(seed)
    for _ in range(POINTS):
        shift = 0.1 * problem.scale() * rng.normal(size=problem.size)
        while not orbits_exist(problem, problem.start() + shift):
            shift *= 0.5
        assert np.max(np.abs(shift / problem.scale())) > 0.02
        yield problem.start() + shift


def differences(problem, x, quantity):
    """(..., P) scaled central differences of a quantity of an evaluation."""
    columns = []
    for i, scale in enumerate(problem.scale()):
        shift = np.zeros_like(x)
        shift[i] = STEP * scale
        above, below = quantity(problem.evaluate(x + shift)), quantity(problem.evaluate(x - shift))
        columns.append((np.asarray(above) - np.asarray(below)) / (2.0 * STEP))
    return np.stack(columns, axis=-1)


@pytest.fixture(params=SPECIFICATIONS)
def problem(request, robot):
    return DesignProblem(robot, SPECIFICATIONS[request.param], NODES)


def test_derivatives_against_differences(problem):
    for x in points(problem, seed=problem.size):
        point = problem.evaluate(x)
        assert np.all(np.isfinite(point.margins)) and np.isfinite(point.cost)
        scale = problem.scale()
        everything = lambda p: np.concatenate([[p.cost], p.equality, p.margins])  # noqa: E731
        difference = differences(problem, x, everything)
        exact = np.concatenate([point.cost_gradient[None], point.equality_jacobian, point.margins_jacobian]) * scale
        # a row with derivatives far below one (in units of its own scale) is compared absolutely
        size = np.maximum(np.max(np.abs(exact), axis=1), np.maximum(1.0, np.abs(everything(point)) * 1e-2))
        error = np.max(np.abs(difference - exact), axis=1) / size
        worst = int(np.argmax(error))
        assert error[worst] < GRADIENT_TOLERANCE, f"row {worst}: {difference[worst]} against {exact[worst]}"


def same_digits(one, other):
    return all(np.array_equal(getattr(one, part), getattr(other, part)) for part in one.__dataclass_fields__)


def test_every_point_is_evaluated_as_if_it_were_the_first(problem):
    """The first one is recorded, the others do its array operations again; a point without a pose leaves no trace."""
    fresh = lambda x: DesignProblem(problem.biped, problem.specification, NODES).evaluate(x)  # noqa: E731
    for x in points(problem, seed=1):
        assert same_digits(problem.evaluate(x), fresh(x))
    beyond = problem.start()
    beyond[2] = 10.0
    for _ in range(2):
        with pytest.raises(UnreachablePoseError):
            problem.evaluate(beyond)
    assert same_digits(problem.evaluate(x), fresh(x))


def test_untightened_bounds_are_the_first_ones(biped):
    """Both problems go from point to point on one recording, and neither moves the other's bounds."""
    problem = DesignProblem(biped, GaitSpecification(), NODES)
    x = problem.start()
    before = problem.evaluate(x)
    row = problem.rows()[0]
    problem.tighten({(row.code, row.name): 1e-3})
    other = problem.untightened()
    assert problem.tightened and not other.tightened
    problem.evaluate(x + 0.01 * problem.scale())
    assert same_digits(other.evaluate(x), before)
    moved = problem.evaluate(x).margins - before.margins
    assert np.all(moved[row.entries] < 0.0)
    other.tighten({(row.code, row.name): 1e-2})
    np.testing.assert_array_equal(problem.evaluate(x).margins - before.margins, moved)


def test_an_evaluation_keeps_its_numbers(problem):
    x = problem.start()
    first = problem.evaluate(x)
    kept = copy.deepcopy(first)
    problem.evaluate(x + 0.01 * problem.scale())
    assert same_digits(first, kept)


def residuals(problem, x):
    """u sqrt(weight dt/dtau / L_s) at the nodes, by the closed form for plain numbers."""
    rising, falling = complete(problem.biped, problem.unpack(x))
    step = step_orbit(problem.biped, rising, falling, float(x[2]), NODES)
    parts = []
    for orbit in (step.rising, step.falling):
        parts.append(orbit.generalized_forces[3:] * np.sqrt(orbit.weights * orbit.time_density / step.step_width))
    return np.concatenate([part.ravel() for part in parts])


def orbits_exist(problem, x):
    rising, falling = complete(problem.biped, problem.unpack(x))
    step = step_orbit(problem.biped, rising, falling, float(x[2]), NODES)
    return np.all(step.rising.z > 0.1) and np.all(step.falling.z > 0.1)


def test_residual_jacobian_is_that_of_the_sum_of_squares(problem):
    x = problem.start()
    assert orbits_exist(problem, x)
    point = problem.evaluate(x)
    r = residuals(problem, x)
    assert r @ r == pytest.approx(point.cost, rel=SAME)
    assert_close(2.0 * r @ point.residual_jacobian, point.cost_gradient, 1e-9)
    scale = problem.scale()
    for i in range(0, problem.size, 4):
        shift = STEP * scale[i] * np.eye(problem.size)[i]
        difference = (residuals(problem, x + shift) - residuals(problem, x - shift)) / (2.0 * STEP)
        assert_close(point.residual_jacobian[:, i] * scale[i], difference, GRADIENT_TOLERANCE, floor=1.0)


def test_evaluation_is_the_closed_form(problem):
    """Cost and periodicity of the optimiser are those of `step_orbit` on the same nodes."""
    x = problem.start()
    rising, falling = complete(problem.biped, problem.unpack(x))
    step = step_orbit(problem.biped, rising, falling, float(x[2]), NODES)
    point = problem.evaluate(x)
    assert point.cost == pytest.approx(step.cost, rel=SAME)
    assert 0.1 * point.equality[0] == pytest.approx(step.periodicity, rel=SAME, abs=1e-12)


def test_impact_of_the_optimiser_is_the_impact(robot):
    """The differentiated impact repeats the formulas of `impact`; their values must not drift apart."""
    differentiable = DifferentiableLanding(robot)
    final = differentiable.pose(*independent(np.array([-1.66, 0.27])))
    q = double_support_pose(robot, -1.66, 0.27)
    assert np.array_equal(final.q.value, q)
    dq = np.array([-0.5, 0.8, -0.3, 0.4])
    flat = differentiable.impact(final, Dual.of(dq, np.zeros((2, 4)))).value
    landing = impact(robot, q, dq)
    touchdown = robot.swing_sole_jacobian(q)[:, 1] @ dq
    expected = np.concatenate([landing.dq_plus, landing.impulse, landing.lift_off, touchdown])
    assert_close(flat, expected, SAME)


def test_periodicity_vanishes_where_the_marginal_condition_does(biped, reference_gait):
    """The optimiser's equality and Z(beta_r-) of the paper have the same sign beside the gait and are zero on it."""
    for shift in (-1e-5, 1e-5):
        beta = reference_gait.beta_reversal + shift
        step = step_orbit(biped, reference_gait.rising, reference_gait.falling, reference_gait.step_width, 40, beta)
        marginal = HybridZeroDynamics(biped, step).marginal_condition
        assert abs(marginal) > 1e-6
        assert np.sign(step.periodicity) == -np.sign(marginal)


def test_variables_there_and_back(problem):
    x = problem.start() + np.arange(problem.size)
    assert np.array_equal(problem.layout.pack(problem.layout.unpack(x)), x)


def test_start_is_inside_its_bounds(problem):
    low, high = problem.bounds()
    start = problem.start()
    assert np.all(low < high)
    assert np.all(start >= low) and np.all(start <= high)
    assert low.shape == high.shape == start.shape == problem.scale().shape == (problem.size,)


def test_every_point_is_invariant(problem):
    """Hybrid invariance is built in: it holds at any values of the variables, not only at the answer."""
    for x in points(problem, seed=1):
        rising, falling = complete(problem.biped, problem.unpack(x))
        residuals = invariance_residuals(problem.biped, rising, falling, float(x[2]))
        assert max(residuals.values()) < 1e-9


def test_an_iterate_without_an_orbit_still_has_a_gradient(biped):
    """Where zeta is negative the cost is continued smoothly, and a margin says that the orbit is missing."""
    problem = DesignProblem(biped, GaitSpecification(), NODES)
    x = problem.start()
    x[problem.layout.fri] = 0.3  # an FRI far beyond the sole turns the moment of the weight round
    point = problem.evaluate(x)
    assert np.isfinite(point.cost)
    assert np.all(np.isfinite(point.cost_gradient))
    assert np.min(point.margins) < -0.1
