"""The robot's own meshes, light enough for a page: few triangles, no textures."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pinocchio as pin
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from frontal_biped.arrays import FloatArray
from frontal_biped.model.urdf.shapes import IntArray, mesh_triangles, mesh_vertices

MOST_TRIANGLES = 40_000
"""Of a whole robot; with their normals about 2 MB of page."""

CELLS_ACROSS = 12
"""At least, of the longest side of each mesh: fingers stay fingers."""

TORN = 0.5
"""A mesh that has lost more than this share of its area (thin strokes have closed) is made light anew, less so."""

FINER = (0.1, 0.2, 0.5)
"""Shares of the cell that are tried for it, as the triangles that are left allow."""

DEBRIS = 2e-3
"""Parts with less than this share of a mesh's area (screws, engraved letters) are lone triangles once it is light."""

CREASE = np.radians(35.0)
"""Edges sharper than this stay edges; smoother ones are shaded round."""

PLAIN = (0.78, 0.80, 0.83, 1.0)
"""Colour of a mesh whose URDF gives none."""


def light_meshes(shapes: pin.GeometryModel) -> Iterator[tuple[pin.GeometryObject, FloatArray, IntArray]]:
    """Meshes of a robot, their vertices (n, 3) merged within cells until all triangles (k, 3) are few.

    What that leaves of small parts, a triangle here and a shard there, is left out; meshes that were light stay whole.
    """
    meshes = [shape for shape in shapes.geometryObjects if is_mesh(shape)]
    read = [(mesh_vertices(shape), mesh_triangles(shape)) for shape in meshes]
    cell = welded = 1e-4  # [m], a tenth of a millimetre welds what belongs together
    light = [merge_vertices(*mesh, cell) for mesh in read]
    whole, areas = light, [_area(*mesh) for mesh in light]
    largest = [np.ptp(vertices, axis=0).max(initial=0.0) / CELLS_ACROSS for vertices, _ in light]
    while sum(len(faces) for _, faces in light) > MOST_TRIANGLES and cell < max(largest):
        cell *= 1.25
        light = [merge_vertices(*mesh, min(cell, limit)) for mesh, limit in zip(light, largest, strict=True)]
    if cell > welded:
        light = [without_debris(*mesh) for mesh in light]
        spare = MOST_TRIANGLES - sum(len(faces) for _, faces in light)
        for i, area in enumerate(areas):
            if _area(*light[i]) < TORN * area:
                cells = (share * min(cell, largest[i]) for share in FINER)
                finer = (without_debris(*merge_vertices(*whole[i], size)) for size in cells)
                used = len(light[i][1])
                light[i] = next((mesh for mesh in finer if len(mesh[1]) - used <= spare), light[i])
                spare -= len(light[i][1]) - used
    for shape, (vertices, faces) in zip(meshes, light, strict=True):
        yield shape, vertices, faces


def is_mesh(shape: pin.GeometryObject) -> bool:
    """Is a shape a mesh, and not a primitive?"""
    return hasattr(shape.geometry, "tri_indices")


def merge_vertices(vertices: FloatArray, faces: IntArray, cell: float) -> tuple[FloatArray, IntArray]:
    """Replace all vertices in one cell by their mean, and drop triangles that vanish or repeat.

    Args:
        vertices: (n, 3) [m].
        faces: (k, 3) indices of vertices.
        cell: edge of the cubic cells [m].

    Returns:
        The fewer vertices and triangles.
    """
    if not len(faces):
        return np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64)
    _, cell_of, count = np.unique(
        _one_number(np.round(vertices / cell).astype(np.int64)), return_inverse=True, return_counts=True
    )
    mean = np.stack([np.bincount(cell_of, weights=vertices[:, i]) for i in range(3)], axis=1) / count[:, None]
    merged = cell_of[faces]
    a, b, c = merged.T
    merged = merged[(a != b) & (b != c) & (c != a)]
    # the same triangle twice, whichever vertex comes first
    _, first = np.unique(_one_number(np.sort(merged, axis=1)), return_index=True)
    merged = merged[np.sort(first)]
    used, renumbered = np.unique(merged, return_inverse=True)
    return mean[used], renumbered.reshape(-1, 3).astype(np.int64)


def _area(vertices: FloatArray, faces: IntArray) -> float:
    """Of all triangles together [m^2]."""
    return float(_areas(vertices, faces).sum())


def _areas(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """(k,) of each triangle [m^2]."""
    corners = vertices[faces]
    normals: FloatArray = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return 0.5 * np.linalg.norm(normals, axis=1)


def without_debris(vertices: FloatArray, faces: IntArray, share: float = DEBRIS) -> tuple[FloatArray, IntArray]:
    """A mesh without its small parts: those whose triangles hang together, and nothing else, and have little area.

    Args:
        vertices: (n, 3) [m].
        faces: (k, 3) indices of vertices.
        share: of the whole area, below which a part is left out. The largest part stays in any case.

    Returns:
        The vertices that are left and their triangles.
    """
    if not len(faces):
        return vertices, faces
    count = len(vertices)
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]]])
    graph = coo_array((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape=(count, count))
    _, part_of_vertex = connected_components(graph, directed=False)
    part = part_of_vertex[faces[:, 0]]
    size = np.bincount(part, weights=_areas(vertices, faces))
    large = size >= min(share * size.sum(), size.max())
    used, renumbered = np.unique(faces[large[part]], return_inverse=True)
    return vertices[used], renumbered.reshape(-1, 3).astype(np.int64)


def _one_number(rows: IntArray) -> IntArray:
    """(n,) numbers that are equal where rows (n, 3) are."""
    low = rows.min(axis=0, initial=0)
    size = rows.max(axis=0, initial=0) - low + 1
    shifted = rows - low
    return (shifted[:, 0] * size[1] + shifted[:, 1]) * size[2] + shifted[:, 2]


def split_creases(vertices: FloatArray, faces: IntArray) -> tuple[FloatArray, FloatArray, IntArray]:
    """Vertices, their normals and triangles, a vertex doubled where its triangles meet in an edge.

    Args:
        vertices: (n, 3) [m].
        faces: (k, 3).

    Returns:
        (m, 3) vertices, (m, 3) unit normals and (k, 3) triangles.
    """
    corners = vertices[faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(normal, axis=1)
    unit = normal / np.maximum(area, 1e-300)[:, None]
    order = np.argsort(faces.ravel(), kind="stable")
    owner = order // 3  # triangle of each corner, corners sorted by vertex
    starts = np.searchsorted(faces.ravel()[order], np.arange(len(vertices) + 1))
    new_vertices: list[FloatArray] = []
    new_normals: list[FloatArray] = []
    new_faces = np.zeros(faces.size, dtype=np.int64)
    limit = np.cos(CREASE)
    for vertex in range(len(vertices)):
        around = slice(starts[vertex], starts[vertex + 1])
        triangles, places = owner[around], order[around]
        left = np.ones(len(triangles), dtype=bool)
        while left.any():
            seed = int(np.argmax(np.where(left, area[triangles], -1.0)))
            group = left & (unit[triangles] @ unit[triangles[seed]] > limit)
            group[seed] = True
            mean = normal[triangles[group]].sum(axis=0)
            new_faces[places[group]] = len(new_vertices)
            new_vertices.append(vertices[vertex])
            new_normals.append(mean / max(float(np.linalg.norm(mean)), 1e-300))
            left &= ~group
    return np.array(new_vertices), np.array(new_normals), new_faces.reshape(-1, 3)


def draw_mesh(
    node: Any,
    shape: pin.GeometryObject,
    vertices: FloatArray,
    faces: IntArray,
    colour: tuple[float, float, float, float] | None = None,
) -> None:
    """Put a mesh into a MeshCat node, in the given colour or the URDF's."""
    import meshcat.geometry as mg

    class ShadedMesh(mg.TriangularMeshGeometry):  # type: ignore[misc]
        """Triangles with normals; without them MeshCat draws every facet."""

        def lower(self, object_data: Any) -> Any:
            lowered = super().lower(object_data)
            lowered["data"]["attributes"]["normal"] = mg.pack_numpy_array(normals.astype(np.float32).T)
            return lowered

    points, normals, triangles = split_creases(vertices, faces)
    red, green, blue, opacity = colour or _colour(shape)
    material = mg.MeshPhongMaterial(
        color=(round(255 * red) << 16) + (round(255 * green) << 8) + round(255 * blue),
        opacity=opacity,
        shininess=20,
    )
    node.set_object(ShadedMesh(points, triangles), material)
    node.set_transform(np.asarray(shape.placement.homogeneous, dtype=float))


def _colour(shape: pin.GeometryObject) -> tuple[float, float, float, float]:
    red, green, blue, opacity = (float(np.clip(part, 0.0, 1.0)) for part in shape.meshColor)
    painted = shape.overrideMaterial and max(red, green, blue) > 0.0  # black all over is what exporters write for none
    return (red, green, blue, opacity) if painted else PLAIN
