"""Walks of the whole robot in space: what a file says is what is walked, and what it is judged by."""

from dataclasses import replace

import numpy as np
import pytest
from standing import Stander

from frontal_biped.control.spatial_walker.path_walker import PathWalker
from frontal_biped.control.spatial_walker.walker import SpatialWalker
from frontal_biped.exceptions import ScenarioError
from frontal_biped.files.table import Range
from frontal_biped.model.stance_map import Stance
from frontal_biped.scenarios import load_scenario, run_scenario, run_trials
from frontal_biped.scenarios.expectations import judge
from frontal_biped.scenarios.preparation import prepare, trial_seed
from frontal_biped.scenarios.scenario import CommandPlan
from frontal_biped.scenarios.space_measures import spatial_measures
from frontal_biped.scenarios.space_run import spatial_conditions, spatial_walker
from frontal_biped.simulation.space.run import load_spatial_run
from frontal_biped.simulation.space.settings import SpeedChange

pytest.importorskip("mujoco")

EVERYTHING = """
space = true
robot = "talos_full"
steps = 9
seed = 5
stance = "right"
speed_error = {within = 0.02}
speed = {from = 0.1, to = 0.3}
[controller]
period = 0.002
delay = 0.004
output = 50
[[command]]
step = 4
lateral = 0.05
turn = {within = 0.1}
[[command]]
time = 3.0
speed = 0.0
[model]
mass = {within = 0.1}
inertia = 1.2
com = {within = 0.01}
[disturbances]
friction = {from = 0.4, to = 1.0}
velocity_noise = 0.02
delay = 0.006
ground = [0.001, -0.001]
[[push]]
at = "30 % of the falling phase of step 5"
impulse = {from = 5.0, to = 10.0}
direction = {within = 180}
link = "torso_2_link"
point = [0.0, 0.0, 0.1]
profile = "half-sine"
[[push]]
time = {from = 1.0, to = 2.0}
impulse = [1.0, {within = 2.0}, -0.5]
duration = 0.2
[expect]
walking_speed = [0.0, 0.4]
yaw_drift = 0.1
self_collisions = 0
cop_margin = 0.01
joint_speed = 1.0
"""

SHORT = """
space = true
robot = "talos_full"
steps = 1
"""


@pytest.fixture
def everything(write):
    return load_scenario(write(EVERYTHING))


def test_what_the_file_says(everything):
    plan = everything.space
    assert everything.simulator == "mujoco"
    assert everything.controller.kind == "walker"
    assert everything.controller.settings == {"output": 50.0}
    assert plan.commands == (
        CommandPlan(step=0, speed=Range(0.1, 0.3)),
        CommandPlan(step=3, lateral=0.05, turn=Range(-0.1, 0.1)),
        CommandPlan(time=3.0, speed=0.0),
    )
    assert plan.within == {"mass": 0.1, "com": 0.01}
    assert plan.factors == {"inertia": 1.2}
    assert plan.velocity_noise == 0.02
    assert [push.link for push in plan.pushes] == ["torso_2_link", ""]
    assert plan.pushes[1].impulse == (1.0, Range(-2.0, 2.0), -0.5)
    assert everything.disturbances["ground"] == (0.001, -0.001)
    assert everything.random


def test_what_is_drawn_stays_in_its_bounds_and_depends_on_seed_and_number_alone(everything):
    prepared = prepare(everything)
    many = [spatial_conditions(prepared, trial_seed(5, i)) for i in range(20)]
    again = spatial_conditions(prepared, np.random.SeedSequence(5).spawn(20)[7])
    assert again.drawn == many[7].drawn
    assert again.settings == many[7].settings
    assert again.errors.as_dict() == many[7].errors.as_dict()
    angles = []
    for each in many:
        settings = each.settings
        assert settings.commands[0] == SpeedChange(speed=each.drawn["command 1 speed"], step=0)
        assert 0.1 <= settings.commands[0].speed <= 0.3
        assert settings.commands[2] == SpeedChange(speed=0.0, time=3.0)
        first, second = settings.pushes
        size = np.hypot(*first.impulse[:2])
        assert 5.0 <= size <= 10.0
        angles.append(np.degrees(np.arctan2(first.impulse[1], first.impulse[0])))
        assert first.impulse[2] == 0.0
        assert (first.step, first.phase, first.link, first.point) == (4, "falling", "torso_2_link", (0.0, 0.0, 0.1))
        assert first.start == pytest.approx(0.3 * prepared.phase_durations["falling"])
        assert second.impulse[0::2] == (1.0, -0.5)
        assert abs(second.impulse[1]) <= 2.0
        assert 1.0 <= second.start <= 2.0
        assert np.abs(each.errors.mass - 1.0).max() <= 0.1
        assert each.errors.inertia.tolist() == [1.2] * (1 + len(prepared.free.joint_names))
        assert np.abs(each.errors.com).max() <= 0.01
        assert 0.4 <= settings.disturbances.friction <= 1.0
        assert settings.velocity_noise == 0.02
    assert max(angles) > 90.0
    assert min(angles) < -90.0


def test_the_walker_is_told_what_the_scenario_says(everything):
    prepared = prepare(everything)
    walker = spatial_walker(prepared, spatial_conditions(prepared, trial_seed(0, 0)))
    assert isinstance(walker, SpatialWalker)
    assert (walker.period, walker.delay, walker.settings.output) == (0.002, 0.004, 50.0)
    knowing = replace(everything, controller=replace(everything.controller, delay=None))
    prepared = prepare(knowing)
    assert spatial_walker(prepared, spatial_conditions(prepared, trial_seed(0, 0))).delay == pytest.approx(0.006)


class Leaner(Stander):
    """One's own controller: it stands, and so falls from where a walk begins; called as the scenarios call it."""

    def __init__(self, free, biped, gait, period):
        super().__init__(free)


def test_a_controller_of_ones_own(write):
    text = SHORT + "[[push]]\ntime = 0.1\nimpulse = [40.0, 0.0, 0.0]\n"
    result = run_scenario(load_scenario(write(text)), controller=Leaner)
    assert not result.passed
    assert result.run.fell
    assert [finding.key for finding in result.failures] == ["steps"]
    assert result.run.settings["trial"]["scenario"] == "case"


def test_controllers_that_are_none_are_refused(write):
    scenario = load_scenario(write(SHORT))
    for wrong, match in ((3, "is no factory"), (lambda free: None, "refused"), (lambda *a, **k: 3, "is no controller")):
        with pytest.raises(ScenarioError, match=match):
            run_scenario(scenario, controller=wrong)


def test_trials_are_kept_and_repeatable(write, tmp_path):
    text = SHORT + "repeat = 2\n[disturbances]\nimu_noise = 1e-4\n[model]\nmass = {within = 0.02}\n"
    scenario = load_scenario(write(text))
    (first,) = run_trials([scenario], numbers=[1], save=tmp_path)
    (again,) = run_trials([scenario], numbers=[1])
    assert first.results[0].measured == again.results[0].measured
    run = load_spatial_run(tmp_path / "case-1.npz")
    assert run.steps_completed == 1
    assert run.settings["errors"]["mass"][3] != 1.0
    assert run.settings["trial"]["trial"] == 1


@pytest.fixture(scope="module")
def short_walk(tmp_path_factory):
    path = tmp_path_factory.mktemp("walk") / "walk.scenario.toml"
    path.write_text(SHORT.replace("steps = 1", "steps = 3\nspeed = 0.1"), encoding="utf-8")
    prepared = prepare(load_scenario(path))
    return prepared, run_scenario(prepared.scenario).run


def test_measures_are_those_of_the_run(short_walk):
    """Every number again, sample by sample, from the arrays of the run."""
    prepared, run = short_walk
    assert not run.fell
    measured, free = spatial_measures(prepared, run), prepared.free
    margins, across, frictions = [], [], []
    for k in range(len(run.t)):
        stance = Stance.of_sign(run.stance[k])
        for foot, side in enumerate(Stance):
            force, moment = run.wrench[k, foot, :3], run.wrench[k, foot, 3:]
            if force[2] > 0.1 * free.weight:
                frictions.append(np.hypot(force[0], force[1]) / force[2])
                if side is stance:
                    sole = free.soles[foot]
                    x, out = -moment[1] / force[2], side.sign * moment[0] / force[2]
                    margins.append(min(sole.front - x, sole.back + x))
                    across.append(min(sole.outer - out, sole.inner + out))
    # the feet's yaw is far below a degree, so world axes are those of the soles
    assert measured["cop_margin"] == pytest.approx(min(margins), abs=1e-4)
    assert measured["fri_margin"] == pytest.approx(min(across), abs=1e-4)
    assert measured["friction"] == pytest.approx(max(frictions))
    later = np.flatnonzero(run.step >= 1)  # of three steps, the second half
    went = run.com[later[-1], 0] - run.com[later[0], 0]
    # a sample at each end of a step belongs to neither
    assert measured["walking_speed"] == pytest.approx(went / (run.t[later[-1]] - run.t[later[0]]), rel=0.02)
    assert measured["steps"] == 3
    assert abs(measured["yaw_drift"]) < 0.01
    assert measured["self_collisions"] == 0
    assert measured["step_time_error"] == pytest.approx(0.0, abs=0.02)


@pytest.mark.parametrize(
    ("expected", "held"),
    [
        ({"walking_speed": (0.05, 0.15)}, True),
        ({"walking_speed": (0.2, 0.3)}, False),
        ({"yaw_drift": 0.1}, True),
        ({"yaw_drift": 1e-9}, False),
        ({"self_collisions": 0}, True),
        ({"cop_margin": 0.0}, True),
        ({"cop_margin": 0.2}, False),
        ({"joint_speed": 1.0}, True),
        ({"joint_speed": 1e-3}, False),
        ({"torque": 1.0}, True),
        ({"foot_slip": 0.01}, True),
    ],
)
def test_expectations_of_space(short_walk, expected, held):
    prepared, run = short_walk
    scenario = replace(prepared.scenario, expect=replace(prepared.scenario.expect, **expected))
    asked = replace(prepared, scenario=scenario)
    findings = {finding.key: finding for finding in judge(asked, run, spatial_measures(asked, run))}
    (key,) = expected
    assert findings[key].held is held
    assert findings["steps"].held


# ---------------------------------------------------------------------- along a path
PATH = """
space = true
robot = "talos_full"
path = "stand 0.2; forward 0.1; stop"
steps = 20
[expect]
path_distance = 0.05
path_angle = 0.05
"""


def test_a_path_is_walked_by_its_own_walker(write):
    prepared = prepare(load_scenario(write(PATH)))
    walker = spatial_walker(prepared, spatial_conditions(prepared, trial_seed(0, 0)))
    assert isinstance(walker, PathWalker)
    assert [leg.verb.value for leg in walker.follower.legs] == ["stand", "forward", "stop"]


@pytest.mark.parametrize(("old", "new", "says"), [
    ("forward 0.1", "hop 1", "command 2 ('hop 1'): no command 'hop'"),
    ("steps = 20", "steps = 20\nspeed = 0.2", "beside path; write rates there"),
    ('path = "stand 0.2; forward 0.1; stop"', "", "[expect] path_distance: of walks along a path only"),
    ("steps = 20", 'steps = 20\ncontroller = "module:make"', "only the walker of this package follows one"),
])  # fmt: skip
def test_what_makes_no_walk_along_a_path_is_refused(write, old, new, says):
    with pytest.raises(ScenarioError) as refused:
        load_scenario(write(PATH.replace(old, new)))
    assert says in str(refused.value)


@pytest.mark.slow
def test_a_walk_along_a_path_is_judged_by_its_end(write):
    result = run_scenario(load_scenario(write(PATH)))
    assert result.passed
    told = {finding.key: finding for finding in result.findings}
    assert told["steps"].text.startswith("arrived after")
    assert abs(told["path_distance"].value) < 0.05
