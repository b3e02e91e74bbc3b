"""Legs that differ: refused, or averaged on request, and how much is said."""

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from random_states import UPRIGHT
from robot_laws import LAWS

from frontal_biped.exceptions import HypothesisError
from frontal_biped.model import load_robot
from frontal_biped.model.urdf.symmetry import asymmetry, symmetrised

LEG_MASS = '<mass value="12.15"/>'
HIP_LIMIT = '<limit lower="-1.0" upper="1.0" effort="150" velocity="10"/>'


def unequal(model_files, edits, symmetrise=True):
    """The robot with edits of its URDF, each in its first place: the left leg's."""
    urdf, description = model_files
    text = urdf.read_text(encoding="utf-8")
    for original, replacement in edits:
        assert original in text
        text = text.replace(original, replacement, 1)
    urdf.write_text(text, encoding="utf-8")
    if symmetrise:
        description.write_text("symmetrise = true\n" + description.read_text(encoding="utf-8"), encoding="utf-8")
    return description


def test_equal_legs_are_not_touched(biped):
    assert biped.asymmetry.differences == ()
    assert biped.asymmetry.mass_matrix == 0.0
    assert biped.asymmetry.gravity == pytest.approx(0.0, abs=1e-12)


def test_a_heavier_leg_is_averaged_and_reported(model_files, biped):
    robot = load_robot(unequal(model_files, [(LEG_MASS, '<mass value="12.35"/>')]))
    assert robot.mass == pytest.approx(biped.mass + 0.2, rel=1e-14)
    legs = robot.chain.bodies[1], robot.chain.bodies[3]
    assert [leg.mass for leg in legs] == pytest.approx([12.25, 12.25], rel=1e-14)
    (difference, *_) = robot.asymmetry.differences
    assert difference.what == "the mass of the leg"
    assert (difference.left, difference.right) == (12.35, 12.15)
    assert difference.relative == pytest.approx(0.2 / 12.35)
    assert 0.0 < robot.asymmetry.mass_matrix < 0.02
    for law in LAWS:
        law(robot)


def test_the_report_is_what_the_legs_do(model_files):
    """D and G of left and of mirrored right stance differ by the reported numbers."""
    robot = load_robot(unequal(model_files, [(LEG_MASS, '<mass value="12.35"/>')]))
    import pinocchio as pin

    from frontal_biped.model import Stance

    q = np.full(4, UPRIGHT)
    models = [robot.measured.chain(robot.description.sole, stance).pinned_model() for stance in Stance]
    D = [np.array(pin.crba(model, model.createData(), q)) for model in models]
    G = [np.array(pin.computeGeneralizedGravity(model, model.createData(), q)) for model in models]
    assert robot.asymmetry.mass_matrix == pytest.approx(np.abs(D[0] - D[1]).max() / D[0].max())
    assert robot.asymmetry.gravity == pytest.approx(np.abs(G[0] - G[1]).max())
    # 0.2 kg at the hip's distance from the middle, over the stance ankle
    assert robot.asymmetry.gravity > 0.1


def test_without_leave_they_are_refused_with_the_remedy(model_files):
    description = unequal(model_files, [(LEG_MASS, '<mass value="12.35"/>')], symmetrise=False)
    with pytest.raises(HypothesisError, match=re.escape("symmetrise = true")):
        load_robot(description)


def test_too_unequal_legs_are_refused_in_any_case(model_files):
    description = unequal(model_files, [(LEG_MASS, '<mass value="6"/>')])
    with pytest.raises(HypothesisError, match="too much to average") as caught:
        load_robot(description)
    assert caught.value.hypothesis == "HR3"


def test_limits_are_what_both_legs_can_do(model_files):
    narrow = HIP_LIMIT.replace('lower="-1.0" upper="1.0" effort="150" velocity="10"',
                               'lower="-0.3" upper="0.7" effort="120" velocity="8"')  # fmt: skip
    urdf, _ = model_files
    head, tail = urdf.read_text(encoding="utf-8").split('<joint name="left_hip"')
    urdf.write_text(head + '<joint name="left_hip"' + tail.replace(HIP_LIMIT, narrow, 1), encoding="utf-8")
    robot = load_robot(unequal(model_files, []))
    assert list(robot.max_torque) == [150.0, 120.0, 120.0, 150.0]
    assert list(robot.joint_max_velocity) == [10.0, 8.0, 8.0, 10.0]
    assert robot.joint_lower - UPRIGHT == pytest.approx([-1.2, -0.3, -0.3, -1.2])
    assert robot.joint_upper - UPRIGHT == pytest.approx([1.2, 0.7, 0.7, 1.2])
    for law in LAWS:
        law(robot)


def test_limits_count_from_the_reference_posture(model_files):
    _, description = model_files
    text = description.read_text(encoding="utf-8")
    posture = "[posture]\nleft_hip = 0.2\nright_hip = -0.2\nleft_ankle = -0.2\nright_ankle = 0.2\n\n[sole]"
    description.write_text(text.replace("[sole]", posture), encoding="utf-8")
    robot = load_robot(description)
    assert robot.joint_lower - UPRIGHT == pytest.approx([-1.0, -1.2, -1.2, -1.0])
    assert robot.joint_upper - UPRIGHT == pytest.approx([1.4, 0.8, 0.8, 1.4])
    for law in LAWS:
        law(robot)


@given(shift=st.floats(-0.01, 0.01), heavier=st.floats(0.9, 1.1), longer=st.floats(-0.01, 0.01))
def test_averaging_keeps_mass_and_height_and_is_done_once(biped, shift, heavier, longer):
    """Whatever the difference: the mean robot has the mass, the height of its centre of mass, and equal legs."""
    bodies, sole = biped.measured, biped.description.sole
    leg = bodies.body["left_hip"]
    changed = leg._replace(mass=leg.mass * heavier, com=leg.com + np.array([shift, longer]))
    position = {**bodies.position, "left_ankle": bodies.position["left_ankle"] + np.array([shift, longer])}
    raw = type(bodies)(position, {**bodies.body, "left_hip": changed}, bodies.joint)
    mean = symmetrised(raw)

    def moments(robot):
        masses = np.array([body.mass for body in robot.body.values()])
        return masses.sum(), sum(body.mass * body.com[1] for body in robot.body.values()) / masses.sum()

    assert moments(mean) == pytest.approx(moments(raw), rel=1e-12)
    assert asymmetry(mean, sole).differences == ()
    again = symmetrised(mean)
    for key, body in mean.body.items():
        assert again.body[key].com == pytest.approx(body.com, rel=1e-12, abs=1e-15)
