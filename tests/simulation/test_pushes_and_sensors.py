"""Pushes by phase and profile, forces above the hips, encoders with steps, the delay line, landing heights."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from frontal_biped.control.interface import Reading
from frontal_biped.exceptions import SimulationError
from frontal_biped.simulation import Disturbances, Push
from frontal_biped.simulation.motors import DelayLine
from frontal_biped.simulation.pushes import PelvisForce, PushForces
from frontal_biped.simulation.sensors import Sensors
from frontal_biped.virtual_constraints.phase import StepPhase


@given(st.floats(0.0, 2.0), st.floats(0.01, 0.5), st.floats(-20.0, 20.0), st.sampled_from(["constant", "half-sine"]))
def test_every_profile_gives_its_impulse(start, duration, impulse, profile):
    push = Push(start, duration, impulse, profile)
    # midpoint rule over the push itself: exact for the constant one, 1e-6 for the half-sine
    t = start + duration * (np.arange(1000) + 0.5) / 1000
    given_impulse = sum(push.force(float(x)) for x in t) * duration / 1000
    assert given_impulse == pytest.approx(impulse, rel=1e-5, abs=1e-12)
    assert push.force(start - 1e-6) == push.force(start + duration + 1e-6) == 0.0


def test_push_of_a_phase_waits_for_it_and_comes_once():
    forces = PushForces((Push(0.1, 0.05, 1.0, step=2, phase="falling"), Push(0.3, 0.1, 2.0, height=0.2)))
    assert forces.at(0.35) == [(pytest.approx(20.0), 0.2)]
    forces.begin(0.9, 2, StepPhase.RISING)
    forces.begin(1.0, 1, StepPhase.FALLING)
    assert forces.at(1.12) == []
    forces.begin(1.3, 2, StepPhase.FALLING)
    forces.begin(1.5, 2, StepPhase.FALLING)  # turned outwards and back: not pushed again
    assert forces.at(1.42) == [(pytest.approx(20.0), 0.0)]
    assert forces.at(1.62) == []


def test_force_above_the_hips_does_the_work_of_its_point(biped):
    """Virtual work: torques . dq = force x velocity of the point on the torso, by differences."""
    rng = np.random.default_rng(0)
    pelvis, height, h = PelvisForce(biped), 0.35, 1e-6

    def point(q):
        hips = biped.joint_positions(q)[1:3]
        across = (hips[1] - hips[0]) / np.linalg.norm(hips[1] - hips[0])
        return hips.mean(axis=0) + height * np.array([-across[1], across[0]])

    for _ in range(5):
        q, dq = rng.uniform(-2.0, -1.2, 4), rng.normal(size=4)
        velocity = (point(q + h * dq) - point(q - h * dq))[0] / (2.0 * h)
        assert pelvis.torques(q, 70.0, height) @ dq == pytest.approx(70.0 * velocity, rel=1e-6)
        assert pelvis.height(q, height) == pytest.approx(point(q)[1], rel=1e-12)


def test_encoder_steps_and_noise():
    positions = np.array([0.1234, -0.5, 0.0, 1.0])
    coarse = Sensors(Disturbances(quantisation=0.01)).joints(positions)
    assert np.allclose(coarse / 0.01, np.round(coarse / 0.01))
    assert np.max(np.abs(coarse - positions)) <= 0.005
    noisy = Sensors(Disturbances(encoder_noise=1e-3, seed=4))
    readings = np.array([noisy.joints(positions) for _ in range(2000)])
    # standard error of a standard deviation from 8000 draws is 0.8 %
    assert np.std(readings - positions) == pytest.approx(1e-3, rel=0.03)


@pytest.mark.parametrize(
    ("disturbances", "rates"), [({}, True), ({"encoder_noise": 1e-4}, False), ({"quantisation": 1e-3}, False)]
)
def test_rates_are_only_read_from_perfect_encoders(disturbances, rates):
    true = Reading(0.0, np.zeros(4), np.ones(4), 0.1, 0.2, (True, False))
    read = Sensors(Disturbances(**disturbances)).read(true)
    assert (read.joint_velocities is not None) is rates
    assert (read.base_roll, read.base_roll_rate, read.contact) == (0.1, 0.2, (True, False))


@given(st.integers(0, 6))
def test_delay_line_is_late_by_its_ticks(ticks):
    line = DelayLine(ticks)
    sent = [np.full(4, float(i)) for i in range(12)]
    arrived = [float(line.push(u)[0]) for u in sent]
    assert arrived == [float(max(0, i - ticks)) for i in range(12)]


def test_landing_heights_are_given_then_drawn():
    uneven = Disturbances(ground=(0.01, -0.02), ground_height=0.003, seed=3)
    heights = uneven.landing_heights(50)
    assert np.array_equal(heights[:2], [0.01, -0.02])
    assert np.max(np.abs(heights[2:])) <= 0.003
    assert np.array_equal(heights[:20], uneven.landing_heights(20))  # more steps do not change the first ones
    # other disturbances leave the ground as it is
    noisier = Disturbances(ground=(0.01, -0.02), ground_height=0.003, seed=3, encoder_noise=1.0, torque_noise=0.1)
    assert np.array_equal(noisier.landing_heights(50), heights)


@pytest.mark.parametrize(
    ("make", "complaint"),
    [
        (lambda: Push(0.0, 0.0, 1.0), "duration"),
        (lambda: Push(-1.0, 0.1, 1.0), "start"),
        (lambda: Push(0.0, 0.1, 1.0, "square"), "constant, half-sine"),
        (lambda: Push(0.0, 0.1, 1.0, step=1), "belong together"),
        (lambda: Push(0.0, 0.1, 1.0, step=1, phase="swing"), "rising"),
        (lambda: Disturbances(delay=-1.0), "delay"),
        (lambda: Disturbances(friction=0.0), "friction"),
        (lambda: Disturbances(torque_limits=(1.0, 0.0)), "torque_limits"),
    ],
)
def test_impossible_disturbances_are_refused(make, complaint):
    with pytest.raises(SimulationError, match=complaint):
        make()
