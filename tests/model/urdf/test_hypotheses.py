"""Robots that break a robot hypothesis of the paper are refused, and the error says which one."""

import numpy as np
import pytest
from random_states import UPRIGHT

from frontal_biped.exceptions import HypothesisError
from frontal_biped.model import load_robot

LEG_INERTIAL = '<origin xyz="0 0 -0.16" rpy="0 0 0"/>\n      <mass value="12.15"/>'
FOOT_INERTIAL = '<mass value="0.2"/>'
PELVIS_INERTIAL = '<origin xyz="0 0 0.2" rpy="0 0 0"/>'
HIP_LIMIT = '<limit lower="-1.0" upper="1.0" effort="150" velocity="10"/>'


def in_joint(name, original, replacement):
    """An edit inside one joint."""

    def edit(text):
        head, tail = text.split(f'<joint name="{name}"')
        assert original in tail
        return head + f'<joint name="{name}"' + tail.replace(original, replacement, 1)

    return edit


def everywhere(original, replacement, count=-1):
    def edit(text):
        assert original in text
        return text.replace(original, replacement, count)

    return edit


# what is wrong: (hypothesis, edit of the URDF, a word that names the place)
BROKEN_URDF = {
    "ankle under the wrong hip": (
        "HR1",
        in_joint("left_ankle", '<parent link="left_leg"/>', '<parent link="right_leg"/>'),
        "left_ankle",
    ),
    "prismatic": ("HR1", in_joint("left_hip", 'type="revolute"', 'type="prismatic"'), "left_hip"),
    "continuous, without limits": (
        "HR1",
        lambda text: in_joint("left_hip", HIP_LIMIT, "")(
            in_joint("left_hip", 'type="revolute"', 'type="continuous"')(text)
        ),
        "left_hip",
    ),
    "massless legs": ("HR1", everywhere('<mass value="12.15"/>', '<mass value="0"/>'), "left_hip"),
    "massless feet": ("HR1", everywhere(FOOT_INERTIAL, '<mass value="0"/>'), "left_ankle"),
    "massless pelvis": ("HR1", everywhere('<mass value="36.0"/>', '<mass value="0"/>'), "pelvis"),
    "pitch joint": ("HR2", in_joint("left_hip", 'xyz="1 0 0"', 'xyz="0 1 0"'), "left_hip"),
    "tilted axis": ("HR2", in_joint("right_ankle", 'xyz="1 0 0"', 'xyz="1 0.01 0"'), "right_ankle"),
    "tilted joint frame": (
        "HR2",
        in_joint("right_hip", 'rpy="0 0 0"', 'rpy="0 0 0.01"'),
        "right_hip",
    ),
    "heavier left leg": (
        "HR3",
        everywhere('<mass value="12.15"/>', '<mass value="12.16"/>', 1),
        "mass of the leg",
    ),
    "heavier left foot": ("HR3", everywhere(FOOT_INERTIAL, '<mass value="0.3"/>', 1), "mass of the foot"),
    "longer left leg": (
        "HR3",
        in_joint("left_ankle", 'xyz="0 0 -0.8"', 'xyz="0 0 -0.81"'),
        "height of the ankle",
    ),
    "wider left hip": ("HR3", in_joint("left_hip", 'xyz="0 0.1 0"', 'xyz="0 0.11 0"'), "torso"),
    "lower left leg CoM": ("HR3", everywhere("0 0 -0.16", "0 0 -0.17", 1), "centre of mass"),
    "both leg CoMs to the left": (
        "HR3",
        everywhere(LEG_INERTIAL, LEG_INERTIAL.replace("0 0 -0.16", "0 0.01 -0.16")),
        "centre of mass",
    ),
    "turned left leg inertia": ("HR3", everywhere('ixx="0.4"', 'ixx="0.5"', 1), "inertia of the leg"),
    "torso off centre": (
        "HR3",
        everywhere(PELVIS_INERTIAL, '<origin xyz="0 0.01 0.2" rpy="0 0 0"/>'),
        "torso",
    ),
    "weaker left hip": ("HR3", everywhere('effort="150"', 'effort="140"', 1), "torque"),
    "no torque at the hips": ("HR4", everywhere(HIP_LIMIT, HIP_LIMIT.replace("150", "0")), "hip"),
}


@pytest.mark.parametrize("case", BROKEN_URDF)
def test_urdf_breaks_a_hypothesis(model_files, case):
    urdf, description = model_files
    hypothesis, edit, place = BROKEN_URDF[case]
    urdf.write_text(edit(urdf.read_text(encoding="utf-8")), encoding="utf-8")
    assert_refused(description, hypothesis, place)


# what is wrong: (hypothesis, (text, replacement) pairs of the description, a word that names the place)
BROKEN_DESCRIPTION = {
    "hips exchanged": (
        "HR1",
        [('left_hip = "left_hip"', 'left_hip = "right_hip"'),
         ('\nright_hip = "right_hip"', '\nright_hip = "left_hip"')],
        "hip",
    ),
    "sides exchanged": (
        "HR3",
        [(f'{side}_{part} = "{side}_{part}"', f'{side}_{part} = "{other}_{part}"')
         for side, other in (("left", "right"), ("right", "left")) for part in ("hip", "ankle")],
        "swap the joint names",
    ),
    "feet not mirrored in the posture": ("HR3", [("[sole]", "[posture]\nleft_hip = 0.2\n\n[sole]")], "left"),
    "soles overlap": ("HR5", [("inner = 0.05", "inner = 0.15")], "inner"),
    "soles touch": ("HR5", [("inner = 0.05", "inner = 0.1")], "inner"),
    "sole missing": ("HR5", [("inner = 0.05", "")], "inner"),
    "sole of no length": ("HR5", [("inner = 0.05", "inner = 0.0")], "inner"),
}  # fmt: skip


@pytest.mark.parametrize("case", BROKEN_DESCRIPTION)
def test_description_breaks_a_hypothesis(model_files, case):
    _, description = model_files
    hypothesis, edits, place = BROKEN_DESCRIPTION[case]
    text = description.read_text(encoding="utf-8")
    for original, replacement in edits:
        assert original in text
        text = text.replace(original, replacement)
    description.write_text(text, encoding="utf-8")
    assert_refused(description, hypothesis, place)


def assert_refused(description, hypothesis, place):
    with pytest.raises(HypothesisError) as caught:
        load_robot(description)
    message = str(caught.value)
    assert caught.value.hypothesis == hypothesis, message
    assert f"({hypothesis})" in message
    assert "\n" not in message
    assert description.name in message
    assert place in message
    assert ";" in message  # what would be right follows


def test_axis_within_the_tolerance_is_accepted(model_files, biped):
    """CAD exports tilt axes by rounding; below a milliradian the motion stays in the plane."""
    urdf, description = model_files
    urdf.write_text(in_joint("left_hip", 'xyz="1 0 0"', 'xyz="1 1e-7 0"')(urdf.read_text()))
    q = UPRIGHT + np.array([0.1, -0.1, 0.2, 0.05])
    assert load_robot(description).D(q) == pytest.approx(biped.D(q), rel=1e-6)
