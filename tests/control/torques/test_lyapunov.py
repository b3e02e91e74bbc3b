"""The control Lyapunov function: Riccati equation, promised rate, scaling with epsilon, and walking with it."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given
from random_states import vectors

from frontal_biped.control import ControllerSettings, QpController
from frontal_biped.control.torques.lyapunov import LyapunovFunction, least_acceleration
from frontal_biped.exceptions import SimulationError
from frontal_biped.simulation import SimulationSettings
from frontal_biped.simulation.walking import simulate
from frontal_biped.virtual_constraints import StepPhase

EXACT = 1e-9
"""Relative: closed forms in double precision."""

F, G = np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0], [1.0]])

outputs = {"y": vectors(-0.1, 0.1, 3), "dy": vectors(-2.0, 2.0, 3)}


def test_riccati_equation():
    P = LyapunovFunction(0.01).P
    assert np.abs(F.T @ P + P @ F - P @ G @ G.T @ P + np.eye(2)).max() < EXACT
    assert np.linalg.eigvalsh(P)[0] > 0.0
    assert np.abs(P - np.array([[3**0.5, 1.0], [1.0, 3**0.5]])).max() < EXACT  # known for Q = I


@given(**outputs)
def test_least_acceleration_meets_the_condition(y, dy):
    """dV/dt <= -(gamma / eps) V from a difference of V along the motion, and no shorter v does."""
    V = LyapunovFunction(0.02)
    decrease = V.decrease(y, dy)
    v, delta = least_acceleration(decrease, np.inf)
    assert delta == 0.0
    h = 1e-7

    def rate(v):
        ahead = V.value(y + h * dy + 0.5 * h**2 * v, dy + h * v)
        behind = V.value(y - h * dy + 0.5 * h**2 * v, dy - h * v)
        return (ahead - behind) / (2.0 * h)

    value = V.value(y, dy)
    slack = 1e-6 * (abs(rate(v)) + V.rate * value + 1e-9)
    assert rate(v) <= -V.rate * value + slack
    if decrease.b > 0.0:  # v = 0 would not do; then the condition is met with equality, by the shortest v
        assert rate(v) == pytest.approx(-V.rate * value, abs=slack)
        assert rate(0.9 * v) > -V.rate * value - slack


@given(**outputs)
def test_dear_decreases_are_relaxed(y, dy):
    decrease = LyapunovFunction(0.02).decrease(y, dy)
    free, _ = least_acceleration(decrease, np.inf)
    multiplier = np.linalg.norm(free) / max(np.linalg.norm(decrease.n), 1e-300)
    v, delta = least_acceleration(decrease, 0.5 * multiplier)
    assert v == pytest.approx(0.5 * free, rel=EXACT, abs=1e-12)
    assert delta == pytest.approx(max(0.0, decrease.n @ v + decrease.b), rel=1e-6, abs=1e-9)
    assert least_acceleration(decrease, 2.0 * multiplier + 1e-9)[1] == 0.0  # exact penalty


def integrate(epsilon, y, dy, duration, steps=4000):
    V, h = LyapunovFunction(epsilon), duration / steps
    values = [V.value(y, dy)]
    for _ in range(steps):
        v, _ = least_acceleration(V.decrease(y, dy), np.inf)
        y, dy = y + h * dy + 0.5 * h**2 * v, dy + h * v
        values.append(V.value(y, dy))
    return V, h * np.arange(steps + 1), np.array(values)


@pytest.mark.parametrize("epsilon", [0.02, 0.005])
def test_v_falls_at_the_promised_rate_whatever_epsilon(epsilon):
    y, dy = np.array([0.01, -0.02, 0.03]), np.array([0.5, 0.1, -0.4])
    V, t, values = integrate(epsilon, y, dy, 6.0 * epsilon)
    assert V.rate == pytest.approx(1.0 / ((3**0.5 + 1.0) * epsilon))
    assert np.all(values <= values[0] * np.exp(-V.rate * t) * 1.01)  # 1 %: first-order steps


@pytest.fixture(scope="module")
def clf_settings(reference_gait):
    return dataclasses.replace(ControllerSettings.for_gait(reference_gait), outputs="clf")


def test_v_falls_as_promised_on_the_robot(biped, reference_gait, clf_settings):
    """In closed loop from an output error, where nothing is relaxed, down to where steps of 0.1 ms can tell."""
    controller = QpController(biped, reference_gait, dataclasses.replace(clf_settings, epsilon=0.01))
    q, dq = reference_gait.state_after_impact()
    x, h = np.r_[q + np.array([0.0, 0.01, -0.01, 0.01]), dq], 1e-4
    values = []

    def slope(x, u):
        return np.r_[x[4:], biped.forward_dynamics(x[:4], x[4:], u)]

    for _ in range(1500):
        command = controller.command(StepPhase.RISING, x[:4], x[4:])
        assert command.solved
        assert command.relaxation < 1e-6
        values.append(controller.lyapunov.value(command.y, command.dy))
        k1 = slope(x, command.u)
        x = x + h * slope(x + 0.5 * h * k1, command.u)
    t = h * np.arange(len(values))
    assert np.all(np.array(values) <= values[0] * np.exp(-controller.lyapunov.rate * t) * 1.05)
    assert values[-1] < 0.01 * values[0]


@pytest.mark.slow
def test_twenty_steps_sampled(biped, reference_gait, clf_settings):
    run = simulate(biped, reference_gait, steps=20, period=1e-3, controller_settings=clf_settings)
    assert run.steps_completed == 20
    assert run.settings["controller"]["unsolved"] == 0
    assert np.abs(run.output_error).max() < 2e-3


@pytest.mark.slow
def test_twenty_steps_in_continuous_time(biped, reference_gait, clf_settings):
    settings = SimulationSettings(rtol=1e-8, atol=1e-10)
    run = simulate(
        biped,
        reference_gait,
        steps=20,
        period=None,
        controller_settings=clf_settings,
        simulation_settings=settings,
    )
    assert run.steps_completed == 20
    assert np.abs(run.output_error).max() < 1e-6  # on Z the least v is zero, and the state stays there
    states = run.post_impact_states()
    assert np.abs(states[-1] - states[0]).max() < 1e-4


def test_unknown_controller_is_refused():
    with pytest.raises(SimulationError, match="known: linearising, clf"):
        ControllerSettings(outputs="pid")
