"""The planned reversal: that Z vanishes there, decided by signs; on gaits, and on functions whose zeros are known."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from frontal_biped.gait.gait import converged_nodes
from frontal_biped.numerics.verdict import Verdict
from frontal_biped.zero_dynamics.poincare import HybridZeroDynamics
from frontal_biped.zero_dynamics.restricted import restrict
from frontal_biped.zero_dynamics.reversal.certificate import certify_reversal
from frontal_biped.zero_dynamics.reversal.planned import AT_THE_PLAN, analyse_reversal, find_reversal
from frontal_biped.zero_dynamics.reversal.problem import BalanceFunction, EnergyBalance, ReversalProblem
from frontal_biped.zero_dynamics.reversal.zeros import REGULAR, count_zeros

NODES = 32
PLACE = 1e-10  # [rad] Brent's method on a spectrally accurate function


@pytest.fixture(params=["reference", "level"])
def gait(request, reference_gait, level_gait):
    return reference_gait if request.param == "reference" else level_gait


def problem_of(biped, gait, nodes=NODES):
    return ReversalProblem.of_phases(biped, gait.rising, gait.falling, gait.step_width, nodes)


def test_reversal_of_a_designed_gait_is_the_planned_one(biped, gait):
    nodes = converged_nodes(biped, gait.rising, gait.falling, gait.step_width)
    found = analyse_reversal(problem_of(biped, gait, nodes))
    assert found.exists
    assert found.is_reversal
    assert found.at_the_plan is Verdict.CERTIFIED
    assert found.beta == pytest.approx(gait.beta_reversal, abs=PLACE)
    low, high = found.bracket
    assert low < found.sign_change[0] < found.beta < found.sign_change[1] < high
    assert found.acceleration < 0.0


def test_around_the_plan_it_is_what_it_is_in_the_whole_bracket(biped, gait):
    problem = problem_of(biped, gait)
    floor = REGULAR * problem.balance(problem.planned).least_inertia
    asked = (problem.at_fixed_parameters(), *problem.bracket, problem, floor)
    near, everywhere = (count_zeros(*asked, connected=connected)[0] for connected in (True, False))
    (region,) = near.region
    assert region == next(part for part in everywhere.region if part[0] <= problem.planned <= part[1])
    assert near.zeros == tuple(zero for zero in everywhere.zeros if region[0] <= zero.place <= region[1])
    assert near.evaluations < everywhere.evaluations


def test_Z_changes_sign_from_positive_to_negative(biped, gait):
    problem = problem_of(biped, gait)

    def Z(beta):
        return HybridZeroDynamics(biped, problem.step(beta, problem.planned)).marginal_condition

    assert Z(gait.beta_reversal - 1e-4) > 0.0 > Z(gait.beta_reversal + 1e-4)
    # below the bracket there is nothing to rise through
    assert np.isnan(problem.at_fixed_parameters()(gait.rising.beta_start - 0.01, NODES).surplus)


def test_reversal_against_integration_in_time(biped, gait):
    """Start the rising zero dynamics after the impact and integrate in time until it stops."""

    def derivative(_, x):
        dynamics = restrict(biped, gait.rising, np.array([x[0]]))
        return [x[1], float(dynamics.acceleration(np.array([x[1] ** 2]))[0])]

    def stopped(_, x):
        return x[1]

    stopped.terminal, stopped.direction = True, -1
    start = [gait.rising.beta_start, gait.orbit.beta_dot_after_impact]
    solution = solve_ivp(derivative, (0.0, 2.0), start, events=stopped, rtol=1e-11, atol=1e-13, method="DOP853")
    assert solution.y_events[0][0, 0] == pytest.approx(gait.beta_reversal, abs=1e-9)


def test_without_an_upper_end_of_the_bracket_the_planned_point_is_asked_all_the_same(biped, level_gait, monkeypatch):
    found = analyse_reversal(problem_of(biped, level_gait))
    monkeypatch.setattr("frontal_biped.zero_dynamics.reversal.problem.beta_maximum", _nowhere)
    unbounded = analyse_reversal(problem_of(biped, level_gait))
    assert np.isnan(unbounded.bracket[1])
    assert replace(unbounded, bracket=found.bracket) == found


def _nowhere(*_):
    from frontal_biped.exceptions import ReversalError

    raise ReversalError("the centre of mass stays inside")


# ------------------------------------------------------- functions whose zeros are known
@dataclass(frozen=True)
class Constructed(ReversalProblem):
    """A problem whose E is a given function of (beta - planned) in radians, turning back everywhere.

    Attributes:
        shape: E over ``R``, of that argument.
        quadrature: what half as many nodes add to it.
    """

    shape: Callable[[float], float] = np.sin
    quadrature: float = 0.0

    R = 30.0

    def balance(self, beta: float, guess: float | None = None) -> EnergyBalance:
        return self.at_fixed_parameters()(beta, self.nodes)

    def at_fixed_parameters(self) -> BalanceFunction:
        def E(beta: float, nodes: int) -> EnergyBalance:
            x, h = beta - self.planned, 1e-7
            coarse = self.quadrature if nodes <= self.nodes else 0.0
            slope = (self.shape(x + h) - self.shape(x - h)) / (2.0 * h)
            return EnergyBalance(self.R * (self.shape(x) + coarse), 10.0, 0.5, 1.0, self.R * slope, self.R, -100.0)

        return E


@pytest.fixture(scope="module")
def at_hand(biped, level_gait):
    return problem_of(biped, level_gait, 16)


def constructed(at_hand, shape, quadrature=0.0):
    return Constructed(at_hand.biped, at_hand.free, at_hand.nodes, shape, quadrature)


def found_in(problem):
    return find_reversal(problem, problem.at_fixed_parameters(), *problem.bracket)


@given(st.floats(-9.0, -2.5), st.sampled_from([-1.0, 1.0]), st.floats(-12.5, -9.0))
def test_a_second_zero_however_close_does_not_hide_the_planned_one(at_hand, log_distance, side, log_error):
    """E = x (x - d), the second zero from 1e-9 to 3e-3 rad away, where a scan of 64 points has 3e-4 rad between two."""
    distance, error = side * 10.0**log_distance, 10.0**log_error * 1e-4
    problem = constructed(at_hand, lambda x: 100.0 * x * (x - distance), error)
    existence, at_the_plan, (left, right) = found_in(problem)
    # how far E falls below zero between its zeros, against what it is known to
    depth = 25.0 * distance**2
    if depth > 20.0 * (error + 1e-13) and abs(distance) > 3.0 * AT_THE_PLAN:
        assert existence is Verdict.CERTIFIED
        assert any(left <= problem.planned + zero <= right for zero in (0.0, distance))
    if existence is not Verdict.REFUTED and at_the_plan is Verdict.CERTIFIED:
        assert right - left <= 2.0 * AT_THE_PLAN * (1.0 + 1e-6)
    assert existence is not Verdict.REFUTED  # a zero exists: it may be in doubt, never denied


@given(st.floats(-12.0, -3.0))
def test_a_near_miss_is_no_reversal_and_a_nearer_one_is_doubted(at_hand, log_height):
    """E = x^2 + h has no zero: refuted where h is above the error, undecided below, certified never."""
    height = 10.0**log_height
    existence, at_the_plan, _ = found_in(constructed(at_hand, lambda x: 100.0 * x**2 + height))
    assert existence is not Verdict.CERTIFIED
    assert at_the_plan is not Verdict.CERTIFIED
    if height > 1e-9:
        assert existence is Verdict.REFUTED


def test_no_zero_is_a_result(at_hand):
    existence, at_the_plan, sign_change = found_in(constructed(at_hand, lambda x: 1.0 + x))
    assert existence is Verdict.REFUTED
    assert at_the_plan is not Verdict.CERTIFIED
    assert np.all(np.isnan(sign_change))


@given(st.floats(-8.5, -2.5), st.sampled_from([-1.0, 1.0]))
def test_a_zero_beside_the_plan_is_found_and_told_from_it(at_hand, log_distance, side):
    distance = side * 10.0**log_distance
    existence, at_the_plan, (left, right) = found_in(constructed(at_hand, lambda x: -(x - distance)))
    assert existence is Verdict.CERTIFIED
    assert at_the_plan is Verdict.REFUTED
    assert left - 1e-12 <= at_hand.planned + distance <= right + 1e-12


@pytest.mark.parametrize("share", [0.4, -0.4, 3.0, -3.0])
def test_a_zero_within_the_error_of_an_end_of_the_region_is_undecided(at_hand, share):
    """The region ends where the bracket does; the zero, as the coarse nodes have it, lies ``share`` errors beyond."""
    error = 1e-7
    low, high = at_hand.bracket
    end = high - 1e-6 * (high - low)  # `zeros` leaves a hair
    place = end - at_hand.planned + (share - 1.0) * error  # the coarse nodes add an error
    problem = constructed(at_hand, lambda x: -(x - place), error)
    count, _, _ = count_zeros(problem.at_fixed_parameters(), low, high, problem, 1.0, connected=True)
    expected = Verdict.UNDECIDED if abs(share) < 1.0 else Verdict.CERTIFIED if share < 0.0 else Verdict.REFUTED
    assert count.existence is expected
    assert find_reversal(problem, problem.at_fixed_parameters(), low, high)[0] is expected


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_verdict_against_a_dense_scan(biped, reference_gait, level_gait, seed):
    """Displaced parameter sets: existence, and every zero, against 1500 points; certificate and analysis agree."""
    gait = (reference_gait, level_gait)[seed % 2]
    problem = problem_of(biped, gait, 24)
    rng = np.random.default_rng(seed)
    size = (1e-5, 1e-4, 1e-3)[seed // 2]
    columns = problem.free.rising_columns
    free = replace(problem.free, rising_columns=columns + size * rng.uniform(-1.0, 1.0, columns.shape))
    problem = ReversalProblem(biped, free, 24)
    assert np.isfinite(problem.S(problem.planned))  # a step exists at the plan of each of these sets
    analysis = analyse_reversal(problem)
    certificate = certify_reversal(problem, analysis)
    assert certificate.fixed.existence is analysis.existence
    E = problem.at_fixed_parameters()
    for low, high in certificate.fixed.region:
        grid = np.linspace(low, high, 1500)[1:-1]
        signs = np.sign([E(float(beta), 24).surplus for beta in grid])
        changes = np.flatnonzero(signs[1:] != signs[:-1])
        if len(changes):
            assert analysis.existence is not Verdict.REFUTED
        for i in changes:
            assert any(grid[i] - 1e-9 <= zero.place <= grid[i + 1] + 1e-9 for zero in certificate.fixed.zeros) or any(
                a <= grid[i + 1] and grid[i] <= b for a, b in certificate.fixed.undecided
            )
