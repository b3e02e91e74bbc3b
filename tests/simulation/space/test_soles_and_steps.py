"""Footsteps, pressure and steps of a walk, against what the walk was made from."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from frontal_biped.simulation.space.resampling import drawable_part, resample_spatial
from frontal_biped.simulation.space.shares import joint_shares
from frontal_biped.simulation.space.soles import (
    footprint,
    footsteps,
    friction_used,
    pressure_in_sole,
    pressure_in_world,
    yaw_moments,
)
from frontal_biped.simulation.space.steps import step_table

KINEMATICS = 1e-8
"""Accuracy of the inverse kinematics that made the walk, with room [m, rad]."""


def test_footsteps_are_where_the_feet_stood(straight, talos_gait):
    steps = footsteps(straight)
    assert [(step.step, step.side.value) for step in steps] == [(-1, "right"), (0, "left"), (1, "right"), (2, "left")]
    feet = np.array([[step.x, step.y, step.yaw] for step in steps])
    start = straight.sole_position[0, 0, 0]
    half = 0.5 * talos_gait.step_width
    np.testing.assert_allclose(feet[:, 0] - start, [0.0, 0.0, 0.2, 0.4], atol=KINEMATICS)
    np.testing.assert_allclose(feet[:, 1], [-half, half, -half, half], atol=1e-6)  # the gait file rounds its width
    np.testing.assert_allclose(feet[:, 2], 0.0, atol=KINEMATICS)
    assert [step.time for step in steps[1:]] == [straight.t[straight.step == k][0] for k in range(3)]


def test_footprint_goes_round_the_sole(talos):
    sole = talos.soles.left
    corners = footprint(sole, 1.0, 2.0, 0.5 * np.pi)
    sides = np.diff(np.concatenate([corners, corners[:1]]), axis=0)
    lengths = np.linalg.norm(sides, axis=1)
    np.testing.assert_allclose(lengths[::2], lengths[0])
    assert np.prod(lengths[:2]) == pytest.approx(sole.length * sole.width)
    # turned to the left, the toes point along y, and what was on the left lies behind in x
    np.testing.assert_allclose([corners[:, 1].max(), corners[:, 1].min()], [2.0 + sole.front, 2.0 - sole.back])
    np.testing.assert_allclose([corners[:, 0].max(), corners[:, 0].min()], [1.0 + sole.inner, 1.0 - sole.outer])


def test_pressure_is_where_the_wrench_has_no_horizontal_moment(bend):
    place, own = pressure_in_world(bend), pressure_in_sole(bend)
    moments = yaw_moments(bend)
    standing = np.where(bend.stance > 0.0, 0, 1)
    rows = np.arange(len(bend.t))
    assert np.isnan(place[rows, 1 - standing]).all()
    assert np.isnan(friction_used(bend)[rows, 1 - standing]).all()
    for k in range(0, len(bend.t), 37):
        foot = standing[k]
        wrench = pin.Force(bend.wrench[k, foot])
        arm = place[k, foot] - bend.sole_position[k, foot]
        at_point = wrench.angular - np.cross(arm, wrench.linear)
        scale = np.abs(bend.wrench).max()
        np.testing.assert_allclose(at_point[:2], 0.0, atol=1e-12 * scale)
        assert at_point[2] == pytest.approx(moments[k, foot], abs=1e-12 * scale)
    np.testing.assert_allclose(own[rows, standing, 0], bend.cop_x, atol=1e-10)
    np.testing.assert_allclose(-bend.stance * own[rows, standing, 1], bend.p_fri, atol=1e-10)


def test_steps_are_as_long_and_as_fast_as_the_orbit(straight, talos_gait):
    falling = talos_gait.falling
    middle = 0.5 * (falling.beta_start + falling.beta_end)
    table = step_table(straight, middle)
    duration = talos_gait.orbit.step_duration
    np.testing.assert_allclose(table.duration, duration, atol=1e-6)
    # the first step goes half as far with the trunk
    np.testing.assert_allclose(table.speed[1:] * duration, 0.2, atol=2e-3)
    assert np.ptp(table.mid_fall_speed) < 1e-3 * abs(table.mid_fall_speed[0])
    assert np.all(table.mid_fall_speed < 0.0)
    assert len(step_table(replace(straight, steps_completed=1)).step) == 1


def test_forward_is_where_the_pelvis_points(bend, straight, talos_gait):
    np.testing.assert_allclose(step_table(bend).speed, step_table(straight).speed, atol=0.02)


def test_shares_reach_one_at_the_limits(talos, straight):
    limits = talos.limits
    at_limits = replace(
        straight,
        q=np.column_stack([straight.q[:, :7], np.tile(limits.upper, (len(straight.t), 1))]),
        v=np.column_stack([straight.v[:, :6], np.tile(-limits.velocity, (len(straight.t), 1))]),
        tau=np.tile(limits.effort, (len(straight.t), 1)),
    )
    for share in joint_shares(talos, at_limits):
        np.testing.assert_allclose(share, 1.0)


def test_resampling_keeps_samples_and_never_turns_the_long_way(bend):
    inside = bend.t[5:20]
    np.testing.assert_allclose(resample_spatial(bend, inside).q, bend.q[5:20], atol=1e-12)
    flipped = bend.q.copy()
    flipped[::2, 3:7] *= -1.0
    between = 0.5 * (bend.t[5:19] + bend.t[6:20])
    q = resample_spatial(replace(bend, q=flipped), between).q
    np.testing.assert_allclose(np.linalg.norm(q[:, 3:7], axis=1), 1.0)
    for row, before in zip(q, bend.q[5:19], strict=True):
        turn = pin.Quaternion(before[3:7]).angularDistance(pin.Quaternion(row[3:7]))
        assert turn < 0.01  # [rad] in 2.5 ms


def test_a_fall_that_ends_in_no_numbers_is_drawn_as_far_as_it_goes(straight):
    q = straight.q.copy()
    q[100:] = np.nan
    tau = straight.tau.copy()
    tau[3] = np.nan
    part = drawable_part(replace(straight, q=q, tau=tau))
    assert len(part.t) == len(part.q) == 100
    assert np.isfinite(part.tau).all()
    with pytest.raises(ValueError, match="no posture"):
        drawable_part(replace(straight, q=np.full_like(q, np.nan)))
