"""Shapes of the robot as MeshCat nodes: its URDF's own, or bars where it has none."""

import logging
from collections.abc import Sequence
from typing import Any

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import RobotError
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.robot import Robot
from frontal_biped.model.urdf.shapes import build_shapes
from frontal_biped.viewer.placements import Y_TO_Z, at
from frontal_biped.viewer.robot_meshes import draw_mesh, is_mesh, light_meshes

_log = logging.getLogger(__name__)

Colour = tuple[float, float, float, float]
"""Red, green, blue and opacity, 0 to 1."""


def visual_model(robot: Robot, model: pin.Model) -> pin.GeometryModel:
    """Shapes of a robot on a model of it: the URDF's visuals, or its collision shapes where it has none, or nothing.

    Raises:
        RobotError: a mesh is not found.
    """
    urdf, text = robot.description.urdf, robot.urdf_text
    shapes = build_shapes(model, urdf, text, pin.GeometryType.VISUAL)
    if not shapes.ngeoms:
        shapes = build_shapes(model, urdf, text, pin.GeometryType.COLLISION)
    return shapes


def draw_robot(node: Any, biped: FrontalBiped, colour: Colour | None = None) -> None:
    """Put the robot's shapes into a node, one child for each body.

    Args:
        node: of a MeshCat visualizer.
        biped: the robot.
        colour: of all its shapes; None: the URDF's.
    """
    if not draw_shapes(node, biped.robot, biped.spatial_model, list(biped.spatial_model.names), colour):
        _draw_plain_robot(node, biped, colour)


def draw_shapes(node: Any, robot: Robot, model: pin.Model, paths: Sequence[str], colour: Colour | None = None) -> bool:
    """Put the shapes of a robot's URDF below the nodes of its bodies.

    Args:
        node: of a MeshCat visualizer.
        robot: the robot.
        model: of it, perhaps with joints locked.
        paths: below ``node``, where the body of each joint of ``model`` hangs.
        colour: of all its shapes; None: the URDF's.

    Returns:
        False, and nothing is drawn, where the URDF has no shapes or a mesh of it is not found; the latter is logged.
    """
    from pinocchio.visualize import MeshcatVisualizer

    class BodyVisualizer(MeshcatVisualizer):  # type: ignore[misc]
        """Pinocchio's shape loader, filing each shape under the body that carries it."""

        def getViewerNodeName(self, geometry_object: pin.GeometryObject, geometry_type: pin.GeometryType) -> str:
            return f"{paths[geometry_object.parentJoint]}/{geometry_object.name}"

    try:
        shapes = visual_model(robot, model)
    except RobotError as error:
        _log.warning("frontal-biped: warning: %s; %s is drawn with bars instead", error, robot.name)
        return False
    if not shapes.ngeoms:
        return False
    loader = BodyVisualizer(model, None, shapes)
    loader.initViewer(viewer=node)
    for shape in shapes.geometryObjects:
        if is_mesh(shape):
            continue
        loader.loadViewerGeometryObject(shape, pin.GeometryType.VISUAL, None if colour is None else list(colour))
        placement = np.asarray(shape.placement.homogeneous, dtype=float)
        scale = np.diag([*np.asarray(shape.meshScale, dtype=float), 1.0])
        node[loader.getViewerNodeName(shape, pin.GeometryType.VISUAL)].set_transform(placement @ scale)
    for shape, vertices, faces in light_meshes(shapes):
        draw_mesh(node[loader.getViewerNodeName(shape, pin.GeometryType.VISUAL)], shape, vertices, faces, colour)
    return True


def _draw_plain_robot(node: Any, biped: FrontalBiped, override: Colour | None) -> None:
    """Bars for a URDF without shapes."""
    import meshcat.geometry as mg

    model, chart, sole = biped.spatial_model, biped.stance_map, biped.description.sole
    data = model.createData()
    pin.forwardKinematics(model, data, biped.spatial_reference)
    size = biped.leg_length
    joints = [data.oMi[model.getJointId(name)] for name in chart.joint_names]

    def bar(joint: str, part: str, world: FloatArray, shape: Any, colour: int) -> None:
        """Hang a shape, placed in the room at the reference posture, on a body."""
        body = data.oMi[model.getJointId(joint)].inverse().homogeneous
        node[joint][part].set_object(shape, _paint(colour, override))
        node[joint][part].set_transform(np.asarray(body @ world, dtype=float))

    for ankle, hip, inwards, colour in ((0, 1, -1.0, 0x2A6CB8), (3, 2, 1.0, 0xDE7329)):
        middle = 0.5 * (joints[ankle].translation + joints[hip].translation)
        upright = np.asarray(pin.SE3(Y_TO_Z, middle).homogeneous, dtype=float)
        bar(chart.joint_names[hip], "leg", upright, mg.Cylinder(size, 0.06 * size), colour)
        thickness = max(sole.ankle_height, 0.04 * size)
        x, y, z = joints[ankle].translation
        offset = 0.5 * inwards * (sole.inner - sole.outer)
        foot = mg.Box([0.28 * size, sole.inner + sole.outer, thickness])
        bar(
            chart.joint_names[ankle],
            "foot",
            at(x, y + offset, z - sole.ankle_height + 0.5 * thickness),
            foot,
            0x384050,
        )
    x, y, z = 0.5 * (joints[1].translation + joints[2].translation)
    root = model.names[1]
    bar(root, "pelvis", at(x, y, z), mg.Box([0.14 * size, biped.hip_width, 0.1 * size]), 0x384050)
    bar(root, "torso", at(x, y, z + 0.3 * size), mg.Box([0.16 * size, 0.35 * size, 0.5 * size]), 0x9EABBD)


def _paint(colour: int, override: Colour | None) -> Any:
    import meshcat.geometry as mg

    if override is None:
        return mg.MeshPhongMaterial(color=colour)
    *rgb, opacity = override
    red, green, blue = (round(255 * part) for part in rgb)
    return mg.MeshPhongMaterial(color=(red << 16) + (green << 8) + blue, opacity=opacity)
