"""The five integrals against inverse dynamics in space, momenta, and the planar model."""

import numpy as np
import pytest
from held_robot import Standing
from hypothesis import given
from hypothesis import strategies as st
from random_states import accelerations, angles, assert_close, rates
from robot_laws import tolerance

from frontal_biped.gait.holding_wrench import HoldingWrench
from frontal_biped.model import FrontalBiped, Stance, load_robot
from frontal_biped.model.space.plane_masses import F_H, N_0, PlaneDynamics, PlaneMasses

HUMANOIDS = ("alexander", "g1", "human", "icub", "romeo", "simple_humanoid_classical", "talos_full")

SAME = 1e-10
"""Relative: different algorithms on the same numbers."""


@pytest.fixture(scope="module", params=HUMANOIDS)
def humanoid(request) -> FrontalBiped:
    return load_robot(request.param)


def at(dynamics: PlaneDynamics, dbeta: float, ddbeta: float):
    """(5, n) rows."""
    return dynamics.at(np.array([ddbeta]), np.array([dbeta**2]))


@given(
    q=angles, slope=rates, bend=accelerations, dbeta=st.floats(-2.0, 2.0), ddbeta=st.floats(-10.0, 10.0),
    stance=st.sampled_from(Stance),
)  # fmt: skip
def test_wrench_is_that_of_inverse_dynamics_in_space(humanoid, q, slope, bend, dbeta, ddbeta, stance):
    rows = at(PlaneMasses.of(humanoid, stance).along(q[None], slope[None], bend[None]), dbeta, ddbeta)
    (sole,) = (sole for sole in humanoid.robot.soles if sole.side is stance)
    expected = Standing(humanoid, stance).wrench(q, slope * dbeta, bend * dbeta**2 + slope * ddbeta)
    assert_close(HoldingWrench(sole, rows).wrench[:, 0], expected, tolerance(humanoid), floor=humanoid.weight)


@given(q=angles, slope=rates, stance=st.sampled_from(Stance))
def test_what_multiplies_ddbeta_is_the_momentum(humanoid, q, slope, stance):
    A = PlaneMasses.of(humanoid, stance).along(q[None], slope[None], np.zeros((1, 4))).A
    (sole,) = (sole for sole in humanoid.robot.soles if sole.side is stance)
    expected = Standing(humanoid, stance).momentum(q, slope)
    size = humanoid.mass * humanoid.leg_length
    assert_close(HoldingWrench(sole, A).wrench[:, 0], expected, tolerance(humanoid), floor=size)


@given(q=angles, slope=rates, bend=accelerations)
def test_equal_legs_are_the_planar_model(robot, q, slope, bend):
    """Robots without any asymmetry: three rows are what `FrontalBiped` computes by recursion."""
    found = PlaneMasses.of(robot, Stance.RIGHT).along(q[None], slope[None], bend[None])
    rest = np.zeros(4)
    weight = robot.inverse_dynamics(q, rest, rest)[: N_0 + 1]
    expected = robot.momentum_map(q)[: N_0 + 1] @ slope, robot.inverse_dynamics(q, slope, bend)[: N_0 + 1] - weight
    for part, planar in zip(found, (*expected, weight), strict=True):
        assert_close(part[F_H : N_0 + 1, 0], planar, SAME, floor=robot.weight)


def test_feet_in_one_plane_with_all_mass_hold_no_yaw(robot):
    """The robots of the paper have no depth."""
    for stance in Stance:
        masses = PlaneMasses.of(robot, stance)
        assert not np.any(masses.depth) and not np.any(masses.depth_moment)
