"""The scene of the exported page, taken from its MeshCat commands, for a viewer that does not speak MeshCat.

The robot is drawn by `viewer.scene` into a recorder; its commands become triangles, and its animation arrays
over time. So the studio shows what the page shows.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.chain import UPRIGHT
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.urdf.shapes import IntArray
from frontal_biped.simulation.pushes import Push
from frontal_biped.simulation.trajectory import COMPLETED, Trajectory
from frontal_biped.viewer.markers import COM, CONTACT, draw_markers
from frontal_biped.viewer.page import SceneRecorder, recording
from frontal_biped.viewer.scene import FIRST, Actor, animate, draw_scene, frontal_camera
from frontal_biped.virtual_constraints.phase import StepPhase

FPS = 30.0

PUSH = "push"
"""Node of the arrow that stands for a push; its tip is where the push acts."""

PUSH_SHOWN = 0.5  # [s]; the push itself is over too soon to be seen
PUSH_COLOUR = (214, 39, 40)
_AROUND = 24  # corners of a circle


class Shape(NamedTuple):
    """One coloured body in its node.

    Attributes:
        node: its name, joined by "/"; the node's parents may be animated.
        vertices: (n, 3) [m].
        faces: (k, 3).
        pose: (4, 4) in the parent node.
        colour: red, green, blue, 0 to 255.
        opacity: 1 is opaque.
        marker: seen through the robot, as far as the viewer can.
        flat: faces meet in edges.
    """

    node: str
    vertices: FloatArray
    faces: IntArray
    pose: FloatArray
    colour: tuple[int, int, int]
    opacity: float
    marker: bool
    flat: bool


class Track(NamedTuple):
    """How one node moves; what does not change over time is None.

    Attributes:
        position: (K, 3) [m].
        wxyz: (K, 4) unit quaternions, real part first.
        scale: (K, 3).
        visible: (K,).
    """

    position: FloatArray | None = None
    wxyz: FloatArray | None = None
    scale: FloatArray | None = None
    visible: Any = None


@dataclass(frozen=True)
class Clip:
    """An animation at `FPS`.

    Attributes:
        tracks: by node.
        frames: how many there are.
        phase: of each frame, in words.
    """

    tracks: Mapping[str, Track]
    frames: int
    phase: tuple[str, ...]


class Drawing(NamedTuple):
    """A robot and its surroundings.

    Attributes:
        shapes: all of them.
        camera: position and target [m].
        depth: how far the robot reaches towards the camera [m].
        standing: the robot upright, shown until there is a gait.
    """

    shapes: tuple[Shape, ...]
    camera: Mapping[str, Any]
    depth: float
    standing: Clip


def drawing_of(biped: FrontalBiped) -> Drawing:
    """Shapes and camera of a robot."""
    recorder, visualizer = recording()
    upright = _upright(biped)
    actors = [Actor(biped, upright, marked=False)]
    draw_scene(visualizer, actors)
    draw_markers(visualizer[FIRST], biped)
    shapes = [*shapes_of(recorder)[0]]
    shapes += _push_arrow(float(biped.chain.joints[1, 1]))
    moving = clip_of(biped, upright)
    standing = replace(moving, phase=("standing; the gait follows",) * moving.frames)
    return Drawing(tuple(shapes), frontal_camera(actors), _depth(biped, shapes), standing)


def clip_of(biped: FrontalBiped, run: Trajectory, push: Push | None = None) -> Clip:
    """A run as an animation, with the push that was given."""
    recorder, visualizer = recording()
    animate(visualizer, [Actor(biped, run)], FPS)
    command = next(c for c in recorder.commands if c["type"] == "set_animation")
    tracks = {_name(part["path"]): _track(part["clip"]["tracks"]) for part in command["animations"]}
    frames = max(len(track.position) for track in tracks.values() if track.position is not None)
    times = float(run.t[0]) + np.arange(frames) / FPS
    at = np.clip(np.searchsorted(run.t, times, side="right") - 1, 0, len(run.t) - 1)
    phase = [
        f"{time - run.t[0]:.2f} s, step {int(run.step[i]) + 1}, {StepPhase.of_sign(run.phase[i]).value}"
        f" on the {Stance.of_sign(run.stance[i]).value} foot"
        for time, i in zip(times, at, strict=True)
    ]
    root = tracks[f"robot/{biped.spatial_model.names[1]}"].position
    assert root is not None
    tracks[PUSH] = _push_track(times, root, push)
    return Clip(tracks, frames, tuple(phase))


# ---------------------------------------------------------------------- shapes
def shapes_of(recorder: SceneRecorder) -> tuple[tuple[Shape, ...], dict[str, FloatArray]]:
    """What a MeshCat scene is made of.

    Returns:
        The shapes, and by name where the nodes that are none stand in their parents, (4, 4).
    """
    poses = {c["path"]: _matrix(c["matrix"]) for c in recorder.commands if c["type"] == "set_transform"}
    shapes = []
    for command in recorder.commands:
        if command["type"] == "set_object":
            shape = _shape(command, poses.pop(command["path"], np.eye(4)))
            if shape is not None:
                shapes.append(shape)
    return tuple(shapes), {_name(path): pose for path, pose in poses.items()}


def _shape(command: Mapping[str, Any], pose: FloatArray) -> Shape | None:
    described = command["object"]
    mesh = _triangles(described["geometries"][0])
    if mesh is None:
        return None
    material = described["materials"][0]
    colour = int(material.get("color", 0xCCCCCC))
    within = _matrix(described["object"].get("matrix", np.eye(4).ravel().tolist()))
    return Shape(
        node=_name(command["path"]),
        vertices=mesh[0] @ within[:3, :3].T + within[:3, 3],
        faces=mesh[1],
        pose=pose,
        colour=(colour >> 16 & 255, colour >> 8 & 255, colour & 255),
        opacity=float(material.get("opacity", 1.0)),
        marker=material.get("depthTest") is False,
        flat=described["geometries"][0]["type"] == "BoxGeometry",
    )


def _triangles(geometry: Mapping[str, Any]) -> tuple[FloatArray, IntArray] | None:
    """Vertices and faces; None for what has none, such as lines."""
    kind = geometry["type"]
    if kind == "BoxGeometry":
        return _box(*(0.5 * float(geometry[key]) for key in ("width", "height", "depth")))
    if kind == "SphereGeometry":
        return _ball(float(geometry["radius"]))
    if kind == "CylinderGeometry":
        return _round(float(geometry["radiusTop"]), float(geometry["radiusBottom"]), 0.5 * float(geometry["height"]))
    if kind == "BufferGeometry" and "position" in geometry["data"]["attributes"]:
        vertices = _unpacked(geometry["data"]["attributes"]["position"])
        index = geometry["data"].get("index")
        faces = _unpacked(index) if index is not None else np.arange(vertices.size // 3)
        return vertices.reshape(-1, 3).astype(float), faces.reshape(-1, 3).astype(np.int64)
    return None


def _unpacked(packed: Mapping[str, Any]) -> np.ndarray[Any, np.dtype[Any]]:
    kind = np.uint32 if packed["type"] == "Uint32Array" else np.float32
    data = packed["array"]
    return np.frombuffer(getattr(data, "data", data), dtype=kind)


def _box(x: float, y: float, z: float) -> tuple[FloatArray, IntArray]:
    corners = np.array([[i, j, k] for i in (-x, x) for j in (-y, y) for k in (-z, z)])
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return corners, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


def _round(top: float, bottom: float, half: float) -> tuple[FloatArray, IntArray]:
    """A cylinder or cone along y, as MeshCat has them; its ends have vertices of their own, so that edges stay."""
    turn = 2.0 * np.pi * np.arange(_AROUND) / _AROUND
    circle = np.stack([np.sin(turn), np.zeros(_AROUND), np.cos(turn)], axis=1)
    up, down = circle * top + [0.0, half, 0.0], circle * bottom - [0.0, half, 0.0]
    vertices = np.vstack([up, down, up, down, [[0.0, half, 0.0], [0.0, -half, 0.0]]])
    i = np.arange(_AROUND)
    j = (i + 1) % _AROUND
    n = _AROUND
    side = [np.stack([i, i + n, j + n], 1), np.stack([i, j + n, j], 1)]
    upper = np.stack([np.full(n, 4 * n), i + 2 * n, j + 2 * n], 1)
    lower = np.stack([np.full(n, 4 * n + 1), j + 3 * n, i + 3 * n], 1)
    ends = [upper, lower]
    return vertices, np.vstack(side + ends)


def _ball(radius: float) -> tuple[FloatArray, IntArray]:
    rings = _AROUND // 2
    polar = np.pi * np.arange(rings + 1) / rings
    turn = 2.0 * np.pi * np.arange(_AROUND) / _AROUND
    vertices = radius * np.stack(
        [
            np.outer(np.sin(polar), np.cos(turn)),
            np.outer(np.sin(polar), np.sin(turn)),
            np.outer(np.cos(polar), np.ones(_AROUND)),
        ],
        axis=-1,
    ).reshape(-1, 3)
    i, j = (index.ravel() for index in np.meshgrid(np.arange(rings), np.arange(_AROUND), indexing="ij"))
    a, b = i * _AROUND + j, i * _AROUND + (j + 1) % _AROUND
    return vertices, np.vstack([np.stack([a, a + _AROUND, b + _AROUND], 1), np.stack([a, b + _AROUND, b], 1)])


def _depth(biped: FrontalBiped, shapes: list[Shape]) -> float:
    """How far the robot reaches forward at its posture; markers are drawn before it."""
    model, data = biped.spatial_model, biped.spatial_model.createData()
    pin.forwardKinematics(model, data, biped.spatial_reference)
    farthest = 0.0
    for shape in shapes:
        parts = shape.node.split("/")
        if parts[0] == "robot" and model.existJointName(parts[1]):
            placed = data.oMi[model.getJointId(parts[1])].homogeneous @ shape.pose
            farthest = max(farthest, float((shape.vertices @ placed[0, :3] + placed[0, 3]).max()))
    return farthest


def _upright(biped: FrontalBiped) -> Trajectory:
    """The robot standing still; what the scene's camera is pointed at."""
    two, zero, one = np.zeros((2, 4)), np.zeros(2), np.ones(2)
    return Trajectory(
        t=np.array([0.0, 1.0]),
        q=two + UPRIGHT,
        dq=two,
        u=two,
        force=np.tile([0.0, biped.weight], (2, 1)),
        p_fri=zero,
        p_fri_target=zero,
        q_b_desired=two[:, 1:] + UPRIGHT,
        phase=one,
        stance=one,
        stance_y=one * 0.5 * biped.hip_width,
        step=zero,
        event_t=np.zeros(0),
        event_kind=(),
        event_step=np.zeros(0),
        event_state=np.zeros((0, 8)),
        robot=biped.name,
        outcome=COMPLETED,
        steps_completed=0,
    )


def _name(path: str) -> str:
    """A node's name here: without MeshCat's root, and without the run it belongs to."""
    return path.removeprefix("/meshcat/").removeprefix(f"{FIRST}/")


def _matrix(numbers: Any) -> FloatArray:
    """MeshCat writes columns first."""
    return np.array(numbers, dtype=float).reshape(4, 4).T


# ---------------------------------------------------------------------- motion
def _track(tracks: list[dict[str, Any]]) -> Track:
    found: dict[str, Any] = {}
    for track in tracks:
        values = np.array([key["value"] for key in track["keys"]])
        name = track["name"].lstrip(".")
        if name == "quaternion":
            found["wxyz"] = values[:, [3, 0, 1, 2]]
        elif name in ("position", "scale", "visible"):
            found[name] = values
    return Track(**found)


def _push_arrow(hip_height: float) -> list[Shape]:
    """An arrow along y whose tip is in the origin."""
    length = 0.45 * hip_height
    shaft = _round(0.02 * hip_height, 0.02 * hip_height, 0.35 * length)
    head = _round(0.0, 0.05 * hip_height, 0.15 * length)
    return [
        Shape(f"{PUSH}/{name}", *mesh, _along_y(y * length), PUSH_COLOUR, 1.0, True, False)
        for name, mesh, y in (("shaft", shaft, -0.65), ("head", head, -0.15))
    ]


def _push_track(times: FloatArray, root: FloatArray, push: Push | None) -> Track:
    if push is None:
        return Track(position=root, visible=np.zeros(len(times), dtype=bool))
    shown = (times >= push.start - 0.5 / FPS) & (times < push.start + PUSH_SHOWN)
    turned = (1.0, 0.0, 0.0, 0.0) if push.impulse > 0.0 else (0.0, 0.0, 0.0, 1.0)
    return Track(position=root, wxyz=np.tile(turned, (len(times), 1)), visible=shown)


def _along_y(y: float) -> FloatArray:
    placement = np.eye(4)
    placement[1, 3] = y
    return placement


def is_marker(node: str) -> bool:
    """Is a node drawn before the robot, so that it is seen?"""
    return node.split("/")[0] in (CONTACT, COM, PUSH)


def wxyz_of(pose: FloatArray) -> FloatArray:
    """(4,) unit quaternion, real part first, of a pose (4, 4)."""
    x, y, z, w = pin.Quaternion(np.ascontiguousarray(pose[:3, :3])).normalized().coeffs()
    return np.array([w, x, y, z])
