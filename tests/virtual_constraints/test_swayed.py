"""Virtual constraints over the sway: the planned poses at the planned places, from wherever a phase begins."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from whole_robots import whole

from frontal_biped.exceptions import SimulationError
from frontal_biped.virtual_constraints.phase import StepPhase
from frontal_biped.virtual_constraints.swayed import BEYOND, LEAST_RANGE, SwayedPhase, runs_one_way, sways

SPLINE = 1e-4
"""What cubics between 81 points leave of a pose [rad], and of the FRI target [m]."""

NAMES = ("talos_full", "romeo_bent")


def planned(name, phase):
    robot = whole(name)
    return robot, robot.gait.rising if phase is StepPhase.RISING else robot.gait.falling


@pytest.fixture(scope="module", params=[(name, phase) for name in NAMES for phase in StepPhase])
def case(request):
    robot, phase = planned(*request.param)
    return robot, phase, SwayedPhase(robot.biped, phase)


def test_as_planned_it_is_the_plan(case):
    robot, phase, swayed = case
    begun = swayed.begun_as_planned()
    motion = phase.motion(np.linspace(phase.beta_start, phase.beta_end, 97))
    for s, q, dq, p_fri in zip(sways(robot.biped, motion.q), motion.q, motion.dq, motion.p_fri, strict=True):
        asked = begun.at(float(s))
        np.testing.assert_allclose(asked.h_d, q[1:], atol=SPLINE)
        assert asked.p_fri == pytest.approx(p_fri, abs=SPLINE)
        slope = dq[1:] / robot.biped.com_velocity(q, dq)[0]  # chain rule through beta
        np.testing.assert_allclose(asked.h_d1, slope, atol=0.02 * max(1.0, np.abs(slope).max()))


shift = st.floats(-0.02, 0.02)
turn = st.floats(-0.05, 0.05)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("which", StepPhase)
@given(shift=shift, error=st.tuples(turn, turn, turn), slope=st.tuples(*[st.floats(-5.0, 5.0)] * 3))
@settings(max_examples=25, deadline=None)
def test_it_begins_where_the_robot_is(name, which, shift, error, slope):
    """In pose and slope; ends in the planned pose; goes on smoothly past both ends."""
    robot, phase = planned(name, which)
    swayed = SwayedPhase(robot.biped, phase)
    s = swayed.start + shift
    sense = np.sign(swayed.end - swayed.start)
    end = s + sense * max(sense * (swayed.end - s), LEAST_RANGE)
    pose = swayed.begun_as_planned().at(swayed.start).h_d + error
    begun = swayed.begun(s, pose, np.array(slope))
    np.testing.assert_allclose(begun.at(s).h_d, pose, atol=1e-12)
    np.testing.assert_allclose(begun.at(s).h_d1, slope, atol=1e-9)
    np.testing.assert_allclose(begun.at(end).h_d, swayed.begun_as_planned().at(swayed.end).h_d, atol=1e-9)
    for edge in (s, end):
        step = 1e-7
        before, after = begun.at(edge - step), begun.at(edge + step)
        np.testing.assert_allclose(before.h_d, after.h_d, atol=1e-4)
        np.testing.assert_allclose(before.h_d1, after.h_d1, atol=1e-2 * max(1.0, np.abs(before.h_d1).max()))


def test_derivatives_are_derivatives(case):
    """Inside, and past both ends."""
    *_, swayed = case
    length = swayed.end - swayed.start
    pose = swayed.begun_as_planned().at(swayed.start).h_d + 0.03
    begun = swayed.begun(swayed.start, pose, np.array([1.0, -2.0, 3.0]))
    h = 1e-7 * abs(length)
    for u in (-0.3, -0.05, 0.07, 0.19, 0.33, 0.61, 0.93, 1.02, 1.4):
        s = swayed.start + u * length
        low, at, high = (begun.at(s + d) for d in (-h, 0.0, h))
        scale = max(1.0, np.abs(at.h_d1).max())
        np.testing.assert_allclose((high.h_d - low.h_d) / (2.0 * h), at.h_d1, atol=1e-4 * scale)
        scale = max(1.0, np.abs(at.h_d2).max())
        np.testing.assert_allclose((high.h_d1 - low.h_d1) / (2.0 * h), at.h_d2, atol=1e-3 * scale)


def test_begun_on_its_way_it_is_what_is_left_of_the_plan(case):
    """Nothing is bent where there is nothing to correct."""
    *_, swayed = case
    whole_way = swayed.begun_as_planned()
    s = swayed.start + 0.2 * (swayed.end - swayed.start)
    here = whole_way.at(s)
    begun = swayed.begun(s, here.h_d, here.h_d1)
    for u in np.linspace(0.2, 1.0, 17):
        there = swayed.start + u * (swayed.end - swayed.start)
        np.testing.assert_allclose(begun.at(there).h_d, whole_way.at(there).h_d, atol=1e-9)


def test_past_its_end_it_comes_to_rest(case):
    *_, swayed = case
    begun = swayed.begun_as_planned()
    length = swayed.end - swayed.start
    far = begun.at(swayed.end + 20.0 * BEYOND * length)
    np.testing.assert_allclose(far.h_d1, 0.0, atol=1e-6)
    at_end = begun.at(swayed.end)
    np.testing.assert_allclose(far.h_d, at_end.h_d + at_end.h_d1 * BEYOND * length, atol=1e-6)


def test_a_centre_of_mass_that_turns_back_is_refused():
    robot = whole("talos_full")
    q = robot.gait.rising.motion(np.linspace(robot.gait.rising.beta_start, robot.gait.rising.beta_end, 5)).q
    with pytest.raises(SimulationError, match="turns back along a phase"):
        sways(robot.biped, np.vstack([q, q[:2]]))


def test_a_robot_of_heavy_legs_sways_the_other_way(biped, low_torso, reference_gait):
    """The low torso's centre of mass moves inwards while it rises: one way, but not one to be followed over."""
    low = low_torso
    phases = (reference_gait.rising, reference_gait.falling)
    assert runs_one_way(biped, phases)
    q = reference_gait.rising.motion(np.linspace(reference_gait.rising.beta_start, reference_gait.beta_reversal, 9)).q
    inwards = np.diff([low.com(row)[0] for row in q])
    assert (inwards > 0.0).any()
    assert not runs_one_way(low, phases)
