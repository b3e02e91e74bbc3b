"""The estimator against the dynamics it predicts with, and against dynamics that it does not know."""

import numpy as np
import pytest

from frontal_biped.control.walker.estimator_gains import TABULATED, EstimatorSettings, gain_table, joint_gains
from frontal_biped.control.walker.state_estimator import StateEstimator
from frontal_biped.model.impact import impact
from frontal_biped.model.stance_map import Stance

H = 1e-3  # [s]
START = -0.5 * np.pi + np.array([-0.05, 0.06, 0.04, -0.05])  # [rad]
RATES = np.array([0.2, -0.1, 0.1, -0.2])  # [rad/s]


def move(biped, q, dq, u, extra=None, parts=10):
    """The robot after H under held torques, by ten midpoint steps: two orders finer than the estimator's one."""
    h = H / parts
    forces = u if extra is None else u + extra
    for _ in range(parts):
        ddq = biped.forward_dynamics(q, dq, forces)
        middle = biped.forward_dynamics(q + 0.5 * h * dq, dq + 0.5 * h * ddq, forces)
        q, dq = q + h * dq + 0.5 * h**2 * ddq, dq + h * middle
    return q, dq


def holding(biped, q, dq):
    """Torques that bring the robot to rest where it is."""
    return biped.bias(q, dq) - biped.D(q) @ (20.0 * dq)


def test_prediction_ahead_is_where_the_robot_will_be(biped):
    """Three periods of torques on their way; the remainder of a midpoint step of 1 ms is far below 1e-7 rad."""
    estimator = StateEstimator(biped, H)
    estimator.reset(Stance.LEFT, START, RATES)
    torques = [np.array([5.0, 20.0, -10.0, 1.0]), np.array([-5.0, 10.0, 5.0, 0.0]), np.array([0.0, 30.0, 0.0, -1.0])]
    q, dq = START, RATES
    for u in torques:
        q, dq = move(biped, q, dq, u)
    q_ahead, dq_ahead = estimator.ahead(torques)
    np.testing.assert_allclose(q_ahead, q, atol=1e-7)
    np.testing.assert_allclose(dq_ahead, dq, atol=1e-5)
    np.testing.assert_array_equal(estimator.q, START)  # looking ahead does not move the estimate


@pytest.mark.parametrize("with_rates", [False, True])
def test_a_constant_torque_that_the_model_lacks_is_found(biped, with_rates):
    """Its acceleration D^-1 d, within 5 % after a second, whether or not the rates are read."""
    estimator = StateEstimator(biped, H)
    estimator.reset(Stance.LEFT, START, RATES)
    lacking = np.array([6.0, -3.0, 2.0, 0.1])  # [N m]
    q, dq = START, RATES
    for _ in range(1000):
        u = holding(biped, q, dq) - lacking  # so that it stays near
        estimator.predict(u)
        q, dq = move(biped, q, dq, u, lacking, parts=2)
        estimator.correct(q, dq if with_rates else None)
    expected = np.linalg.solve(biped.D(q), lacking)
    np.testing.assert_allclose(estimator.error, expected, rtol=0.05, atol=0.05)


def test_noise_of_the_encoders_is_taken_out(biped):
    """Positions within half the noise; rates twenty times better than differences of readings (0.14 rad/s)."""
    noise, generator = 1e-4, np.random.default_rng(1)
    estimator = StateEstimator(biped, H)
    estimator.reset(Stance.LEFT, START, RATES)
    q, dq, position, rate = START, RATES, [], []
    for k in range(600):
        u = holding(biped, q, dq)
        estimator.predict(u)
        q, dq = move(biped, q, dq, u, parts=2)
        estimator.correct(q + noise * generator.standard_normal(4))
        if k > 300:
            position.append(estimator.q - q)
            rate.append(estimator.dq - dq)
    assert np.std(position) < 0.5 * noise
    assert np.std(rate) < 0.05 * np.sqrt(2.0) * noise / H


@pytest.mark.parametrize("velocities", [False, True])
def test_one_matrix_takes_the_readings_of_all_joints(velocities):
    """To what the gains of each joint take its own."""
    settings = (EstimatorSettings(), EstimatorSettings(impact_velocity=0.7, blind=0.0))
    both = np.random.default_rng(2).standard_normal((2 if velocities else 1, 2))  # of q (and dq), of either joint
    for k in (0, 3, 7, TABULATED - 1):
        corrections = (joint_gains(settings, H, velocities)[k] @ both.ravel()).reshape(3, 2)
        for joint, one in enumerate(settings):
            own = gain_table(one, H, velocities)[k] @ both[:, joint]
            np.testing.assert_allclose(corrections[:, joint], own, rtol=1e-13, atol=1e-13)


@pytest.mark.filterwarnings("ignore:invalid value")
def test_an_infinite_reading_is_one_joint_s_own(biped):
    """The others are estimated as ever."""
    broken, sound = (StateEstimator(biped, H) for _ in range(2))
    for estimator in (broken, sound):
        estimator.reset(Stance.LEFT, START, RATES)
    read = START + 1e-3
    sound.correct(read, RATES)
    read[2] = np.inf
    broken.correct(read, RATES)
    others = [0, 1, 3]
    for seen, expected in ((broken.q, sound.q), (broken.dq, sound.dq), (broken.error, sound.error)):
        assert np.isfinite(seen).all()
        np.testing.assert_allclose(seen[others], expected[others], rtol=1e-13)


def test_landing_is_the_impact_of_the_model(biped):
    estimator = StateEstimator(biped, H)
    q = np.array([-1.66, -1.45, -1.68, -1.49])
    estimator.reset(Stance.LEFT, q, RATES)
    estimator.error[:] = 1.0
    before = estimator.q + np.array([0.0, 0.0, 0.0, 0.01])
    estimator.q[:] = before
    expected = impact(biped, before, RATES)
    tilt = float(biped.swing_foot_rotation(before))
    estimator.land()
    np.testing.assert_allclose(estimator.dq, expected.dq_plus)
    # the leg keeps its absolute angle when the foot is taken for flat
    assert abs(float(biped.pelvis_roll(estimator.q)) + float(biped.pelvis_roll(before))) < abs(tilt) + 1e-12
    assert biped.pelvis_roll(estimator.q) == pytest.approx(-float(biped.pelvis_roll(before)), abs=1e-12)
    np.testing.assert_array_equal(estimator.error, np.zeros(4))  # the other foot has not erred yet


def test_each_foot_remembers_its_error(biped):
    estimator = StateEstimator(biped, H)
    estimator.reset(Stance.LEFT, START, RATES)
    estimator.error[:] = np.array([1.0, 2.0, 3.0, 4.0])
    estimator.land()
    estimator.error[:] = np.array([-1.0, -2.0, -3.0, -4.0])
    estimator.land()
    np.testing.assert_array_equal(estimator.error, [1.0, 2.0, 3.0, 4.0])
