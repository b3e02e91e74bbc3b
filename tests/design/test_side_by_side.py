"""Inverse dynamics at many states against that at one, and its derivatives against differences."""

import numpy as np
import pytest
from random_states import assert_close

from frontal_biped.design.side_by_side import COPIES, side_by_side

SAME = 1e-12
"""Relative difference of the same sums in another order."""

STEP = 1e-5
"""Of central differences [rad], [rad/s], [rad/s^2]."""

GRADIENT_TOLERANCE = 1e-6
"""Relative: rounding of 1e-13/1e-5 and truncation of 1e-5 squared, with room."""


def states(n, seed=0):
    rng = np.random.default_rng(seed)
    return np.array([rng.normal(size=(n, 4)) - 0.5 * np.pi, rng.normal(size=(n, 4)), rng.normal(size=(n, 4))])


@pytest.mark.parametrize("n", [1, COPIES - 1, COPIES, 2 * COPIES + 3])
def test_motion_and_weight_are_inverse_dynamics(robot, n):
    at = states(n)
    found = side_by_side(robot).at(at)
    weight = side_by_side(robot).weight(found.by[2])
    expected = np.array([robot.inverse_dynamics(*one) for one in zip(*at, strict=True)])
    assert_close((found.tau + weight.tau).T, expected, SAME)


def test_weight_alone_is_inverse_dynamics_at_rest(robot):
    at = states(COPIES + 1, seed=1)
    weight = side_by_side(robot).weight(side_by_side(robot).at(at).by[2])
    assert_close(weight.tau.T, np.array([robot.inverse_dynamics(q, *np.zeros((2, 4))) for q in at[0]]), SAME)


@pytest.mark.parametrize("n", [1, COPIES + 1])
def test_set_in_motion_from_rest_is_inverse_dynamics_without_velocity(robot, n):
    """And its derivatives are those of the states at rest themselves."""
    q, dq, ddq = at = states(n, seed=4)
    many = side_by_side(robot)
    found = many.from_rest(many.at(at), dq.T)
    expected = many.at(np.array([q, np.zeros_like(dq), dq]))
    assert_close(found.tau.T, expected.tau.T, SAME)
    assert_close(found.by_q.T, expected.by[0].T, SAME, floor=1.0)


def test_derivatives_against_differences(robot):
    at = states(3, seed=2)
    many = side_by_side(robot)
    found = many.at(at)
    for part, exact in enumerate(found.by):
        for joint in range(4):
            shift = np.zeros((3, 3, 4))
            shift[part, :, joint] = STEP
            above, below = many.at(at + shift).tau, many.at(at - shift).tau
            assert_close(((above - below) / (2.0 * STEP)).T, exact[joint].T, GRADIENT_TOLERANCE, floor=1.0)
    weight = many.weight(found.by[2])
    for joint in range(4):
        shift = np.zeros((3, 3, 4))
        shift[0, :, joint] = STEP
        above, below = (many.weight(many.at(moved).by[2]).tau for moved in (at + shift, at - shift))
        assert_close(((above - below) / (2.0 * STEP)).T, weight.by_q[joint].T, GRADIENT_TOLERANCE, floor=1.0)


def test_the_swing_ankle_is_where_the_robot_has_it(robot):
    at = states(COPIES + 2, seed=3)
    J = side_by_side(robot).at(at).J
    for q, own in zip(at[0], J.T, strict=True):
        assert_close(np.stack([-own[1], own[0]], axis=1), robot.joint_positions(q), SAME, floor=1.0)
