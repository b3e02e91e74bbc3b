"""Where a watch tells of no event, a look finds none; and it is rarely asked to look."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from frontal_biped.model import State
from frontal_biped.model.chain import UPRIGHT
from frontal_biped.simulation.guard_watch import GuardWatch, reaches
from frontal_biped.simulation.hybrid_system import walking_guards

angles = st.lists(st.floats(-3.2, 3.2), min_size=4, max_size=4).map(np.array)
small = st.lists(st.floats(-0.2, 0.2), min_size=4, max_size=4).map(np.array)
LIFTED = UPRIGHT + np.array([0.0, 0.0, 0.1, 0.0])
"""Upright but for the swing leg, which is off the ground [rad]."""

phases = st.sampled_from(("rising", "falling"))


@given(q=angles, change=angles)
def test_no_point_comes_farther_than_the_reaches_say(biped, q, change):
    reach = np.array(reaches(biped.chain))
    before, after = (np.array([*biped.swing_sole(at), biped.com(at)]) for at in (q, q + change))
    assert np.linalg.norm(after - before, axis=1).max() <= reach @ np.abs(change) + 1e-12


def test_the_reaches_of_a_stretched_chain_are_attained(biped):
    """From the ankle: leg, hips, leg and the sole's farther end; from the other one the sole's end alone."""
    end = np.hypot(max(biped.chain.sole_inner, biped.chain.sole_outer), biped.ankle_height)
    whole = 2.0 * biped.leg_length + biped.hip_width + end
    assert reaches(biped.chain) == pytest.approx(
        (whole, whole - biped.leg_length, biped.leg_length + end, end), rel=1e-12
    )


@given(q=small, change=small, rate=st.floats(-1.0, 1.0), phase=phases)
def test_where_no_event_is_told_of_every_guard_is_positive(biped, q, change, rate, phase):
    guards = getattr(walking_guards(biped), phase)
    begun, rates = State(LIFTED + q, np.zeros(4)), np.array([rate, 0.0, 0.0, 0.0])
    watch = GuardWatch(guards, reaches(biped.chain), begun)
    after = State(begun.q + change, rates)
    told, values = watch.look(after), guards.values(*after)
    assert told == (values if min(values) <= 0.0 else None)


def test_a_motion_far_from_events_is_not_looked_at(biped):
    """A swing foot 2 cm above the ground: a pose near by needs no kinematics; one with the foot down does."""
    guards = walking_guards(biped).rising
    raised = UPRIGHT + np.array([0.1, 0.0, 0.0, -0.1])
    watch, rates = GuardWatch(guards, reaches(biped.chain), State(raised, np.ones(4))), np.ones(4)
    assert watch._room > 0.01
    begun = watch._pose
    assert watch.look(State(raised + 1e-3, rates)) is None
    assert watch._pose is begun
    lowered = State(raised - [0.2, 0.0, 0.0, 0.0], rates)
    assert watch.look(lowered) == guards.values(*lowered)
