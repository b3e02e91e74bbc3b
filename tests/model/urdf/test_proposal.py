"""Descriptions proposed for robots that have none: compared with those written by hand, and loaded."""

import numpy as np
import pinocchio as pin
import pytest

from frontal_biped.cli import main
from frontal_biped.exceptions import HypothesisError, RobotError
from frontal_biped.model import load_robot, load_whole_robot, models_dir
from frontal_biped.model.urdf.description import ROLL_JOINTS, read_description
from frontal_biped.model.urdf.legs import find_legs
from frontal_biped.model.urdf.proposal import propose_description, propose_posture
from frontal_biped.model.urdf.soles import measure_sole

DESCRIBED = ("alexander", "g1", "human", "icub", "romeo", "talos_full")


def proposed(name, folder):
    """The robot that is proposed for the URDF of a packaged one."""
    proposal = propose_description(load_robot(name).description.urdf)
    path = folder / "proposed.toml"
    path.write_text(proposal.text, encoding="utf-8")
    return proposal, path


@pytest.mark.parametrize("name", DESCRIBED)
def test_joints_and_sides_are_found_without_a_name(name, tmp_path):
    by_hand = load_robot(name)
    proposal, path = proposed(name, tmp_path)
    assert proposal.undecided == ()
    found = read_description(path)
    assert dict(found.joints) == dict(by_hand.description.joints)
    assert found.base_rpy == pytest.approx(by_hand.description.base_rpy, abs=1e-9)
    assert found.urdf == by_hand.description.urdf
    robot = load_robot(path)
    assert robot.mass == pytest.approx(by_hand.mass, rel=1e-12)
    assert robot.hip_width == pytest.approx(by_hand.hip_width, rel=1e-6)
    # the width under another posture's centre of mass differs by millimetres
    assert robot.sole == pytest.approx(by_hand.sole, abs=3e-3)
    assert robot.ankle_height == pytest.approx(by_hand.ankle_height, abs=2e-4)
    # the length is that of one flat foot in either posture; the proposal rounds it down to a tenth of a millimetre
    sole = robot.description.sole
    for proposed_end, measured in (
        (sole.front, by_hand.robot.soles.left.front),
        (sole.back, by_hand.robot.soles.left.back),
    ):
        assert measured - 2e-4 <= proposed_end <= measured + 1e-5


def test_what_cannot_be_decided_is_said(tmp_path, capsys):
    urdf = load_robot("simple_humanoid_classical").description.urdf
    out = tmp_path / "toy.toml"
    assert main(["robots", "--describe", str(urdf), "-o", str(out)]) == 1
    written, *lines = capsys.readouterr().out.splitlines()
    assert written == f"written to {out}"
    assert [line.partition(":")[0] for line in lines if line[0] != " "] == ["found", "not decided", "next"]
    assert lines[0].startswith("found:       legs: ")
    (sole,) = (line for line in lines if "sole: " in line)
    assert "sole: the foot has neither collision nor visual shapes; measure inner" in sole
    assert lines[-1].endswith(f"settle in {out} what is not decided, then frontal-biped design --robot {out}")
    text = out.read_text(encoding="utf-8")
    assert "# NOT DECIDED: sole" in text
    with pytest.raises(HypothesisError, match=r"\[sole\] inner is missing"):
        load_robot(out)
    for key, value in {"inner": 0.05, "outer": 0.05, "ankle_height": 0.105, "front": 0.125, "back": 0.125}.items():
        text = text.replace(f"# {key} = ?", f"{key} = {value}")
    out.write_text(text, encoding="utf-8")
    robot = load_robot(out)
    assert robot.mass == pytest.approx(130.8, rel=1e-9)
    assert robot.robot.soles.left.length == 0.25


def test_a_planar_urdf_beside_it(model_files, capsys, biped):
    urdf, description = model_files
    description.unlink()
    assert main(["robots", "--describe", str(urdf), "-o", str(description)]) == 0
    told = capsys.readouterr().out
    assert "\nnot decided: nothing\n" in told
    assert told.endswith(f"\nnext:        frontal-biped design --robot {description}\n")
    robot = load_robot(description)
    assert robot.sole == pytest.approx(biped.sole)
    assert robot.D(np.full(4, -1.5)) == pytest.approx(biped.D(np.full(4, -1.5)), rel=1e-14)


def test_a_description_belongs_beside_its_urdf(model_files, tmp_path, capsys):
    urdf, _ = model_files
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    assert main(["robots", "--describe", str(urdf), "-o", str(elsewhere / "robot.toml")]) == 2
    assert "write it there" in capsys.readouterr().err
    assert list(elsewhere.iterdir()) == []


@pytest.mark.parametrize("name", ["g1", "icub", "human"])
def test_a_posture_is_found_where_the_axes_are_parallel_at_one_hip_pitch_only(name, tmp_path):
    """From zero, where g1's axes are ten degrees off, to a posture the reduction accepts, flat and balanced."""
    packaged = load_robot(name).description
    text = (models_dir() / f"{name}.toml").read_text(encoding="utf-8")
    start, rest = text.split("[posture]")
    keep = "l_elbow = 0.0959931\nr_elbow = 0.0959931\n" if name == "icub" else ""
    bare = tmp_path / "bare.toml"
    bare.write_text(f"{start}[posture]\n{keep}\n[sole]" + rest.split("[sole]")[1], encoding="utf-8")
    if name == "g1":
        with pytest.raises(HypothesisError, match="10 degrees off world X"):
            load_robot(bare)
    proposal = propose_posture(bare)
    assert proposal.undecided == ()
    path = tmp_path / "found.toml"
    path.write_text(proposal.text, encoding="utf-8")
    found = load_robot(path)
    assert found.description.joints == packaged.joints
    assert found.leg_length == pytest.approx(load_robot(name).leg_length, abs=1e-3)
    # independently: axes, feet and centre of mass at that posture
    description, full, q = found.description, found.robot.model, found.robot.posture
    data = full.createData()
    pin.computeJointJacobians(full, data, q)
    for key in ROLL_JOINTS:
        joint = full.getJointId(description.joints[key])
        axis = pin.getJointJacobian(full, data, joint, pin.LOCAL_WORLD_ALIGNED)[3:, full.joints[joint].idx_v]
        assert np.linalg.norm(axis[1:]) < 2e-5  # icub prints its axes to five digits
    ankle = data.oMi[full.getJointId(description.joints["left_ankle"])].translation
    com_x = pin.centerOfMass(full, data, q)[0] - ankle[0]
    sole = measure_sole(full, q, description.joints["left_ankle"], description.urdf, found.robot.urdf_text, com_x)
    assert sole.heel < com_x < sole.toe
    # all of the sole touches at once: it is flat
    assert sole.toe - sole.heel > 0.14


def test_a_torso_leans_where_balance_wants_it(tmp_path):
    """g1 leans its waist forwards or back until the centre of mass is over the middle half of the sole."""
    proposal = propose_posture(models_dir() / "g1.toml")
    path = tmp_path / "found.toml"
    path.write_text(proposal.text, encoding="utf-8")
    assert -0.3 < read_description(path).posture["waist_pitch_joint"] < -0.05


def test_icub_looks_backwards_and_the_human_lies_down():
    for name, rpy in (("icub", (0.0, 0.0, np.pi)), ("human", (0.5 * np.pi, 0.0, 0.0)), ("romeo", (0.0, 0.0, 0.0))):
        legs = find_legs(load_whole_robot(name).model, name)
        assert legs.sides_named
        assert legs.upright == pytest.approx(pin.rpy.rpyToMatrix(*rpy), abs=1e-12)


def test_a_joint_of_the_wrong_leg_is_named(tmp_path):
    text = (models_dir() / "romeo.toml").read_text(encoding="utf-8")
    path = tmp_path / "romeo.toml"
    path.write_text(text.replace('left_ankle = "LAnkleRoll"', 'left_ankle = "NeckYaw"'), encoding="utf-8")
    with pytest.raises(RobotError, match="'NeckYaw' is not of the left leg"):
        propose_posture(path)


def test_sole_of_a_box_and_of_spheres(biped):
    """Table I's foot is a box of 0.1 m; g1 stands on four spheres, 0.25 m apart and wider in front."""

    def measured(robot, ankle, x=None):
        return measure_sole(robot.model, pin.neutral(robot.model), ankle, robot.description.urdf, robot.urdf_text, x)

    sole = measured(biped.robot, "left_ankle")
    assert (sole.right, sole.left, sole.ankle_height) == pytest.approx((0.05, 0.05, 0.0), abs=1e-12)
    g1 = load_whole_robot("g1")
    for x, half in ((-0.0499, 0.025), (0.1199, 0.030)):
        sole = measured(g1, "left_ankle_roll_joint", x)
        assert (sole.heel, sole.toe, sole.ankle_height) == pytest.approx((-0.05, 0.12, 0.035), abs=1e-9)
        assert (sole.right, sole.left) == pytest.approx((half, half), abs=1e-4)


def test_names_with_line_breaks_stay_comments(model_files):
    """XML may hold a line break in a name; in the proposal it must not end a comment."""
    urdf, description = model_files
    description.unlink()
    text = urdf.read_text(encoding="utf-8").replace('name="left_hip"', 'name="left_hip&#10;urdf = 3 #"')
    urdf.write_text(text, encoding="utf-8")
    proposal = propose_description(urdf)
    commented = [
        line for line in proposal.text.splitlines() if "urdf = 3" in line and not line.startswith("left_hip = ")
    ]
    assert commented
    assert all(line.startswith("#") for line in commented)
