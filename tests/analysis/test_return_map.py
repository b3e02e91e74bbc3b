"""The restricted return map with a variable reversal point, against the full model and against its own theory."""

import numpy as np
import pytest

from frontal_biped.analysis.push_recovery import RECOVERED, speed_errors
from frontal_biped.analysis.return_map import RestrictedMap
from frontal_biped.control import ReanchoringTransitions, make_stabiliser
from frontal_biped.control.stabilisers.ankle_law import AnkleLaw
from frontal_biped.control.stabilisers.step_law import StepLaw, StepRule
from frontal_biped.exceptions import ReversalError
from frontal_biped.gait.gait import converged_nodes
from frontal_biped.simulation import SimulationSettings
from frontal_biped.simulation.walking import simulate
from frontal_biped.zero_dynamics.half_steps import falling_energy, rising_energy, speed_at_end
from frontal_biped.zero_dynamics.orbit import resample
from frontal_biped.zero_dynamics.poincare import HybridZeroDynamics

MAP = 1e-5  # relative, closed form against the full model (bound of the design)
INVARIANCE = 1e-6  # [rad] (bound of the design)
SLOPE = 1e-4  # one-sided differences of a map with curvature
DEAD_BEAT = 0.01  # relative error after two steps
SETTINGS = SimulationSettings(rtol=1e-9, atol=1e-11)


def adaptive(biped, gait):
    return RestrictedMap(biped, gait, ReanchoringTransitions(biped, gait))


@pytest.fixture(params=["level", pytest.param("reference", marks=pytest.mark.slow), "robust"])
def gait(request):
    return request.getfixturevalue(f"{request.param}_gait")


def test_energy_along_the_rising_phase_is_the_orbits(biped, gait):
    """Integrated forwards from the impact on panels, and backwards from the reversal by quadrature: one zeta."""
    nodes = converged_nodes(biped, gait.rising, gait.falling, gait.step_width)
    orbit = gait.step(biped, nodes).rising
    energy = rising_energy(biped, ReanchoringTransitions(biped, gait).planned_rising)
    tau = np.linspace(0.05, 1.0, 9)
    expected = resample(biped, gait.rising, orbit, tau)
    zeta_plus = 0.5 * (energy.start_inertia * gait.orbit.beta_dot_after_impact) ** 2
    for beta, zeta in zip(expected.beta, expected.zeta, strict=True):
        gamma, spent = energy.at(min(max(beta, energy.start), gait.beta_reversal))
        assert np.exp(gamma) * (zeta_plus - spent) == pytest.approx(zeta, rel=1e-8, abs=1e-8 * zeta_plus)
    assert energy.reversal(gait.orbit.beta_dot_after_impact) == pytest.approx(gait.beta_reversal, abs=1e-9)


def test_gait_is_the_fixed_point_and_the_slope_is_the_multiplier(biped, gait):
    """From either side: late reversals retrace, early ones rejoin at second order (see `anchoring`)."""
    restricted = adaptive(biped, gait)
    assert restricted.speed_ratio(restricted.step(restricted.start()).landed) == pytest.approx(1.0, abs=1e-9)
    below, above = restricted.slope()
    assert below == pytest.approx(gait.orbit.multiplier, abs=SLOPE)
    assert above == pytest.approx(gait.orbit.multiplier, abs=SLOPE)


@pytest.mark.parametrize("ratio", [1.005, 1.03])
def test_late_reversals_obey_the_papers_affine_map(biped, level_gait, ratio):
    """Retracing makes rho of [O] eq. pcc exact, although the reversal point moves."""
    restricted = adaptive(biped, level_gait)
    hzd = HybridZeroDynamics(biped, level_gait.step(biped))
    found = restricted.speed_ratio(restricted.step(restricted.start(ratio)).landed)
    zeta = hzd.rho(ratio**2 * hzd.fixed_point)
    assert found**2 == pytest.approx(zeta / hzd.fixed_point, rel=1e-8)


CASES = [
    ("level", "adaptive", 0.03), ("robust", "ankle", 0.5), ("robust", "ankle", -0.5),
    *(
        pytest.param(*case, marks=pytest.mark.slow)
        for case in [
            ("level", "adaptive", -0.05), ("level", "adaptive", 0.3), ("reference", "adaptive", 0.001),
            ("reference", "ankle", -0.05), ("reference", "ankle", 0.25), ("level", "ankle", -0.2),
            ("level", "ankle", 0.5), ("robust", "ankle", -0.6), ("robust", "ankle", 0.8), ("robust", "step", -0.05),
            ("robust", "adaptive", -0.1), ("robust", "adaptive", 0.15), ("level", "step", 0.05),
        ]
    ),
]  # fmt: skip


@pytest.mark.parametrize(("name", "stabiliser", "error"), CASES)
def test_map_against_the_full_model(biped, request, name, stabiliser, error):
    """Two steps of the full model under continuous control from a speed error, against two steps of the map."""
    gait = request.getfixturevalue(f"{name}_gait")
    run = simulate(
        biped, gait, steps=2, period=None, speed_error=error, stabiliser=stabiliser, simulation_settings=SETTINGS
    )
    assert run.outcome == "completed"
    restricted = RestrictedMap(biped, gait, make_stabiliser(stabiliser, biped, gait))
    landed, speeds, reversals = restricted.start(1.0 + error), [], []
    for _ in range(2):
        step = restricted.step(landed)
        landed = step.landed
        speeds.append(landed.dbeta)
        reversals.append(step.reversal)
    assert run.post_impact_speeds[1:] == pytest.approx(speeds, rel=MAP)
    assert run.event_state[run.events("REVERSAL"), 0] == pytest.approx(reversals, abs=1e-6)
    assert np.max(np.abs(run.output_error)) < INVARIANCE
    assert run.settings["controller"]["unsolved"] == 0


def landed_speeds(biped, gait, stabiliser, ratio):
    """Post-impact speed after one step from a speed ratio: full model, restricted map [rad/s]."""
    restricted = RestrictedMap(biped, gait, make_stabiliser(stabiliser, biped, gait))
    run = simulate(
        biped,
        gait,
        steps=1,
        period=None,
        speed_error=float(ratio) - 1.0,
        stabiliser=restricted.stabiliser,
        simulation_settings=SimulationSettings(rtol=1e-8, atol=1e-10, record_rate=50.0),
    )
    assert run.outcome == "completed"
    return run.post_impact_speeds[-1], restricted.step(restricted.start(float(ratio))).landed.dbeta


@pytest.mark.slow
@pytest.mark.parametrize("stabiliser", ["adaptive", "ankle"])
def test_map_against_the_full_model_over_the_whole_basin(biped, gait, stabiliser):
    """One step under continuous control from each of twelve speeds, end to end of the interval that returns.

    The return itself, step after step, is the map's; it is walked from some of these speeds only.
    """
    basin = RestrictedMap(biped, gait, make_stabiliser(stabiliser, biped, gait)).basin()
    assert basin.low < 0.97 < 1.03 < basin.high
    for ratio in np.linspace(basin.low, basin.high, 12):
        full, closed = landed_speeds(biped, gait, stabiliser, ratio)
        assert full == pytest.approx(closed, rel=MAP), ratio


def test_ankle_law_lets_the_robot_fall(biped, robust_gait):
    """Reversals so late that the sole alone could hold the robot up: it leans inwards of its FRI all the same."""
    restricted = RestrictedMap(biped, robust_gait, AnkleLaw(biped, robust_gait))
    for ratio in (1.9, 2.0, 2.1):
        step = restricted.step(restricted.start(ratio))
        at = step.falling.motion(np.array([step.reversal]))
        assert at.p_fri[0] < biped.com(at.q[0])[0]
        assert 0.0 < step.landed.dbeta < ratio * robust_gait.orbit.beta_dot_after_impact


def test_a_robot_that_leans_outwards_of_its_fri_does_not_fall(biped, robust_gait):
    """Its energy would be positive at the impact, but not on the way there."""
    law = AnkleLaw(biped, robust_gait)
    step = RestrictedMap(biped, robust_gait, law).step(RestrictedMap(biped, robust_gait, law).start(1.94))
    at = step.falling.motion(np.array([step.reversal]))
    outwards = float(biped.com(at.q[0])[0] - at.p_fri[0]) + 0.002
    with pytest.raises(ReversalError, match="stops in the falling phase"):
        speed_at_end(falling_energy(biped, step.falling.shifted(outwards), step.reversal))


def test_ankle_law_keeps_the_target_in_the_sole(biped, robust_gait):
    restricted = RestrictedMap(biped, robust_gait, AnkleLaw(biped, robust_gait))
    outer, inner = biped.sole
    for ratio in (0.5, 0.9, 1.2, 1.7):
        step = restricted.step(restricted.start(ratio))
        for phase, end in ((step.rising, step.rising.beta_start), (step.falling, step.falling.beta_end)):
            p = phase.motion(np.linspace(end, step.reversal, 101)).p_fri
            assert np.all((p > outer) & (p < inner))
        assert step.tightest.value > 0.0


@pytest.mark.slow
def test_robust_gait_under_the_ankle_law_returns_from_far(biped, robust_gait):
    """Bound of the design: -40 % .. +60 %, aim -60 % .. +80 %, every contact constraint respected on the way."""
    basin = RestrictedMap(biped, robust_gait, AnkleLaw(biped, robust_gait)).basin()
    assert basin.low <= 0.4
    assert basin.high >= 1.8
    for error in (-0.6, 0.8):
        run = simulate(
            biped,
            robust_gait,
            steps=6,
            period=None,
            speed_error=error,
            stabiliser="ankle",
            simulation_settings=SETTINGS,
        )
        assert run.outcome == "completed"
        assert run.post_impact_speeds[-1] == pytest.approx(robust_gait.orbit.beta_dot_after_impact, rel=1e-4)
        friction = robust_gait.specification.friction
        assert np.all(np.abs(run.force[:, 0]) < friction * run.force[:, 1])
        assert np.all(run.force[:, 1] > robust_gait.specification.min_normal_force * biped.weight)
        outer, inner = biped.sole
        assert np.all((run.p_fri > outer) & (run.p_fri < inner))
        assert np.max(np.abs(run.output_error)) < INVARIANCE


@pytest.mark.slow
@pytest.mark.parametrize("error", [-0.6, 0.8])
def test_robust_gait_under_the_ankle_law_returns_with_torques_held_for_a_millisecond(biped, robust_gait, error):
    """The aims of the design again; nearer to standstill than -90 % continuous control returns and this does not."""
    run = simulate(biped, robust_gait, steps=6, period=1e-3, speed_error=error, stabiliser="ankle")
    assert run.outcome == "completed"
    assert speed_errors(run, robust_gait)[-1] < RECOVERED
    assert run.settings["controller"]["unsolved"] == 0


@pytest.mark.parametrize("error", [-0.1, 0.02, 0.05])
def test_dead_beat_step_law(biped, robust_gait, level_gait, error):
    gait = robust_gait if error < 0.0 else level_gait
    restricted = RestrictedMap(biped, gait, StepLaw(biped, gait))
    landed, widths = restricted.start(1.0 + error), []
    for _ in range(2):
        step = restricted.step(landed)
        landed = step.landed
        widths.append(step.width)
    assert restricted.speed_ratio(landed) == pytest.approx(1.0, abs=DEAD_BEAT)
    # more width, more energy; the second step is the gait's again
    assert np.sign(widths[0] - gait.step_width) == -np.sign(error)
    assert widths[1] == pytest.approx(gait.step_width, abs=1e-6)


def test_lqr_contracts_as_its_linear_map_says(biped, robust_gait):
    law = StepLaw(biped, robust_gait, rule=StepRule.LQR)
    a, b = law.linear_map
    closed_loop = a - b * law.gain
    assert abs(closed_loop) < abs(a)
    assert a == pytest.approx(robust_gait.orbit.multiplier, rel=1e-2)
    restricted = RestrictedMap(biped, robust_gait, law)
    energy = rising_energy(biped, ReanchoringTransitions(biped, robust_gait).planned_rising)
    shift = 1e-3 * robust_gait.rising.range
    start = restricted.start(energy.speed(robust_gait.beta_reversal + shift) / robust_gait.orbit.beta_dot_after_impact)
    following = restricted.step(restricted.step(start).landed).reversal - robust_gait.beta_reversal
    assert following / shift == pytest.approx(closed_loop, abs=0.02)


def test_a_step_that_does_not_exist_says_why(biped, level_gait):
    restricted = adaptive(biped, level_gait)
    with pytest.raises(ReversalError, match="does not rise"):
        restricted.step(restricted.start(-0.1))
    with pytest.raises(ReversalError, match="no reversal before"):
        restricted.step(restricted.start(5.0))
    fate = restricted.follow(5.0)
    assert not fate.returned
    assert "energy barrier" in fate.limited_by
