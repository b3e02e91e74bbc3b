"""Meshes made light: the shape stays, the triangles go, and the page shows the robot's own body."""

import coal
import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st

from frontal_biped.gait.file import load_gait
from frontal_biped.model import load_robot, models_dir
from frontal_biped.model.urdf.shapes import mesh_triangles, mesh_vertices
from frontal_biped.simulation import orbit_trajectory
from frontal_biped.viewer import animation_page
from frontal_biped.viewer.page import SceneRecorder
from frontal_biped.viewer.robot_meshes import (
    MOST_TRIANGLES,
    is_mesh,
    light_meshes,
    merge_vertices,
    split_creases,
    without_debris,
)
from frontal_biped.viewer.robot_shapes import visual_model
from frontal_biped.viewer.scene import cast, draw_scene, frontal_camera

MOST_PAGE_BYTES = 4_000_000


def shipped_orbit(robot):
    return orbit_trajectory(robot, load_gait(models_dir() / f"{robot.name}.gait.json"))


def sphere(count):
    """Vertices and triangles of a unit sphere, a grid of count x 2 count facets."""
    theta, phi = np.meshgrid(np.linspace(0.0, np.pi, count + 1), np.linspace(0.0, 2.0 * np.pi, 2 * count + 1))
    points = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)
    rows, columns = theta.shape
    faces = []
    for i in range(rows - 1):
        for j in range(columns - 1):
            a, b = i * columns + j, (i + 1) * columns + j
            faces += [(a, b, b + 1), (a, b + 1, a + 1)]
    return points.reshape(-1, 3), np.array(faces)


def area(vertices, faces):
    corners = vertices[faces]
    return 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum()


@given(cell=st.floats(1e-4, 0.2))
def test_merged_vertices_stay_within_their_cells(cell):
    """The sphere loses triangles, but no point leaves it by more than the diagonal of a cell."""
    vertices, faces = sphere(24)
    light, triangles = merge_vertices(vertices, faces, cell)
    assert len(triangles) <= len(faces)
    assert np.all(np.abs(np.linalg.norm(light, axis=1) - 1.0) <= np.sqrt(3.0) * cell + 1e-12)
    assert triangles.min() == 0
    assert triangles.max() == len(light) - 1
    assert area(light, triangles) == pytest.approx(4.0 * np.pi, rel=0.02 + 2.0 * cell)


def test_nothing_is_lost_but_doubles():
    vertices, faces = sphere(24)
    light, triangles = merge_vertices(vertices, faces, 1e-6)
    # the seam and the poles are welded, facets at the poles without area vanish
    assert len(light) == 2 * 24 * 23 + 2
    assert len(triangles) == 2 * (2 * 24 * 23)
    assert area(light, triangles) == pytest.approx(area(vertices, faces), rel=1e-12)


def test_a_cube_keeps_its_edges_and_a_sphere_has_none():
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
    points, normals, triangles = split_creases(corners, faces)
    assert len(points) == 24  # three faces meet at each of eight corners
    assert np.sort(np.abs(normals), axis=1) == pytest.approx(np.tile([0.0, 0.0, 1.0], (24, 1)), abs=1e-12)
    assert points[triangles] == pytest.approx(corners[faces])
    vertices, faces = merge_vertices(*sphere(24), 1e-6)
    points, normals, _ = split_creases(vertices, faces)
    assert len(points) == len(vertices)
    assert np.abs(np.einsum("ij,ij->i", points, normals)) == pytest.approx(1.0, abs=0.015)


def test_thin_strokes_of_a_small_mesh_stay():
    """A heavy body beside the bars of a logo, each a thin box: the body is made light, the bars are not closed."""
    bars = [box((0.1, 0.002, 0.001), (0.0, 0.006 * i, 0.0), 20) for i in range(8)]
    counts = np.cumsum([0, *(len(points) for points, _ in bars)])
    logo = (
        np.concatenate([points for points, _ in bars]),
        np.concatenate([faces + first for (_, faces), first in zip(bars, counts, strict=False)]),
    )
    shapes = pin.GeometryModel()
    for name, (points, faces) in {"body": sphere(200), "logo": logo}.items():
        shapes.addGeometryObject(pin.GeometryObject(name, 0, 0, pin.SE3.Identity(), bvh(points, faces)))
    light = {shape.name: mesh for shape, *mesh in light_meshes(shapes)}
    assert sum(len(faces) for _, faces in light.values()) <= MOST_TRIANGLES < 2 * 200 * 400
    assert area(*light["logo"]) > 0.9 * area(*logo)
    assert area(*light["body"]) == pytest.approx(4.0 * np.pi, rel=0.05)


def box(size, centre, along):
    """A closed box, its long sides cut in pieces."""
    x = np.linspace(-0.5, 0.5, along + 1)
    ring = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])
    points = np.array([(here, *corner) for here in x for corner in ring]) * size + centre
    faces = []
    for i in range(along):
        for k in range(4):
            a, b = 4 * i + k, 4 * i + (k + 1) % 4
            faces += [(a, b, b + 4), (a, b + 4, a + 4)]
    last = 4 * along
    faces += [(0, 1, 2), (0, 2, 3), (last, last + 1, last + 2), (last, last + 2, last + 3)]
    return points, np.array(faces)


def bvh(points, faces):
    mesh = coal.BVHModelOBBRSS()
    mesh.beginModel(len(faces), len(points))
    mesh.addVertices(np.asarray(points, dtype=float))
    mesh.addTriangles(np.asarray(faces, dtype=np.uint32))
    mesh.endModel()
    return mesh


@pytest.mark.slow
@pytest.mark.parametrize("name", ["talos_full", "g1"])
def test_the_page_shows_the_robots_own_body(name):
    robot = load_robot(name)
    shapes = visual_model(robot.robot, robot.spatial_model)
    heavy = sum(shape.geometry.num_tris for shape in shapes.geometryObjects if is_mesh(shape))
    light = {shape.name: (vertices, faces) for shape, vertices, faces in light_meshes(shapes)}
    assert sum(len(faces) for _, faces in light.values()) <= MOST_TRIANGLES < heavy
    for shape in shapes.geometryObjects:
        if is_mesh(shape):
            before = mesh_vertices(shape)[np.unique(mesh_triangles(shape))]
            after, _ = light[shape.name]
            assert after.min(axis=0) == pytest.approx(before.min(axis=0), abs=0.015)
            assert after.max(axis=0) == pytest.approx(before.max(axis=0), abs=0.015)
    page = animation_page(robot, shipped_orbit(robot), title=name)
    assert len(page) < MOST_PAGE_BYTES


def test_shapes_are_where_the_urdf_has_them():
    """The lowest point of a foot's mesh, through the scene's transforms, is on the ground at the reference posture."""
    meshcat = pytest.importorskip("meshcat")
    robot = load_robot("alexander")
    recorder = SceneRecorder()
    draw_scene(meshcat.Visualizer(window=recorder), cast(robot, shipped_orbit(robot)))
    placed = {
        c["path"]: np.array(c["matrix"]).reshape(4, 4).T for c in recorder.commands if c["type"] == "set_transform"
    }
    model, data = robot.spatial_model, robot.spatial_model.createData()
    pin.forwardKinematics(model, data, robot.spatial_reference)
    ankle = model.getJointId(robot.stance_map.joint_names[0])
    lowest = np.inf
    for shape, vertices, _ in light_meshes(visual_model(robot.robot, robot.spatial_model)):
        if shape.parentJoint == ankle:
            matrix = data.oMi[ankle].homogeneous @ placed[f"/meshcat/first/robot/{model.names[ankle]}/{shape.name}"]
            lowest = min(lowest, float((vertices @ matrix[:3, :3].T + matrix[:3, 3])[:, 2].min()))
    assert data.oMi[ankle].translation[2] - lowest == pytest.approx(robot.ankle_height, abs=2e-3)


@pytest.mark.parametrize("name", ["talos_full", "g1", "icub"])
def test_head_and_feet_are_in_the_picture(name):
    robot = load_robot(name)
    model, data = robot.spatial_model, robot.spatial_model.createData()
    pin.forwardKinematics(model, data, robot.spatial_reference)
    heights = []
    for shape in visual_model(robot.robot, robot.spatial_model).geometryObjects:
        placement = data.oMi[shape.parentJoint] * shape.placement
        if is_mesh(shape):
            heights.append(mesh_vertices(shape) @ placement.rotation[2] + placement.translation[2])
    top = np.concatenate(heights).max() - np.concatenate(heights).min()
    camera = frontal_camera(cast(robot, shipped_orbit(robot)))
    distance, _, height = camera["position"]
    down = np.arctan2(height - camera["target"][2], distance)
    half = np.radians(18.0)  # of a field of view of 36 degrees
    assert height + distance * np.tan(half - down) > top
    assert height - distance * np.tan(half + down) < 0.0


def test_small_parts_of_a_light_mesh_are_left_out_and_large_ones_stay():
    """Of a ball, a smaller ball beside it and a lone triangle, the triangle goes."""
    ball, faces = sphere(16)
    small = 0.2 * ball + [3.0, 0.0, 0.0]  # 4 % of the area
    shard = 0.02 * np.eye(3) + [0.0, 0.0, 1.2]
    vertices, triangles = merge_vertices(
        np.concatenate([ball, small, shard]),
        np.concatenate([faces, faces + len(ball), [np.arange(3) + 2 * len(ball)]]),
        1e-6,
    )
    clean, left = without_debris(vertices, triangles)
    assert len(left) == len(triangles) - 1
    assert area(clean, left) == pytest.approx(1.04 * area(*merge_vertices(ball, faces, 1e-6)), rel=1e-9)
    np.testing.assert_array_equal(np.unique(left), np.arange(len(clean)))
    alone, kept = without_debris(shard, np.arange(3)[None])
    assert len(alone) == 3 and len(kept) == 1
