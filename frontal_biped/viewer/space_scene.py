"""The scene of a walk in space: ground as long as the way, the robot, wrenches, centre of mass, footsteps, foothold."""

from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.model.robot import FootSole
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.urdf.shapes import IntArray
from frontal_biped.simulation.space.asked_path import asked_corners
from frontal_biped.simulation.space.run import SpatialRun
from frontal_biped.simulation.space.soles import Footstep, footprint, footsteps
from frontal_biped.simulation.world import FEET
from frontal_biped.viewer.markers import COLOURS, COM, CONTACT, draw_com, draw_contact, overlay
from frontal_biped.viewer.placements import at
from frontal_biped.viewer.scene import ABOVE, FIRST, FLOOR, GLOW, GROUND, LINE, ROBOT, draw_room, highest_body
from frontal_biped.viewer.space_robot import draw_free_robot
from frontal_biped.viewer.tracks import start_clock

FOOTSTEPS, FOOTHOLD, PUSH = "footsteps", "foothold", "push"
"""Nodes of a run: where the feet stood, where the next one is wanted, pushes."""

ROOM = 6.0
"""Ground beyond the way, on every side [m]."""

PITCH, METRE = 0.5, 1.0
"""Lines on the ground: all, and the wider ones [m]."""

TRIANGLES = 10
"""Of one footstep: two inside, eight along its edge."""

PATH_WIDTH = 0.02
"""Of the line of a path [m]."""

PUSH_LENGTH = 0.35
"""Length of a push's arrow, over the robot's height."""


def draw_space_scene(visualizer: Any, robot: FreeRobot, run: SpatialRun, pushes: int = 0) -> None:
    """Put ground, robot and markers into an empty scene, and start its clock.

    Args:
        visualizer: a ``meshcat.Visualizer``.
        robot: the robot.
        run: its walk, see `drawable_part`.
        pushes: how many arrows are needed.
    """
    draw_room(visualizer)
    _draw_ground(visualizer[GROUND], run)
    place = visualizer[FIRST]
    draw_free_robot(place[ROBOT], robot)
    size = marker_size(robot)
    for foot in FEET:
        draw_contact(place[CONTACT][foot.value], "cop", size)
        _draw_moment(place[CONTACT][foot.value]["moment"], size)
    draw_com(place[COM], size)
    _draw_shadow(place[COM]["plumb"]["below"], size)
    _draw_footsteps(place[FOOTSTEPS], robot, footsteps(run))
    _draw_path(place[FOOTSTEPS]["path"], asked_corners(run))
    for foot, sole in zip(FEET, robot.soles, strict=True):
        _draw_foothold(place[FOOTHOLD][foot.value], sole)
    for k in range(pushes):
        _draw_push(place[PUSH][str(k)], robot)
    start_clock(visualizer, float(run.t[-1] - run.t[0]))


def marker_size(robot: FreeRobot) -> float:
    """Height of the root link at the posture, about that of the hips [m]."""
    return float(robot.posture[2])


def space_camera(robot: FreeRobot) -> dict[str, Any]:
    """Where the camera stands at first, and what it looks at: from ahead on the robot's left, a bit raised [m]."""
    model, data = robot.model, robot.model.createData()
    top = highest_body(model, data, robot.posture)
    # of a robot whose highest body begins at the hips, as in the plane, twice their height
    hips = float(data.oMi[model.getJointId(robot.robot.description.joints["left_hip"])].translation[2])
    half = max(hips, 0.5 * ABOVE * top)
    azimuth, away = np.radians(42.0), 3.95 * half
    return {
        "position": [away * np.cos(azimuth), away * np.sin(azimuth), 1.8 * half],
        "target": [0.0, 0.0, 0.95 * half],
        "half_width": 1.1 * half,
    }


# ---------------------------------------------------------------------- drawing
def _draw_ground(node: Any, run: SpatialRun) -> None:
    import meshcat.geometry as mg

    low = np.floor(run.com[:, :2].min(axis=0) - ROOM)
    high = np.ceil(run.com[:, :2].max(axis=0) + ROOM)
    slab, beyond = 0.02, 4.0 * ROOM
    x, y = 0.5 * (low + high)
    across, along = high - low + 2.0 * beyond
    node["slab"].set_object(mg.Box([across, along, slab]), mg.MeshLambertMaterial(color=FLOOR, emissive=GLOW))
    node["slab"].set_transform(at(x, y, -0.5 * slab))
    strips = []
    for axis in (0, 1):
        for place in np.arange(low[axis], high[axis] + 0.5 * PITCH, PITCH):
            half = 0.004 if place % METRE == 0.0 else 0.0015
            corner = {axis: (place - half, place + half), 1 - axis: (low[1 - axis], high[1 - axis])}
            strips.append([[corner[0][i], corner[1][j]] for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))])
    # a hair above the slab lest they flicker
    vertices, faces = quadrilaterals(np.array(strips), 1e-3)
    node["grid"].set_object(mg.TriangularMeshGeometry(vertices, faces), mg.MeshBasicMaterial(color=LINE))


def quadrilaterals(corners: FloatArray, z: float) -> tuple[FloatArray, IntArray]:
    """Flat faces on the ground.

    Args:
        corners: (n, 4, 2) of each, going round [m].
        z: their height [m].

    Returns:
        (4 n, 3) vertices and (2 n, 3) triangles, two for each in turn.
    """
    flat = corners.reshape(-1, 2)
    vertices = np.column_stack([flat, np.full(len(flat), z)])
    first = 4 * np.arange(len(corners))[:, None]
    return vertices, (first + np.array([0, 1, 2, 0, 2, 3])).reshape(-1, 3)


class _Footprints(NamedTuple):
    """Rectangles and their edges, `TRIANGLES` for each footstep."""

    inside: FloatArray
    edge: FloatArray


def _footprints(robot: FreeRobot, steps: list[Footstep], width: float) -> _Footprints:
    inside, edge = [], []
    for step in steps:
        sole = robot.soles.left if step.side is Stance.LEFT else robot.soles.right
        outer = footprint(sole, step.x, step.y, step.yaw)
        middle = outer.mean(axis=0)
        reach = np.linalg.norm(outer - middle, axis=1, keepdims=True)
        inner = outer + (middle - outer) * np.minimum(1.0, 1.4 * width / reach)
        inside.append(inner)
        edge += [[outer[i], outer[j], inner[j], inner[i]] for i, j in ((0, 1), (1, 2), (2, 3), (3, 0))]
    return _Footprints(np.array(inside).reshape(-1, 4, 2), np.array(edge).reshape(-1, 4, 2))


def _draw_footsteps(node: Any, robot: FreeRobot, steps: list[Footstep]) -> None:
    """One mesh for the soles and one for their edges of either foot; the page shows as many as have landed."""
    import meshcat.geometry as mg

    for foot in FEET:
        own = [step for step in steps if step.side is foot]
        if not own:
            continue
        prints = _footprints(robot, own, 0.012 * marker_size(robot))
        colour = COLOURS[foot.value]
        for name, corners, z, opacity in (("inside", prints.inside, 2e-3, 0.3), ("edge", prints.edge, 2.5e-3, 0.9)):
            vertices, faces = quadrilaterals(corners, z)
            material = mg.MeshBasicMaterial(color=colour, opacity=opacity, transparent=True)
            node[foot.value][name].set_object(mg.TriangularMeshGeometry(vertices, faces), material)


def _draw_path(node: Any, corners: FloatArray) -> None:
    """The way that was asked for, as a line on the ground with a square at each corner."""
    import meshcat.geometry as mg

    if not len(corners):
        return
    strips = []
    for a, b in pairwise(corners):
        along = (b - a) / np.linalg.norm(b - a)
        aside = 0.5 * PATH_WIDTH * np.array([-along[1], along[0]])
        strips.append([a + aside, a - aside, b - aside, b + aside])
    half = PATH_WIDTH * np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
    vertices, faces = quadrilaterals(np.array([*strips, *(corner + half for corner in corners)]), 1.5e-3)
    material = mg.MeshBasicMaterial(color=COLOURS["trace"], opacity=0.7, transparent=True)
    node.set_object(mg.TriangularMeshGeometry(vertices, faces), material)


def _draw_foothold(node: Any, sole: FootSole) -> None:
    """The outline of a sole about the origin of its frame, dashed along its sides."""
    import meshcat.geometry as mg

    corners = footprint(sole, 0.0, 0.0, 0.0)
    width, dashes = 0.06 * sole.width, []
    for i, j in ((0, 1), (1, 2), (2, 3), (3, 0)):
        side = corners[j] - corners[i]
        along = side / np.linalg.norm(side)
        inwards = width * np.array([-along[1], along[0]])
        if np.dot(corners.mean(axis=0) - corners[i], inwards) < 0.0:
            inwards = -inwards
        count = 2 * int(np.ceil(np.linalg.norm(side) / (0.3 * sole.width))) + 1
        for k in range(0, count, 2):
            a, b = corners[i] + side * k / count, corners[i] + side * (k + 1) / count
            dashes.append([a, b, b + inwards, a + inwards])
    vertices, faces = quadrilaterals(np.array(dashes), 3.5e-3)
    node["outline"].set_object(mg.TriangularMeshGeometry(vertices, faces), mg.MeshBasicMaterial(color=COLOURS["fri"]))


def _draw_shadow(node: Any, size: float) -> None:
    """The centre of mass seen from above: a disc with a rim, at the lower end of the plumb line of length one."""
    import meshcat.geometry as mg

    turned = np.eye(4)
    turned[:3, :3] = [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]
    turned[2, 3] = -1.0
    for name, radius in (("rim", 0.042), ("disc", 0.033)):
        node[name].set_object(mg.Cylinder(2e-3, radius * size), overlay("rim" if name == "rim" else "com"))
        node[name].set_transform(turned)


def _draw_moment(node: Any, size: float) -> None:
    """An arc about the vertical with a head, turning to the left; the page sizes it, and mirrors it for the right."""
    import meshcat.geometry as mg

    turn = np.linspace(0.0, np.radians(250.0), 26)
    radius, half = 0.12 * size, 0.012 * size
    ring = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    inner, outer = (radius - half) * ring, (radius + half) * ring
    band = np.stack([inner[:-1], outer[:-1], outer[1:], inner[1:]], axis=1)
    ahead = np.array([-ring[-1, 1], ring[-1, 0]])
    tip = radius * ring[-1] + 5.0 * half * ahead
    base = radius * ring[-1]
    head = [base - 2.6 * half * ring[-1], base + 2.6 * half * ring[-1], tip, tip]
    vertices, faces = quadrilaterals(np.concatenate([band, [head]]), 0.004)
    node["arc"].set_object(mg.TriangularMeshGeometry(vertices, faces), overlay("moment"))


def _draw_push(node: Any, robot: FreeRobot) -> None:
    """An arrow along y that ends at the origin: its tip is where the push acts."""
    import meshcat.geometry as mg

    length = PUSH_LENGTH * ABOVE * highest_body(robot.model, robot.model.createData(), robot.posture)
    material = overlay("push", opacity=0.85)
    node["shaft"].set_object(mg.Cylinder(0.7 * length, 0.028 * length), material)
    node["shaft"].set_transform(at(0.0, -0.65 * length, 0.0))
    head = mg.Cylinder(0.3 * length, radiusTop=0.0, radiusBottom=0.075 * length)
    node["head"].set_object(head, material)
    node["head"].set_transform(at(0.0, -0.15 * length, 0.0))
