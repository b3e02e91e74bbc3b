"""A walk that is steered: the same walk without orders, and orders followed from the next step on."""

import numpy as np
import pytest
from whole_robots import whole

from frontal_biped.simulation.space.steered import PICTURES, Order, walk_steered
from frontal_biped.simulation.space.walk_spatial import walk_spatial

pytest.importorskip("mujoco")


@pytest.mark.slow
def test_without_orders_it_is_the_walk_on_the_spot():
    robot, pictures = whole("simple_humanoid_bent"), []
    run = walk_steered(robot.biped, robot.gait, lambda: None, pictures.append, steps=3)
    other = walk_spatial(robot.biped, robot.gait, steps=3)
    assert run.outcome == other.outcome == "completed"
    assert run.event_t == pytest.approx(other.event_t, abs=0.0)
    t = np.array([picture.t for picture in pictures])
    assert np.diff(t) == pytest.approx(1.0 / PICTURES, abs=1.1e-3)  # whole control periods
    assert [picture.steps for picture in pictures] == sorted(picture.steps for picture in pictures)


@pytest.mark.slow
def test_an_order_is_followed_from_the_next_step_on_and_one_too_far_is_refused():
    robot, pictures = whole("talos_full"), []
    planned = [(1, Order(0.0, 0.0, 0.2)), (3, Order(0.0, 0.0, 50.0))]

    def orders():
        if planned and pictures and pictures[-1].steps >= planned[0][0]:
            return planned.pop(0)[1]
        return None

    walk_steered(robot.biped, robot.gait, orders, pictures.append, steps=5)
    turning = [picture for picture in pictures if picture.order.turn and picture.steps == 2]
    assert all(picture.answered == (1, 2) for picture in turning)
    assert abs(next(picture for picture in pictures if picture.steps == 2).yaw) < 0.01
    step = robot.gait.orbit.step_duration
    # half of a step's turn in the first one, a whole one in each of the next
    assert pictures[-1].yaw == pytest.approx(2.5 * 0.2 * step, rel=0.3)
    refused = pictures[-1]
    assert "turn = 50" in refused.refused and refused.order == Order(0.0, 0.0, 0.2)
