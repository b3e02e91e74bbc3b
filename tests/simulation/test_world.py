"""The robot in the room: feet stay where they stand, and nothing jumps when they change roles."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from frontal_biped.simulation.walking import simulate
from frontal_biped.simulation.world import (
    frame_times,
    phase_spans,
    plane_to_world,
    resample,
    sole_ends,
    world_configurations,
    world_motion,
)

ROUNDING = 1e-12  # [m] kinematics of a few bodies
LANDING = 1e-6  # [m] how exactly an impact is located by the simulator


def feet(trajectory):
    """Indices of stance and swing foot in `sole_ends`."""
    stance = np.where(trajectory.stance > 0.0, 0, 1)
    return stance, 1 - stance


@pytest.fixture(scope="module")
def soles(biped, trajectory):
    return sole_ends(biped, world_configurations(biped, trajectory))


def test_stance_sole_lies_flat_where_it_was_recorded(biped, trajectory, soles):
    stance, _ = feet(trajectory)
    ends = soles[np.arange(len(stance)), stance]
    np.testing.assert_allclose(ends[..., 2], 0.0, atol=ROUNDING)
    outer, inner = biped.sole
    inwards = -trajectory.stance
    np.testing.assert_allclose(ends[:, 0, 1], trajectory.stance_y + inwards * inner, atol=ROUNDING)
    np.testing.assert_allclose(ends[:, 1, 1], trajectory.stance_y + inwards * outer, atol=ROUNDING)
    for span in phase_spans(trajectory):
        assert np.ptp(ends[span.samples], axis=0).max() < ROUNDING


def test_swing_sole_is_where_the_planar_model_has_it(biped, trajectory, soles):
    _, swing = feet(trajectory)
    ends = soles[np.arange(len(swing)), swing]
    planar = np.array([biped.swing_sole(q) for q in trajectory.q])
    expected = plane_to_world(planar, trajectory.stance[:, None], trajectory.stance_y[:, None])
    np.testing.assert_allclose(ends[..., 1:], expected, atol=ROUNDING)
    assert set(np.unique(trajectory.stance)) == {-1.0, 1.0}


def test_feet_are_continuous_across_impacts(trajectory, soles):
    impacts = np.flatnonzero(np.diff(trajectory.step))
    assert len(impacts) == 3
    np.testing.assert_allclose(soles[impacts + 1], soles[impacts], atol=LANDING)


def test_a_foot_that_lands_tilted_settles_by_no_more_than_its_tilt(biped, gait):
    """Torques held for 2 ms leave the foot a fraction of a degree off at the impact, which lays it flat."""
    run = simulate(biped, gait, steps=3, period=2e-3, stabiliser="adaptive")
    soles = sole_ends(biped, world_configurations(biped, run))
    impacts = np.flatnonzero(np.diff(run.step))
    tilted = np.array([np.ptp(biped.swing_sole(q)[:, 1]) for q in run.q[impacts]])
    jumps = np.abs(soles[impacts + 1] - soles[impacts]).max(axis=(1, 2, 3))
    assert 1e-6 < tilted.max() < 2e-3
    # the robot turns about the edge that touched: the other foot moves as far as the step is wider than a sole
    assert np.all(jumps <= tilted * gait.step_width / np.diff(biped.sole)[0])


def test_the_motion_stays_in_the_frontal_plane(trajectory, soles):
    assert np.ptp(soles[..., 0]) < ROUNDING


def test_left_is_left(biped, soles):
    assert np.all(soles[:, 0, :, 1].mean(axis=-1) > soles[:, 1, :, 1].mean(axis=-1))


def test_centre_of_mass_and_force_agree_with_the_planar_model(biped, trajectory):
    motion = world_motion(biped, trajectory)
    planar = np.array([biped.com(q) for q in trajectory.q])
    np.testing.assert_allclose(
        motion.com[:, 1:], plane_to_world(planar, trajectory.stance, trajectory.stance_y), atol=ROUNDING
    )
    np.testing.assert_allclose(motion.force[:, 2], trajectory.force[:, 1])
    # the ground pushes the robot towards its swing foot: to the right while the left foot stands
    assert np.all(motion.force[:, 1] * trajectory.stance * np.sign(trajectory.force[:, 0]) < 0.0)
    np.testing.assert_allclose(motion.fri[:, 2], 0.0)


def test_raised_and_offset_feet_stand_flat_too(raised_ankle, orbit):
    soles = sole_ends(raised_ankle, world_configurations(raised_ankle, orbit))
    stance, swing = feet(orbit)
    rows = np.arange(len(stance))
    np.testing.assert_allclose(soles[rows, stance, :, 2], 0.0, atol=ROUNDING)
    heights = np.array([raised_ankle.swing_sole(q)[:, 1] for q in orbit.q])
    np.testing.assert_allclose(soles[rows, swing, :, 2], heights, atol=ROUNDING)


def test_configurations_belong_to_the_spatial_model(biped, orbit):
    q = world_configurations(biped, orbit)
    assert q.shape == (len(orbit.t), biped.spatial_model.nq)
    assert all(pin.isNormalized(biped.spatial_model, row) for row in q)


def test_frames_follow_the_clock(trajectory):
    times = frame_times(trajectory, 30.0)
    assert times[0] == trajectory.t[0]
    assert times[-1] == trajectory.t[-1]
    np.testing.assert_allclose(np.diff(times)[:-1], 1.0 / 30.0)
    assert 0.0 < np.diff(times)[-1] <= 1.0 / 30.0 + 1e-6


def test_resampling_at_the_samples_changes_nothing(trajectory):
    phase = phase_spans(trajectory)[1]
    inside = slice(phase.samples.start, phase.samples.stop - 1)
    again = resample(trajectory, trajectory.t[inside])
    np.testing.assert_array_equal(again.q, trajectory.q[inside])
    np.testing.assert_array_equal(again.step, trajectory.step[inside])


def test_resampling_does_not_mix_the_two_sides_of_an_impact(biped, trajectory):
    impact = trajectory.t[np.flatnonzero(np.diff(trajectory.step))[0]]
    around = resample(trajectory, impact + np.linspace(-1e-3, 1e-3, 9))
    soles = sole_ends(biped, world_configurations(biped, around))
    assert np.abs(np.diff(soles, axis=0)).max() < 1e-3  # a swing foot lands at a few cm/s


def test_a_run_that_ends_at_once_can_be_shown(biped, orbit):
    arrays = {name: getattr(orbit, name)[:1] for name in ("t", "q", "dq", "u", "force", "p_fri", "phase", "stance")}
    more = {name: getattr(orbit, name)[:1] for name in ("p_fri_target", "q_b_desired", "stance_y", "step")}
    run = replace(orbit, **arrays, **more)
    motion = world_motion(biped, resample(run, frame_times(run, 30.0)))
    assert motion.q.shape == (1, biped.spatial_model.nq)


def test_orbit_is_what_the_simulator_walks(orbit, walk):
    """Two routes to one motion, both interpolated linearly between samples a few milliseconds apart."""
    times = np.linspace(0.01, 3.1, 50)
    closed_form, simulated = resample(orbit, times), resample(walk, times)
    np.testing.assert_allclose(closed_form.q, simulated.q, atol=1e-3)
    np.testing.assert_allclose(closed_form.force, simulated.force, atol=0.1)
