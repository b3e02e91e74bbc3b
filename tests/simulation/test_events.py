"""Events are located, counted in the right direction, and falls are told apart."""

import numpy as np
import pytest
from scipy.optimize import brentq

from frontal_biped.model import Stance, State
from frontal_biped.simulation import SimulationSettings, continuous, simulate_walk
from frontal_biped.simulation.hybrid_system import FLAT_LANDING, GRAZE, LEAVING, EventKind, land, walking_guards
from frontal_biped.simulation.loop import TOO_STIFF
from frontal_biped.simulation.stance_motion import StanceMotion
from frontal_biped.virtual_constraints import double_support_pose

EVENT_TIME = 1e-8  # [s] Runge-Kutta at 1 ms against DOP853 at rtol 1e-9
ENERGY = 1e-7  # relative: DOP853 at rtol 1e-9, an error of that size in each of up to a hundred steps


class ConstantTorque:
    """The same torques whatever the state: held or continuous control must then be the same motion."""

    def __init__(self, u):
        self.u = np.asarray(u, dtype=float)
        self.y = np.zeros(3)
        self.p_fri_target = 0.0

    def begin(self, phase, q, dq):
        pass

    def command(self, phase, q, dq):
        return self


def walk(biped, controller, q, dq, **settings):
    return simulate_walk(biped, controller, State(q, dq), SimulationSettings(steps=1, **settings))


@pytest.mark.parametrize("period", [1e-3, 2.7e-3])
def test_held_and_continuous_flow_agree_when_the_torque_is_constant(biped, reference_gait, period):
    q, dq = reference_gait.state_after_impact()
    controller = ConstantTorque(biped.G(q) * 0.9)
    runs = [walk(biped, controller, q, dq, period=T) for T in (None, period)]
    assert runs[0].event_kind == runs[1].event_kind
    assert "REVERSAL" in runs[0].event_kind
    assert runs[0].event_t == pytest.approx(runs[1].event_t, abs=EVENT_TIME)
    # the stance ankle crosses zero speed at the reversal, in both
    for run in runs:
        state = run.event_state[run.event_kind.index("REVERSAL")]
        assert abs(state[4]) < 1e-9


def test_without_torque_energy_is_kept_until_the_swing_foot_drops_and_the_run_says_so(biped, reference_gait):
    """Torques carry the swing leg. Of the ways to end a phase the one that is told has come, no other before it."""
    q, dq = reference_gait.state_after_impact()
    run = walk(biped, ConstantTorque(np.zeros(4)), q, dq)
    energy = np.array([biped.energy(*state) for state in zip(run.q, run.dq, strict=True)])
    assert energy == pytest.approx(energy[0], rel=ENERGY)
    state = run.event_state[-1]
    assert run.fell
    assert run.steps_completed == 0
    assert run.outcome == EventKind.EARLY_LANDING.value
    guard = next(g for g in walking_guards(biped).rising if g.kind is EventKind.EARLY_LANDING)
    assert abs(guard.function(state[:4], state[4:])) < GRAZE
    assert -LEAVING - 2.0 * GRAZE < biped.swing_sole(state[:4])[:, 1].min() < 0.0
    # and nothing else had come before it: still rising, over its sole, upright
    assert state[4] > 0.0
    assert biped.com(state[:4])[0] > biped.sole[0]
    assert biped.com(state[:4])[1] > 0.9 * biped.com(q)[1]


def test_too_fast_outwards_tips_over(biped, reference_gait):
    from frontal_biped.control import QpController

    q, dq = reference_gait.state_after_impact()
    run = simulate_walk(
        biped, QpController(biped, reference_gait), State(q, 6.0 * dq), SimulationSettings(steps=1, period=1e-3)
    )
    assert run.fell
    assert run.steps_completed == 0


def test_a_sole_that_has_not_left_the_ground_may_dip_and_one_that_has_may_not(biped):
    """The ground holds up a foot that lies on it, whatever the torques do to it; one in the air it meets."""
    guard = next(g for g in walking_guards(biped).rising if g.kind is EventKind.EARLY_LANDING)
    pose = double_support_pose(biped, -1.66, 0.3)
    flat = np.eye(4)[3]
    lying, raised = (
        q + flat * brentq(lambda turn, q=q: biped.swing_clearance(q + turn * flat) + 0.5 * LEAVING, 0.0, 0.5)
        for q in (pose, pose + np.array([0.05, 0.0, 0.0, -0.05]))
    )
    assert guard.function(lying, np.zeros(4)) > 0.0 > guard.function(raised, np.zeros(4))


def test_impact_guard_counts_only_downward_crossings(biped):
    pose = double_support_pose(biped, -1.66, 0.3)
    guard = next(g for g in walking_guards(biped).falling if g.kind is EventKind.IMPACT)
    lowered = pose - np.array([0.02, 0.0, 0.0, 0.0])
    assert guard.function(pose, np.zeros(4)) == pytest.approx(0.0, abs=1e-12)
    raised = pose + np.array([0.02, 0.0, 0.0, 0.0])
    assert guard.function(raised, np.zeros(4)) > 0.0 > guard.function(lowered, np.zeros(4))
    motion, guards = StanceMotion(biped, Stance.LEFT), walking_guards(biped).falling
    for rate, found in ((-1.0, EventKind.IMPACT), (1.0, None)):  # through the pose, downwards and upwards
        rates = np.array([rate, 0.0, 0.0, 0.0])
        begun = State(pose - 1e-3 * rates, rates)
        motion.u = biped.bias(*begun)  # on at this speed
        ends = [guards.values(*at) for at in (begun, motion.advance(begun, 2e-3))]
        assert ends[0][0] * ends[1][0] < 0.0
        crossing = motion.first_crossing(begun, 2e-3, guards, *ends)
        assert (crossing and crossing[1]) is found


def test_a_foot_that_lands_at_an_angle(biped):
    pose = double_support_pose(biped, -1.66, 0.3)
    dq = np.array([-0.2, 0.1, 0.1, 0.0])
    flat = land(biped, pose, dq)
    assert np.array_equal(flat.q_plus, pose[::-1])
    tilted = pose + np.array([0.0, 0.0, 0.0, 0.5 * FLAT_LANDING])
    settled = land(biped, tilted, dq)
    # the leg keeps its absolute direction: the tilt is taken out of the new stance ankle
    assert settled.q_plus[0] == pytest.approx(pose[3])
    assert land(biped, pose + np.array([0.0, 0.0, 0.0, 1.5 * FLAT_LANDING]), dq) is None


def test_torques_that_no_integrator_can_follow_end_the_walk(biped, reference_gait, monkeypatch):
    """They change sign within nanoradians: without an end to it the steps become as short as that, for hours."""
    monkeypatch.setattr(continuous, "MOST_EVALUATIONS", 2000)
    q, dq = reference_gait.state_after_impact()

    class Chatter(ConstantTorque):
        def command(self, phase, q, dq):
            self.u = biped.G(q) + 40.0 * np.sign(np.sin(1e9 * q))
            return self

    run = walk(biped, Chatter(np.zeros(4)), q, dq)
    assert run.outcome == TOO_STIFF
    assert 0.0 < run.t[-1] < 0.1
    assert np.isfinite(run.q).all()
