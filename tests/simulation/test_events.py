"""Events are located, counted in the right direction, and falls are told apart."""

import numpy as np
import pytest

from frontal_biped.model import State
from frontal_biped.simulation import SimulationSettings, simulate_walk
from frontal_biped.simulation.hybrid_system import FLAT_LANDING, EventKind, land, walking_guards
from frontal_biped.virtual_constraints import double_support_pose

EVENT_TIME = 1e-8  # [s] Runge-Kutta at 1 ms against DOP853 at rtol 1e-10


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


def test_no_torque_collapses_or_lands_and_says_so(biped, reference_gait):
    q, dq = reference_gait.state_after_impact()
    run = walk(biped, ConstantTorque(np.zeros(4)), q, dq)
    assert run.fell
    assert run.outcome in {kind.value for kind in EventKind}


def test_too_fast_outwards_tips_over(biped, reference_gait):
    from frontal_biped.control import QpController

    q, dq = reference_gait.state_after_impact()
    run = simulate_walk(
        biped, QpController(biped, reference_gait), State(q, 6.0 * dq), SimulationSettings(steps=1, period=1e-3)
    )
    assert run.fell
    assert run.steps_completed == 0


def test_impact_guard_counts_only_downward_crossings(biped):
    pose = double_support_pose(biped, -1.66, 0.3)
    guard = next(g for g in walking_guards(biped).falling if g.kind is EventKind.IMPACT)
    assert guard.direction == -1
    assert guard.function(pose, np.zeros(4)) == pytest.approx(0.0, abs=1e-12)
    raised = pose + np.array([0.02, 0.0, 0.0, 0.0])
    assert guard.function(raised, np.zeros(4)) > 0.0


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
