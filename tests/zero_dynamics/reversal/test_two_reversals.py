"""The pair of reversals: E_2 and what it is made of, its slope, one step as a special case, the certificate."""

from pathlib import Path

import numpy as np
import pytest

from frontal_biped.exceptions import ReversalError
from frontal_biped.gait.file import load_any_gait
from frontal_biped.numerics.verdict import Verdict
from frontal_biped.zero_dynamics.poincare import step_orbit
from frontal_biped.zero_dynamics.reversal.pair_certificate import certify_pair
from frontal_biped.zero_dynamics.reversal.pair_problem import TwoStepReversal
from frontal_biped.zero_dynamics.reversal.pair_solver import analyse_pair, solve_pair
from frontal_biped.zero_dynamics.reversal.problem import ReversalProblem

DATA = Path(__file__).parents[2] / "data"

NODES = 40
"""Quadrature nodes a phase that the gait needs."""

ZERO = 1e-11
"""E over the energy that rising takes, where it vanishes; rounding of integrals."""

ROUNDING = 1e-9
"""Relative, of slopes and products made of the same integrals."""

DIFFERENCE = 1e-6
"""Relative, of a derivative by central differences of a thousandth of the range."""


@pytest.fixture(scope="module")
def sideways():
    return load_any_gait(DATA / "sideways.gait.json")


@pytest.fixture(scope="module")
def problem(biped, sideways):
    widths = sideways.a.step_width, sideways.b.step_width
    return TwoStepReversal.of_phases(biped, sideways.phases, widths, NODES)


class TestEliminated:
    def test_vanishes_at_the_plan(self, problem):
        own = problem.balance(problem.planned)
        assert abs(own.surplus) < ZERO * own.required
        assert own.drive_ratio == pytest.approx(1.0, rel=ROUNDING)

    def test_second_reversal_at_the_plan(self, problem):
        first, second = problem.planned_pair
        assert problem.fixed.second(first, NODES) == pytest.approx(second, abs=1e-11)

    def test_multiplier_is_that_of_the_pair(self, problem, sideways):
        assert problem.balance(problem.planned).multiplier == pytest.approx(sideways.multiplier, rel=ROUNDING)

    @pytest.mark.parametrize("share", [-0.05, -0.02, 0.01])
    def test_is_what_it_is_made_of(self, problem, biped, sideways, share):
        """E_2 put together from steps through both reversals, and the energies met at both impacts."""
        beta = problem.planned + share * problem.length
        second = problem.fixed.second(beta, NODES)
        a = step_orbit(biped, *sideways.a.phases, sideways.a.step_width, NODES, beta)
        b = step_orbit(biped, *sideways.b.phases, sideways.b.step_width, NODES, second)
        jump_a = a.landing.speed_ratio * b.rising.restricted.I_P[-1] / a.falling.restricted.I_P[-1]
        jump_b = b.landing.speed_ratio * a.rising.restricted.I_P[-1] / b.falling.restricted.I_P[-1]
        assert jump_a**2 * a.falling.z[-1] == pytest.approx(b.rising.z[-1], rel=ROUNDING)
        expected = jump_b**2 * b.falling.z[-1] - a.rising.z[-1]
        assert problem.balance(beta).surplus == pytest.approx(expected, abs=ZERO * a.rising.z[-1])

    @pytest.mark.parametrize("share", [-0.05, 0.0, 0.01])
    def test_slope_in_closed_form(self, problem, share):
        beta, h = problem.planned + share * problem.length, 1e-3 * problem.length
        slope = (problem.balance(beta + h).surplus - problem.balance(beta - h).surplus) / (2.0 * h)
        # the error of a central difference falls with the square of its step
        coarse = (problem.balance(beta + 2.0 * h).surplus - problem.balance(beta - 2.0 * h).surplus) / (4.0 * h)
        extrapolated = (4.0 * slope - coarse) / 3.0
        assert problem.balance(beta).slope == pytest.approx(extrapolated, rel=DIFFERENCE)

    def test_beyond_the_barrier_it_is_not_defined(self, problem):
        assert np.isnan(problem.balance(problem.brackets[0][0] - 0.01).surplus)
        with pytest.raises(ReversalError):
            problem.fixed.second(problem.brackets[0][0] - 0.01, NODES)


class TestEqualSteps:
    """w_1 = w_2 and equal parameters: the pair of one gait."""

    def test_zero_slope_and_jacobian(self, biped, reference_gait):
        phases = reference_gait.rising, reference_gait.falling
        width = reference_gait.step_width
        one = ReversalProblem.of_phases(biped, *phases, width, NODES)
        two = TwoStepReversal.of_phases(biped, (phases, phases), (width, width), NODES)
        alone, pair = one.balance(one.planned), two.balance(two.planned)
        assert abs(pair.surplus) < ZERO * pair.required
        assert pair.multiplier == pytest.approx(alone.multiplier**2, rel=ROUNDING)
        assert pair.slope == pytest.approx(alone.slope * (1.0 + alone.multiplier), rel=ROUNDING)
        # both reversals moved alike: S_1 = S_2 = S
        rows = two.jacobian(two.planned_pair).sum(axis=1)
        size = np.abs(two.jacobian(two.planned_pair)).max()
        assert rows == pytest.approx(np.full(2, one.slope(one.planned)), abs=DIFFERENCE * size)


class TestCertificate:
    def test_analysis(self, problem):
        found = analyse_pair(problem)
        assert found.existence is found.at_the_plan is Verdict.CERTIFIED
        assert found.is_reversal
        assert found.betas == pytest.approx(problem.planned_pair, abs=1e-9)

    def test_pair_with_invariance_imposed(self, problem):
        found = solve_pair(problem, (problem.planned + 1e-3 * problem.length, problem.planned_pair[1]))
        assert found.converged and found.regular is Verdict.CERTIFIED
        assert found.betas == pytest.approx(problem.planned_pair, abs=1e-9)
        assert found.residual < ZERO

    @pytest.mark.slow
    def test_certificate(self, problem):
        found = certify_pair(problem)
        places = [zero.place for zero in found.fixed.zeros]
        assert min(abs(place - problem.planned) for place in places) < 1e-9
        # between two zeros the slope changes its sign, so condition (b) cannot hold throughout
        assert found.uniqueness is Verdict.REFUTED and len(places) == 2
        assert found.condition_b.verdict is Verdict.REFUTED
        assert found.conditions_a[1].verdict is Verdict.CERTIFIED
        assert found.self_consistent.regular is Verdict.CERTIFIED
        assert {"fixed", "self_consistent", "condition_b"} <= set(found.as_dict())
        assert "undecided" in dict(found.rows())["invariance imposed"]

    @pytest.mark.slow
    def test_another_energy_has_its_pair_elsewhere(self, biped, sideways):
        moved = sideways.a.rising.fri_bezier.copy()
        moved[1] += 1e-3
        phases = (type(sideways.a.rising)(
            sideways.a.rising.beta_start, sideways.a.rising.beta_end, sideways.a.rising.joint_bezier, moved
        ), sideways.a.falling), sideways.b.phases  # fmt: skip
        widths = sideways.a.step_width, sideways.b.step_width
        found = analyse_pair(TwoStepReversal.of_phases(biped, phases, widths, NODES))
        assert found.at_the_plan is not Verdict.CERTIFIED
