"""Broken URDF files: each is refused in one line that names the file, the place and what would be right."""

import re

import numpy as np
import pytest
from random_states import UPRIGHT

from frontal_biped.exceptions import RobotError
from frontal_biped.model import load_robot
from frontal_biped.model.urdf.read import JOINT_TYPES, read_urdf

REVOLUTE_LEFT_HIP = '<joint name="left_hip" type="revolute"'
HIP_LIMIT = '<limit lower="-1.0" upper="1.0" effort="150" velocity="10"/>'
PELVIS_INERTIA = '<inertia ixx="5.53" ixy="0" ixz="0" iyy="5.53" iyz="0" izz="5.53"/>'
LOOP = '<joint name="loop" type="fixed"><parent link="left_foot"/><child link="pelvis"/></joint>'

# what is wrong: (text in the file, its replacement, words of the message, words of the remedy)
BROKEN = {
    "doctype": ('<?xml version="1.0"?>', '<?xml version="1.0"?><!DOCTYPE robot>', "DOCTYPE", "remove"),
    "entity": ('<?xml version="1.0"?>', '<!DOCTYPE r [<!ENTITY a "b">]>', "entity", "remove"),
    "duplicate link": ('<link name="right_foot"', '<link name="left_foot"', "left_foot", "name of its own"),
    "link without a name": ('<link name="right_foot"', "<link", "without a name", "name"),
    "duplicate joint": ('<joint name="right_hip"', '<joint name="left_hip"', "left_hip", "name of its own"),
    "unknown joint type": (REVOLUTE_LEFT_HIP, '<joint name="left_hip" type="hinge"', "hinge", "revolute"),
    "undefined parent": (
        '<parent link="left_leg"/>',
        '<parent link="left_log"/>',
        "left_log",
        "add the link",
    ),
    "undefined child": ('<child link="left_leg"/>', '<child link="left_log"/>', "left_log", "add the link"),
    "missing parent": ('<parent link="left_leg"/>', "", "left_ankle", "add the link"),
    "two parents": (
        '<child link="right_foot"/>',
        '<child link="left_foot"/>',
        "left_foot",
        "remove one joint",
    ),
    "cycle": ("</robot>", LOOP + "</robot>", "own ancestor", "break the loop"),
    "two trees": ("</robot>", '<link name="lost"/></robot>', "lost", "join them"),
    "mass is not a number": ('<mass value="36.0"/>', '<mass value="nan"/>', "pelvis", "finite number"),
    "mass is a word": ('<mass value="36.0"/>', '<mass value="heavy"/>', "heavy", "finite number"),
    "mass overflows": ('<mass value="36.0"/>', '<mass value="1e400"/>', "pelvis", "finite number"),
    "two of three numbers": ('xyz="0 0.1 0"', 'xyz="0 0.1"', "left_hip", "3 finite numbers"),
    "four of three numbers": ('xyz="0 0.1 0"', 'xyz="0 0.1 0 0"', "left_hip", "3 finite numbers"),
    "infinite limit": ('upper="1.0"', 'upper="inf"', "upper", "finite number"),
    "empty effort": ('effort="150"', 'effort=""', "effort", "finite number"),
    "negative mass": ('<mass value="36.0"/>', '<mass value="-36.0"/>', "-36 kg", "positive mass"),
    "negative inertia": ('ixx="5.53"', 'ixx="-5.53"', "ixx", "positive inertia"),
    "zero axis": ('<axis xyz="1 0 0"/>', '<axis xyz="0 0 0"/>', "left_hip", "1 0 0"),
    "revolute without limits": (HIP_LIMIT, "", "left_hip", "limit"),
    "limit without effort": (' effort="150"', "", "left_hip", "effort"),
    "limit without velocity": (' velocity="10"', "", "left_hip", "velocity"),
    "limits exchanged": ('lower="-1.0" upper="1.0"', 'lower="1.0" upper="-1.0"', "left_hip", "lower"),
    "robot without a name": ('<robot name="frontal_biped">', "<robot>", "name", "name"),
    "mass without inertia": (PELVIS_INERTIA, "", "pelvis", "inertia"),
    "inertia without ixy": (PELVIS_INERTIA, PELVIS_INERTIA.replace(' ixy="0"', ""), "pelvis", "ixy"),
    "inertial without mass": ('<mass value="36.0"/>', "", "pelvis", "mass"),
}


def refusal(description) -> str:
    with pytest.raises(RobotError) as caught:
        load_robot(description)
    message = str(caught.value)
    assert "\n" not in message
    return message


def assert_says(message: str, *words: str) -> None:
    for word in words:
        assert re.search(re.escape(word), message, re.IGNORECASE), f"{word!r} is not in {message!r}"


@pytest.mark.parametrize("case", BROKEN)
def test_broken_urdf(model_files, case):
    urdf, description = model_files
    original, replacement, what, remedy = BROKEN[case]
    text = urdf.read_text(encoding="utf-8")
    assert original in text
    urdf.write_text(text.replace(original, replacement, 1), encoding="utf-8")
    assert_says(refusal(description), "frontal_biped", what, remedy)


def test_joint_types_are_those_of_the_format():
    assert set(JOINT_TYPES) == {"revolute", "continuous", "prismatic", "fixed", "floating", "planar"}


def test_missing_file(model_files):
    urdf, description = model_files
    urdf.unlink()
    assert_says(refusal(description), "frontal_biped.urdf", "no such URDF", "check the path")


def test_missing_urdf_given_by_name(tmp_path):
    assert_says(refusal(tmp_path / "robot.urdf"), "robot.urdf", "no such URDF", "check the path")


def test_urdf_without_a_description_beside_it(model_files):
    urdf, description = model_files
    description.unlink()
    assert_says(refusal(urdf), "frontal_biped.urdf", "frontal_biped.toml")


def test_urdf_with_a_description_beside_it(model_files, biped):
    urdf, _ = model_files
    assert load_robot(urdf).fingerprint == biped.fingerprint


@pytest.mark.parametrize("content", ["", "   \n", "not xml", "<robot name='x'><link name='a'>"])
def test_not_xml(model_files, content):
    urdf, description = model_files
    urdf.write_text(content, encoding="utf-8")
    assert_says(refusal(description), "frontal_biped.urdf", "not well-formed XML", "mend")


def test_truncated(model_files):
    urdf, description = model_files
    text = urdf.read_text(encoding="utf-8")
    urdf.write_text(text[: len(text) // 2], encoding="utf-8")
    assert_says(refusal(description), "frontal_biped.urdf", "line", "mend")


def test_not_text(model_files):
    urdf, description = model_files
    urdf.write_bytes(b"\xff\xfe\x00<robot>")
    assert_says(refusal(description), "frontal_biped.urdf", "not UTF-8", "save")


def test_root_is_not_a_robot(model_files):
    urdf, description = model_files
    urdf.write_text("<sdf><model/></sdf>", encoding="utf-8")
    assert_says(refusal(description), "frontal_biped.urdf", "<sdf>", "<robot>")


def test_no_links(model_files):
    urdf, description = model_files
    urdf.write_text('<robot name="empty"/>', encoding="utf-8")
    assert_says(refusal(description), "frontal_biped.urdf", "no link")


def test_comments_may_hold_any_language(model_files, biped):
    urdf, description = model_files
    text = urdf.read_text(encoding="utf-8").replace("<robot", "<!-- größe, 重心 -->\n<robot", 1)
    urdf.write_text(text, encoding="utf-8")
    assert load_robot(description).mass == biped.mass


def test_axis_need_not_be_a_unit_vector(model_files, biped):
    urdf, description = model_files
    text = urdf.read_text(encoding="utf-8").replace('<axis xyz="1 0 0"/>', '<axis xyz="2 0 0"/>')
    urdf.write_text(text, encoding="utf-8")
    q = UPRIGHT + np.array([0.1, -0.1, 0.2, 0.05])
    assert load_robot(description).D(q) == pytest.approx(biped.D(q), rel=1e-12)


def test_a_link_may_bear_the_name_of_a_joint(model_files, biped):
    """Pinocchio cannot tell them apart; the robot is the same, its shapes too."""
    urdf, description = model_files
    text = urdf.read_text()
    assert '"left_leg"' in text and '"left_hip"' in text
    urdf.write_text(text.replace('"left_leg"', '"left_hip"'))
    robot = load_robot(description)
    assert robot.D(np.full(4, -1.5)) == pytest.approx(biped.D(np.full(4, -1.5)), rel=1e-14)
    assert robot.stance_map.joint_names == biped.stance_map.joint_names
    assert 'link name="left_hip_link"' in read_urdf(urdf)
    assert robot.robot.soles.left.length == biped.robot.soles.left.length
