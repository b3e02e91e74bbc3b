"""Stance against URDF coordinates, and the planar models against the 3D model they were reduced from."""

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from random_states import UPRIGHT, angles, assert_close, rates, vectors

from frontal_biped.model import FrontalBiped, Stance, load_robot, relabel

REDUCTION_TOLERANCE = 1e-10
"""Relative difference between the 3D model and its planar reduction: the projection is exact."""

PLANE = [1, 2, 3, 6, 7, 8, 9]
"""Velocity components of the 3D model that move the frontal plane: y, z, roll, four joints."""

stances = pytest.mark.parametrize("stance", list(Stance))


def configuration_3d(robot: FrontalBiped, q, stance):
    """Configuration of the 3D model with the stance foot flat and the given stance coordinates."""
    model, full = robot.spatial_model, robot.spatial_reference.copy()
    roll_joints = robot.stance_map.joint_names
    joint_angles = robot.stance_map.positions_to_urdf(q, stance)
    for name, angle in zip(roll_joints, joint_angles, strict=True):
        full[model.joints[model.getJointId(name)].idx_q] = angle
    # turn the pelvis so that the stance foot is flat
    data = model.createData()
    pin.forwardKinematics(model, data, full)
    ankle = model.getJointId(roll_joints[0 if stance is Stance.LEFT else 3])
    foot, reference = data.oMi[ankle].rotation, stance_foot_reference(robot, stance)
    turn = reference @ foot.T
    full[3:7] = pin.Quaternion(turn).coeffs()
    return full, ankle


def stance_foot_reference(robot: FrontalBiped, stance):
    model, data = robot.spatial_model, robot.spatial_model.createData()
    pin.forwardKinematics(model, data, robot.spatial_reference)
    name = robot.stance_map.joint_names[0 if stance is Stance.LEFT else 3]
    return data.oMi[model.getJointId(name)].rotation


def stance_foot_projection(robot: FrontalBiped, stance, full, ankle):
    """(10, 4) matrix: velocities of the 3D model of stance velocities dq, stance foot at rest."""
    model, data = robot.spatial_model, robot.spatial_model.createData()
    pin.computeJointJacobians(model, data, full)
    J = pin.getJointJacobian(model, data, ankle, pin.LOCAL)
    joints = np.zeros((model.nv, 4))
    for name, row in zip(
        robot.stance_map.joint_names, robot.stance_map.velocities_to_urdf(np.eye(4), stance).T, strict=True
    ):
        joints[model.joints[model.getJointId(name)].idx_v] = row
    projection = joints.copy()
    projection[:6] = -np.linalg.solve(J[:, :6], J @ joints)
    return projection


@stances
@given(q=angles)
def test_pinned_mass_matrix_is_the_3d_one_with_the_stance_foot_held(robot, stance, q):
    full, ankle = configuration_3d(robot, q, stance)
    N = stance_foot_projection(robot, stance, full, ankle)
    outside = [i for i in range(10) if i not in PLANE]
    assert_close(N[outside], np.zeros((3, 4)), REDUCTION_TOLERANCE, floor=1.0)  # the motion stays in the plane
    M = pin.crba(robot.spatial_model, robot.spatial_model.createData(), full)
    M = np.triu(M) + np.triu(M, 1).T
    in_plane = N[PLANE]
    assert_close(in_plane.T @ M[np.ix_(PLANE, PLANE)] @ in_plane, robot.D(q), REDUCTION_TOLERANCE)


@stances
@given(q=angles, dq=rates)
def test_pinned_gravity_and_energy_are_the_3d_ones(robot, stance, q, dq):
    full, ankle = configuration_3d(robot, q, stance)
    N = stance_foot_projection(robot, stance, full, ankle)
    data = robot.spatial_model.createData()
    gravity = pin.computeGeneralizedGravity(robot.spatial_model, data, full)
    assert_close(N.T @ gravity, robot.G(q), REDUCTION_TOLERANCE, floor=10.0)
    kinetic = pin.computeKineticEnergy(robot.spatial_model, data, full, N @ dq)
    assert kinetic == pytest.approx(0.5 * dq @ robot.D(q) @ dq, rel=REDUCTION_TOLERANCE, abs=REDUCTION_TOLERANCE)


@stances
@given(q=angles)
def test_joint_positions_are_those_of_the_3d_model(robot, stance, q):
    full, _ = configuration_3d(robot, q, stance)
    model, data = robot.spatial_model, robot.spatial_model.createData()
    pin.forwardKinematics(model, data, full)
    names = robot.stance_map.joint_names if stance is Stance.LEFT else robot.stance_map.joint_names[::-1]
    y_z = np.array([data.oMi[model.getJointId(name)].translation[1:] for name in names])
    y_z -= y_z[0]
    # h points from the stance foot to the swing foot: -Y when the left foot stands
    planar = y_z * [-1.0 if stance is Stance.LEFT else 1.0, 1.0]
    planar[:, 1] += robot.ankle_height
    assert_close(robot.joint_positions(q), planar, REDUCTION_TOLERANCE)


@stances
@given(values=vectors(-1.0, 1.0))
def test_there_and_back(robot, stance, values):
    stance_map = robot.stance_map
    for name in ("positions", "velocities", "torques"):
        to_stance = getattr(stance_map, f"{name}_to_stance")
        to_urdf = getattr(stance_map, f"{name}_to_urdf")
        assert_close(to_urdf(to_stance(values, stance), stance), values, REDUCTION_TOLERANCE, floor=1.0)
        assert_close(to_stance(to_urdf(values, stance), stance), values, REDUCTION_TOLERANCE, floor=1.0)


@stances
@given(tau=vectors(-100.0, 100.0), dq_urdf=rates)
def test_power_is_the_same_in_both_coordinates(robot, stance, tau, dq_urdf):
    u = robot.stance_map.torques_to_stance(tau, stance)
    dq = robot.stance_map.velocities_to_stance(dq_urdf, stance)
    assert u @ dq == pytest.approx(tau @ dq_urdf, rel=REDUCTION_TOLERANCE, abs=1e-9)


@stances
@given(q=angles, dq=rates)
def test_velocities_are_the_derivative_of_positions(robot, stance, q, dq):
    step = 0.5  # the map is affine, so any step will do
    positions = robot.stance_map.positions_to_urdf
    rate = (positions(q + step * dq, stance) - positions(q - step * dq, stance)) / (2.0 * step)
    assert_close(robot.stance_map.velocities_to_urdf(dq, stance), rate, REDUCTION_TOLERANCE, floor=1.0)


@stances
def test_trajectories_map_row_by_row(biped, stance):
    trajectory = UPRIGHT + 0.1 * np.arange(12.0).reshape(3, 4)
    mapped = biped.stance_map.positions_to_urdf(trajectory, stance)
    rows = [biped.stance_map.positions_to_urdf(q, stance) for q in trajectory]
    assert np.array_equal(mapped, rows)


@given(q_urdf=vectors(-0.5, 0.5), dq_urdf=rates)
def test_mirrored_states_have_the_same_stance_coordinates(robot, q_urdf, dq_urdf):
    """Mirroring the robot in its middle exchanges left and right and turns every roll angle round."""
    stance_map = robot.stance_map
    mirrored_q, mirrored_dq = -q_urdf[::-1], -dq_urdf[::-1]
    left, right = Stance.LEFT, Stance.RIGHT
    q = stance_map.positions_to_stance(q_urdf, left)
    dq = stance_map.velocities_to_stance(dq_urdf, left)
    assert_close(stance_map.positions_to_stance(mirrored_q, right), q, REDUCTION_TOLERANCE)
    assert_close(stance_map.velocities_to_stance(mirrored_dq, right), dq, REDUCTION_TOLERANCE, floor=1.0)


@given(q_urdf=vectors(-0.5, 0.5))
def test_changing_the_stance_foot_is_relabelling(robot, q_urdf):
    left = robot.stance_map.positions_to_stance(q_urdf, Stance.LEFT)
    right = robot.stance_map.positions_to_stance(q_urdf, Stance.RIGHT)
    assert np.array_equal(relabel(left), right)


@stances
def test_zero_urdf_configuration_is_upright(biped, stance):
    assert_close(biped.stance_map.positions_to_stance(np.zeros(4), stance), np.full(4, UPRIGHT), REDUCTION_TOLERANCE)


@stances
def test_rising_leans_away_from_the_swing_foot(robot, stance):
    """dbeta > 0, other joints fixed, moves everything away from the swing foot, in the plane and in space."""
    upright = np.full(4, UPRIGHT)
    leaning = upright + 0.05 * np.eye(4)[0]
    assert robot.com(leaning)[0] < robot.com(upright)[0]
    heights = robot.swing_sole(leaning)[:, 1]
    assert np.all(heights > robot.swing_sole(upright)[:, 1])  # and lifts the swing foot
    y = []
    for q in (upright, leaning):
        full, ankle = configuration_3d(robot, q, stance)
        model, data = robot.spatial_model, robot.spatial_model.createData()
        pin.forwardKinematics(model, data, full)
        y.append(pin.centerOfMass(model, data, full)[1] - data.oMi[ankle].translation[1])
    outwards = 1.0 if stance is Stance.LEFT else -1.0
    assert outwards * (y[1] - y[0]) > 0.0
    assert y[1] - y[0] == pytest.approx(-outwards * (robot.com(leaning) - robot.com(upright))[0], rel=1e-9)


def test_a_raised_pelvis_side_follows_the_right_hand_rule(biped):
    """Positive pelvis roll is counter-clockwise in (h, v): the swing hip rises."""
    q = np.full(4, UPRIGHT) + 0.1 * np.eye(4)[1]
    positions = biped.joint_positions(q)
    assert float(biped.pelvis_roll(q)) == pytest.approx(0.1)
    assert positions[2, 1] > positions[1, 1]


@stances
def test_opposite_axes_in_the_urdf_change_only_the_map(biped, model_files, stance):
    """A URDF whose left hip and right ankle turn about -X is the same robot, these joint signs reversed."""
    urdf, description = model_files
    text = urdf.read_text()
    for joint in ("left_hip", "right_ankle"):
        head, tail = text.split(f'<joint name="{joint}"')
        text = head + f'<joint name="{joint}"' + tail.replace('xyz="1 0 0"', 'xyz="-1 0 0"', 1)
    urdf.write_text(text)
    twin = load_robot(description)
    q = UPRIGHT + np.array([0.1, -0.2, 0.15, 0.05])
    assert_close(twin.D(q), biped.D(q), REDUCTION_TOLERANCE)
    assert_close(twin.chain.joints, biped.chain.joints, REDUCTION_TOLERANCE)
    sign = np.array([1.0, -1.0, 1.0, -1.0])
    for name in ("velocities_to_urdf", "torques_to_urdf", "positions_to_urdf"):
        here, there = getattr(biped.stance_map, name)(q, stance), getattr(twin.stance_map, name)(q, stance)
        assert_close(there, sign * here, REDUCTION_TOLERANCE)


def test_locked_joints_enter_the_inertia(biped, model_files):
    """A mass on a locked joint of the pelvis is part of the torso, where the [posture] puts it."""
    urdf, description = model_files
    arm = (
        '<link name="arm"><inertial><origin xyz="0 0 -0.3"/><mass value="4"/>'
        '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        '<joint name="shoulder" type="revolute"><parent link="pelvis"/><child link="arm"/>'
        '<origin xyz="0 0 0.4"/><axis xyz="0 1 0"/>'
        '<limit lower="-3.2" upper="3.2" effort="1" velocity="1"/></joint>'
    )
    urdf.write_text(urdf.read_text().replace("</robot>", arm + "</robot>"))
    upright = np.full(4, UPRIGHT)
    hip_height = biped.leg_length + biped.ankle_height
    for angle, height in ((0.0, 0.1), (np.pi / 3, 0.25), (np.pi, 0.7)):
        text = description.read_text().replace("[sole]", f"[posture]\nshoulder = {angle!r}\n\n[sole]")
        changed = description.with_name("with_arm.toml")
        changed.write_text(text)
        robot = load_robot(changed)
        assert robot.mass == pytest.approx(biped.mass + 4.0)
        expected = (biped.mass * biped.com(upright)[1] + 4.0 * (hip_height + height)) / robot.mass
        assert robot.com(upright)[1] == pytest.approx(expected, rel=1e-12)
        assert robot.com(upright)[0] == pytest.approx(0.1, rel=1e-12)
