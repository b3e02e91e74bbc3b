"""A walk in three lines: each number against the samples it stands for."""

from dataclasses import replace

import numpy as np
import pytest

from frontal_biped.analysis.walk_summary import Use, walk_summary


def test_numbers_are_those_of_the_samples(biped, gait, walk):
    summary = walk_summary(biped, gait, walk, 4)
    shares = np.max(np.abs(walk.u) / biped.max_torque, axis=0)
    assert summary.torque.share == pytest.approx(shares.max())
    assert summary.speed.value == pytest.approx(
        np.max(np.abs(walk.dq), axis=0)[np.argmax(np.max(np.abs(walk.dq) / biped.joint_max_velocity, axis=0))]
    )
    friction, sole = summary.uses
    assert friction.value == pytest.approx(np.max(np.abs(walk.force[:, 0]) / walk.force[:, 1]))
    assert friction.limit == gait.specification.friction
    assert 0.0 < sole.share <= 1.0 + 1e-9 and sole.limit == pytest.approx(50.0)  # mm, of Table I
    assert summary.tightest.share == max(use.share for use in (friction, sole, summary.torque, summary.speed))


def test_the_fri_is_measured_towards_the_end_that_is_nearer(biped, gait, walk):
    for sign in (1.0, -1.0):
        moved = replace(walk, p_fri=np.where(np.arange(len(walk.t)) == 3, 0.04 * sign, 0.001))
        use = walk_summary(biped, gait, moved, 4).uses[1]
        assert (use.value, use.share) == pytest.approx((40.0, 0.8))
    gone = replace(walk, p_fri=np.full(len(walk.t), np.nan))
    assert walk_summary(biped, gait, gone, 4).uses[1].share == 0.0


def test_lines(biped, gait, walk):
    head, tightest, motors = str(walk_summary(biped, gait, walk, 4)).splitlines()
    assert head.startswith("frontal_biped: walked 4 steps of 4 in ")
    assert tightest.startswith("tightest  ") and motors.startswith("motors    torque of the ")
    fallen = replace(walk, outcome="the swing foot landed on its edge", steps_completed=1)
    head = str(walk_summary(biped, gait, fallen, 4)).splitlines()[0]
    assert "FELL (the swing foot landed on its edge) after 1 step of 4" in head
    assert "ask for max_foot_rotation = 0.05" in head


def test_a_limit_that_there_is_not_is_said_and_is_null_in_json(biped, gait, walk):
    assert str(Use("speed of the hip", 3.0, np.inf, "rad/s")) == "speed of the hip 3 rad/s, which has no limit"
    summary = replace(walk_summary(biped, gait, walk, 4), speed=Use("speed of the hip", 3.0, np.inf, "rad/s"))
    assert summary.as_dict()["motors"]["speed"]["limit"] is None
    assert summary.tightest is not summary.speed
