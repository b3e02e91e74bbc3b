"""Inverse dynamics at many states against that at one, and its derivatives against differences."""

import numpy as np
import pytest
from random_states import assert_close

from frontal_biped.design.side_by_side import COPIES, InverseDynamics, side_by_side

SAME = 1e-12
"""Relative difference of the same sums in another order."""

STEP = 1e-5
"""Of central differences [rad], [rad/s], [rad/s^2]."""

GRADIENT_TOLERANCE = 1e-6
"""Relative: rounding of 1e-13/1e-5 and truncation of 1e-5 squared, with room."""


def states(n, seed=0):
    rng = np.random.default_rng(seed)
    return np.array([rng.normal(size=(4, n)) - 0.5 * np.pi, rng.normal(size=(4, n)), rng.normal(size=(4, n))])


def moving(robot, at):
    """(13, 7, n) inverse dynamics without gravity and its derivatives, and J."""
    found = np.full((13, 7, at.shape[2]), np.nan)
    return found, side_by_side(robot).at(at, found)


def weight(robot, at):
    """The weight alone."""
    found, _ = moving(robot, at)
    alone = np.zeros_like(found)
    side_by_side(robot).weight(found[9:], InverseDynamics(alone[0], alone[1:5]))
    return alone


@pytest.mark.parametrize("n", [1, COPIES - 1, COPIES, 2 * COPIES + 3])
def test_motion_and_weight_are_inverse_dynamics(robot, n):
    at = states(n)
    found = moving(robot, at)[0][0] + weight(robot, at)[0]
    expected = np.array([robot.inverse_dynamics(*one) for one in zip(*at.swapaxes(1, 2), strict=True)])
    assert_close(found.T, expected, SAME)


def test_weight_alone_is_inverse_dynamics_at_rest(robot):
    at = states(COPIES + 1, seed=1)
    expected = np.array([robot.inverse_dynamics(q, *np.zeros((2, 4))) for q in at[0].T])
    assert_close(weight(robot, at)[0].T, expected, SAME)


@pytest.mark.parametrize("n", [1, COPIES + 1])
def test_set_in_motion_from_rest_is_inverse_dynamics_without_velocity(robot, n):
    """And its derivatives are those of the states at rest themselves."""
    q, dq, _ = at = states(n, seed=4)
    found = np.full((5, 7, n), np.nan)
    side_by_side(robot).from_rest(*moving(robot, at), dq, InverseDynamics(found[0], found[1:]))
    expected, _ = moving(robot, np.array([q, np.zeros_like(dq), dq]))
    assert_close(found[0].T, expected[0].T, SAME)
    assert_close(found[1:].T, expected[1:5].T, SAME, floor=1.0)


def test_derivatives_against_differences(robot):
    at = states(3, seed=2)
    exact, exact_weight = moving(robot, at)[0], weight(robot, at)
    for variable in range(12):
        part, joint = divmod(variable, 4)
        shift = np.zeros((3, 4, 3))
        shift[part, joint] = STEP
        for found, own in ((lambda at: moving(robot, at)[0], exact), (lambda at: weight(robot, at), exact_weight)):
            difference = (found(at + shift)[0] - found(at - shift)[0]) / (2.0 * STEP)
            assert_close(difference.T, own[1 + variable].T, GRADIENT_TOLERANCE, floor=1.0)


def test_the_swing_ankle_is_where_the_robot_has_it(robot):
    at = states(COPIES + 2, seed=3)
    _, J = moving(robot, at)
    for q, own in zip(at[0].T, J.T, strict=True):
        assert_close(np.stack([-own[1], own[0]], axis=1), robot.joint_positions(q), SAME, floor=1.0)
