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
    return rng.normal(size=(n, 4)) - 0.5 * np.pi, rng.normal(size=(n, 4)), rng.normal(size=(n, 4))


@pytest.mark.parametrize("n", [1, COPIES - 1, COPIES, 2 * COPIES + 3])
def test_motion_and_weight_are_inverse_dynamics(robot, n):
    q, dq, ddq = states(n)
    found = side_by_side(robot).at(q, dq, ddq)
    weight = side_by_side(robot).weight(found.by_ddq)
    expected = np.array([robot.inverse_dynamics(*at) for at in zip(q, dq, ddq, strict=True)])
    assert_close(found.tau + weight.tau, expected, SAME)


def test_weight_alone_is_inverse_dynamics_at_rest(robot):
    q, dq, ddq = states(COPIES + 1, seed=1)
    weight = side_by_side(robot).weight(side_by_side(robot).at(q, dq, ddq).by_ddq)
    assert_close(weight.tau, np.array([robot.inverse_dynamics(at, *np.zeros((2, 4))) for at in q]), SAME)


@pytest.mark.parametrize("n", [1, COPIES + 1])
def test_set_in_motion_from_rest_is_inverse_dynamics_without_velocity(robot, n):
    """And its derivatives are those of the states at rest themselves."""
    q, dq, ddq = states(n, seed=4)
    many = side_by_side(robot)
    found = many.from_rest(many.at(q, dq, ddq), dq)
    expected = many.at(q, np.zeros_like(dq), dq)
    assert_close(found.tau, expected.tau, SAME)
    assert_close(found.by_q, expected.by_q, SAME, floor=1.0)


def test_derivatives_against_differences(robot):
    q, dq, ddq = states(3, seed=2)
    many = side_by_side(robot)
    found = many.at(q, dq, ddq)
    for part, exact in enumerate((found.by_q, found.by_dq, found.by_ddq)):
        for joint in range(4):
            shift = np.zeros((3, 4))
            shift[:, joint] = STEP
            moved = [np.array([q, dq, ddq]) for _ in range(2)]
            moved[0][part] += shift
            moved[1][part] -= shift
            above, below = (many.at(*at).tau for at in moved)
            assert_close((above - below) / (2.0 * STEP), exact[:, :, joint], GRADIENT_TOLERANCE, floor=1.0)
    weight = many.weight(found.by_ddq)
    for joint in range(4):
        above, below = (
            many.weight(many.at(q + sign * STEP * np.eye(4)[joint], dq, ddq).by_ddq).tau for sign in (1.0, -1.0)
        )
        assert_close((above - below) / (2.0 * STEP), weight.by_q[:, :, joint], GRADIENT_TOLERANCE, floor=1.0)


def test_the_swing_ankle_is_where_the_robot_has_it(robot):
    q, dq, ddq = states(COPIES + 2, seed=3)
    J = side_by_side(robot).at(q, dq, ddq).J
    for at, own in zip(q, J, strict=True):
        assert_close(np.stack([-own[1], own[0]], axis=1), robot.joint_positions(at), SAME, floor=1.0)
