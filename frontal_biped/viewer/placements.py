"""Placements of MeshCat's shapes, whose cylinders point along y."""

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray

Y_TO_Z = pin.Quaternion.FromTwoVectors(pin.YAxis, pin.ZAxis).matrix()


def at(x: float, y: float, z: float) -> FloatArray:
    """(4, 4) translation [m]."""
    placement = np.eye(4)
    placement[:3, 3] = x, y, z
    return placement


def hanging_cylinder() -> FloatArray:
    """(4, 4) of a cylinder of length one from z = -1 to 0."""
    return np.asarray(pin.SE3(Y_TO_Z, np.array([0.0, 0.0, -0.5])).homogeneous, dtype=float)


def from_y_axis(direction: FloatArray) -> list[float]:
    """Quaternion (x, y, z, w) that turns the y axis into a direction (3,); upwards where that is zero."""
    towards = direction if np.linalg.norm(direction) > 0.0 else pin.ZAxis
    turn: list[float] = pin.Quaternion.FromTwoVectors(pin.YAxis, towards).coeffs().tolist()
    return turn
