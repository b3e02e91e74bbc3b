"""What a walk in space lacks is made, kept, found again, and never written over."""

import shutil

import numpy as np
import pinocchio as pin
import pytest

from frontal_biped.design import preparation
from frontal_biped.design.preparation import prepare_to_walk
from frontal_biped.exceptions import DesignFailedError, GaitFileError, RobotError
from frontal_biped.gait.file import load_gait, save_gait
from frontal_biped.model import load_robot, models_dir
from frontal_biped.model.urdf.description import read_description

BARE = {"romeo": False, "g1": True}
"""Robots whose URDF is taken bare, and whether their roll axes leave X with the knees bent."""


@pytest.fixture
def told():
    return []


@pytest.fixture
def no_design(monkeypatch):
    """The packaged gait of Romeo in place of a design, and how often one was asked for."""
    asked = []

    class Designed:
        gait, remedy, message = load_gait(models_dir() / "romeo_bent.gait.json"), None, "found"

    def design(biped, *_):
        asked.append(biped.name)
        return Designed

    monkeypatch.setattr(preparation, "optimise_gait", design)
    return asked


@pytest.mark.parametrize(("name", "walks"), [
    ("romeo", "romeo_bent"),
    ("g1", "g1_bent"),
    ("icub", "icub_bent"),
    ("simple_humanoid_classical", "simple_humanoid_bent"),
    ("talos_full", "talos_full"),
    ("g1_bent", "g1_bent"),
])  # fmt: skip
def test_packaged_robots_walk_with_bent_knees(name, walks, tmp_path, told):
    ready = prepare_to_walk(name, tmp_path, on_progress=told.append)
    assert (ready.biped.name, ready.made) == (walks, ())
    assert ready.gait.robot.fingerprint == ready.biped.fingerprint
    assert [line for line in told if "whose knees are bent" in line] == told
    assert (told == []) is (name == walks)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", BARE)
def test_a_bare_urdf(name, tmp_path, told, no_design):
    """Described, bent, measured: the feet flat, the same joints and soles as described by hand, virtual legs or not."""
    by_hand = load_robot(name)
    ready = prepare_to_walk(by_hand.description.urdf, tmp_path, on_progress=told.append)
    description = ready.biped.description
    assert dict(description.joints) == dict(by_hand.description.joints)
    assert description.virtual_legs is BARE[name]
    assert ready.biped.sole == pytest.approx(by_hand.sole, abs=3e-3)  # under another centre of mass
    assert ready.biped.leg_length < by_hand.leg_length
    assert description.other_armature > 0.0
    stem = by_hand.description.urdf.stem
    assert ready.made == (tmp_path / f"{stem}_bent.toml", tmp_path / f"{stem}_bent.gait.json")
    assert len(no_design) == 1
    assert [line.split(" ")[0] for line in told] == ["describing", "kept", "designing", "kept"]


def test_what_was_made_is_found_again(tmp_path, told, no_design, monkeypatch):
    """The description whatever was changed in it, the gait where it is still for that robot."""
    urdf = load_robot("romeo").description.urdf
    made = prepare_to_walk(urdf, tmp_path).made
    before = [path.read_text() for path in made]
    monkeypatch.setattr(preparation, "propose_walking_description", None)
    _gait_fits(made, tmp_path)
    ready = prepare_to_walk(urdf, tmp_path, on_progress=told.append)
    assert ready.made == ()
    assert told == [f"using {path}, made before" for path in made]
    assert made[0].read_text() == before[0]
    made[0].write_text(before[0].replace("inner = 0.04", "inner = 0.03"))
    with pytest.raises(GaitFileError, match=r"another URDF or description of romeo_small_bent; move it away"):
        prepare_to_walk(urdf, tmp_path)
    assert len(no_design) == 1


def _gait_fits(made, folder):
    """Write the gait as if it had been designed for the robot made."""
    from dataclasses import replace

    robot, gait = load_robot(made[0]), load_gait(made[1])
    save_gait(replace(gait, robot=replace(gait.robot, fingerprint=robot.fingerprint)), made[1])


def test_a_file_of_another_robot_stays(tmp_path, no_design):
    urdf = load_robot("romeo").description.urdf
    other = tmp_path / f"{urdf.stem}_bent.toml"
    shutil.copy(models_dir() / "g1.toml", other)
    before = other.read_text()
    with pytest.raises(RobotError, match=r"is there and describes .*g1.*move it away"):
        prepare_to_walk(urdf, tmp_path)
    assert other.read_text() == before


def test_soles_that_cannot_be_measured_are_asked_for(tmp_path, told, no_design):
    """Meshes are missing: the description says where to write the soles, and is used once they are there."""
    urdf = tmp_path / "robots" / "mine.urdf"
    urdf.parent.mkdir()
    # meshes of example-robot-data would be found from anywhere
    text = load_robot("romeo").description.urdf.read_text(encoding="utf-8")
    urdf.write_text(text.replace("package://example-robot-data", "package://of_nowhere"), encoding="utf-8")
    folder = tmp_path / "run"
    with pytest.raises(RobotError, match=r"mine_bent.toml: \[sole\] inner is missing.*stands at its head: settle it"):
        prepare_to_walk(urdf, folder, on_progress=told.append)
    made = urdf.parent / "mine_bent.toml"  # the run's folder is not above the URDF
    assert any(line.startswith("not decided: sole: ") for line in told)
    text = made.read_text()
    for key, value in {"inner": 0.04, "outer": 0.05, "ankle_height": 0.07, "front": 0.12, "back": 0.07}.items():
        text = text.replace(f"# {key} = ?", f"{key} = {value}")
    made.write_text(text)
    ready = prepare_to_walk(urdf, folder)
    assert ready.biped.sole == (-0.05, 0.04)
    assert ready.made == (folder / "mine_bent.gait.json",)


def test_a_description_whose_knees_are_straight(tmp_path, told, no_design):
    path = tmp_path / "mine.toml"
    text = (models_dir() / "alexander.toml").read_text()
    path.write_text(text.split("[posture]")[0] + "[sole]" + text.split("[sole]")[1])
    ready = prepare_to_walk(path, tmp_path, on_progress=told.append)
    assert ready.biped.name == "mine_bent"
    assert told[0] == "bending the knees of alexander, far enough for steps"
    assert read_description(path).posture == {}


def test_a_description_whose_knees_are_bent_is_taken_as_it_is(tmp_path, no_design):
    path = tmp_path / "alexander.toml"
    shutil.copy(models_dir() / "alexander.toml", path)
    assert prepare_to_walk(path, tmp_path).biped.path == path


def test_a_gait_that_is_named(tmp_path, told):
    gait = models_dir() / "g1_bent.gait.json"
    ready = prepare_to_walk("romeo", tmp_path, gait, told.append)
    assert ready.gait.robot == load_gait(gait).robot
    assert "was designed for 'g1_bent' with another URDF or description" in told[-1]


def test_no_gait_is_an_error_that_names_the_file(tmp_path, monkeypatch):
    class Failed:
        gait, remedy, message = None, None, "contradiction"

    monkeypatch.setattr(preparation, "optimise_gait", lambda *_: Failed)
    with pytest.raises(DesignFailedError, match=r"no gait: human_bent: contradiction; change \[gait\] in .*human_bent"):
        prepare_to_walk("human", tmp_path)


def test_a_remedy_that_was_tried_is_taken(tmp_path, told, monkeypatch):
    gait = load_gait(models_dir() / "romeo_bent.gait.json")

    class Remedy:
        key, old, new, specification = "friction", 0.1, 0.2, gait.specification

    class Result:
        def __init__(self, found):
            self.gait, self.remedy, self.message = (gait, None, "") if found else (None, Remedy, "no")

    def design(biped, spec):
        return Result(spec is Remedy.specification)

    monkeypatch.setattr(preparation, "optimise_gait", design)
    prepare_to_walk("human", tmp_path, on_progress=told.append)
    assert "with friction = 0.2 in place of 0.1, which leaves none" in told


def test_a_foot_may_turn_more_where_no_remedy_is_known(tmp_path, told, monkeypatch):
    class Result:
        remedy, message = None, "nothing"

        def __init__(self, spec):
            found = spec.max_foot_rotation > 0.05
            self.gait = load_gait(models_dir() / "romeo_bent.gait.json") if found else None

    monkeypatch.setattr(preparation, "optimise_gait", lambda biped, spec: Result(spec))
    prepare_to_walk(load_robot("romeo").description.urdf, tmp_path, on_progress=told.append)
    assert "with max_foot_rotation = 0.1 in place of 0.05, which found none" in told


@pytest.mark.parametrize(("robot", "words"), [
    ("rome", "did you mean 'romeo'"),
    ("nowhere.urdf", "no such URDF file"),
    ("frontal_biped", "2 joints down to the ankle roll joint"),
])  # fmt: skip
def test_what_cannot_walk_is_told_in_one_line(robot, words, tmp_path):
    with pytest.raises(RobotError, match=words) as caught:
        prepare_to_walk(robot, tmp_path)
    assert "\n" not in str(caught.value)
    assert list(tmp_path.iterdir()) == []


def replaced_behind(text, mark, old, new):
    """The text with the first of something behind a mark replaced."""
    at = text.index(old, text.index(mark))
    return text[:at] + new + text[at + len(old) :]


def test_hips_that_are_tilted_and_legs_mirrored_only_nearly(tmp_path, no_design):
    """Pitch axes 20 degrees off Y turn the foot; all six joints of each leg are needed to keep it flat."""
    original = load_robot("g1").description.urdf
    text = original.read_text()
    for side, sense in (("left", 1.0), ("right", -1.0)):
        tilted = f'<axis xyz="0 {np.cos(0.35):.6f} {sense * np.sin(0.35):.6f}"/>'
        text = replaced_behind(text, f'<joint name="{side}_hip_pitch_joint"', '<axis xyz="0 1 0"/>', tilted)
    text = replaced_behind(text, '<joint name="right_knee_joint"', 'xyz="-0.078273', 'xyz="-0.077273')  # 1 mm
    package = tmp_path / original.parent.parent.name
    shutil.copytree(original.parent.parent / "meshes", package / "meshes")
    urdf = package / "urdf" / "tilted.urdf"
    urdf.parent.mkdir()
    urdf.write_text(text)
    biped = prepare_to_walk(urdf, tmp_path).biped
    model, posture = biped.robot.model, biped.robot.posture
    data = model.createData()
    yaw = posture[model.joints[model.getJointId("left_hip_yaw_joint")].idx_q]
    assert abs(yaw) > 0.01
    pin.forwardKinematics(model, data, posture)
    feet = [data.oMi[model.getJointId(f"{side}_ankle_roll_joint")].copy() for side in ("left", "right")]
    pin.forwardKinematics(model, data, pin.neutral(model))
    for side, foot in zip(("left", "right"), feet, strict=True):
        drawn = data.oMi[model.getJointId(f"{side}_ankle_roll_joint")].rotation
        assert np.abs(pin.log3(foot.rotation @ drawn.T)).max() < 1e-7
    left, right = (foot.translation for foot in feet)
    assert left == pytest.approx(right * [1.0, -1.0, 1.0], abs=1e-4)
    knees = [posture[model.joints[model.getJointId(f"{side}_knee_joint")].idx_q] for side in ("left", "right")]
    assert 1e-4 < abs(knees[0] - knees[1]) < 0.02  # the right leg bends for itself
