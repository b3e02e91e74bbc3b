"""The shapes of a URDF: meshes and primitives as Pinocchio reads them."""

from pathlib import Path

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import RobotError
from frontal_biped.model.urdf.meshes import with_found_meshes

IntArray = npt.NDArray[np.int64]


def build_shapes(model: pin.Model, urdf: Path, urdf_text: str, kind: pin.GeometryType) -> pin.GeometryModel:
    """Shapes of a URDF on a model.

    Args:
        model: the whole robot, or with joints locked.
        urdf: the file; meshes are looked up in the robot's folders, see `meshes`.
        urdf_text: its text, or a part of it.
        kind: visual or collision shapes.

    Raises:
        RobotError: a mesh is not found, lies outside the robot's folders, or cannot be read.
    """
    found = with_found_meshes(urdf, urdf_text, "visual" if kind == pin.GeometryType.VISUAL else "collision")
    try:
        return pin.buildGeomFromUrdfString(model, found, kind, package_dirs=[])
    except (ValueError, RuntimeError) as error:
        reason = " ".join(str(error).split()).rstrip(".")
        raise RobotError(f"{urdf}: {reason}; export the mesh again, as .stl") from None


def shape_points(shape: pin.GeometryObject) -> FloatArray:
    """(n, 3) points of a shape in its own frame that span its convex hull; round shapes by their lowest rims [m]."""
    geometry = shape.geometry
    kind = type(geometry).__name__
    corners = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)], dtype=float)
    circle = np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False)
    ring = np.stack([np.cos(circle), np.sin(circle), np.zeros_like(circle)], axis=1)
    if hasattr(geometry, "vertices"):
        return mesh_vertices(shape)
    if kind == "Box":
        return corners * np.asarray(geometry.halfSide)
    if kind == "Cylinder":
        rims = [ring * geometry.radius + np.array([0.0, 0.0, z * geometry.halfLength]) for z in (-1, 1)]
        return np.concatenate(rims)
    if kind in ("Sphere", "Capsule"):
        half = geometry.halfLength if kind == "Capsule" else 0.0
        ends = np.concatenate([np.eye(3), -np.eye(3)]) * geometry.radius
        return np.concatenate([ends + np.array([0.0, 0.0, z * half]) for z in (-1, 1)])
    return np.zeros((0, 3))


def mesh_vertices(shape: pin.GeometryObject) -> FloatArray:
    """(n, 3) vertices of a mesh in the shape's frame, scaled [m].

    A COLLADA file says which way is up; the reader ignores it, the robot's other tools do not.
    """
    vertices = np.array(shape.geometry.vertices(), dtype=float)
    path = Path(shape.meshPath)
    if path.suffix.lower() == ".dae" and _up_axis(path) == "Y_UP":
        vertices = np.stack([vertices[:, 0], -vertices[:, 2], vertices[:, 1]], axis=1)
    return vertices


def mesh_triangles(shape: pin.GeometryObject) -> IntArray:
    """(k, 3) indices of the vertices of each triangle of a mesh."""
    geometry = shape.geometry
    found = np.empty((geometry.num_tris, 3), dtype=np.int64)
    for i in range(geometry.num_tris):
        triangle = geometry.tri_indices(i)
        found[i] = triangle[0], triangle[1], triangle[2]
    return found


def _up_axis(path: Path) -> str:
    with path.open("rb") as stream:
        head = stream.read(65536).decode("utf-8", errors="replace")
    _, opening, rest = head.partition("<up_axis>")
    return rest.partition("<")[0].strip() if opening else "Y_UP"  # the format's default
