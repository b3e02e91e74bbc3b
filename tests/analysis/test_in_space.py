"""What a planar gait means in space: published figures, limits, and the report that says it."""

import json
from dataclasses import replace

import numpy as np
import pytest

from frontal_biped.analysis.closed_form import analyze
from frontal_biped.analysis.free_landing import STANCE, free_landing
from frontal_biped.analysis.in_space import analyse_in_space
from frontal_biped.gait.file import load_gait
from frontal_biped.model import load_robot, models_dir
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.model.space.landing import land
from frontal_biped.model.space.virtual_legs import SpaceState
from frontal_biped.model.state import State
from frontal_biped.simulation.space.start import start_in_space

PUBLISHED = {
    "talos_full": (2.0, 19.2, 12.5),
    "romeo": (7.9, 8.5, None),
    "simple_humanoid_classical": (18.0, 21.1, None),
}
"""Vertical impulse [N s] with every joint free and no rotors, of the planar impact, and the energy after the former
[J]: found by other code."""

LAST_DIGIT = 0.05

ROLLING = ("alexander", "g1", "human", "icub", "romeo", "simple_humanoid_classical", "talos_full")
"""Whose roll joints are the planar robot's."""

VIRTUAL = ("g1_bent",)
"""Whose virtual legs are."""


def landing_state(robot, gait):
    falling = gait.step(robot).falling
    return State(falling.motion.q[-1], falling.motion.dq[-1] * falling.dbeta[-1])


@pytest.fixture(scope="module", params=[*ROLLING, *VIRTUAL])
def walker(request):
    robot = load_robot(request.param)
    return robot, load_gait(models_dir() / f"{robot.name}.gait.json")


@pytest.mark.parametrize("name", PUBLISHED)
def test_published_landings(name):
    robot = load_robot(name)
    report = free_landing(robot, load_gait(models_dir() / f"{name}.gait.json"), swept=())
    free, planar, energy = PUBLISHED[name]
    assert report.bare.vertical_impulse == pytest.approx(free, abs=LAST_DIGIT)
    assert report.planar.vertical_impulse == pytest.approx(planar, abs=LAST_DIGIT)
    if energy is not None:
        assert report.bare.energy_after == pytest.approx(energy, abs=LAST_DIGIT)


# ---------------------------------------------------------------------- the report
def test_softer_than_the_plane_says(walker):
    robot, gait = walker
    report = free_landing(robot, gait, swept=(1e-3, 1e-1, 1e1, 1e3))
    impulses = [landed.vertical_impulse for landed in report.swept]
    assert impulses == sorted(impulses)
    assert 0.0 < report.bare.vertical_impulse < report.planar.vertical_impulse
    lost = [landed.energy_lost for landed in report.swept]
    assert lost == sorted(lost) and lost[0] > 0.0
    (rigid,) = report.swept[-1:]
    if not robot.description.virtual_legs:
        assert rigid.vertical_impulse == pytest.approx(report.planar.vertical_impulse, rel=1e-2)
        assert abs(rigid.leg_rate) < 1e-3
    assert STANCE.other.value in ("left", "right") and len(report.jumps) == 4
    names = set(robot.robot.joint_names) - set(robot.description.joints.values())
    assert set(report.jumps) <= names


@pytest.mark.parametrize("name", ROLLING)
def test_impulse_of_the_planar_impact_in_space(name):
    """Where it acts, from momenta weighted by x, is where it acts on the robot whose other joints are held."""
    robot, gait = load_robot(name), load_gait(models_dir() / f"{name}.gait.json")
    free = FreeRobot(robot.robot)
    space = SpaceState(free)
    space.at(*start_in_space(free, robot, landing_state(robot, gait), STANCE, space))
    rolls = np.isin(free.joint_names, list(robot.description.joints.values()))
    held = land(space, STANCE.other, np.where(rolls, free.armature, np.inf))
    planar = free_landing(robot, gait, swept=()).planar
    # the planar impact is that of averaged legs
    assert planar.cop[0] == pytest.approx(held.cop[0], abs=2e-4)
    assert planar.cop[1] == pytest.approx(-STANCE.other.sign * held.cop[1], abs=1e-3)


def test_description_is_one_of_the_sweep():
    """Where all joints have the described rotors it is a point of the curve."""
    robot = load_robot("talos_full")
    gait = load_gait(models_dir() / "talos_full.gait.json")
    report = free_landing(robot, gait, swept=(robot.description.other_armature,))
    swept, described = (
        np.hstack(list(replace(one, rotors=0.0).__dict__.values())) for one in (report.swept[0], report.described)
    )
    np.testing.assert_allclose(swept, described, rtol=1e-12)


def test_analysis_of_a_humanoid(walker):
    robot, gait = walker
    analysis = analyze(robot, gait, certify=False)
    found = analysis.in_space
    assert [at.stance for at in found.holding] == ["left", "right"]
    assert not found.asked and not found.missing and len(found.checks) == 4
    text = str(analysis)
    assert all(name in text for name in ("held by the ground in space", "landing with every joint free"))
    table = json.loads(json.dumps(analysis.as_dict(), allow_nan=False))["in_space"]
    assert table["holding"][0]["cop_x"] == list(found.holding[0].cop_x)
    assert table["landing"]["planar"]["rotors"] == "held"
    # beyond a bound that nobody asked for, a gait stays certified
    assert not set(analysis.constraints.checks) & set(found.checks)


def test_asked_for_rows_are_not_said_twice():
    robot = load_robot("talos_full")
    gait = load_gait(models_dir() / "talos_full.gait.json")
    asked = replace(gait.specification, yaw_friction=0.5, cop_margin_x=0.01)
    analysis = analyze(robot, gait, asked, certify=False)
    assert analysis.in_space.asked
    assert set(analysis.in_space.checks) <= set(analysis.constraints.checks)
    assert str(analysis).count("yaw_friction") == 2


def test_robots_of_four_joints_have_nothing_to_hold(biped, gait):
    analysis = analyze(biped, gait, certify=False)
    assert analysis.in_space is None and "in_space" not in analysis.as_dict()


def test_soles_of_unknown_length_are_told(walker, monkeypatch):
    from frontal_biped.exceptions import RobotError
    from frontal_biped.model.robot import Robot

    robot, gait = walker

    def unknown(self):
        raise RobotError("robot.toml: the length of the sole cannot be measured")

    monkeypatch.setattr(Robot, "soles", property(unknown))
    found = analyse_in_space(robot, gait, gait.specification, gait.step(robot))
    assert found.missing == ("robot.toml: the length of the sole cannot be measured",)
    assert str(found) == f"in space: {found.missing[0]}"
    assert found.as_dict()["landing"] is None
