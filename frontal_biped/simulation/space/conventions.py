"""A walk in space as arrays for Pinocchio and for MuJoCo, every joint of the URDF among them.

Both write a configuration as the root link's position, its orientation and the joints' positions, and agree on nothing
else:

=================  =========================================  ====================================================
what               Pinocchio, free-flyer root                 MuJoCo, free joint on the root link
=================  =========================================  ====================================================
quaternion         x, y, z, w                                 w, x, y, z
linear velocity    of the root link's origin, its own axes    of the root link's origin, world axes
angular velocity   root link's axes                           root link's axes
order of joints    children of a link by name                 children of a link as the URDF lists their joints
continuous joint   cosine and sine                            angle
=================  =========================================  ====================================================
"""

import xml.etree.ElementTree as ElementTree
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.model.robot import Robot
from frontal_biped.model.space.free_robot import BASE, FreeRobot
from frontal_biped.simulation.space.run import SpatialRun

ROOT = 7
"""Numbers of the root's pose, before the joints."""


class JointArrays(NamedTuple):
    """Motion of every joint of a URDF, its light ones held at the posture, in one of the two conventions.

    Attributes:
        q: (T, nq) configurations.
        v: (T, nv) velocities.
        tau: (T, nv - 6) joint torques; 0 for joints that are held [N m].
        names: of the joints, in the order of the arrays.
    """

    q: FloatArray
    v: FloatArray
    tau: FloatArray
    names: tuple[str, ...]


def pinocchio_arrays(robot: FreeRobot, run: SpatialRun) -> JointArrays:
    """The run for the URDF read by Pinocchio with a free-flyer root: `Robot.model`."""
    full, rows = robot.robot.model, robot.robot.joint_names
    q = np.tile(robot.robot.posture, (len(run.t), 1))
    v, tau = np.zeros((len(run.t), full.nv)), np.zeros((len(run.t), full.nv - BASE))
    q[:, :ROOT], v[:, :BASE] = run.q[:, :ROOT], run.v[:, :BASE]
    for i, name in enumerate(run.joint_names):
        joint = full.joints[full.getJointId(name)]
        q[:, joint.idx_q] = run.q[:, ROOT + i]
        v[:, joint.idx_v] = run.v[:, BASE + i]
        tau[:, joint.idx_v - BASE] = run.tau[:, i]
    return JointArrays(q, v, tau, rows)


def mujoco_arrays(robot: FreeRobot, run: SpatialRun) -> JointArrays:
    """The run for the URDF read by MuJoCo, a free joint on its root link: qpos, qvel and the joints' qfrc_applied."""
    return to_mujoco(robot.robot, pinocchio_arrays(robot, run))


def to_mujoco(robot: Robot, arrays: JointArrays) -> JointArrays:
    """From Pinocchio's convention to MuJoCo's."""
    names = mujoco_joint_names(robot.urdf_text)
    angles = np.stack([_positions(robot.model, name, arrays.q) for name in names], axis=1)
    order = [arrays.names.index(name) for name in names]
    rotation = _rotations(arrays.q[:, 3:7])
    linear = np.einsum("tij,tj->ti", rotation, arrays.v[:, :3])
    return JointArrays(
        np.column_stack([arrays.q[:, :3], arrays.q[:, [6, 3, 4, 5]], angles]),
        np.column_stack([linear, arrays.v[:, 3:BASE], arrays.v[:, BASE:][:, order]]),
        arrays.tau[:, order],
        names,
    )


def from_mujoco(robot: Robot, arrays: JointArrays) -> JointArrays:
    """From MuJoCo's convention to Pinocchio's."""
    model, names = robot.model, robot.joint_names
    order = [arrays.names.index(name) for name in names]
    quaternion = arrays.q[:, [4, 5, 6, 3]]
    q = np.zeros((len(arrays.q), model.nq))
    q[:, :3], q[:, 3:ROOT] = arrays.q[:, :3], quaternion
    for name, place in zip(names, order, strict=True):
        joint, angle = model.joints[model.getJointId(name)], arrays.q[:, ROOT + place]
        if joint.nq == 2:
            q[:, joint.idx_q], q[:, joint.idx_q + 1] = np.cos(angle), np.sin(angle)
        else:
            q[:, joint.idx_q] = angle
    linear = np.einsum("tji,tj->ti", _rotations(quaternion), arrays.v[:, :3])
    v = np.column_stack([linear, arrays.v[:, 3:BASE], arrays.v[:, BASE:][:, order]])
    return JointArrays(q, v, arrays.tau[:, order], names)


def mujoco_joint_names(urdf_text: str) -> tuple[str, ...]:
    """The movable joints of a URDF in MuJoCo's order: depth first, children as the URDF lists their joints."""
    urdf = ElementTree.fromstring(urdf_text)
    joints: dict[str, list[tuple[str, str, str]]] = {}
    children = set()
    for joint in urdf.findall("joint"):
        parent, child = (joint.find(end).get("link", "") for end in ("parent", "child"))  # type: ignore[union-attr]
        joints.setdefault(parent, []).append((joint.get("name", ""), joint.get("type", ""), child))
        children.add(child)
    found = []
    stack = [link.get("name", "") for link in urdf.findall("link") if link.get("name") not in children]
    while stack:
        link = stack.pop()
        if link.startswith("/"):  # a joint, reached by the way down
            found.append(link[1:])
            continue
        for name, kind, child in reversed(joints.get(link, [])):
            stack.append(child)
            if kind != "fixed":
                stack.append(f"/{name}")
    return tuple(found)


def convention_arrays(robot: FreeRobot, run: SpatialRun) -> dict[str, FloatArray]:
    """What an exported archive holds: the run in both conventions, and what concerns neither.

    Returns:
        t; pinocchio_q, pinocchio_v, pinocchio_tau, pinocchio_joints; mujoco_qpos, mujoco_qvel, mujoco_tau,
        mujoco_joints; wrench, contact, com, com_velocity, sole_position, sole_yaw, frontal_q, frontal_dq as in
        `SpatialRun`; held_joints, the joints at rest at the posture.
    """
    ours, theirs = pinocchio_arrays(robot, run), mujoco_arrays(robot, run)
    shared = ("wrench", "contact", "com", "com_velocity", "sole_position", "sole_yaw", "frontal_q", "frontal_dq")
    return {
        "t": run.t,
        "pinocchio_q": ours.q,
        "pinocchio_v": ours.v,
        "pinocchio_tau": ours.tau,
        "pinocchio_joints": np.array(ours.names),
        "mujoco_qpos": theirs.q,
        "mujoco_qvel": theirs.v,
        "mujoco_tau": theirs.tau,
        "mujoco_joints": np.array(theirs.names),
        **{name: getattr(run, name) for name in shared},
        "held_joints": np.array(run.locked),
    }


def _positions(model: pin.Model, name: str, q: FloatArray) -> FloatArray:
    joint = model.joints[model.getJointId(name)]
    if joint.nq == 2:
        return np.arctan2(q[:, joint.idx_q + 1], q[:, joint.idx_q])
    return q[:, joint.idx_q]


def _rotations(quaternions: FloatArray) -> FloatArray:
    """(T, 3, 3) of quaternions (T, 4), x y z w."""
    return np.array([pin.Quaternion(row).matrix() for row in quaternions])
