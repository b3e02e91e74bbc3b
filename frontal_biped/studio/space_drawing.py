"""The whole robot as triangles and turning joints, taken from the page's MeshCat scene."""

from typing import Any, NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.simulation.space.soles import footprint
from frontal_biped.studio.drawing import Shape, shapes_of
from frontal_biped.viewer.page import recording
from frontal_biped.viewer.space_robot import draw_free_robot, node_paths
from frontal_biped.viewer.space_scene import space_camera

ROBOT = "walker"
"""Node of the robot."""


class Turn(NamedTuple):
    """A node that turns or slides with a joint.

    Attributes:
        node: its name.
        place: of the joint's position in q.
        axis: (3,) unit vector.
        slides: along it, in place of turning about it.
    """

    node: str
    place: int
    axis: FloatArray
    slides: bool


class SpaceDrawing(NamedTuple):
    """A robot in space.

    Attributes:
        name: of the robot.
        shapes: all of them.
        placements: (4, 4) of nodes in their parents that do not move.
        root: node that is placed by the pose of the root link.
        turns: nodes that move with joints.
        posture: (nq,) of a `FreeRobot`.
        soles: (4, 2) corners of the left and the right one, about the origin of its frame [m].
        camera: position and target before a robot at the origin that looks along x [m].
    """

    name: str
    shapes: tuple[Shape, ...]
    placements: dict[str, FloatArray]
    root: str
    turns: tuple[Turn, ...]
    posture: FloatArray
    soles: tuple[FloatArray, FloatArray]
    camera: dict[str, Any]


def space_drawing_of(biped: FrontalBiped) -> SpaceDrawing:
    """Shapes and joints of a robot in space."""
    free = FreeRobot(biped.robot)
    recorder, visualizer = recording()
    draw_free_robot(visualizer[ROBOT], free)
    shapes, placements = shapes_of(recorder)
    model, paths = free.model, [f"{ROBOT}/{path}" for path in node_paths(free.model)]
    turns = []
    for joint in range(2, model.njoints):
        axis = np.asarray(model.joints[joint].createData().S, dtype=float).ravel()
        slides = not np.any(axis[3:])
        turns.append(Turn(paths[joint], model.joints[joint].idx_q, axis[:3] if slides else axis[3:], slides))
    left, right = (footprint(sole, 0.0, 0.0, 0.0) for sole in free.soles)
    camera = space_camera(free)
    return SpaceDrawing(biped.name, shapes, placements, paths[1], tuple(turns), free.posture, (left, right), camera)
