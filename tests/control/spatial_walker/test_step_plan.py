"""What a step is to do: the stand of a foot, and steps at commanded speeds."""

import numpy as np
import pytest

from frontal_biped.control.path.pose import Pose
from frontal_biped.control.spatial_walker.step_plan import CommandedSpeeds, StepPlan, stand_of
from frontal_biped.model.stance_map import Stance

T, W = 0.7, 0.3  # [s], [m]


def test_both_feet_of_a_stand_belong_to_it():
    rng = np.random.default_rng(0)
    for x, y, yaw in rng.uniform(-2.0, 2.0, (10, 3)).tolist():
        stand = Pose(x, y, yaw)
        left, right = stand.moved(0.0, 0.5 * W, 0.0), stand.moved(0.0, -0.5 * W, 0.0)
        assert stand_of(Stance.LEFT, left, W) == pytest.approx(stand)
        assert stand_of(Stance.RIGHT, right, W) == pytest.approx(stand)


@pytest.mark.parametrize(("stance", "wider"), [(Stance.RIGHT, 1.0), (Stance.LEFT, -1.0)])
def test_a_foot_that_steps_to_its_own_side_lands_wider(stance, wider):
    """To the left, standing on the right foot, and the other way round: by feet of stands that are apart."""
    foot, aside = Pose(1.0, 2.0, 0.5), 0.04
    stand = stand_of(stance, foot, W)
    next_foot = stand.moved(0.0, aside, 0.0).moved(0.0, 0.5 * stance.other.sign * W, 0.0)
    apart = abs(foot.seen(next_foot).y)
    assert StepPlan(aside=aside).widening(stance) == pytest.approx(apart - W) == pytest.approx(wider * aside)


def test_the_heading_is_half_way():
    plan = StepPlan(yaw=0.3, turn=0.2)
    assert (plan.heading, plan.next_yaw) == pytest.approx((0.4, 0.5))


def test_speeds_become_steps():
    speeds = CommandedSpeeds(T, speed_change=1.0)
    speeds.reset(0.1)
    speeds.asked, speeds.lateral, speeds.turning = 0.2, 0.05, 0.1
    yaws = []
    for _ in range(5):
        plan = speeds.begin(Stance.LEFT, Pose())
        yaws.append(plan.yaw)
        assert plan[1:] == pytest.approx((0.2 * T, 0.05 * T, 0.1 * T, 0.2 * T, 0.1 * T, 0.2))
    assert yaws == pytest.approx(0.1 + 0.1 * T * np.arange(5))


def test_the_speed_is_approached():
    speeds = CommandedSpeeds(T, speed_change=0.15)
    speeds.asked = 0.25
    seen = [speeds.begin(Stance.LEFT, Pose()).speed for _ in range(3)]
    speeds.asked = -0.02
    seen += [speeds.begin(Stance.LEFT, Pose()).speed for _ in range(2)]
    assert seen == pytest.approx([0.15, 0.25, 0.25, 0.1, -0.02])


def test_a_command_within_a_step_changes_the_next_one():
    speeds = CommandedSpeeds(T, speed_change=1.0)
    before = speeds.begin(Stance.LEFT, Pose())
    speeds.asked, speeds.turning = 0.3, 0.2
    now = speeds.plan()
    assert (now.length, now.turn) == (before.length, before.turn) == (0.0, 0.0)
    assert (now.next_length, now.next_turn) == pytest.approx((0.3 * T, 0.2 * T))
