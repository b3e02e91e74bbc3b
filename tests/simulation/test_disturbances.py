"""Pushes and noise: momentum, ground reaction, repeatability, and two hundred noisy steps."""

import numpy as np
import pytest

from frontal_biped.exceptions import SimulationError
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation import Disturbances, Push, SimulationSettings
from frontal_biped.simulation.pushes import PelvisForce, along_h
from frontal_biped.simulation.sensors import NoisyEncoders, Sensors
from frontal_biped.simulation.walking import simulate

PERIOD = 1e-3


def test_force_at_the_pelvis_does_the_work_of_its_point(biped):
    """Virtual work: torques . dq = force x velocity of the middle of the hips, by differences."""
    rng = np.random.default_rng(0)
    pelvis = PelvisForce(biped)
    for _ in range(5):
        q, dq = rng.uniform(-2.0, -1.2, 4), rng.normal(size=4)
        h = 1e-6
        ends = [biped.joint_positions(q + s * h * dq)[1:3, 0].mean() for s in (1.0, -1.0)]
        assert pelvis.torques(q, 70.0) @ dq == pytest.approx(70.0 * (ends[0] - ends[1]) / (2.0 * h), rel=1e-6)


def test_direction_of_a_push_is_the_worlds(biped):
    force = Push(0.1, 0.05, 2.0).force
    assert along_h(force(0.12), Stance.LEFT) == pytest.approx(-40.0)
    assert along_h(force(0.12), Stance.RIGHT) == pytest.approx(40.0)
    assert force(0.16) == 0.0


def test_push_changes_the_momentum_by_its_impulse(biped, robust_gait):
    """Newton: int (F_h + push) dt = change of horizontal momentum, along a recorded run."""
    push = Push(0.05, 0.04, 3.0)
    run = simulate(
        biped,
        robust_gait,
        steps=1,
        period=PERIOD,
        stabiliser="ankle",
        disturbances=Disturbances(pushes=(push,)),
        simulation_settings=SimulationSettings(record_rate=1000.0),
    )
    keep = (run.t > 0.02) & (run.t < 0.12) & (run.step == 0)
    t, force = run.t[keep], run.force[keep, 0]
    states = list(zip(run.q[keep], run.dq[keep], strict=True))
    momentum = [biped.mass * biped.com_velocity(q, dq)[0] for q, dq in states]
    # the left foot stands first, so a push to the left acts along -h
    assert momentum[-1] - momentum[0] == pytest.approx(np.trapezoid(force, t) - push.impulse, abs=0.05)


def test_same_seed_same_run_other_seed_another(biped, robust_gait):
    def walk(seed):
        noise = Disturbances(encoder_noise=1e-4, torque_noise=0.01, seed=seed)
        return simulate(biped, robust_gait, steps=1, period=PERIOD, stabiliser="ankle", disturbances=noise)

    assert np.array_equal(walk(1).q, walk(1).q)
    assert not np.array_equal(walk(1).q, walk(2).q)


def test_observer_without_noise_follows_the_state(biped, robust_gait):
    q, dq = robust_gait.state_after_impact()
    observer = NoisyEncoders(biped, Sensors(Disturbances()), q, dq + 0.05)
    u, true_q, true_dq = 0.9 * biped.G(q), q.copy(), dq.copy()
    for _ in range(150):
        observer.advance(u, PERIOD)
        middle = biped.forward_dynamics(true_q, true_dq, u)
        later = biped.forward_dynamics(true_q + 0.5 * PERIOD * true_dq, true_dq + 0.5 * PERIOD * middle, u)
        true_q, true_dq = true_q + PERIOD * true_dq + 0.5 * PERIOD**2 * middle, true_dq + PERIOD * later
        observer.read(true_q, PERIOD)
    assert np.max(np.abs(observer.dq - true_dq)) < 2e-3  # from 0.05, time constant 1/80 s


def test_disturbances_need_a_period(biped, robust_gait):
    with pytest.raises(SimulationError, match="control period"):
        simulate(biped, robust_gait, steps=1, period=None, disturbances=Disturbances(encoder_noise=1e-4))


def test_unknown_stabiliser_is_named(biped, robust_gait):
    with pytest.raises(SimulationError, match=r"no stabiliser 'magic'.*adaptive"):
        simulate(biped, robust_gait, steps=1, stabiliser="magic")


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1])
def test_two_hundred_noisy_steps(biped, robust_gait, seed):
    """Bound of the design: 1 kHz, torque noise 1 %, encoder noise 1e-4 rad, no fall."""
    noise = Disturbances(encoder_noise=1e-4, torque_noise=0.01, seed=seed)
    run = simulate(biped, robust_gait, steps=200, period=PERIOD, stabiliser="ankle", disturbances=noise)
    assert run.outcome == "completed"
    assert run.steps_completed == 200
    errors = run.post_impact_speeds / robust_gait.orbit.beta_dot_after_impact - 1.0
    assert np.max(np.abs(errors)) < 0.1
