"""Commands for many states at once are those for each of them, or there are none."""

from dataclasses import replace

import numpy as np
import pytest

from frontal_biped.control import ControllerSettings, QpController
from frontal_biped.control.interface import many_at_once
from frontal_biped.control.stabilisers.transitions import ReanchoringTransitions
from frontal_biped.control.steps_in_turn import StepsInTurn
from frontal_biped.control.torques.torque_program import Source
from frontal_biped.virtual_constraints import StepPhase

ROUNDING = 1e-8  # [N m] of torques up to a hundred


def states(gait, count, off):
    """Of both phases, around the virtual constraints."""
    rng = np.random.default_rng(3)
    for kind, phase in ((StepPhase.RISING, gait.rising), (StepPhase.FALLING, gait.falling)):
        at = phase.motion(phase.beta_start + np.linspace(0.02, 0.98, count) * phase.range)
        q = at.q + off * rng.normal(size=(count, 4))
        yield kind, q, 0.1 * kind.sign * at.dq + off * rng.normal(size=(count, 4))


def controller(biped, gait, **changes):
    return QpController(biped, gait, replace(ControllerSettings.for_gait(gait), **changes))


@pytest.mark.parametrize("joint_rate", [None, 100.0])
@pytest.mark.parametrize("stabiliser", [None, ReanchoringTransitions])
def test_they_are_those_for_single_states(biped, reference_gait, joint_rate, stabiliser):
    one = controller(biped, reference_gait, joint_rate=joint_rate)
    if stabiliser is not None:
        q, dq = reference_gait.state_after_impact()
        one.stabiliser = stabiliser(biped, reference_gait)
        one.begin(StepPhase.RISING, q + 1e-3, 1.02 * dq)
        one.begin(StepPhase.FALLING, q + 0.02, 0.0 * dq)
    for kind, q, dq in states(reference_gait, 12, 1e-4):
        singles = [one.command(kind, *state) for state in zip(q, dq, strict=True)]
        free = [single.source is Source.CLOSED_FORM for single in singles]
        assert sum(free) > 8  # at the end of the rising phase a joint limit may bind
        ticks, unsolved = one.ticks, one.unsolved
        found = one.commands(kind, q[free], dq[free])
        assert (one.ticks, one.unsolved) == (ticks + sum(free), unsolved)
        for i, single in enumerate(single for single in singles if single.source is Source.CLOSED_FORM):
            assert found.u[i] == pytest.approx(single.u, abs=ROUNDING)
            assert found.y[i] == pytest.approx(single.y, abs=1e-14)
            assert found.p_fri_target[i] == pytest.approx(single.p_fri_target, abs=1e-14)


def test_there_are_none_where_one_of_the_states_is_at_a_limit(biped, reference_gait):
    one = controller(biped, reference_gait)
    (kind, q, dq), *_ = states(reference_gait, 12, 0.0)
    assert one.commands(kind, q, dq) is not None
    away = q.copy()
    away[7, 2] += 0.3
    assert one.command(kind, away[7], dq[7]).source is not Source.CLOSED_FORM
    before = dict(one.counts)
    assert one.commands(kind, away, dq) is None
    assert one.counts == before
    away[7, 2] = np.nan
    assert one.commands(kind, away, dq) is None


LIMITS = {
    "torque": {"max_torque": (1.0, 1.0, 1.0, 1.0)},
    "friction": {"friction": 1e-6},
    "normal force": {"min_normal_force": 1.5},
    "joints": {"joint_rate": 1e-3},
}


@pytest.mark.parametrize("limit", LIMITS)
def test_every_limit_is_looked_at(biped, reference_gait, limit):
    free, bound = controller(biped, reference_gait), controller(biped, reference_gait, **LIMITS[limit])
    for kind, q, dq in states(reference_gait, 12, 0.0):
        assert free.commands(kind, q, dq) is not None
        sources = {bound.command(kind, *state).source for state in zip(q, dq, strict=True)}
        assert (bound.commands(kind, q, dq) is None) == (sources != {Source.CLOSED_FORM})


@pytest.mark.parametrize("changes", [{"outputs": "clf"}, {"solver": "proxqp"}])
def test_programs_that_are_solved_one_by_one_have_none(biped, reference_gait, changes):
    (kind, q, dq), *_ = states(reference_gait, 3, 0.0)
    assert controller(biped, reference_gait, **changes).commands(kind, q, dq) is None


class Own(QpController):
    """A user's controller that changes what is commanded."""

    def command(self, phase, q, dq, fri_shift=0.0):
        return super().command(phase, q, dq, 0.01)


def test_only_the_class_that_defines_both_answers_many_at_once(biped, reference_gait):
    plain = controller(biped, reference_gait)
    assert many_at_once(plain) is plain
    turns = StepsInTurn([plain, plain])
    assert many_at_once(turns) is turns
    assert many_at_once(Own(biped, reference_gait)) is None
    plain.command = lambda *asked: None
    assert many_at_once(plain) is None


def test_steps_in_turn_ask_the_controller_in_charge(biped, reference_gait):
    one = controller(biped, reference_gait)
    (kind, q, dq), *_ = states(reference_gait, 3, 0.0)
    assert (StepsInTurn([one]).commands(kind, q, dq).u == one.commands(kind, q, dq).u).all()
