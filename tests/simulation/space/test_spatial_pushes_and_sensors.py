"""Pushes in space, and what sensors make of the true state."""

import numpy as np
import pinocchio as pin
import pytest

from frontal_biped.control.spatial_walker.interface import SpatialReading
from frontal_biped.exceptions import SimulationError
from frontal_biped.simulation.disturbances import Disturbances
from frontal_biped.simulation.space.pushes import SpatialPush, SpatialPushForces
from frontal_biped.simulation.space.sensors import SpatialSensors
from frontal_biped.simulation.space.settings import SpatialSettings
from frontal_biped.virtual_constraints.phase import StepPhase

SAMPLES = 4000
SPREAD = 0.1
"""Relative error of a standard deviation from so many samples: 6 of its own standard deviations."""


@pytest.mark.parametrize("profile", ["constant", "half-sine"])
def test_force_integrates_to_the_impulse(profile):
    push = SpatialPush(0.1, 0.2, (3.0, -2.0, 0.5), profile=profile)
    times = np.linspace(0.0, 0.4, 4001)
    forces = np.array([push.force(t) for t in times])
    np.testing.assert_allclose(forces.sum(axis=0) * (times[1] - times[0]), push.impulse, rtol=1e-3)
    assert not forces[times < 0.1 - 1e-6].any()
    assert not forces[times > 0.3].any()


def test_pushes_of_a_phase_wait_for_it():
    forces = SpatialPushForces(
        [SpatialPush(0.0, 0.1, (1.0, 0.0, 0.0), "arm", (0.1, 0.0, 0.0), step=1, phase="falling")]
    )
    assert forces.at(0.0) == []
    forces.begin(0.3, 0, StepPhase.FALLING)
    forces.begin(0.5, 1, StepPhase.RISING)
    assert forces.at(0.5) == []
    forces.begin(0.7, 1, StepPhase.FALLING)
    forces.begin(0.9, 1, StepPhase.FALLING)  # turned outwards and back: only the first counts
    (acting,) = forces.at(0.7)
    assert acting.force.tolist() == [10.0, 0.0, 0.0]
    assert acting.link == "arm"
    assert acting.point.tolist() == [0.1, 0.0, 0.0]
    assert forces.at(0.81) == []


@pytest.mark.parametrize(
    ("wrong", "match"),
    [
        ({"duration": 0.0}, "duration"),
        ({"start": -1.0}, "start"),
        ({"impulse": (1.0, 2.0)}, "impulse"),
        ({"impulse": (1.0, float("nan"), 0.0)}, "impulse"),
        ({"point": (0.0,)}, "point"),
        ({"profile": "square"}, "profile"),
        ({"step": 3}, "belong together"),
        ({"step": 3, "phase": "flying"}, "phase"),
    ],
)
def test_what_makes_no_push_is_refused(wrong, match):
    with pytest.raises(SimulationError, match=match):
        SpatialPush(**{"start": 0.0, "duration": 0.1, "impulse": (1.0, 0.0, 0.0)} | wrong)


# ---------------------------------------------------------------------- sensors
def true_reading(n=6):
    generator = np.random.default_rng(0)
    rotation = pin.rpy.rpyToMatrix(0.1, -0.2, 0.3)
    return SpatialReading(
        0.5, generator.normal(size=n), generator.normal(size=n), rotation, generator.normal(size=3), (True, False)
    )


def read(count=1, velocity_noise=None, **disturbances):
    sensors = SpatialSensors(SpatialSettings(disturbances=Disturbances(**disturbances), velocity_noise=velocity_noise))
    return [sensors.read(true_reading()) for _ in range(count)]


def test_without_noise_sensors_tell_the_truth():
    (reading,), true = read(), true_reading()
    for name in vars(true):
        assert np.array_equal(getattr(reading, name), getattr(true, name)), name


def test_noise_has_the_size_that_is_asked_for():
    noise = {"encoder_noise": 1e-4, "imu_noise": 2e-3, "gyro_noise": 5e-3}
    readings, true = read(SAMPLES, velocity_noise=0.02, **noise), true_reading()
    errors = {
        "encoder_noise": [each.joint_positions - true.joint_positions for each in readings],
        "imu_noise": [pin.log3(true.base_rotation.T @ each.base_rotation) for each in readings],
        "gyro_noise": [each.base_angular_velocity - true.base_angular_velocity for each in readings],
    }
    for key, size in noise.items():
        assert np.std(errors[key], axis=0) == pytest.approx(np.full(np.shape(errors[key])[1], size), rel=SPREAD), key
        assert np.abs(np.mean(errors[key], axis=0)).max() < SPREAD * size
    rates = np.array([each.joint_velocities for each in readings]) - true.joint_velocities
    assert np.std(rates) == pytest.approx(0.02, rel=SPREAD)
    for each in readings[:5]:
        np.testing.assert_allclose(each.base_rotation @ each.base_rotation.T, np.eye(3), atol=1e-12)


def test_rates_behind_noisy_encoders_are_left_out():
    assert read(encoder_noise=1e-4)[0].joint_velocities is None
    assert read(quantisation=1e-4)[0].joint_velocities is None
    assert read(imu_noise=1e-3)[0].joint_velocities is not None
    assert np.array_equal(
        read(encoder_noise=1e-4, velocity_noise=0.0)[0].joint_velocities, true_reading().joint_velocities
    )


def test_the_same_seed_reads_the_same():
    noise = {"encoder_noise": 1e-4, "imu_noise": 2e-3, "gyro_noise": 5e-3}
    first, again, other = (read(3, **noise, seed=seed)[2] for seed in (4, 4, 5))
    assert np.array_equal(first.joint_positions, again.joint_positions)
    assert np.array_equal(first.base_rotation, again.base_rotation)
    assert not np.array_equal(first.joint_positions, other.joint_positions)
