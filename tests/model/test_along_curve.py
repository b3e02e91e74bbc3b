"""Inverse dynamics along curves against that at single states, its derivatives against differences."""

import numpy as np
import pytest
from random_states import assert_close

SAME = 1e-12
"""Relative difference of the same sums in another order."""

STEP = 1e-5
"""Of central differences [rad], [-], [1/rad]."""

GRADIENT_TOLERANCE = 1e-6
"""Relative: rounding of 1e-13/1e-5 and truncation of 1e-5 squared, with room."""


def curve(n, seed=0):
    rng = np.random.default_rng(seed)
    return rng.normal(size=(n, 4)) - 0.5 * np.pi, rng.normal(size=(n, 4)), rng.normal(size=(n, 4))


@pytest.mark.parametrize("n", [1, 2, 37])
def test_forces_are_inverse_dynamics(robot, n):
    q, dq, ddq = curve(n)
    A, B, G = robot.masses.along(q, dq, ddq).forces
    ddbeta, dbeta = np.random.default_rng(1).normal(size=(2, n))
    velocity, acceleration = dq * dbeta[:, None], ddq * dbeta[:, None] ** 2 + dq * ddbeta[:, None]
    expected = [robot.inverse_dynamics(*at) for at in zip(q, velocity, acceleration, strict=True)]
    assert_close((A * ddbeta + B * dbeta**2 + G).T, np.array(expected), SAME)


def test_weight_is_inverse_dynamics_at_rest(robot):
    q, dq, ddq = curve(5, seed=1)
    expected = np.array([robot.inverse_dynamics(at, *np.zeros((2, 4))) for at in q])
    assert_close(robot.masses.along(q, dq, ddq).forces[2].T, expected, SAME)


def test_mass_matrix_is_the_slope_of_forces(robot):
    q, dq, ddq = curve(5, seed=2)
    found = robot.masses.along(q, dq, ddq).derivatives.by_ddq
    assert_close(found[:, 3:], np.array([robot.D(at) for at in q]), SAME)
    assert_close(found, np.array([robot.momentum_map(at) for at in q]), SAME)


@pytest.mark.parametrize("part", [0, 1, 2])
def test_derivatives_against_differences(robot, part):
    at = np.array(curve(3, seed=3))
    by_q, by_dq, by_ddq = robot.masses.along(*at).derivatives
    nothing = np.zeros_like(by_dq)
    exact = (by_q, np.stack([by_ddq, by_dq, nothing]), np.stack([nothing, by_ddq, nothing]))[part]
    for joint in range(4):
        shift = np.zeros_like(at)
        shift[part, :, joint] = STEP
        above, below = (robot.masses.along(*moved).forces for moved in (at + shift, at - shift))
        slope = ((above - below) / (2.0 * STEP)).transpose(0, 2, 1)
        assert_close(slope, exact[..., joint], GRADIENT_TOLERANCE, floor=1.0)


def test_joints_are_where_the_robot_has_them(robot):
    at = np.array(curve(3, seed=4))
    places = robot.masses.along(*at).places
    for q, own in zip(at[0], places[0], strict=True):
        assert_close(np.stack([own.real, own.imag], axis=1), robot.joint_positions(q), SAME, floor=1.0)
    # along the curve, with q'' its second derivative
    forth, back = (
        robot.masses.along(at[0] + t * at[1] + 0.5 * t * t * at[2], at[1] + t * at[2], at[2]).places
        for t in (STEP, -STEP)
    )
    slope = (forth[:2] - back[:2]) / (2.0 * STEP)
    for found, exact in ((slope.real, places[1:].real), (slope.imag, places[1:].imag)):
        assert_close(found, exact, GRADIENT_TOLERANCE, floor=1.0)


def test_sole_heights_of_many_states_are_those_of_one(robot):
    q, _, _ = curve(4, seed=5)
    expected = np.array([robot.swing_sole(at)[:, 1] for at in q]).T
    assert_close(robot.swing_sole_heights(q), expected, SAME, floor=1.0)
