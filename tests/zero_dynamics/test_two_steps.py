"""Two steps in turn: equal ones give the map of one, twice; different ones the composition; the full model agrees."""

from pathlib import Path

import numpy as np
import pytest

from frontal_biped.design.sideways_studies import cost_of_travel
from frontal_biped.gait.file import load_any_gait
from frontal_biped.gait.specification import default_specification
from frontal_biped.model.catalogue import load_robot
from frontal_biped.simulation.settings import SimulationSettings
from frontal_biped.simulation.walking import simulate
from frontal_biped.virtual_constraints.invariance import complete, complete_in_turn, free_parameters
from frontal_biped.zero_dynamics.poincare import HybridZeroDynamics
from frontal_biped.zero_dynamics.two_steps import AffineMap, TwoStepMap, TwoSteps

DATA = Path(__file__).parents[1] / "data"

ROUNDING = 1e-12
"""Relative; both sides are the same formula in another order."""

CONVERGED = 1e-9
"""Relative; both sides are integrals on converged nodes, by other ways."""

MAP = 1e-5  # relative, closed form against the full model (bound of the design)
MULTIPLIER = 1e-4  # relative, the same for the slope (bound of the design)


@pytest.fixture(scope="module")
def sideways():
    return load_any_gait(DATA / "sideways.gait.json")


@pytest.fixture(scope="module")
def steps(biped, sideways):
    return sideways.two_steps(biped)


@pytest.fixture(scope="module")
def closed_form(biped, steps):
    return TwoStepMap(biped, steps)


@pytest.fixture(scope="module")
def one(biped, reference_gait):
    return HybridZeroDynamics(biped, reference_gait.step(biped))


@pytest.fixture(scope="module")
def two(biped, one):
    """The same step twice."""
    return TwoStepMap(biped, TwoSteps(one.step, one.step))


class TestEqualSteps:
    """w_1 = w_2 and equal parameters."""

    def test_phases(self, biped, reference_gait):
        free = free_parameters(reference_gait.rising, reference_gait.falling, reference_gait.step_width)
        for pair in complete_in_turn(biped, free, free):
            for phase, alone in zip(pair, complete(biped, free), strict=True):
                assert phase.joint_bezier.tobytes() == alone.joint_bezier.tobytes()
                assert (phase.beta_start, phase.beta_end) == (alone.beta_start, alone.beta_end)

    def test_map_is_that_of_one_step_twice(self, one, two):
        zeta = 1.1 * one.fixed_point
        assert two.rho_a(zeta) == pytest.approx(one.rho(zeta), rel=ROUNDING)
        assert two.rho(zeta) == pytest.approx(one.rho(one.rho(zeta)), rel=ROUNDING)
        assert two.multiplier == pytest.approx(one.multiplier**2, rel=ROUNDING)
        assert two.fixed_points == pytest.approx((one.fixed_point, one.fixed_point), rel=ROUNDING)

    def test_balances(self, one, two):
        assert two.steps.periodicity == (one.step.periodicity, one.step.periodicity)
        assert two.steps.multipliers == pytest.approx((one.step.multiplier,) * 2, rel=ROUNDING)
        assert two.steps.cost == one.step.cost
        assert two.steps.duration == pytest.approx(2.0 * one.step.duration, rel=ROUNDING)
        assert two.steps.travel == 0.0
        assert two.in_domain and two.is_stable


class TestDifferentSteps:
    def test_fixed_point_as_the_formula_has_it(self, closed_form):
        (m_a, c_a), (m_b, c_b) = closed_form.rho_a, closed_form.rho_b
        assert closed_form.rho.fixed_point == pytest.approx(-(m_b * c_a + c_b) / (1.0 - m_a * m_b), rel=ROUNDING)
        end_of_a, end_of_b = closed_form.fixed_points
        assert closed_form.rho_b(end_of_a) == pytest.approx(end_of_b, rel=CONVERGED)

    def test_orbit_from_the_reversals(self, closed_form, biped, steps):
        """The energy integrated from rest at either reversal is that of the fixed point."""
        for step, zeta in zip(steps, closed_form.fixed_points, strict=True):
            assert HybridZeroDynamics(biped, step).rho_f(0.0) == pytest.approx(zeta, rel=CONVERGED)
        assert max(closed_form.energy_balance) < CONVERGED
        assert max(np.abs(steps.periodicity)) < CONVERGED

    def test_multiplier_two_ways(self, closed_form, steps):
        assert closed_form.multiplier == pytest.approx(steps.multiplier, rel=CONVERGED)
        assert closed_form.is_stable and closed_form.in_domain

    def test_the_steps_differ(self, closed_form, steps):
        assert steps.travel == pytest.approx(0.1)
        assert closed_form.rho_a.m != pytest.approx(closed_form.rho_b.m, rel=1e-2)


def test_composition():
    first, second = AffineMap(0.5, -3.0), AffineMap(2.5, 1.0)
    both = first.then(second)
    assert both(7.0) == second(first(7.0))
    assert both(both.fixed_point) == pytest.approx(both.fixed_point)
    assert both.m == 1.25  # one step of the two may be unstable alone


FULL = SimulationSettings(rtol=1e-10, atol=1e-12, record_rate=20.0)
"""Integration far below what is compared."""

SHIFT = 1e-6
"""Relative speed error for the slope. The map bends where a reversal comes early or late, for the phases are anchored
otherwise: the central difference errs in proportion to the shift, and the integration by 1e-10 over it."""


def after_two_steps(biped, gait, speed_error):
    """Energy zeta_f- of the section, from the speed after the impact that ends it; it is proportional to its square."""
    run = simulate(
        biped, gait, steps=2, period=None, speed_error=speed_error, stabiliser="re-anchored", simulation_settings=FULL
    )
    assert run.outcome == "completed"
    return float(run.post_impact_speeds[-1] ** 2 / gait.a.speed_after_impact**2)


@pytest.mark.slow
@pytest.mark.parametrize("robot", ["frontal_biped", "talos_full"])
def test_closed_form_against_the_full_model(robot):
    """Three sideways speeds of two robots: where two steps return to, and how fast an error decays."""
    biped = load_robot(robot)
    points = cost_of_travel(biped, default_specification(biped), (0.02, 0.06, 0.1))
    for point in points:
        gait = point.gait
        assert gait is not None, point.message
        assert gait.speed > 0.01
        closed = TwoStepMap(biped, gait.two_steps(biped))
        assert after_two_steps(biped, gait, 0.0) == pytest.approx(1.0, rel=MAP)
        above, below = ((1.0 + sign * SHIFT) ** 2 for sign in (1.0, -1.0))
        slope = (after_two_steps(biped, gait, SHIFT) - after_two_steps(biped, gait, -SHIFT)) / (above - below)
        assert slope == pytest.approx(closed.multiplier, rel=MULTIPLIER)
