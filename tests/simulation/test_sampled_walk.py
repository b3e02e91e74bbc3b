"""Walks that go on in copies are walks from the start, to the last bit."""

from dataclasses import replace

import numpy as np
import pytest

from frontal_biped.control import make_stabiliser
from frontal_biped.control.controller import QpController
from frontal_biped.exceptions import SimulationError
from frontal_biped.simulation import Disturbances, Push, SimulationSettings
from frontal_biped.simulation.event_driven import begin_walk
from frontal_biped.simulation.hybrid_system import EventKind
from frontal_biped.simulation.walking import sampled_settings, start_state

PERIOD = 1e-3
SETTINGS = SimulationSettings(steps=2, period=PERIOD, disturbances=Disturbances(rolls=True))


def control(biped, gait):
    return QpController(biped, gait, sampled_settings(gait, PERIOD), make_stabiliser("re-anchored", biped, gait))


def begun(biped, gait, controller, *pushes, **disturbances):
    settings = replace(SETTINGS, disturbances=replace(SETTINGS.disturbances, pushes=pushes, **disturbances))
    return begin_walk(biped, controller, start_state(gait), settings)


def seen(walk):
    return walk.outcome, walk.told.speeds, np.concatenate(walk.told.engine.state).tolist()


@pytest.mark.parametrize("phase", ["rising", "falling"])
def test_a_copy_walks_as_if_it_had_been_pushed_from_its_start(biped, robust_gait, phase):
    """A small push and one that fells, each in the middle of a phase; the original and the other copy do not matter."""
    step = robust_gait.step(biped)
    at = 0.5 * step.rising.duration if phase == "rising" else step.rising.duration + 0.5 * step.falling.duration
    controller = control(biped, robust_gait)
    walk = begun(biped, robust_gait, controller)
    walk.walk_until(at)
    here = walk.told.engine.state
    found = {}
    for impulse in (64.0, -3.0, 0.5):
        pushed = walk.copy(controller.copy(), [Push(at, 0.05, impulse)])
        pushed.walk()
        found[impulse] = seen(pushed)
    assert found[64.0][0] in {EventKind.ROLLED.value, EventKind.TIPPED_OUTWARDS.value}
    assert walk.told.engine.state is here
    assert walk.outcome is None
    for impulse, expected in found.items():
        whole = begun(biped, robust_gait, control(biped, robust_gait), Push(at, 0.05, impulse))
        whole.walk()
        assert seen(whole) == expected


def test_a_push_of_a_phase_that_has_begun_counts_from_there(biped, robust_gait):
    up = robust_gait.step(biped).rising.duration
    push, controller = Push(0.3, 0.05, 2.0, step=0, phase="falling"), control(biped, robust_gait)
    walk = begun(biped, robust_gait, controller)
    walk.walk_until(up + 0.1)
    copy, whole = walk.copy(controller.copy(), [push]), begun(biped, robust_gait, control(biped, robust_gait), push)
    copy.walk()
    whole.walk()
    assert seen(copy) == seen(whole)


def test_a_walk_that_ends_before_the_time_is_over(biped, robust_gait):
    controller = control(biped, robust_gait)
    walk = begun(biped, robust_gait, controller, Push(0.0, 0.05, 64.0))
    walk.walk_until(1.0)
    assert walk.outcome is not None
    assert walk.copy(controller.copy(), []).walk() == walk.walk() == walk.outcome


def test_observers_of_noisy_sensors_are_not_copied(biped, robust_gait):
    controller = control(biped, robust_gait)
    walk = begun(biped, robust_gait, controller, encoder_noise=1e-5)
    walk.walk_until(0.002)
    with pytest.raises(SimulationError, match="noisy"):
        walk.copy(controller.copy(), [])
