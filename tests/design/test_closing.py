"""Equalities taken to rounding on the quadrature that a step needs, with slopes of the optimiser's."""

from types import SimpleNamespace

import numpy as np
import pytest
from random_states import assert_close

from frontal_biped.design.closing import CLOSED, close_step, meet_equalities
from frontal_biped.design.problem import DesignProblem
from frontal_biped.design.two_step_problem import TwoStepProblem
from frontal_biped.gait import GaitSpecification
from frontal_biped.gait.gait import converged_quadrature

NODES = 16
"""Quadrature nodes of the optimiser."""

SAME = 1e-10
"""Difference between two evaluations of the same formulas, with and without derivatives."""

MOVED = 1e-4
"""Scaled distance of a start from where the equality holds."""


@pytest.mark.parametrize(
    "make",
    [
        lambda biped: DesignProblem(biped, GaitSpecification(), NODES),
        lambda biped: DesignProblem(biped, GaitSpecification(degree=(5, 4, 6)), NODES),
        lambda biped: TwoStepProblem(biped, GaitSpecification(travel=0.05, degree=(5, 4, 5)), NODES),
    ],
    ids=["one degree", "mixed degrees", "two steps"],
)
def test_equalities_are_the_same_without_derivatives(biped, make):
    problem = make(biped)
    x = problem.start()
    assert_close(problem.equality(x, NODES), problem.evaluate(x).equality, SAME, floor=1.0)


class Circle:
    """x^2 + y^2 = 1 + 1/nodes^6 in the upper half plane, with slopes as of no nodes at all; y at most 1."""

    def bounds(self):
        return np.array([-1.0, 0.0]), np.array([2.0, 1.0])

    def scale(self):
        return np.ones(2)

    def evaluate(self, x):
        return SimpleNamespace(equality_jacobian=2.0 * x[None])

    def equality(self, x, nodes):
        return np.array([x @ x - 1.0 - nodes**-6.0])


@pytest.mark.parametrize("nodes", [NODES, 2 * NODES])
def test_the_nearest_point_is_found(nodes):
    problem, direction = Circle(), np.array([0.6, 0.8])
    x = meet_equalities(problem, (1.0 + MOVED) * direction, nodes)
    assert np.abs(problem.equality(x, nodes)) < CLOSED
    assert_close(x / np.linalg.norm(x), direction, SAME)


def test_variables_at_their_bounds_stay_there():
    problem, nodes = Circle(), 2
    expected = np.array([nodes**-3.0, 1.0])
    x = meet_equalities(problem, np.array([expected[0] + MOVED, 1.0]), nodes)
    assert x[1] == 1.0
    assert_close(x, expected, SAME)


def test_a_gait_is_closed_on_the_nodes_it_needs(biped, reference_gait):
    problem = DesignProblem(biped, reference_gait.specification, NODES)
    x = problem.variables(reference_gait)
    x[0] += MOVED * problem.scale()[0]
    closed = close_step(problem, x)
    assert closed.quadrature.nodes == len(closed.step.rising.tau)
    assert closed.quadrature.nodes == converged_quadrature(biped, *closed.phases, reference_gait.step_width).nodes
    assert abs(closed.step.periodicity) < 1e-13
    assert np.max(np.abs(closed.x - x) / problem.scale()) < 10.0 * MOVED
