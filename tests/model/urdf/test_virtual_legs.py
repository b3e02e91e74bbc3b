"""Virtual legs: roll axes that are not along X are turned in place, and what that leaves as it was."""

import numpy as np
import pinocchio as pin
import pytest
from robot_laws import EXACT, LAWS, close

from frontal_biped.exceptions import HypothesisError, RobotError
from frontal_biped.model import load_robot, load_whole_robot, models_dir
from frontal_biped.model.urdf.description import read_description
from frontal_biped.model.urdf.description_text import description_text
from frontal_biped.model.urdf.locked_model import lock_other_joints

BENT = (-0.3, 0.6, -0.3)
"""Hip pitch, knee, ankle pitch [rad]: G1's hip roll axes are then 27 degrees below X."""


@pytest.fixture
def described(tmp_path):
    """G1 as shipped, its knees bent or not, with further keys at the head of its description."""

    def write(head="", angles=BENT):
        lines = (models_dir() / "g1.toml").read_text(encoding="utf-8").splitlines()
        for i, line in enumerate(lines):
            for joint, angle in zip(("hip_pitch", "knee", "ankle_pitch"), angles, strict=True):
                if line.startswith((f"left_{joint}_joint", f"right_{joint}_joint")):
                    lines[i] = f"{line.split(' = ')[0]} = {angle}"
        path = tmp_path / "bent.toml"
        path.write_text("\n".join([head, *lines, ""]), encoding="utf-8")
        return path

    return write


@pytest.fixture
def biped(described):
    return load_robot(described("virtual_legs = true"))


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.__name__)
def test_the_planar_robot_obeys_the_laws(biped, law):
    law(biped)


def test_nothing_moves_at_the_posture(biped):
    """Every link, every body's inertia and every joint's origin is where the URDF has it."""
    turned = biped.spatial_model
    as_built, reference = lock_other_joints(biped.robot)
    data, data_built = turned.createData(), as_built.createData()
    pin.framesForwardKinematics(turned, data, reference)
    pin.framesForwardKinematics(as_built, data_built, reference)
    for i, frame in enumerate(as_built.frames):
        if frame.type != pin.FrameType.JOINT:
            assert turned.frames[i].name == frame.name
            close(data.oMf[i].homogeneous, data_built.oMf[i].homogeneous, EXACT, frame.name)
    for joint in range(1, as_built.njoints):
        close(data.oMi[joint].translation, data_built.oMi[joint].translation, EXACT, as_built.names[joint])
        inertia = data.oMi[joint].act(turned.inertias[joint]).matrix()
        close(inertia, data_built.oMi[joint].act(as_built.inertias[joint]).matrix(), EXACT, as_built.names[joint])


def test_a_leg_turns_about_x(biped):
    """Through the origin of its joint, by the joint's angle: Rodrigues' formula against Pinocchio's joint."""
    model, reference = biped.spatial_model, biped.spatial_reference
    data, moved = model.createData(), model.createData()
    pin.framesForwardKinematics(model, data, reference)
    for name, sign in zip(biped.stance_map.joint_names, biped.stance_map.axis_sign, strict=True):
        q, joint = reference.copy(), model.getJointId(name)
        q[model.joints[joint].idx_q] += 0.4
        pin.framesForwardKinematics(model, moved, q)
        turn, origin = pin.rpy.rpyToMatrix(0.4 * sign, 0.0, 0.0), data.oMi[joint].translation
        for i, frame in enumerate(model.frames):
            if frame.parentJoint == joint:
                expected = turn @ (data.oMf[i].translation - origin) + origin
                close(moved.oMf[i].translation, expected, EXACT, frame.name)
                close(moved.oMf[i].rotation, turn @ data.oMf[i].rotation, EXACT, frame.name)


def test_limits_are_carried_over(biped):
    measured, limits = biped.measured, biped.robot.limits
    for key, name in biped.description.joints.items():
        row = biped.robot.joint_names.index(name)
        joint = measured.joint[key]
        assert (joint.lower, joint.upper) == (limits.lower[row], limits.upper[row])  # their axes point forward
        assert (joint.velocity, joint.effort) == (limits.velocity[row], limits.effort[row])


def test_axes_along_x_are_left_alone(described):
    """Where HR2 holds, the key changes nothing but the fingerprint."""
    straight = (0.1749, -0.087265999, -0.087634001)
    plain, virtual = load_robot(described(angles=straight)), load_robot(described("virtual_legs = true", straight))
    q = np.array([-1.5, -1.7, -1.4, -1.6])
    close(virtual.D(q), plain.D(q), EXACT, "mass matrix")
    assert plain.fingerprint == load_robot("g1").fingerprint != virtual.fingerprint


def test_without_them_the_remedy_is_named(described):
    with pytest.raises(HypothesisError, match=r"27.2 degrees off world X.*virtual_legs = true.*HR2"):
        load_robot(described())


def test_a_joint_that_does_not_roll_is_refused(described, tmp_path):
    path = described("virtual_legs = true")
    path.write_text(path.read_text(encoding="utf-8").replace('"left_hip_roll', '"left_hip_pitch'), encoding="utf-8")
    with pytest.raises(HypothesisError, match=r"left_hip_pitch_joint' is .* degrees off world X; .*HR2"):
        load_robot(path)


def test_a_foot_that_is_not_flat_is_refused(described):
    path = described("virtual_legs = true", (-0.3, 0.6, -0.2))
    with pytest.raises(HypothesisError, match=r"left foot is turned by .* 5.73 and .*left_ankle_roll_joint.*HR5"):
        load_robot(path)


def test_a_leg_of_too_few_joints_is_refused(tmp_path):
    for file in ("frontal_biped.urdf", "frontal_biped.toml"):
        text = (models_dir() / file).read_text(encoding="utf-8")
        (tmp_path / file).write_text(f"virtual_legs = true\n{text}" if file.endswith("toml") else text)
    with pytest.raises(HypothesisError, match=r"the left leg has 2 joints of at least 6; leave virtual_legs out"):
        load_robot(tmp_path / "frontal_biped.toml")


def test_mujocos_plane_refuses_it(biped):
    pytest.importorskip("mujoco")
    from frontal_biped.simulation.mujoco.model import mujoco_model

    with pytest.raises(RobotError, match=r"virtual_legs = true.*walk it in space: frontal-biped walk .*bent.toml"):
        mujoco_model(biped)


def test_a_truth_value_is_asked_for(described):
    with pytest.raises(RobotError, match="virtual_legs = 1 is neither true nor false; write virtual_legs = true"):
        load_robot(described("virtual_legs = 1"))


def test_rotors_of_the_other_joints(described):
    """They are the whole robot's; the planar one, and its fingerprint, know nothing of them."""
    path = described("virtual_legs = true")
    plain = load_whole_robot(path)
    path.write_text(f"{path.read_text(encoding='utf-8')}\n[armature]\nother = 0.02\n", encoding="utf-8")
    robot = load_whole_robot(path)
    rolls = set(robot.description.joints.values())
    expected = [0.0 if name in rolls else 0.02 for name in robot.joint_names]
    assert robot.armature.tolist() == expected
    assert robot.fingerprint == plain.fingerprint


def test_talos_has_one_rotor_inertia_throughout():
    """Its SRDF gives all motors of legs, torso, arms and head the same."""
    assert set(load_whole_robot("talos_full").armature) == {0.1}


def test_a_description_is_written_with_both_keys(described, tmp_path):
    path = described("virtual_legs = true")
    path.write_text(f"{path.read_text(encoding='utf-8')}\n[armature]\nother = 0.02\n", encoding="utf-8")
    description = read_description(path)
    again = tmp_path / "again.toml"
    again.write_text(description_text(description, "example-robot-data:g1_description/urdf/g1_29dof_rev_1_0.urdf"))
    written = read_description(again)
    assert written.virtual_legs
    assert written.other_armature == 0.02
    assert load_whole_robot(again).fingerprint == load_whole_robot(path).fingerprint
