"""Controllers that take their steps in turn, and the frontal law that takes its step by the foot that stands."""

from pathlib import Path

import numpy as np
import pytest

from frontal_biped.control.frontal_law import FrontalLaw, FrontalSettings
from frontal_biped.control.stabilisers.by_name import make_stabilisers
from frontal_biped.control.steps_in_turn import StepsInTurn
from frontal_biped.control.walker.walker import Walker
from frontal_biped.exceptions import SimulationError
from frontal_biped.gait.file import load_any_gait
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.state import State
from frontal_biped.model.sway import Sway
from frontal_biped.virtual_constraints.phase import StepPhase

RISING, FALLING = StepPhase.RISING, StepPhase.FALLING


@pytest.fixture(scope="module")
def sideways():
    return load_any_gait(Path(__file__).parents[1] / "data" / "sideways.gait.json")


class Named:
    """A controller that remembers what it was told."""

    def __init__(self):
        self.begun = []

    def begin(self, phase, q, dq):
        self.begun.append(phase)

    def command(self, phase, q, dq):
        return self


def test_controllers_alternate_at_landings_alone():
    first, second = Named(), Named()
    both = StepsInTurn([first, second])
    q, moving, still = np.zeros(4), np.array([0.1, 0.0, 0.0, 0.0]), np.zeros(4)
    both.begin(RISING, q, moving)
    both.begin(FALLING, q, still)
    both.begin(RISING, q, still)  # pushed outwards again: the same step
    both.begin(FALLING, q, still)
    assert both.command(FALLING, q, -moving) is first
    both.begin(RISING, q, moving)
    assert both.command(RISING, q, moving) is second
    both.begin(FALLING, q, still)
    both.begin(RISING, q, moving)
    assert both.controller is first
    assert (first.begun, second.begun) == ([RISING, FALLING] * 2 + [RISING], [RISING, FALLING])


@pytest.mark.parametrize("first", Stance)
def test_frontal_law_takes_the_step_of_the_foot_that_stands(biped, sideways, first):
    law = FrontalLaw(biped, sideways, 1e-3, 100.0, FrontalSettings(settle=0.0))
    law.reset(first)
    of_steps = []
    for stance, step in ((first, sideways.a), (first.other, sideways.b), (first, sideways.a)):
        state = step.state_after_impact()
        sway = Sway(float(biped.com(state.q)[0]), float(biped.com_velocity(*state)[0]), np.zeros(4), 0.0)
        law.land(stance, sway, State(*state))
        assert law.orbit.duration == pytest.approx(step.orbit.step_duration, rel=1e-9)
        of_steps.append(law.orbit)
    assert of_steps[0] is of_steps[2] and of_steps[0] is not of_steps[1]


@pytest.mark.parametrize("name", ["adaptive", "step", "nobody"])
def test_stabilisers_that_look_ahead_to_the_same_step_are_refused(biped, sideways, name):
    with pytest.raises(SimulationError, match=rf"no stabiliser '{name}' for two steps in turn; known: fixed"):
        make_stabilisers(name, biped, sideways.steps)


def test_walker_follows_two_steps_over_the_sway_alone(biped, sideways):
    assert Walker(biped, sideways).over == "sway"
    for options in ({"over": "ankle"}, {"stabiliser": "step"}):
        with pytest.raises(SimulationError, match="two steps in turn are followed over the sway alone"):
            Walker(biped, sideways, **options)
