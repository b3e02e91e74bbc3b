"""MuJoCo's model of the whole robot in space against Pinocchio's: two readings of one URDF by two engines."""

import xml.etree.ElementTree as ElementTree
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from frontal_biped import load_robot
from frontal_biped.model.chain import GRAVITY
from frontal_biped.model.robot import Robot
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.mujoco.space_model import (
    SMALLEST,
    joint_addresses,
    moved_bodies,
    mujoco_space_model,
    nearest_possible_inertia,
)
from frontal_biped.simulation.mujoco.space_robot import SpaceRobot
from frontal_biped.simulation.mujoco.spec import SOLE_THICKNESS, sole_of

mujoco = pytest.importorskip("mujoco")

ROBOTS = ("frontal_biped", "talos_full", "g1", "icub", "alexander", "human", "simple_humanoid_classical")
"""All whose inertias bodies can have, but for rounding (icub)."""

DYNAMICS = 1e-10
"""Relative difference of M and bias: two engines; `SMALLEST` of forty bodies is far below, iCub's rounding is not."""


def random_state(free, generator):
    """Joints within half a radian of the posture, root anywhere."""
    q = pin.integrate(free.model, free.posture, generator.uniform(-0.5, 0.5, free.model.nv))
    return q, generator.uniform(-2.0, 2.0, free.model.nv)


def dynamics_in_mujoco(robot, q, v):
    """M (nv, nv) and bias (nv,) in Pinocchio's coordinates."""
    robot.place(q, v)
    model, data, free = robot.model, robot.data, robot.free
    M = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, M)
    _, at = joint_addresses(free, model)
    T = np.zeros_like(M)  # velocity in MuJoCo's coordinates = T v
    T[:3, :3] = pin.Quaternion(q[3:7]).matrix()
    T[3:6, 3:6] = np.eye(3)
    T[at, np.arange(6, model.nv)] = 1.0
    return T.T @ M @ T, T.T @ data.qfrc_bias


def dynamics_in_pinocchio(model, q, v):
    """The same by Pinocchio; MuJoCo has the root's velocity in world axes, so that is what does not accelerate."""
    model = model.copy()
    model.gravity.linear = np.array([0.0, 0.0, -GRAVITY])
    data = model.createData()
    still = np.zeros(model.nv)
    still[:3] = -np.cross(v[3:6], v[:3])
    M = np.triu(pin.crba(model, data, q))
    return M + np.triu(M, 1).T, pin.rnea(model, data, q, v, still)


def assert_same_dynamics(robot, model, tolerance):
    generator = np.random.default_rng(5)
    for _ in range(10):
        state = random_state(robot.free, generator)
        for ours, theirs in zip(dynamics_in_mujoco(robot, *state), dynamics_in_pinocchio(model, *state), strict=True):
            np.testing.assert_allclose(ours, theirs, atol=tolerance * np.max(np.abs(theirs)))


@pytest.mark.parametrize("name", ROBOTS)
def test_mass_matrix_and_bias_are_those_of_pinocchio(name):
    free = FreeRobot(load_robot(name).robot)
    robot = SpaceRobot(free)
    assert robot.model.nv == free.model.nv
    assert robot.model.body_mass.sum() == pytest.approx(free.mass, rel=1e-9)
    assert_same_dynamics(robot, free.model, DYNAMICS)


def test_impossible_inertias_are_all_that_differs():
    """Romeo's right arm: with the inertias of the URDF mended as MuJoCo's are, both engines agree again."""
    robot = load_robot("romeo").robot
    root = ElementTree.fromstring(robot.urdf_text)
    keys = (("ixx", 0, 0), ("iyy", 1, 1), ("izz", 2, 2), ("ixy", 0, 1), ("ixz", 0, 2), ("iyz", 1, 2))
    mended = []
    for link in root.findall("link"):
        inertia = link.find("inertial/inertia")
        if inertia is None:
            continue
        I = np.zeros((3, 3))
        for key, i, j in keys:
            I[i, j] = I[j, i] = float(inertia.get(key))
        possible = nearest_possible_inertia(I)
        if possible is not I:
            mended.append(link.get("name"))
            for key, i, j in keys:
                inertia.set(key, repr(float(possible[i, j])))
    assert mended == ["RShoulderYawLink", "RElbowYawLink"]
    changed = FreeRobot(Robot(robot.description, ElementTree.tostring(root, encoding="unicode")))
    in_mujoco = SpaceRobot(FreeRobot(robot))
    assert_same_dynamics(in_mujoco, changed.model, DYNAMICS)
    with pytest.raises(AssertionError):
        assert_same_dynamics(in_mujoco, in_mujoco.free.model, DYNAMICS)


class TestNearestPossibleInertia:
    @pytest.fixture
    def generator(self):
        return np.random.default_rng(2)

    @staticmethod
    def turned(moments, generator):
        axes = np.linalg.qr(generator.normal(size=(3, 3)))[0]
        return axes @ np.diag(moments) @ axes.T

    def test_a_possible_one_stays(self, generator):
        I = self.turned([1.0, 2.0, 2.9], generator)
        assert nearest_possible_inertia(I) is I

    @pytest.mark.parametrize("moments", [(1.0, 2.0, 5.0), (0.1, 0.1, 9.0)])
    def test_none_is_nearer(self, moments, generator):
        """Against moments about the same axes, which are nearest for equal moments, on a fine grid."""
        I = self.turned(moments, generator)
        mended = nearest_possible_inertia(I)
        a, b, c = np.linalg.eigvalsh(mended)
        assert a > 0.0
        assert c <= a + b
        grid = np.linspace(0.0, 10.0, 101)
        A, B, C = np.meshgrid(grid, grid, grid, indexing="ij")
        possible = (A <= B) & (B <= C) & (C <= A + B)
        others = (A - moments[0]) ** 2 + (B - moments[1]) ** 2 + (C - moments[2]) ** 2
        assert np.sum((mended - I) ** 2) <= others[possible].min() + 1e-9

    def test_less_than_nothing(self):
        moments = np.linalg.eigvalsh(nearest_possible_inertia(np.diag([-1e-20, 0.0, 0.0])))
        assert moments == pytest.approx(np.full(3, SMALLEST))


@pytest.mark.parametrize("name", ["talos_full", "romeo", "frontal_biped"])
def test_soles_are_where_the_robot_has_them(name):
    """Corners of the lower faces of the boxes, at the posture: on the ground, as the description or the shapes say."""
    free = FreeRobot(load_robot(name).robot)
    robot = SpaceRobot(free)
    robot.place(free.posture, np.zeros(free.model.nv))
    for side, sole in zip(Stance, free.soles, strict=True):
        geom = robot.model.geom(sole_of(side)).id
        size, R = robot.model.geom_size[geom], robot.data.geom_xmat[geom].reshape(3, 3)
        assert 2.0 * size == pytest.approx([sole.length, sole.width, SOLE_THICKNESS])
        signs = np.array([[i, j, -1.0] for i in (1.0, -1.0) for j in (1.0, -1.0)])
        corners = robot.data.geom_xpos[geom] + (signs * size) @ R.T
        pose = robot.sole(side)
        expected = pose.position + sole.corners @ pose.rotation.T
        for corner in expected:
            assert np.min(np.linalg.norm(corners - corner, axis=1)) < 1e-12
        assert corners[:, 2] == pytest.approx(np.zeros(4), abs=1e-6)


def test_joints_keep_range_and_rotor_and_nothing_else():
    free = FreeRobot(load_robot("talos_full").robot)
    model = mujoco_space_model(free)
    for i, name in enumerate(free.joint_names):
        joint = model.joint(name)
        assert joint.range == pytest.approx([free.limits.lower[i], free.limits.upper[i]])
        assert joint.armature == pytest.approx(free.armature[i])
        assert joint.damping == 0.0
        assert joint.frictionloss == 0.0
    assert free.locked  # the grippers, which are part of the hands
    assert {model.joint(i).name for i in range(1, model.njnt)} == set(free.joint_names)
    assert len(set(moved_bodies(free, model))) == 1 + len(free.joint_names)


def test_light_joints_are_locked_at_their_posture():
    """A gripper that is half open in the posture is so in both engines."""
    robot = load_robot("talos_full").robot
    gripper = FreeRobot(robot).locked[0]
    posture = {**robot.description.posture, gripper: -0.3}
    free = FreeRobot(Robot(replace(robot.description, posture=posture), robot.urdf_text))
    assert gripper in free.locked
    assert_same_dynamics(SpaceRobot(free), free.model, DYNAMICS)
