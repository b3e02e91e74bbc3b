"""What a scenario file says is what is run: defaults, moments, ranges, draws."""

from dataclasses import fields

import numpy as np
import pytest

import frontal_biped.scenarios.file as files
from frontal_biped.files.table import Range
from frontal_biped.model.perturbation import LINKS
from frontal_biped.model.stance_map import Stance
from frontal_biped.scenarios import Expectations, load_scenario
from frontal_biped.scenarios.preparation import conditions, prepare, trial_seed
from frontal_biped.scenarios.scenario import Moment
from frontal_biped.simulation import Disturbances

EVERYTHING = """
name = "all of it"
about = "every section"
robot = "frontal_biped"
steps = 12
seed = 5
stance = "right"
speed_error = {within = 0.02}
flat_landing = 0.1
slow = true
[gait]
max_pelvis_roll = 0.1
[controller]
type = "qp"
stabiliser = "step"
period = 0.002
frequency = 50
max_torque = [100, 100, 100, 100]
[model]
mass = {pelvis = 1.1, within = 0.05}
com = {pelvis = [0.01, -0.02]}
inertia = 1.2
length = {right_leg = 0.99}
[disturbances]
encoder_noise = 1e-4
delay = 0.004
friction = {from = 0.3, to = 0.9}
ground = [0.001, -0.001]
torque_limits = [40, 90]
[[push]]
at = "reversal of step 5"
impulse = {from = 2.0, to = 4.0}
[[push]]
at = "30 % of the rising phase of step 7"
impulse = -3.0
duration = 0.1
profile = "half-sine"
height = 0.3
[[push]]
time = 1.5
impulse = 1.0
[expect]
return_within = 4
step_duration = [0.6, 1.0]
survival = 0.9
"""


@pytest.fixture
def everything(write):
    return load_scenario(write(EVERYTHING))


def test_empty_file_is_a_scenario(write):
    scenario = load_scenario(write(""))
    assert scenario.name == "case"
    assert scenario.robot == "frontal_biped"
    assert scenario.expect == Expectations()
    assert not scenario.random


def test_everything_is_read(everything):
    assert (everything.name, everything.steps, everything.seed) == ("all of it", 12, 5)
    assert everything.stance is Stance.RIGHT
    assert everything.slow
    assert everything.speed_error == Range(-0.02, 0.02)
    assert everything.gait == {"max_pelvis_roll": 0.1}
    assert everything.controller.settings == {"frequency": 50.0, "max_torque": (100.0,) * 4}
    assert everything.model.fixed.mass[LINKS.index("pelvis")] == 1.1
    assert everything.model.within == {"mass": 0.05}
    assert np.array_equal(everything.model.fixed.com[2], [0.01, -0.02])
    assert np.all(everything.model.fixed.inertia == 1.2)
    assert np.array_equal(everything.model.fixed.length, [1.0, 0.99])
    assert everything.disturbances["friction"] == Range(0.3, 0.9)
    assert everything.disturbances["torque_limits"] == (40.0, 90.0)
    assert [push.moment for push in everything.pushes] == [
        Moment(step=5, phase="falling"),
        Moment(step=7, phase="rising", fraction=0.3),
        Moment(time=1.5),
    ]
    assert everything.expect.survival == 0.9
    assert everything.random


def test_paths_are_relative_to_the_scenario(write, tmp_path):
    scenario = load_scenario(write('robot = "robots/mine.toml"\ngait = "mine.gait.json"'))
    assert scenario.robot == str(tmp_path / "robots/mine.toml")
    assert scenario.gait == tmp_path / "mine.gait.json"


def test_what_is_drawn_stays_in_its_bounds_and_depends_on_seed_and_number_alone(everything):
    prepared = prepare(everything)
    numbers = [conditions(prepared, trial_seed(5, i)) for i in range(20)]
    again = conditions(prepared, np.random.SeedSequence(5).spawn(20)[7])
    assert again.drawn == numbers[7].drawn
    assert again.disturbances == numbers[7].disturbances
    assert again.errors.as_dict() == numbers[7].errors.as_dict()
    assert len({each.disturbances.seed for each in numbers}) == 20
    assert len({each.drawn["push 1 impulse"] for each in numbers}) == 20
    for each in numbers:
        assert abs(each.speed_error) <= 0.02
        assert 0.3 <= each.disturbances.friction <= 0.9
        assert 2.0 <= each.disturbances.pushes[0].impulse <= 4.0
        assert 1.1 * 0.95 <= each.errors.mass[2] <= 1.1 * 1.05
        assert np.array_equal(each.errors.com, everything.model.fixed.com)
    push = numbers[0].disturbances.pushes[1]
    assert (push.step, push.phase, push.profile, push.height) == (6, "rising", "half-sine", 0.3)
    assert push.start == pytest.approx(0.3 * prepared.gait.step(prepared.biped).rising.duration)


def test_every_disturbance_and_expectation_can_be_written():
    """A field that is added without its bounds would only be noticed by a user."""
    written = {*files._DISTURBANCES, "ground", "rolls", "torque_limits"}
    assert written == {field.name for field in fields(Disturbances)} - {"pushes", "seed"}
    special = {"steps", "return_within", "unsolved", "survival", "return_tolerance", "step_duration"}
    special |= {"walking_speed", "self_collisions"}
    assert {*files._EXPECTED, *special} == {field.name for field in fields(Expectations)}
