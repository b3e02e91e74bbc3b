"""What to change against a fall in space: what must be wrong before what may be."""

from dataclasses import replace

import numpy as np
import pytest

from frontal_biped.gait.file import load_gait
from frontal_biped.model import load_robot, models_dir
from frontal_biped.simulation.hybrid_system import EventKind
from frontal_biped.simulation.space.falls import spatial_fall_remedy
from frontal_biped.simulation.trajectory import COMPLETED

TOPPLED_OVER = "the pelvis tilted by more than 60 degrees"


class Run:
    """Of a walk what the advice looks at."""

    def __init__(self, outcome=TOPPLED_OVER, speeds=(0.0,), pushes=()):
        self.outcome, self.fell = outcome, outcome != COMPLETED
        self.speed_target, self.settings = np.array(speeds), {"pushes": list(pushes)}


@pytest.fixture(scope="module")
def bent():
    robot = load_robot("talos_bent")
    return robot, load_gait(models_dir() / "talos_bent.gait.json")


def asked(gait, **keys):
    return replace(gait, specification=replace(gait.specification, **keys))


def test_no_advice_without_a_fall_or_knowledge(bent):
    assert spatial_fall_remedy(*bent, Run(COMPLETED, (0.3,))) is None
    assert spatial_fall_remedy(*bent, Run()) is None


def test_speed_then_pushes_then_the_outcome(bent):
    push = {"impulse": [0.0, 90.0, 0.0]}
    assert spatial_fall_remedy(*bent, Run(speeds=(0.0, 0.2, -0.6), pushes=[push])) == "walk slower than -0.6 m/s"
    assert spatial_fall_remedy(*bent, Run(pushes=[push])).startswith("push less")
    assert "ask for fri_margin = " in spatial_fall_remedy(*bent, Run(EventKind.TURNED_OUTWARDS.value))


def test_what_the_ground_cannot_hold_comes_first(bent):
    robot, gait = bent
    slippery = asked(gait, friction=0.01, yaw_friction=None)
    advice = spatial_fall_remedy(robot, slippery, Run(speeds=(0.2,)))
    assert advice.startswith("the gait needs a F_h and yaw moment") and "ask for yaw_friction = 0.01" in advice
    wide = asked(gait, cop_margin_x=0.5)
    assert "ask for cop_margin_x = 0.5, and design again" in spatial_fall_remedy(robot, wide, Run())
