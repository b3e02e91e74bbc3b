"""Two ways through continuous time: by collocation and by DOP853, the same motion."""

import numpy as np
import pytest

from frontal_biped.control import ControllerSettings, QpController
from frontal_biped.control.stabilisers.transitions import FixedTransitions, ReanchoringTransitions
from frontal_biped.model.perturbation import ModelErrors
from frontal_biped.model.state import State
from frontal_biped.simulation import SimulationSettings, simulate_walk
from frontal_biped.simulation.walking import start_state

RTOL, ATOL = 1e-9, 1e-11
SAME = 1e-8
"""[s], [rad], [rad/s]: both err by their tolerance, which two steps and their impacts hand on."""


class OneByOne(QpController):
    """Of a subclass nobody knows that it answers many states as it answers one: it is asked for single ones."""


def walk(kind, biped, gait, stabiliser, error, errors=None):
    control = kind(biped, gait, ControllerSettings.for_gait(gait), stabiliser)
    settings = SimulationSettings(steps=2, rtol=RTOL, atol=ATOL)
    return simulate_walk(biped, control, start_state(gait, error), settings, errors=errors), control


LEGS = ModelErrors(mass=np.array([1.0, 1.01, 0.99, 1.02, 1.0]))
CASES = {
    "on the orbit": (None, 0.0, None),
    "re-anchored where it is faster": (ReanchoringTransitions, 0.01, None),
    "another robot": (ReanchoringTransitions, 0.0, LEGS),
    "a fall": (None, -0.3, None),
}


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_both_follow_the_same_motion(biped, reference_gait, case):
    made, error, errors = CASES[case]
    runs = []
    for kind in (QpController, OneByOne):
        stabiliser = FixedTransitions(reference_gait) if made is None else made(biped, reference_gait)
        run, control = walk(kind, biped, reference_gait, stabiliser, error, errors)
        runs.append(run)
        assert control.unsolved == 0
    at_once, one_by_one = runs
    assert at_once.outcome == one_by_one.outcome
    assert at_once.event_kind == one_by_one.event_kind
    assert at_once.event_t == pytest.approx(one_by_one.event_t, abs=SAME)
    assert np.abs(at_once.event_state - one_by_one.event_state).max() < 30.0 * SAME
    assert len(at_once.t) == len(one_by_one.t)
    assert np.abs(at_once.q - one_by_one.q).max() < 10.0 * SAME


def test_samples_join_the_events_and_are_evenly_spread(biped, reference_gait):
    run, _ = walk(QpController, biped, reference_gait, FixedTransitions(reference_gait), 0.0)
    for step, phase in ((0, 1.0), (0, -1.0), (1, 1.0)):
        keep = (run.step == step) & (run.phase == phase)
        assert np.diff(run.t[keep]) == pytest.approx(np.diff(run.t[keep])[0], rel=1e-9)
    impact = run.events("IMPACT")[1]
    first = np.flatnonzero(run.step == 1)[0]
    assert run.t[first] == run.event_t[impact]
    assert (np.concatenate([run.q[first], run.dq[first]]) == run.event_state[impact]).all()


def test_recorded_at_once_is_what_single_states_give(biped, reference_gait):
    run, control = walk(QpController, biped, reference_gait, FixedTransitions(reference_gait), 0.0)
    last = int(run.step[-1])
    for i in np.flatnonzero(run.step == last)[::40]:
        state = State(run.q[i], run.dq[i])
        ddq = biped.forward_dynamics(*state, run.u[i])
        assert run.force[i] == pytest.approx(biped.ground_reaction(*state, ddq), abs=1e-8)
        assert run.p_fri[i] == pytest.approx(biped.fri(*state, ddq), abs=1e-11)
        phase = control.gait.rising if run.phase[i] > 0.0 else control.gait.falling
        assert run.q_b_desired[i] == pytest.approx(phase.desired(float(run.q[i, 0]))[0], abs=1e-12)


def test_a_walk_that_is_too_slow_ends_in_time(biped, reference_gait):
    """Torque-free but for gravity's: nothing happens for as long as a phase may last, by either way."""

    class Balanced(QpController):
        def command(self, phase, q, dq, fri_shift=0.0):
            return super().command(phase, q, dq)._replace(u=biped.bias(q, dq))

    q = np.full(4, -0.5 * np.pi)
    control = Balanced(biped, reference_gait)
    run = simulate_walk(biped, control, State(q, np.zeros(4)), SimulationSettings(steps=1))
    assert run.fell
