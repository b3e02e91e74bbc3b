"""A motion of the whole robot as arrays for Pinocchio and for MuJoCo, every joint of the URDF among them.

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
from frontal_biped.model.space.free_robot import BASE

ROOT = 7
"""Numbers of the root's pose, before the joints."""


class JointArrays(NamedTuple):
    """Motion of every joint of a URDF, in one of the two conventions.

    Attributes:
        q: (T, nq) configurations.
        v: (T, nv) velocities.
        tau: (T, nv - 6) joint torques [N m].
        names: of the joints, in the order of the arrays.
    """

    q: FloatArray
    v: FloatArray
    tau: FloatArray
    names: tuple[str, ...]


def to_mujoco(robot: Robot, arrays: JointArrays) -> JointArrays:
    """From Pinocchio's convention to MuJoCo's."""
    names = mujoco_joint_names(robot.urdf_text)
    angles = np.stack([joint_positions(robot.model, name, arrays.q) for name in names], axis=1)
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


def joint_positions(model: pin.Model, name: str, q: FloatArray) -> FloatArray:
    """(T,) positions of a joint in configurations q (T, nq) of Pinocchio's convention [rad, m]."""
    joint = model.joints[model.getJointId(name)]
    if joint.nq == 2:
        return np.arctan2(q[:, joint.idx_q + 1], q[:, joint.idx_q])
    return q[:, joint.idx_q]


def _rotations(quaternions: FloatArray) -> FloatArray:
    """(T, 3, 3) of quaternions (T, 4), x y z w."""
    return np.array([pin.Quaternion(row).matrix() for row in quaternions])
