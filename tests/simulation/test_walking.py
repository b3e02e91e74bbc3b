"""Two routes to one number: the closed form of the zero dynamics against the full model in closed loop."""

import numpy as np
import pytest

from frontal_biped.analysis.sensitivity import simulated_multiplier, speed_error_outcome
from frontal_biped.control import ControllerSettings
from frontal_biped.control.controller import QpController
from frontal_biped.control.settings import sampled_frequency
from frontal_biped.model.state import State
from frontal_biped.simulation import SimulationSettings, simulate_walk
from frontal_biped.simulation.walking import simulate
from frontal_biped.virtual_constraints.phase import StepPhase
from frontal_biped.zero_dynamics.orbit import resample
from frontal_biped.zero_dynamics.poincare import HybridZeroDynamics
from frontal_biped.zero_dynamics.restricted import restrict

POST_IMPACT_STATE = 1e-7  # bound of the design; integrator at rtol 1e-10, contraction 0.76 a step
OUTPUT_CONTINUOUS = 1e-8  # [rad] on Z the output is zero, what remains is the integrator's error
MULTIPLIER = 1e-4  # relative; central difference of step 1e-4 of a smooth map
ZETA_ON_RUN = 1e-7  # relative to the largest zeta; integrator's error again
HALF_AN_ORDER = 0.5
STEPS = 20


@pytest.fixture(scope="module", params=["reference", "level"])
def gait(request, reference_gait, level_gait):
    return reference_gait if request.param == "reference" else level_gait


@pytest.fixture(scope="module")
def run(biped, gait):
    return simulate(biped, gait, steps=STEPS, period=None)


@pytest.mark.slow
class TestContinuousControl:
    def test_twenty_steps_return_to_the_same_state(self, run):
        assert run.outcome == "completed"
        assert run.steps_completed == STEPS
        states = run.post_impact_states()
        assert len(states) == STEPS + 1
        assert np.max(np.abs(states - states[0])) < POST_IMPACT_STATE

    def test_every_control_tick_was_solved(self, run):
        controller = run.settings["controller"]
        assert controller["ticks"] > 1000
        assert controller["unsolved"] == 0

    def test_outputs_stay_on_the_virtual_constraints(self, run):
        assert np.max(np.abs(run.output_error)) < OUTPUT_CONTINUOUS

    def test_fri_follows_its_target(self, run):
        assert np.max(np.abs(run.p_fri - run.p_fri_target)) < 1e-8

    def test_step_time_is_the_closed_form_one(self, run, gait):
        impacts = run.event_t[run.events("IMPACT")]
        assert np.diff(impacts) == pytest.approx(gait.orbit.step_duration, rel=1e-8)

    def test_reversal_is_where_the_closed_form_puts_it(self, run, gait):
        states = run.event_state[run.events("REVERSAL")]
        assert states[:, 0] == pytest.approx(gait.beta_reversal, abs=1e-9)
        assert np.max(np.abs(states[:, 4])) < 1e-9

    def test_zeta_along_the_run_solves_the_closed_form(self, run, gait, biped):
        """zeta + V_Z = delta^2 zeta+ along a rollout: zeta of the full model against the integrated one."""
        orbit = gait.step(biped)
        for phase, sign, closed in ((gait.rising, 1.0, orbit.rising), (gait.falling, -1.0, orbit.falling)):
            keep = (run.step == 3) & (run.phase == sign)
            # in order of growing distance from the reversal
            order = np.argsort(-run.q[keep, 0])
            beta, dbeta = run.q[keep, 0][order], run.dq[keep, 0][order]
            tau = np.sqrt(np.clip((closed.beta[0] - beta) / closed.Delta, 0.0, 1.0))
            expected = resample(biped, phase, closed, tau).zeta
            sigma = restrict(biped, phase, beta).I_P * dbeta
            assert np.max(np.abs(0.5 * sigma**2 - expected)) < ZETA_ON_RUN * np.max(expected)

    def test_contact_constraints_hold_along_the_run(self, run, biped, gait):
        friction = gait.specification.friction
        assert np.all(run.force[:, 1] > gait.specification.min_normal_force * biped.weight)
        assert np.all(np.abs(run.force[:, 0]) < friction * run.force[:, 1])
        outer, inner = biped.sole
        assert np.all((run.p_fri > outer) & (run.p_fri < inner))
        assert np.all(np.abs(run.u) < biped.max_torque)

    def test_work_of_the_joints_is_the_change_of_energy(self, run, biped):
        for step, phase in ((0, 1.0), (1, -1.0)):
            keep = (run.step == step) & (run.phase == phase)
            t, power = run.t[keep], np.sum(run.u[keep] * run.dq[keep], axis=1)
            work = np.trapezoid(power, t)
            states = zip(run.q[keep][[0, -1]], run.dq[keep][[0, -1]], strict=True)
            energy = [biped.energy(q, dq) for q, dq in states]
            # trapezoidal rule at 250 samples a second
            assert work == pytest.approx(energy[1] - energy[0], abs=2e-3 * max(1.0, np.max(np.abs(power))))

    def test_feet_alternate_on_the_spot(self, run, gait):
        first = [run.stance[run.step == step][0] for step in range(4)]
        assert first == [1.0, -1.0, 1.0, -1.0]
        for side in (1.0, -1.0):
            y = run.stance_y[run.stance == side]
            assert y == pytest.approx(0.5 * side * gait.step_width, abs=1e-8)


@pytest.mark.slow
def test_multiplier_of_the_full_model(biped, gait):
    closed = HybridZeroDynamics(biped, gait.step(biped)).multiplier
    assert simulated_multiplier(biped, gait) == pytest.approx(closed, rel=MULTIPLIER)


@pytest.mark.slow
class TestSampledControl:
    def test_twenty_steps_at_one_kilohertz(self, biped, gait):
        run = simulate(biped, gait, steps=STEPS, period=1e-3, stabiliser="adaptive")
        assert run.outcome == "completed"
        assert run.steps_completed == STEPS

    def test_errors_are_of_first_order_in_the_period(self, biped, gait):
        """A held torque lags by half a period. A kink at an event would show as half an order more or less."""
        periods = np.array([2e-3, 1e-3, 5e-4])
        gains = ControllerSettings.for_gait(gait)  # the same for every period; by default they rise with the rate
        told = {"steps": 1, "stabiliser": "adaptive", "controller_settings": gains}
        runs = [simulate(biped, gait, period=T, **told) for T in periods]
        speed, reversal = gait.orbit.beta_dot_after_impact, gait.beta_reversal
        errors = [
            (
                np.max(np.abs(run.output_error)),
                abs(run.post_impact_speeds[-1] - speed),
                abs(run.event_state[run.events("REVERSAL")][0, 0] - reversal),
            )
            for run in runs
        ]
        orders = np.diff(np.log(errors), axis=0) / np.diff(np.log(periods))[:, None]
        assert orders == pytest.approx(1.0, abs=HALF_AN_ORDER / 2.0)


@pytest.mark.slow
def test_speed_errors_are_reported_as_they_are(biped, reference_gait):
    small = speed_error_outcome(biped, reference_gait, 1e-4, steps=2)
    assert small.outcome == "completed"
    assert small.reversal_shift > 0.0  # more energy rises further
    # to first order the restricted map acts: two steps multiply the error by the multiplier squared
    expected = 1e-4 * reference_gait.orbit.multiplier**2
    assert small.final_speed_error == pytest.approx(expected, rel=0.05)
    # a reversal past the planned one leaves the polynomials where they were planned: invariance is lost
    large = speed_error_outcome(biped, reference_gait, 0.01, steps=1)
    assert large.worst_output_error > 100.0 * small.worst_output_error
    assert "rad of invariance" in str(large)


def test_sampled_gains_follow_the_rate():
    assert sampled_frequency(1e-3) == pytest.approx(100.0)
    assert sampled_frequency(4e-3) == pytest.approx(25.0)
    assert sampled_frequency(1e-4) == 100.0


@pytest.mark.parametrize("period", [None, 1e-3])
def test_a_controller_is_told_of_the_phases_that_are_walked_and_of_no_other(biped, gait, period):
    """What a stabiliser answers after the last landing nobody would walk, and looking ahead takes its time."""

    told = []

    class Told(QpController):
        def begin(self, phase, q, dq):
            told.append(phase)
            super().begin(phase, q, dq)

    settings = SimulationSettings(steps=2, period=period)
    run = simulate_walk(biped, Told(biped, gait), State(*gait.state_after_impact()), settings)
    assert run.steps_completed == 2
    assert told == 2 * [StepPhase.RISING, StepPhase.FALLING]


def test_right_foot_first_is_the_mirror_image(biped, level_gait):
    from frontal_biped.model import Stance

    settings = SimulationSettings(rtol=1e-8, atol=1e-10)
    left = simulate(biped, level_gait, steps=1, period=None, simulation_settings=settings)
    right = simulate(biped, level_gait, steps=1, period=None, simulation_settings=settings, stance=Stance.RIGHT)
    assert np.array_equal(left.q, right.q)
    assert np.array_equal(left.stance, -right.stance)
    assert left.stance_y == pytest.approx(-right.stance_y)
