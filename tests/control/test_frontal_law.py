"""The frontal law over the sway: on the orbit it asks for the orbit; off it the FRI moves the right way."""

import numpy as np
import pytest
from whole_robots import whole

from frontal_biped.control.controller import SHIFT_ROOM
from frontal_biped.control.frontal_law import LEARNED, FrontalLaw, FrontalSettings
from frontal_biped.control.interface import PhaseEvent
from frontal_biped.model import Stance
from frontal_biped.model.state import State
from frontal_biped.model.sway import Sway
from frontal_biped.virtual_constraints.phase import StepPhase

H, FREQUENCY = 1e-3, 60.0

POSE = 2e-4
"""Output error that interpolating the orbit leaves [rad]."""

SETTLED = 0.1
"""After a landing the energy law is at work from here [s]."""


def seen(robot, q, dq):
    """A state as the law is told of it; rows are not its business."""
    nothing = np.zeros(0)
    sway = Sway(float(robot.biped.com(q)[0]), float(robot.biped.com_velocity(q, dq)[0]), nothing, 0.0)
    return State(q, dq), sway


def states(robot, phase, count=25):
    """Of the orbit, in the order of the motion."""
    step = robot.gait.step(robot.biped)
    orbit = step.rising if phase is StepPhase.RISING else step.falling
    order = np.argsort(orbit.tau)[:: -1 if phase is StepPhase.RISING else 1]
    for k in order[:: max(1, len(order) // count)]:
        yield orbit.motion.q[k], orbit.motion.dq[k] * orbit.dbeta[k], float(orbit.motion.p_fri[k])


@pytest.fixture(params=["talos_bent", "romeo_bent"])
def robot(request):
    return whole(request.param)


def law_of(robot, **settings):
    law = FrontalLaw(robot.biped, robot.gait, H, FREQUENCY, FrontalSettings(settle=0.0, **settings))
    first = next(states(robot, StepPhase.RISING))
    frontal, sway = seen(robot, *first[:2])
    law.land(Stance.LEFT, sway, frontal)
    for _ in range(round(SETTLED / H)):
        law.at(StepPhase.RISING, frontal, sway, None, 0.0)
    return law


def test_on_the_orbit_it_asks_for_the_orbit(robot):
    law = law_of(robot)
    for phase in StepPhase:
        event = PhaseEvent.REVERSAL if phase is StepPhase.FALLING else None
        for q, dq, p_fri in states(robot, phase):
            frontal, sway = seen(robot, q, dq)
            wanted = law.at(phase, frontal, sway, event, 0.0)
            event = None
            assert wanted.targets.sway is sway
            assert np.abs(wanted.y).max() < POSE
            low, high = (SHIFT_ROOM * end for end in robot.biped.sole)
            assert wanted.targets.p_fri == pytest.approx(min(max(p_fri, low), high), abs=3e-3)


@pytest.mark.parametrize("fast", [1.2, 0.8])
def test_the_fri_moves_against_the_error(robot, fast):
    """Too fast outwards: the FRI outwards, which draws the robot back; too fast inwards: the FRI inwards."""
    for phase, outwards in ((StepPhase.RISING, -1.0), (StepPhase.FALLING, 1.0)):
        law = law_of(robot)
        q, dq, _ = list(states(robot, phase))[12]
        event = PhaseEvent.REVERSAL if phase is StepPhase.FALLING else None
        frontal, sway = seen(robot, q, dq)
        planned = law.at(phase, frontal, sway, event, 0.0).targets.p_fri
        _, moved = seen(robot, q, fast * dq)
        shift = law.at(phase, frontal, moved, None, 0.0).targets.p_fri - planned
        assert np.sign(shift) == outwards * np.sign(fast - 1.0)


def test_an_unexplained_acceleration_is_taken_off(robot):
    """What pushes inwards is met by an FRI further inwards, by z/g of it."""
    law, plain = law_of(robot), law_of(robot)
    q, dq, _ = list(states(robot, StepPhase.RISING))[8]
    frontal, sway = seen(robot, q, dq)
    for _ in range(2000):
        moved = law.at(StepPhase.RISING, frontal, sway, None, 0.05).targets.p_fri
    shift = moved - plain.at(StepPhase.RISING, frontal, sway, None, 0.0).targets.p_fri
    assert shift == pytest.approx(0.05 / law.orbit.omega**2, rel=0.01)


def test_it_learns_what_comes_back(robot):
    """A fall that is too fast half-way leaves an offset inwards for the next one on that foot, inside the sole."""
    law = law_of(robot)
    fall = list(states(robot, StepPhase.FALLING))
    assert np.isnan(law.mid_fall)
    event = PhaseEvent.REVERSAL
    for q, dq, _ in fall:
        law.at(StepPhase.FALLING, *seen(robot, q, 1.05 * dq), event, 0.0)
        event = None
    assert law.mid_fall == pytest.approx(0.05, abs=0.01)
    assert 0.0 < law.offset[Stance.LEFT] <= LEARNED * robot.biped.sole[1]
    assert law.offset[Stance.RIGHT] == 0.0


def test_a_reversal_anywhere_goes_on_from_there(robot):
    """Targets do not jump, however early or late the robot turns."""
    for k in (6, 12, 20):
        law = law_of(robot)
        rising = list(states(robot, StepPhase.RISING))
        q, dq, _ = rising[k]
        frontal, sway = seen(robot, q, dq)
        before = law.at(StepPhase.RISING, frontal, sway, None, 0.0)
        still = sway._replace(rate=0.0)
        after = law.at(StepPhase.FALLING, frontal, still, PhaseEvent.REVERSAL, 0.0)
        np.testing.assert_allclose(after.y, before.y, atol=1e-9)
        np.testing.assert_allclose(after.targets.h_d1, before.targets.h_d1, atol=1e-6)
