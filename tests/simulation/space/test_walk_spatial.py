"""Walks in space from one call: robot and gait in, run out, in MuJoCo, from sensor readings alone."""

import numpy as np
import pytest
from whole_robots import whole

from frontal_biped.simulation.disturbances import Disturbances
from frontal_biped.simulation.hybrid_system import EventKind
from frontal_biped.simulation.space.walk_spatial import walk_spatial

pytest.importorskip("mujoco")

DURATION = 0.01
"""Of a step on the spot, from the closed form of the planar gait [-]."""

EVERY = {"romeo_bent": 0.03, "g1_bent": 0.05, "icub_bent": 0.03, "simple_humanoid_bent": 0.05}
"""The same of every single step, the first ones after the start among them."""

FORWARDS = 0.02
"""The same at speed."""

SPEED = 0.1
"""Of the commanded speed, once it has been approached [-]."""

SPOT = 0.05
"""How far a robot on the spot may be from where it began [m]."""

NOISE = Disturbances(encoder_noise=1e-4, imu_noise=1e-3, gyro_noise=5e-3, delay=3e-3)
"""Standard deviations [rad, rad, rad/s], and the delay [s], which the walker knows."""


def impacts(run):
    """Times of start and landings [s]."""
    return np.array([t for t, kind in zip(run.event_t, run.event_kind, strict=True) if kind == EventKind.IMPACT.name])


def durations(run, robot):
    """Of every step, landing to landing, over that of the closed form [-]."""
    taken = np.diff(impacts(run)) / robot.gait.step(robot.biped).duration
    assert len(taken) == run.steps_completed
    return taken


@pytest.mark.slow
def test_talos_on_the_spot():
    """Four steps: a step takes what the closed form says, every tick is solved with all limits kept."""
    robot = whole("talos_full")
    run = walk_spatial(robot.biped, robot.gait, steps=4)
    assert run.outcome == "completed" and run.steps_completed == 4
    assert np.abs(durations(run, robot) - 1.0).max() < DURATION
    assert np.abs(run.com[-1] - run.com[0])[0] < SPOT
    assert np.all(run.solved == 1)
    assert run.settings["controller"]["landings"] == 4
    assert run.settings["measured"]["beyond_range"]["largest"] == 0.0


@pytest.mark.slow
@pytest.mark.parametrize("name", ["romeo_bent", "g1_bent", "icub_bent", "simple_humanoid_bent"])
def test_others_on_the_spot(name):
    robot = whole(name)
    run = walk_spatial(robot.biped, robot.gait, steps=6)
    assert run.outcome == "completed" and run.steps_completed == 6
    assert abs(np.median(durations(run, robot)) - 1.0) < DURATION
    assert np.abs(durations(run, robot) - 1.0).max() < EVERY[name]
    assert np.abs(run.com[-1] - run.com[0])[0] < SPOT
    assert run.settings["controller"]["held"] == run.settings["controller"]["relaxed"] == 0


@pytest.mark.slow
@pytest.mark.parametrize("disturbances", [Disturbances(), NOISE], ids=["exact", "noise and delay"])
def test_talos_forwards(disturbances):
    """Ten steps; the speed is reached within the first four."""
    robot, speed = whole("talos_full"), 0.2
    run = walk_spatial(robot.biped, robot.gait, speed=speed, steps=10, disturbances=disturbances)
    assert run.outcome == "completed"
    at = impacts(run)
    speeds = np.diff(np.interp(at, run.t, run.com[:, 0])) / np.diff(at)
    np.testing.assert_allclose(speeds[4:], speed, rtol=SPEED)
    assert np.abs(durations(run, robot) - 1.0).max() < FORWARDS
    assert run.settings["controller"]["held"] == 0
