"""The whole robot of a planar run, a gait and a walk in space: by Pinocchio's and MuJoCo's own reading of the URDF."""

from dataclasses import replace
from functools import cache
from typing import NamedTuple

import numpy as np
import pinocchio as pin
import pytest
from swept_walk import swept_walk
from urdf_in_mujoco import mujoco_model
from whole_robots import Whole, whole

from frontal_biped.exceptions import RobotError, SpecificationError, UnknownNameError
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.robot import Robot
from frontal_biped.model.space.whole_motion import WholeMotion
from frontal_biped.simulation.orbit import orbit_trajectory
from frontal_biped.simulation.trajectory import Trajectory
from frontal_biped.simulation.whole_robot import whole_motion

STILL = 1e-9
"""How far a foot that stands may seem to move [m, rad, m/s]."""

SEEN = {
    "talos_bent": 1e-4,  # legs that differ by rounding of the URDF are averaged in the plane
    "romeo": 1e-9,
    "g1_bent": 2e-3,  # virtual legs, left and right averaged
}
"""By robot: how far the swing foot may be from where the plane has it [m]."""


class Moved(NamedTuple):
    """A robot, two steps of its orbit in the plane, and the whole of it there."""

    robot: Whole
    run: Trajectory
    motion: WholeMotion


@cache
def moved_by(name):
    robot = whole(name)
    run = orbit_trajectory(robot.biped, robot.gait, 2, samples=15)
    return Moved(robot, run, whole_motion(robot.biped, run))


@cache
def fast_step(name):
    """One step at 500 Hz, of which differences can be taken."""
    robot = whole(name)
    return robot.gait.trajectory(robot.biped, 500.0, steps=1)


@pytest.fixture(params=SEEN)
def moved(request):
    return moved_by(request.param)


def own_model(robot):
    """What a stranger builds of the URDF, who knows nothing of this package."""
    return pin.buildModelFromXML(robot.biped.robot.urdf_text, pin.JointModelFreeFlyer())


def sole(robot, model, data, foot):
    """World placement of a sole, below the ankle: `Robot.sole_placement` on the stranger's model."""
    side = (robot.free.soles.left, robot.free.soles.right)[foot]
    return data.oMi[model.getJointId(side.joint)] * side.placement


def test_the_stance_foot_stands_and_the_swing_foot_is_where_the_plane_has_it(moved):
    robot, run, motion = moved
    model = own_model(robot)
    data = model.createData()
    biped, allowed = robot.biped, SEEN[robot.biped.name]
    stood = {}
    for k in range(len(motion.t)):
        pin.forwardKinematics(model, data, motion.q[k], motion.v[k])
        stance = 0 if motion.stance[k] > 0.0 else 1
        here, there = (sole(robot, model, data, foot) for foot in (stance, 1 - stance))
        np.testing.assert_allclose(here.rotation, np.eye(3), atol=STILL)
        first = stood.setdefault(motion.step[k], here.translation.copy())
        np.testing.assert_allclose(here.translation, first, atol=STILL)
        assert abs(here.translation[2]) < STILL
        ankle = model.getJointId(robot.biped.stance_map.joint_names[0 if stance == 0 else 3])
        assert np.abs(pin.getVelocity(model, data, ankle).vector).max() < STILL
        h, v = biped.joint_positions(run.q[k])[-1]
        ankle_there = there.act(np.array([0.0, 0.0, biped.ankle_height]))
        expected = [here.translation[1] - motion.stance[k] * h, v]
        np.testing.assert_allclose(ankle_there[1:], expected, atol=allowed)
    assert set(motion.step) == {0.0, 1.0}


def test_velocities_are_the_rates_of_the_pose(moved):
    """A difference over 4 ms at its middle, base and joints alike."""
    motion, h = fast_step(moved.robot.biped.name), 2e-3
    at = len(motion.t) // 8  # well inside the rising phase
    assert motion.phase[at - 1] == motion.phase[at + 1] == 1.0
    between = pin.difference(motion.robot.model, motion.q[at - 1], motion.q[at + 1]) / (2.0 * h)
    np.testing.assert_allclose(between, motion.v[at], atol=1e-3)  # order 2 in h, jerks of some 1000 rad/s^3
    assert np.abs(motion.v[at]).max() > 0.1


def test_torques_and_wrench_balance_the_motion(moved):
    """Newton and Euler for every link, with accelerations from differences of the velocities alone."""
    robot, motion = moved.robot, fast_step(moved.robot.biped.name)
    at = len(motion.t) // 8
    model = motion.robot.model  # the description's rotor inertias, which a URDF cannot tell
    data = model.createData()
    a = (motion.v[at + 1] - motion.v[at - 1]) / 4e-3
    forces = pin.rnea(model, data, motion.q[at], motion.v[at], a)
    pin.forwardKinematics(model, data, motion.q[at])
    stands = sole(robot, model, data, 0)
    wrench = pin.Force(motion.wrench[at, 0])
    at_root = data.oMi[1].actInv(pin.SE3(np.eye(3), stands.translation).act(wrench))
    weight = 9.81 * robot.biped.mass
    np.testing.assert_allclose(at_root.vector, forces[:6], atol=1e-3 * weight)
    assert not motion.wrench[:, 1][motion.stance > 0.0].any()
    pin.computeJointJacobians(model, data, motion.q[at])
    frame = model.getJointId(robot.free.soles.left.joint)
    J = pin.getJointJacobian(model, data, frame, pin.LOCAL)
    local = data.oMi[frame].actInv(pin.SE3(np.eye(3), stands.translation).act(wrench))
    np.testing.assert_allclose(motion.tau[at], (forces - J.T @ local.vector)[6:], atol=1e-3 * weight)


def test_a_run_at_a_rate_is_the_orbit_at_that_rate():
    robot = whole("romeo")
    exact = robot.gait.trajectory(robot.biped, 250.0, steps=2)
    run = whole_motion(robot.biped, orbit_trajectory(robot.biped, robot.gait, 2, samples=481), 250.0)
    assert len(run.t) == len(exact.t)
    np.testing.assert_allclose(run.q, exact.q, atol=1e-7)
    np.testing.assert_allclose(run.v, exact.v, atol=1e-4)


def test_nothing_is_interpolated_where_the_feet_change_roles(biped, orbit):
    """A run whose impact lies between two samples, as a sensed one has it: joints go straight across."""
    lost = np.ones(len(orbit.t), dtype=bool)
    lost[np.flatnonzero(np.diff(orbit.step) != 0.0)] = False  # the sample before each impact
    names = (
        "t",
        "q",
        "dq",
        "u",
        "force",
        "p_fri",
        "p_fri_target",
        "q_b_desired",
        "phase",
        "stance",
        "stance_y",
        "step",
    )
    sensed = replace(orbit, **{name: getattr(orbit, name)[lost] for name in names})
    motion = whole_motion(biped, sensed.first_steps(2), 400.0)
    jumps = np.abs(np.diff(motion.angles, axis=0)).max()
    assert jumps < 3.0 * np.abs(motion.v[:, 6:]).max() / 400.0


def test_a_walk_in_space_keeps_every_number_and_the_power_of_its_joints(talos_walk):
    free, run = talos_walk
    motion = whole_motion(free, run)
    power = np.einsum("ti,ti->t", run.tau, run.v[:, 6:])
    for arrays in (motion.pinocchio, motion.mujoco):
        np.testing.assert_allclose(np.einsum("ti,ti->t", arrays.tau, arrays.v[:, 6:]), power, rtol=1e-12, atol=1e-9)
    assert motion.held == free.locked
    for i, name in enumerate(run.joint_names):
        np.testing.assert_array_equal(motion.positions[name], run.q[:, 7 + i])
        np.testing.assert_array_equal(motion.torques[name], run.tau[:, i])
        np.testing.assert_array_equal(run.positions[name], run.q[:, 7 + i])
        np.testing.assert_array_equal(run.velocities[name], motion.velocities[name])
        np.testing.assert_array_equal(run.torques[name], run.tau[:, i])
    assert all(np.ptp(motion.positions[name]) == 0.0 and not motion.velocities[name].any() for name in free.locked)
    # the whole model and the one without fingers have their mass at the same place
    full, data = free.robot.model, free.robot.model.createData()
    com = [pin.centerOfMass(full, data, q).copy() for q in motion.q[::50]]
    np.testing.assert_allclose(com, run.com[::50], atol=1e-12)


@pytest.fixture(scope="module")
def talos_walk():
    robot = whole("talos_full")
    return robot.free, swept_walk(robot.biped, robot.gait, steps=1, step_length=0.1)


def test_mujoco_has_every_link_where_pinocchio_has_it(moved):
    mujoco = pytest.importorskip("mujoco")
    robot, _, motion = moved
    theirs = mujoco_model(robot.biped.robot.urdf_text)
    state, arrays = mujoco.MjData(theirs), motion.mujoco
    model = own_model(robot)
    data = model.createData()
    for k in range(0, len(motion.t), 10):
        state.qpos[:] = arrays.q[k]
        mujoco.mj_forward(theirs, state)
        pin.framesForwardKinematics(model, data, motion.q[k])
        for body in range(1, theirs.nbody):
            place = data.oMf[model.getBodyId(theirs.body(body).name)]
            np.testing.assert_allclose(state.xpos[body], place.translation, atol=1e-9)


def test_held_joints_are_at_the_posture_of_the_description():
    robot = whole("talos_bent")
    motion = robot.gait.trajectory(robot.biped.robot, 20.0, steps=1)
    assert isinstance(motion.robot, Robot) and len(motion.held) == len(motion.joint_names) - 4
    posture = robot.biped.description.posture
    for name in motion.held:
        np.testing.assert_allclose(motion.positions[name], posture.get(name, 0.0), atol=1e-12)
    knee = next(name for name in posture if posture[name] > 0.3)
    assert np.abs(motion.torques[knee]).max() > 10.0  # a bent knee has a robot to bear


def test_names_that_are_none_and_rates_that_are_none_are_refused_in_one_line():
    robot = whole("romeo")
    motion = robot.gait.trajectory(robot.biped, 20.0, steps=1)
    with pytest.raises(UnknownNameError, match="no joint 'LHipRol'; did you mean 'LHipRoll'"):
        motion.torques["LHipRol"]
    assert "LHipRol" not in motion.torques and motion.torques.get("LHipRol") is None
    for wrong in ({"rate": 0.0}, {"rate": float("nan")}, {"rate": 10.0, "steps": 0}):
        with pytest.raises(SpecificationError, match="write"):
            robot.gait.trajectory(robot.biped, **wrong)


def test_a_floating_joint_of_the_urdf_itself_stays_where_it_is_and_only_arrays_are_refused(biped, orbit, tmp_path):
    """A link without mass on a joint of six freedoms, as some URDFs have for a tool; the robot is the same."""
    text = biped.robot.urdf_text.replace("</robot>", "")
    root = biped.robot.model.frames[2].name
    floating = (
        f'<link name="tool"/><joint name="floats" type="floating"><parent link="{root}"/>'
        '<child link="tool"/></joint></robot>'
    )
    (tmp_path / "floats.urdf").write_text(text + floating, encoding="utf-8")
    description = replace(biped.description, urdf=tmp_path / "floats.urdf")
    other = FrontalBiped(Robot.of(description))
    motion, expected = (whole_motion(robot, orbit.first_steps(1), 20.0) for robot in (other, biped))
    assert "floats" not in motion.positions and motion.root_link == root
    for name in expected.joint_names:
        np.testing.assert_allclose(motion.positions[name], expected.positions[name], atol=1e-12)
        np.testing.assert_allclose(motion.torques[name], expected.torques[name], atol=1e-9)
    np.testing.assert_allclose(motion.wrench, expected.wrench, atol=1e-9)
    with pytest.raises(RobotError, match="joint 'floats' has more than one freedom"):
        assert motion.mujoco
