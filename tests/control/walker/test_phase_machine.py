"""Landings and reversals from flags that chatter and rates that are noisy."""

import numpy as np
import pytest

from frontal_biped.control.interface import PhaseEvent
from frontal_biped.control.walker.phase_machine import PhaseMachine, PhaseSettings
from frontal_biped.virtual_constraints.phase import StepPhase

H = 1e-3  # [s]
HIGH, NEAR = 0.03, 0.0  # [m] clearances: in the air, where the ground is expected


def falling_machine():
    """A machine whose swing foot has left the ground and whose robot falls."""
    machine = PhaseMachine(H)
    for _ in range(50):
        machine.landing(False, HIGH)
        machine.turn(0.3)
    for _ in range(10):
        machine.turn(-0.3)
    assert machine.phase is StepPhase.FALLING
    return machine


def test_a_touch_where_the_ground_is_expected_is_a_landing_at_once():
    machine = falling_machine()
    assert machine.landing(True, NEAR)
    assert machine.phase is StepPhase.RISING


def test_a_single_touch_high_above_the_ground_is_not():
    machine = falling_machine()
    assert not machine.landing(True, 0.01)
    assert not machine.landing(True, HIGH)
    assert not machine.landing(False, HIGH)


def test_a_lasting_touch_above_the_expected_ground_is_a_landing_even_if_the_flag_drops_out():
    machine = falling_machine()
    flags = [True, False, True, True, True]
    landed = [machine.landing(flag, 0.01) for flag in flags]
    assert any(landed)
    assert landed.index(True) * H <= PhaseSettings().touch + 3 * H  # one drop-out costs two readings


def test_the_bounce_of_a_landing_is_no_second_landing():
    """The old stance foot chatters while it leaves the ground, and the robot may be said to fall."""
    machine = falling_machine()
    assert machine.landing(True, NEAR)
    machine.phase = StepPhase.FALLING
    generator = np.random.default_rng(0)
    for flag in generator.random(100) < 0.7:  # never away for longer than `lifted`
        flag = flag or machine._free + H > PhaseSettings().lifted
        assert not machine.landing(bool(flag), NEAR)


def test_a_scuff_while_rising_is_counted_and_a_lasting_one_is_an_early_landing():
    machine = PhaseMachine(H)
    for _ in range(20):
        machine.landing(False, HIGH)
    assert not any(machine.landing(True, NEAR) for _ in range(5))
    for _ in range(20):
        machine.landing(False, HIGH)
    assert (machine.scuffs, machine.early_landings) == (1, 0)
    assert any(machine.landing(True, NEAR) for _ in range(round(PhaseSettings().scuff / H) + 1))
    assert (machine.scuffs, machine.early_landings) == (1, 1)


@pytest.mark.parametrize("height", [-0.005, 0.003, 0.005])
def test_a_foot_that_stays_on_uneven_ground_has_not_left_it(height):
    """After a landing the old stance foot still touches, some millimetres off by the joints: no landing of its own."""
    machine = PhaseMachine(H)
    assert not any(machine.landing(True, height) for _ in range(100))
    assert (machine.scuffs, machine.early_landings) == (0, 0)


@pytest.mark.parametrize("stood", [0.0, 0.01])
def test_what_is_high_depends_on_where_the_foot_stood(stood):
    """A foot on ground 10 mm higher than the new stance foot's has not left it at 10 mm."""
    machine = PhaseMachine(H)
    machine.stands(stood)
    landed = [machine.landing(True, 0.01) for _ in range(100)]
    assert any(landed) == (stood == 0.0)
    machine.reset()
    machine.stands(stood)
    for _ in range(10):
        machine.landing(True, stood + 2.0 * PhaseSettings().standing)
    assert machine._lifted


def test_a_foot_high_above_the_ground_has_left_it_whatever_its_flag_says():
    machine = PhaseMachine(H)
    for _ in range(50):
        machine.landing(True, HIGH)
        machine.turn(-0.3)
    assert machine.landing(True, NEAR)


def test_scuffs_are_never_negative():
    """Lifted while it touches, by its height, and on the ground again at once."""
    machine = PhaseMachine(H)
    for clearance in [HIGH] * 10 + [NEAR] * 30:
        machine.landing(True, clearance)
        assert machine.scuffs >= 0


def test_a_landing_below_the_known_ground_is_late():
    machine = falling_machine()
    assert machine.landing(True, -0.005)
    assert machine.late_landings == 1


@pytest.mark.parametrize("seed", range(5))
def test_a_noisy_rate_reverses_once_and_near_its_zero(seed):
    """A rate through zero at 1 rad/s^2, noise of a third of the hysteresis: one reversal within 25 ms of the zero."""
    machine, generator = PhaseMachine(H), np.random.default_rng(seed)
    noise = PhaseSettings().rate / 3.0
    events = []
    for k in range(600):
        t = k * H
        event = machine.turn(0.3 - 1.0 * t + noise * generator.standard_normal())
        if event is not None:
            events.append((t, event))
    assert [event for _, event in events] == [PhaseEvent.REVERSAL]
    assert abs(events[0][0] - 0.3) < 0.025


def test_the_ringing_of_an_impact_is_no_reversal():
    machine = PhaseMachine(H)
    assert all(machine.turn(rate) is None for rate in [0.3, -2.0, 1.0, -0.5] * 5)
    assert machine.phase is StepPhase.RISING


def test_a_push_outwards_while_falling_is_told():
    machine = falling_machine()
    events = [machine.turn(0.2) for _ in range(60)]
    assert events.count(PhaseEvent.TURNED_OUTWARDS) == 1
    assert machine.phase is StepPhase.RISING
