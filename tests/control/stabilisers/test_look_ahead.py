"""Re-anchoring that looks ahead: the interval of speeds the design asks for, within the limits of the contact."""

import numpy as np
import pytest

from frontal_biped.analysis.return_map import RestrictedMap
from frontal_biped.control import make_stabiliser
from frontal_biped.control.stabilisers.look_ahead import LookAheadTransitions
from frontal_biped.simulation import SimulationSettings
from frontal_biped.simulation.walking import simulate
from frontal_biped.zero_dynamics.poincare import HybridZeroDynamics

INVARIANCE = 1e-6  # [rad] bound of the design
MAP = 1e-5  # relative, closed form against the full model (bound of the design)
SETTINGS = SimulationSettings(rtol=1e-8, atol=1e-10)

# bound of the design: speed errors from which re-anchoring alone returns
BOUNDS = {"reference": (-0.05, 0.25), "level": (-0.20, 0.50)}
ENDS = [(name, error) for name, pair in BOUNDS.items() for error in pair]


@pytest.fixture(params=["level", pytest.param("reference", marks=pytest.mark.slow)])
def gait(request):
    return request.getfixturevalue(f"{request.param}_gait")


def rho(biped, gait, ratio):
    hzd = HybridZeroDynamics(biped, gait.step(biped))
    return float(np.sqrt(hzd.rho(ratio**2 * hzd.fixed_point) / hzd.fixed_point))


@pytest.mark.parametrize("error", [-0.2, -0.1, 0.2, 0.5])
def test_one_step_nears_the_gait_within_the_limits(biped, level_gait, error):
    restricted = RestrictedMap(biped, level_gait, LookAheadTransitions(biped, level_gait))
    step = restricted.step(restricted.start(1.0 + error))
    assert step.tightest.value > 0.0
    left = (restricted.speed_ratio(step.landed) - 1.0) / error
    assert 0.0 < left < 0.9
    # no ankle torque is spent on the error: the FRI target is the gait's at both ends of the step
    assert step.rising.phase.fri_bezier == pytest.approx(level_gait.rising.fri_bezier)
    assert step.falling.desired(step.falling.beta_end)[3] == pytest.approx(level_gait.falling.fri_bezier[-1])
    # and the landing is as planned
    assert step.landed.q == pytest.approx(restricted.start().q, abs=1e-9)
    assert step.landed.slope == pytest.approx(restricted.start().slope, rel=1e-9)


@pytest.mark.parametrize("error", [-0.04, 0.05])
def test_where_the_limits_allow_it_the_map_is_the_papers(biped, level_gait, error):
    """rho of [O] eq. pcc: the speed that the choice of the stretch aims at."""
    restricted = RestrictedMap(biped, level_gait, LookAheadTransitions(biped, level_gait))
    found = restricted.speed_ratio(restricted.step(restricted.start(1.0 + error)).landed)
    assert found == pytest.approx(rho(biped, level_gait, 1.0 + error), abs=0.05 * abs(error) + 1e-9)


def test_gait_itself_is_left_alone(biped, level_gait):
    chosen = LookAheadTransitions(biped, level_gait)
    rising = chosen.rising(RestrictedMap(biped, level_gait, chosen).start())
    assert rising.phase.joint_bezier == pytest.approx(level_gait.rising.joint_bezier)
    assert chosen.falling(rising, level_gait.beta_reversal) is level_gait.falling


def test_falling_phase_starts_on_the_rising_one(biped, level_gait):
    """In pose and slope, wherever the robot reverses: the state stays on Z."""
    chosen = LookAheadTransitions(biped, level_gait)
    restricted = RestrictedMap(biped, level_gait, chosen)
    for ratio in (0.8, 0.9, 0.97, 1.3):
        step = restricted.step(restricted.start(ratio))
        at = np.array([step.reversal])
        up, down = step.rising.motion(at), step.falling.motion(at)
        assert down.q == pytest.approx(up.q, abs=1e-9)
        assert down.dq == pytest.approx(up.dq, rel=1e-7, abs=1e-7)


def test_what_was_looked_at_for_the_rising_phase_is_answered_again(biped, level_gait):
    """The falling phase is the one that a stabiliser finds that has looked at nothing before; step after step."""
    chosen = LookAheadTransitions(biped, level_gait)
    restricted = RestrictedMap(biped, level_gait, chosen)
    for ratio in (0.8, 1.3, 0.9):
        step = restricted.step(restricted.start(ratio))
        anew = LookAheadTransitions(biped, level_gait).falling(step.rising, step.reversal)
        beta = np.linspace(step.reversal, step.falling.beta_end, 9)
        for part, own in zip(step.falling.motion(beta), anew.motion(beta), strict=True):
            np.testing.assert_array_equal(part, own)


@pytest.mark.slow
def test_basin_covers_the_interval_of_the_design(biped, gait):
    basin = RestrictedMap(biped, gait, make_stabiliser("adaptive", biped, gait)).basin()
    low, high = BOUNDS["level" if (gait.specification.max_pelvis_roll or 1.0) < 0.1 else "reference"]
    assert basin.low <= 1.0 + low
    assert basin.high >= 1.0 + high


@pytest.mark.slow
@pytest.mark.parametrize(("name", "error"), ENDS)
def test_full_model_returns_within_its_limits(biped, request, name, error):
    """Continuous control by the quadratic program, all its limits active: four steps, each as the map says."""
    gait = request.getfixturevalue(f"{name}_gait")
    run = simulate(
        biped, gait, steps=4, period=None, speed_error=error, stabiliser="adaptive", simulation_settings=SETTINGS
    )
    assert run.outcome == "completed"
    restricted = RestrictedMap(biped, gait, make_stabiliser("adaptive", biped, gait))
    landed, speeds = restricted.start(1.0 + error), [1.0 + error]
    for _ in range(4):
        landed = restricted.step(landed).landed
        speeds.append(restricted.speed_ratio(landed))
    errors = np.abs(np.array(speeds) - 1.0)
    assert np.all(np.diff(errors) < 0.0)
    found = run.post_impact_speeds / gait.orbit.beta_dot_after_impact
    assert found == pytest.approx(speeds, rel=MAP)
    assert np.max(np.abs(run.output_error)) < INVARIANCE
    assert np.all(np.abs(run.force[:, 0]) < gait.specification.friction * run.force[:, 1])
    assert np.all(run.force[:, 1] > gait.specification.min_normal_force * biped.weight)
    outer, inner = biped.sole
    assert np.all((run.p_fri > outer) & (run.p_fri < inner))
    assert np.all(np.abs(run.u) < biped.max_torque)
    assert run.settings["controller"]["unsolved"] == 0
