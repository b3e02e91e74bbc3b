"""The whole robot as a tree of MeshCat nodes, one inside the other as its links are, that turn about their joints.

A page of a long walk stays small: of each joint it keeps one number a frame, of the root seven, and the browser's
scene does the forward kinematics. Every joint has two nodes: one that is placed in its parent, and ``TURNED`` in it,
which the page turns or shifts.
"""

from typing import Any

import numpy as np
import pinocchio as pin

from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.viewer.channels import ROOT_POSE
from frontal_biped.viewer.markers import COLOURS
from frontal_biped.viewer.placements import at
from frontal_biped.viewer.robot_shapes import Colour, draw_shapes

TURNED = "turned"


def node_paths(model: pin.Model) -> list[str]:
    """Of each joint of a model the node whose children move with it; the universe is the robot's own node."""
    paths = [""]
    for joint in range(1, model.njoints):
        paths.append(f"{paths[model.parents[joint]]}/{model.names[joint]}/{TURNED}".lstrip("/"))
    return paths


def channel(joint: int) -> str:
    """Name of the channel that tells a joint's position, by its place among `FreeRobot.joint_names`."""
    return f"joint{joint}"


def body_drivers(robot: FreeRobot) -> list[dict[str, Any]]:
    """What moves the nodes: the root by its pose, each joint by its position along or about its axis."""
    model = robot.model
    paths = node_paths(model)
    drivers: list[dict[str, Any]] = [{"node": paths[1].split("/"), "how": "pose", "from": list(ROOT_POSE)}]
    for joint in range(2, model.njoints):
        axis = np.asarray(model.joints[joint].createData().S, dtype=float).ravel()
        how, own = ("turn", axis[3:]) if np.any(axis[3:]) else ("slide", axis[:3])
        value = channel(model.joints[joint].idx_q - 7)
        drivers.append({"node": paths[joint].split("/"), "how": how, "axis": own.tolist(), "from": [value]})
    return drivers


def draw_free_robot(node: Any, robot: FreeRobot, colour: Colour | None = None) -> None:
    """Put the robot into a node, at its posture.

    Args:
        node: of a MeshCat visualizer.
        robot: the robot.
        colour: of all its shapes; None: the URDF's.
    """
    model = robot.model
    paths = node_paths(model)
    for joint in range(2, model.njoints):
        place = paths[joint].removesuffix(f"/{TURNED}")
        node[place].set_transform(np.asarray(model.jointPlacements[joint].homogeneous, dtype=float))
    if not draw_shapes(node, robot.robot, model, paths, colour):
        _draw_bars(node, robot, paths)


def _draw_bars(node: Any, robot: FreeRobot, paths: list[str]) -> None:
    """Bars from joint to joint, and the soles, for a URDF without shapes."""
    import meshcat.geometry as mg

    model, size = robot.model, float(robot.posture[2])
    material = mg.MeshPhongMaterial(color=0x9EABBD)
    for joint in range(2, model.njoints):
        way = model.jointPlacements[joint].translation
        length = float(np.linalg.norm(way))
        if length < 1e-3 * size:
            continue
        along = pin.SE3(pin.Quaternion.FromTwoVectors(pin.YAxis, way).matrix(), 0.5 * way)
        bar = node[paths[model.parents[joint]]][f"to_{model.names[joint]}"]
        bar.set_object(mg.Cylinder(length, 0.03 * size), material)
        bar.set_transform(np.asarray(along.homogeneous, dtype=float))
    for sole in robot.soles:
        thick = 0.25 * sole.ankle_height
        middle = sole.corners.mean(axis=0)
        foot = node[paths[model.getJointId(sole.joint)]]["sole"]
        foot.set_object(mg.Box([sole.length, sole.width, thick]), mg.MeshPhongMaterial(color=COLOURS["rim"]))
        placement = np.asarray(sole.placement.homogeneous, dtype=float)
        foot.set_transform(placement @ at(middle[0], middle[1], 0.5 * thick))
