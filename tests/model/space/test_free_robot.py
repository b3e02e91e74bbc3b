"""The robot on its free base."""

import pickle
import xml.etree.ElementTree as ElementTree

import numpy as np
import pinocchio as pin
import pytest

from frontal_biped.model.catalogue import load_whole_robot
from frontal_biped.model.robot import Robot
from frontal_biped.model.space.free_robot import BASE, FreeRobot
from frontal_biped.model.stance_map import Stance

ROBOTS = ("talos_full", "romeo", "g1", "icub", "simple_humanoid_classical")


@pytest.fixture(scope="module", params=ROBOTS)
def free(request):
    return FreeRobot(load_whole_robot(request.param))


def test_nothing_is_lost_with_the_light_joints(free):
    whole, data = free.robot.model, free.robot.model.createData()
    pin.centerOfMass(whole, data, free.robot.posture)
    ours = free.model.createData()
    pin.centerOfMass(free.model, ours, free.posture)
    assert free.mass == pytest.approx(pin.computeTotalMass(free.model), rel=1e-14)
    shift = free.posture[:3] - free.robot.posture[:3]
    np.testing.assert_allclose(ours.com[0] - shift, data.com[0], atol=1e-12)


def test_rows_are_those_of_the_joints(free):
    assert len(free.joint_names) == free.model.nv - BASE == len(free.limits.effort) == len(free.armature)
    for i, name in enumerate(free.joint_names):
        joint = free.model.joints[free.model.getJointId(name)]
        assert joint.idx_v == BASE + i
        assert free.limits.effort[i] == pytest.approx(free.model.effortLimit[joint.idx_v])


def test_soles_lie_flat_on_the_ground(free):
    data = free.model.createData()
    pin.framesForwardKinematics(free.model, data, free.posture)
    left, right = (data.oMf[free.sole_frame(side)] for side in (Stance.LEFT, Stance.RIGHT))
    np.testing.assert_allclose(left.translation + right.translation, 0.0, atol=1e-12)
    for sole in (left, right):
        # icub's own axes are rounded to 1e-5
        np.testing.assert_allclose(sole.rotation, np.eye(3), atol=1e-4)
        assert abs(sole.translation[2]) < 1e-4


def test_grippers_are_held_and_nothing_else():
    assert FreeRobot(load_whole_robot("talos_full")).locked
    assert all("gripper" in name for name in FreeRobot(load_whole_robot("talos_full")).locked)
    assert FreeRobot(load_whole_robot("g1")).locked == ()


def test_legs_are_six_joints_down_to_the_ankle(free):
    for side in Stance:
        names = [free.joint_names[i] for i in free.leg(side)]
        assert len(names) == 6
        assert names[-1] == free.robot.description.joints[f"{side.value}_ankle"]


def test_pickles():
    free = FreeRobot(load_whole_robot("romeo"))
    again = pickle.loads(pickle.dumps(free))
    np.testing.assert_array_equal(again.posture, free.posture)


def test_a_limit_of_nothing_is_none():
    """Exporters write effort="0" velocity="0" where they know none."""
    robot = load_whole_robot("talos_full")
    root = ElementTree.fromstring(robot.urdf_text)
    (limit,) = root.findall("joint[@name='head_1_joint']/limit")
    limit.set("effort", "0")
    limit.set("velocity", "0")
    free = FreeRobot(Robot(robot.description, ElementTree.tostring(root, encoding="unicode")))
    head = free.joint_names.index("head_1_joint")
    assert np.isinf([free.limits.effort[head], free.limits.velocity[head]]).all()
    others = np.arange(len(free.joint_names)) != head
    assert np.isfinite(free.limits.effort[others]).all()
    assert np.isfinite(free.limits.velocity[others]).all()
