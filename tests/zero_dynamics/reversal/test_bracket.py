"""The reversal point for given parameters: bracket, existence, place."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from frontal_biped.exceptions import ReversalError
from frontal_biped.gait.gait import converged_nodes
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.virtual_constraints import Phase
from frontal_biped.zero_dynamics.restricted import restrict
from frontal_biped.zero_dynamics.reversal.bracket import analyse_reversal, beta_maximum, marginal_condition

NODES = 32
PLACE = 1e-10  # [rad] Brent's method on a spectrally accurate function


@pytest.fixture(params=["reference", "level"])
def gait(request, reference_gait, level_gait):
    return reference_gait if request.param == "reference" else level_gait


def test_reversal_of_a_designed_gait_is_the_planned_one(biped, gait):
    nodes = converged_nodes(biped, gait.rising, gait.falling, gait.step_width)
    found = analyse_reversal(biped, gait.rising, gait.falling, gait.step_width, nodes)
    assert found.exists
    assert found.is_reversal
    assert found.beta == pytest.approx(gait.beta_reversal, abs=PLACE)
    low, high = found.bracket
    assert low < found.sign_change[0] < found.beta < found.sign_change[1] < high
    assert found.acceleration < 0.0


def test_Z_changes_sign_from_positive_to_negative(biped, gait):
    Z = marginal_condition(biped, gait.rising, gait.falling, gait.step_width, NODES)
    below, above = gait.beta_reversal - 1e-4, gait.beta_reversal + 1e-4
    assert Z(below) > 0.0 > Z(above)
    assert np.isnan(Z(gait.rising.beta_start - 0.01))  # below the bracket there is nothing to rise through


def test_centre_of_mass_is_over_the_fri_at_beta_maximum(biped, gait):
    beta_max = beta_maximum(biped, gait.rising)
    end = gait.rising.motion(np.array([gait.rising.beta_end]))
    frozen = end.q[0].copy()
    frozen[0] = beta_max
    assert biped.com(frozen)[0] == pytest.approx(end.p_fri[0], abs=1e-12)
    assert beta_max > gait.beta_reversal


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


def test_no_reversal_is_a_result(biped, reference_gait, monkeypatch):
    """Without a sign change of Z in the bracket the analysis says so instead of guessing."""
    monkeypatch.setattr("frontal_biped.zero_dynamics.reversal.bracket.marginal_condition", lambda *_: lambda beta: 1.0)
    gait = reference_gait
    found = analyse_reversal(biped, gait.rising, gait.falling, gait.step_width, 16)
    assert not found.exists
    assert not found.is_reversal
    assert np.isnan(found.beta)


def test_centre_of_mass_outside_the_target_is_refused(biped: FrontalBiped, reference_gait):
    rising = reference_gait.rising
    shifted = Phase(rising.beta_start, rising.beta_end, rising.joint_bezier, rising.fri_bezier + 1.0)
    with pytest.raises(ReversalError, match="centre of mass"):
        beta_maximum(biped, shifted)
