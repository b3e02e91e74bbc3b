"""The robustness measures against other routes to the same numbers, and as bounds of a design."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from frontal_biped.design import optimise_gait, pareto_front
from frontal_biped.gait import GaitSpecification
from frontal_biped.gait.constraints import energy_margin, reversal_shift
from frontal_biped.simulation.settings import SimulationSettings
from frontal_biped.simulation.walking import simulate
from frontal_biped.virtual_constraints import ConstrainedMotion
from frontal_biped.zero_dynamics.restricted import RestrictedDynamics, project_dynamics

FIRST_ORDER = 0.01
"""Relative difference of a displacement by 1e-5 of speed from the first-order prediction: the next order is 1e-3."""

TANGENT = 0.15
"""Relative difference of the barrier from its tangent: the drive bends a little over a tenth of a radian."""


@pytest.fixture(scope="module", params=["reference_gait", "level_gait"])
def gait(request):
    return request.getfixturevalue(request.param)


def test_reversal_shift_against_the_full_model(biped, gait):
    error = 1e-5
    settings = SimulationSettings(rtol=1e-10, atol=1e-12)
    run = simulate(biped, gait, steps=1, period=None, speed_error=error, simulation_settings=settings)
    reversal = run.event_state[run.events("REVERSAL")[0], 0]
    predicted = float(reversal_shift(gait.step(biped))) * error / 0.01
    assert reversal - gait.beta_reversal == pytest.approx(predicted, rel=FIRST_ORDER)


def test_energy_margin_against_the_integrated_barrier(biped, gait):
    """The pose goes on along its tangent beyond the reversal, FRI at rest: integrate the drive up to kappa_2 = 0."""
    step = gait.step(biped)
    rising = step.rising
    q, dq, p_fri = rising.motion.q[0], rising.motion.dq[0], rising.motion.p_fri[:1]

    def beyond(x):
        motion = ConstrainedMotion((q + x * dq)[None], dq[None], np.zeros((1, 4)), p_fri, np.zeros(1))
        return RestrictedDynamics(project_dynamics(biped, motion), p_fri, np.zeros(1))

    barrier = brentq(lambda x: float(beyond(x).kappa_2[0]), 0.0, 0.6)
    energy = -quad(lambda x: float(beyond(x).drive[0]), 0.0, barrier, epsabs=1e-10)[0]
    orbit = float(rising.zeta[-1] * np.exp(-rising.log_delta_squared[-1]))
    assert float(energy_margin(step)) == pytest.approx(energy / orbit, rel=TANGENT)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("key", "bound", "sign"),
    [("max_multiplier", 0.72, -1), ("min_energy_margin", 1.0, 1), ("max_reversal_shift", 1e-3, -1)],
)
def test_bounds_are_kept_and_cost_something(biped, reference_design, key, bound, sign):
    result = optimise_gait(biped, GaitSpecification(**{key: bound}))
    assert result.success, result.message
    step = result.gait.step(biped)
    value = {
        "max_multiplier": step.multiplier,
        "min_energy_margin": energy_margin(step),
        "max_reversal_shift": reversal_shift(step),
    }[key]
    assert sign * (float(value) - bound) >= -1e-9
    assert result.gait.orbit.cost > reference_design.gait.orbit.cost


@pytest.mark.slow
def test_cost_rises_along_the_front(biped):
    points = pareto_front(biped, GaitSpecification(), "min_energy_margin", [0.5, 1.0, 1.5])
    costs = [point.measures["cost"] for point in points]
    assert costs == sorted(costs)
    assert [point.value for point in points] == [0.5, 1.0, 1.5]
    assert all(point.measures["energy_margin"] >= point.value - 1e-9 for point in points)


@pytest.mark.slow
def test_a_higher_degree_is_no_dearer(biped):
    from frontal_biped.design import degree_study

    series = degree_study(biped, GaitSpecification(), [4, 5, 6], [2])
    costs = [point.measures["cost"] for point in series[2]]
    assert costs == sorted(costs, reverse=True)


@pytest.mark.slow
def test_degrees_of_single_outputs(biped, reference_design):
    """A lower degree of one output costs more than none; its surplus coefficients vanish to rounding."""
    result = optimise_gait(biped, GaitSpecification(degree=(5, 4, 5)))
    assert result.success, result.message
    assert result.gait.orbit.cost > reference_design.gait.orbit.cost
    for phase in (result.gait.rising, result.gait.falling):
        assert abs(np.diff(phase.joint_bezier[1], n=5)[0]) < 1e-12
        assert abs(np.diff(phase.joint_bezier[0], n=5)[0]) > 1e-6
