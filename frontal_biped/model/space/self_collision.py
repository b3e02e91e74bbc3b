"""Does a free robot run into itself? Distances between its links, by the convex hulls of their shapes.

A hull is never farther from another than the shapes in it: what is told to be apart is apart. The shapes are the URDF's
for collision, or those to be seen where it has no others. The soles, boxes of their true length and width, count as
shapes of the feet; they are all there is where the URDF has no shapes or its meshes are not to be had.
"""

from typing import NamedTuple

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import RobotError
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.urdf.shapes import build_shapes, mesh_vertices

SOLE_THICKNESS = 0.02
"""Of the boxes upwards from the soles [m]."""


class Closest(NamedTuple):
    """The two links that are closest.

    Attributes:
        distance: between them [m]; negative: how deep one is in the other.
        links: their names.
    """

    distance: float
    links: tuple[str, str]


class SelfDistances:
    """Distances between links of one robot that could run into each other. Owns work data: not thread-safe.

    Left out are pairs on one joint or on neighbouring ones, and pairs that touch at the posture, by the shapes' design.

    Args:
        free: the robot.

    Attributes:
        shapes: which shapes these are, for the record.
    """

    def __init__(self, free: FreeRobot) -> None:
        self._free, self._data = free, free.model.createData()
        self._geometry, self.shapes = _convex_shapes(free)
        _add_soles(free, self._geometry)
        self._add_pairs()
        self._work = self._geometry.createData()
        self._boxes = pin.BroadPhaseManager_DynamicAABBTreeCollisionManager(free.model, self._geometry, self._work)
        names = [shape.name for shape in self._geometry.geometryObjects]
        self._links = [(_link(names[pair.first]), _link(names[pair.second])) for pair in self._geometry.collisionPairs]
        legs = [{1 + 1 + joint for joint in free.leg(side)} for side in Stance]
        self._between_legs = np.array([self._joins(pair, *legs) for pair in self._geometry.collisionPairs], dtype=bool)

    def _add_pairs(self) -> None:
        model, geometry = self._free.model, self._geometry
        shapes = list(enumerate(geometry.geometryObjects))
        for i, first in shapes:
            for j, second in shapes[i + 1 :]:
                a, b = first.parentJoint, second.parentJoint
                if a != b and model.parents[a] != b and model.parents[b] != a:
                    geometry.addCollisionPair(pin.CollisionPair(i, j))
        work = geometry.createData()
        pin.computeDistances(model, self._data, geometry, work, self._free.posture)
        touching = [
            pin.CollisionPair(pair.first, pair.second)
            for pair, result in zip(geometry.collisionPairs, work.distanceResults, strict=True)
            if result.min_distance <= 0.0
        ]
        for pair in touching:
            geometry.removeCollisionPair(pair)

    def _joins(self, pair: pin.CollisionPair, left: set[int], right: set[int]) -> bool:
        a, b = (self._geometry.geometryObjects[index].parentJoint for index in (pair.first, pair.second))
        return (a in left and b in right) or (a in right and b in left)

    def touching(self, q: FloatArray) -> tuple[tuple[str, str], ...]:
        """Pairs of links that touch at a configuration (nq,)."""
        model, geometry = self._free.model, self._geometry
        pin.updateGeometryPlacements(model, self._data, geometry, self._work, q)
        self._boxes.update(False)
        if not pin.computeCollisions(self._boxes, True):  # hardly ever; a look at every pair takes fifty times as long
            return ()
        pin.computeCollisions(geometry, self._work, False)
        found = {
            links
            for links, result in zip(self._links, self._work.collisionResults, strict=True)
            if result.isCollision()
        }
        return tuple(sorted(found))

    def between_legs(self, q: FloatArray) -> Closest:
        """The closest links of the left and the right leg at a configuration (nq,)."""
        model, geometry = self._free.model, self._geometry
        pin.updateGeometryPlacements(model, self._data, geometry, self._work, q)
        closest = Closest(float("inf"), ("", ""))
        for index in np.flatnonzero(self._between_legs).tolist():
            distance = pin.computeDistance(geometry, self._work, index).min_distance
            if distance < closest.distance:
                closest = Closest(float(distance), self._links[index])
        return closest


def _convex_shapes(free: FreeRobot) -> tuple[pin.GeometryModel, str]:
    """Convex hulls of the links, and what they are of."""
    description = free.robot.description
    why = "the URDF has no shapes"
    for kind, source in ((pin.GeometryType.COLLISION, "collision"), (pin.GeometryType.VISUAL, "visual")):
        try:
            geometry = build_shapes(free.model, description.urdf, free.robot.urdf_text, kind)
        except RobotError as error:
            why = str(error)
            continue
        if geometry.ngeoms:
            for shape in geometry.geometryObjects:
                if hasattr(shape.geometry, "vertices"):
                    shape.geometry = _hull(mesh_vertices(shape))
            return geometry, f"{source} shapes and soles"
    return pin.GeometryModel(), f"soles only: {why}"


def _hull(vertices: FloatArray) -> object:
    points = pin.coal.StdVec_Vec3s()
    for vertex in vertices:
        points.append(vertex)
    return pin.coal.ConvexBase.convexHull(points, True, "Qt")


def _add_soles(free: FreeRobot, geometry: pin.GeometryModel) -> None:
    for side, sole in zip(Stance, free.soles, strict=True):
        middle = 0.5 * (sole.corners.min(axis=0) + sole.corners.max(axis=0))
        middle[2] = 0.5 * SOLE_THICKNESS
        frame = free.model.frames[free.sole_frame(side)]
        box = pin.coal.Box(sole.length, sole.width, SOLE_THICKNESS)
        placement = frame.placement * pin.SE3(np.eye(3), middle)
        geometry.addGeometryObject(pin.GeometryObject(f"{side.value}_sole_0", frame.parentJoint, placement, box))


def _link(shape: str) -> str:
    """Pinocchio numbers the shapes of a link."""
    return shape.rpartition("_")[0]
