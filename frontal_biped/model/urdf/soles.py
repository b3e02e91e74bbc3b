"""Measure the soles of a robot on its shapes: collision shapes first, visual ones where there are none."""

import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.model.urdf.quiet import kept_from_terminal
from frontal_biped.model.urdf.shapes import build_shapes, shape_points

SOLE_THICKNESS = 0.003
"""Points at most this far above the lowest one belong to the sole [m]."""


class MeasuredSole(NamedTuple):
    """The sole of one foot, below its ankle roll joint, robot upright with X forward.

    Attributes:
        right: extent to the robot's right of the ankle [m].
        left: extent to its left [m].
        heel: x of its hindmost point, from the ankle [m].
        toe: x of its foremost point, from the ankle [m].
        ankle_height: of the ankle above it [m].
        source: "collision" or "visual" shapes.
    """

    right: float
    left: float
    heel: float
    toe: float
    ankle_height: float
    source: str

    @property
    def spans_ankle(self) -> bool:
        """Does it reach forwards and backwards of the ankle, as a sole a robot can stand on does?"""
        return self.heel < 0.0 < self.toe


def measure_sole(
    full: pin.Model, q: FloatArray, ankle: str, urdf: Path, urdf_text: str, x: float | None = None
) -> MeasuredSole | None:
    """Measure one foot.

    The width is that of the convex sole at one x, under the centre of mass: there the ground reaction acts, and a
    sole that tapers is no wider than it is there.

    Args:
        full: 3D model with all joints.
        q: (nq,) posture with flat feet, root turned upright.
        ankle: name of the ankle roll joint.
        urdf: the robot's URDF file; meshes are looked up around it.
        urdf_text: its text.
        x: where the width is measured, from the ankle [m]; None, or beyond the sole: in its middle.

    Returns:
        The sole, or None if the foot has no shapes.

    Raises:
        RobotError: a mesh is not found, or cannot be read.
    """
    data = full.createData()
    pin.forwardKinematics(full, data, q)
    pin.updateFramePlacements(full, data)
    joint = full.getJointId(ankle)
    foot_joints = set(full.subtrees[joint])
    links = {
        frame.name for frame in full.frames if frame.type == pin.FrameType.BODY and frame.parentJoint in foot_joints
    }
    for kind, source in ((pin.GeometryType.COLLISION, "collision"), (pin.GeometryType.VISUAL, "visual")):
        with kept_from_terminal():
            shapes = build_shapes(full, urdf, _shapes_of_links_only(urdf_text, links), kind)
        points = [
            (data.oMi[shape.parentJoint] * shape.placement).act(point) - data.oMi[joint].translation
            for shape in shapes.geometryObjects
            for point in shape_points(shape)
        ]
        if points:
            return _sole(np.array(points), x, source)
    return None


def _sole(points: FloatArray, x: float | None, source: str) -> MeasuredSole:
    bottom = float(points[:, 2].min())
    sole = points[points[:, 2] <= bottom + SOLE_THICKNESS][:, :2]
    heel, toe = float(sole[:, 0].min()), float(sole[:, 0].max())
    at = 0.5 * (heel + toe) if x is None or not heel < x < toe else x
    across = list(_crossings(sole, at))
    return MeasuredSole(-min(across), max(across), heel, toe, -bottom, source)


def _crossings(points: FloatArray, x: float) -> Iterator[float]:
    """Y where lines between points, among them the edges of the convex hull, cross a line of constant x."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        corners = points[ConvexHull(points).vertices]
    except QhullError:  # fewer than three points, or all on one line
        corners = points
    for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        if a[0] == b[0]:
            if a[0] == x:
                yield from (float(a[1]), float(b[1]))
        elif min(a[0], b[0]) <= x <= max(a[0], b[0]):
            yield float(a[1] + (b[1] - a[1]) * (x - a[0]) / (b[0] - a[0]))


def _shapes_of_links_only(urdf_text: str, links: set[str]) -> str:
    """The URDF without the shapes of other links: their meshes need not be read."""
    root = ElementTree.fromstring(urdf_text)
    for link in root.findall("link"):
        if link.get("name") not in links:
            for shape in (*link.findall("visual"), *link.findall("collision")):
                link.remove(shape)
    return ElementTree.tostring(root, encoding="unicode")
