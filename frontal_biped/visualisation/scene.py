"""The scene: robot, ground, contact force, FRI and centre of mass as MeshCat nodes, and their animation.

Works on any MeshCat visualizer, of the live server or of the exported page. Bodies are animated, not shapes: one
node per joint, the shapes below it placed once.
"""

import logging
from collections.abc import Iterator
from typing import Any

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import RobotError
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.geometry import build_shapes
from frontal_biped.simulation.trajectory import Trajectory
from frontal_biped.visualisation.robot_meshes import draw_mesh, is_mesh, light_meshes
from frontal_biped.visualisation.world import FEET, WorldMotion, frame_times, resample, stance_of, world_motion

_log = logging.getLogger(__name__)

ROBOT, GROUND, CONTACT, COM = "robot", "ground", "contact", "centre_of_mass"
"""Top nodes below ``/meshcat``."""

REPETITIONS = 1_000_000  # MeshCat plays once unless told otherwise
FORCE_LENGTH = 0.6  # length of the arrow that carries the whole weight, over the hip's height

_Y_TO_Z = pin.Quaternion.FromTwoVectors(pin.YAxis, pin.ZAxis).matrix()  # MeshCat's cylinders point along y

COLOURS = {
    "floor": 0xE4E9EF,
    "glow": 0x565A60,
    "line": 0xAAB4C2,
    "force": 0x009E73,
    "fri": 0xCC1F7A,
    "com": 0xF0C000,
    "rim": 0x222222,
}


def visual_model(biped: FrontalBiped) -> pin.GeometryModel:
    """Shapes of a robot: the URDF's visuals, or its collision shapes where it has none; possibly neither.

    Raises:
        RobotError: a mesh is not found.
    """
    urdf = biped.description.urdf
    text = urdf.read_text(encoding="utf-8")
    shapes = build_shapes(biped.spatial_model, urdf, text, pin.GeometryType.VISUAL)
    if not shapes.ngeoms:
        shapes = build_shapes(biped.spatial_model, urdf, text, pin.GeometryType.COLLISION)
    return shapes


def draw_scene(visualizer: Any, biped: FrontalBiped) -> None:
    """Put the robot, the ground and the markers into an empty scene.

    Args:
        visualizer: a ``meshcat.Visualizer``.
        biped: the robot.
    """
    hip_height = float(biped.chain.joints[1, 1])
    for node in ("/Grid", "/Axes"):
        visualizer[node].set_property("visible", False)
    visualizer["/Background"].set_property("top_color", [0.80, 0.87, 0.94])
    visualizer["/Background"].set_property("bottom_color", [0.97, 0.98, 0.99])
    visualizer["/Cameras/default/rotated/<object>"].set_property("fov", 36.0)
    _light(visualizer)
    _draw_ground(visualizer[GROUND])
    _draw_robot(visualizer[ROBOT], biped)
    _draw_markers(visualizer, hip_height)


def frontal_camera(biped: FrontalBiped) -> dict[str, list[float]]:
    """Where the page's camera stands and what it looks at, xyz [m]: in front of the robot, facing it, slightly raised.

    The page sets this itself; MeshCat 0.3.2 has a command for the position but none for the target.
    """
    size = max(float(biped.chain.joints[1, 1]), _top(biped) / 2.0)  # heads and feet in the picture
    target = 0.9 * size
    return {"position": [3.6 * size, 0.0, target + 0.3 * size], "target": [0.0, 0.0, target]}


def _top(biped: FrontalBiped) -> float:
    """About how high the robot reaches: its highest link, and a head above it [m]."""
    model, data = biped.spatial_model, biped.spatial_model.createData()
    pin.forwardKinematics(model, data, biped.spatial_reference)
    pin.updateFramePlacements(model, data)
    ankle = data.oMi[model.getJointId(biped.stance_map.joint_names[0])].translation[2]
    highest = max(data.oMf[i].translation[2] for i, f in enumerate(model.frames) if f.type == pin.FrameType.BODY)
    return 1.15 * float(highest - ankle + biped.ankle_height)


def animate(visualizer: Any, biped: FrontalBiped, trajectory: Trajectory, fps: float = 30.0) -> None:
    """Animate a scene with a run, at a fixed rate in the run's own time.

    Args:
        visualizer: a ``meshcat.Visualizer`` that `draw_scene` has filled.
        biped: the robot.
        trajectory: the run.
        fps: key frames per second.
    """
    from meshcat.animation import Animation

    motion = world_motion(biped, resample(trajectory, frame_times(trajectory, fps)))
    animation = Animation(default_framerate=float(fps))
    frames = [float(frame) for frame in motion.t * fps]
    for path, frame_poses in _body_poses(biped, motion):
        clip = _clip(animation, visualizer[ROBOT][path], fps)
        _pose_tracks(clip, frames, frame_poses)
    _animate_markers(animation, visualizer, biped, motion, frames, fps)
    visualizer.set_animation(animation, play=True, repetitions=REPETITIONS)


# ---------------------------------------------------------------------- drawing
def _light(visualizer: Any) -> None:
    visualizer["/Lights/SpotLight"].set_property("visible", True)
    spot = visualizer["/Lights/SpotLight/<object>"]
    spot.set_property("position", [2.5, 1.2, 4.0])
    spot.set_property("intensity", 0.4)  # the page lets it cast shadows: MeshCat cannot, it writes "castshadow"
    visualizer["/Lights/AmbientLight/<object>"].set_property("intensity", 0.5)


def _draw_ground(node: Any) -> None:
    import meshcat.geometry as mg

    slab = 0.02
    node["slab"].set_object(
        mg.Box([30.0, 30.0, slab]), mg.MeshLambertMaterial(color=COLOURS["floor"], emissive=COLOURS["glow"])
    )
    node["slab"].set_transform(_at(0.0, 0.0, -0.5 * slab))
    # a line every 0.25 m of y, 1 mm above the slab lest it flicker: steps can be read off
    for k in range(-8, 9):
        line = node[f"line_{k + 8}"]
        line.set_object(mg.Box([8.0, 0.004, 2e-3]), mg.MeshBasicMaterial(color=COLOURS["line"]))
        line.set_transform(_at(0.0, 0.25 * k, 0.0))


def _draw_robot(node: Any, biped: FrontalBiped) -> None:
    from pinocchio.visualize import MeshcatVisualizer

    class BodyVisualizer(MeshcatVisualizer):  # type: ignore[misc]
        """Pinocchio's shape loader, filing each shape under the body that carries it."""

        def getViewerNodeName(self, geometry_object: pin.GeometryObject, geometry_type: pin.GeometryType) -> str:
            body: str = self.model.names[geometry_object.parentJoint]
            return f"{body}/{geometry_object.name}"

    try:
        shapes = visual_model(biped)
    except RobotError as error:
        _log.warning("frontal-biped: warning: %s; %s is drawn with bars instead", error, biped.name)
        _draw_plain_robot(node, biped)
        return
    if not shapes.ngeoms:
        _draw_plain_robot(node, biped)
        return
    loader = BodyVisualizer(biped.spatial_model, None, shapes)
    loader.initViewer(viewer=node)
    for shape in shapes.geometryObjects:
        if is_mesh(shape):
            continue
        loader.loadViewerGeometryObject(shape, pin.GeometryType.VISUAL)
        placement = np.asarray(shape.placement.homogeneous, dtype=float)
        scale = np.diag([*np.asarray(shape.meshScale, dtype=float), 1.0])
        node[loader.getViewerNodeName(shape, pin.GeometryType.VISUAL)].set_transform(placement @ scale)
    for shape, vertices, faces in light_meshes(shapes):
        draw_mesh(node[loader.getViewerNodeName(shape, pin.GeometryType.VISUAL)], shape, vertices, faces)


def _draw_plain_robot(node: Any, biped: FrontalBiped) -> None:
    """Bars for a URDF without shapes."""
    import meshcat.geometry as mg

    model, chart, sole = biped.spatial_model, biped.stance_map, biped.description.sole
    data = model.createData()
    pin.forwardKinematics(model, data, biped.spatial_reference)
    size = biped.leg_length
    at = [data.oMi[model.getJointId(name)] for name in chart.joint_names]

    def bar(joint: str, part: str, world: FloatArray, shape: Any, colour: int) -> None:
        """Hang a shape, placed in the room at the reference posture, on a body."""
        body = data.oMi[model.getJointId(joint)].inverse().homogeneous
        node[joint][part].set_object(shape, mg.MeshPhongMaterial(color=colour))
        node[joint][part].set_transform(np.asarray(body @ world, dtype=float))

    for ankle, hip, inwards, colour in ((0, 1, -1.0, 0x2A6CB8), (3, 2, 1.0, 0xDE7329)):
        middle = 0.5 * (at[ankle].translation + at[hip].translation)
        upright = np.asarray(pin.SE3(_Y_TO_Z, middle).homogeneous, dtype=float)
        bar(chart.joint_names[hip], "leg", upright, mg.Cylinder(size, 0.06 * size), colour)
        thickness = max(sole.ankle_height, 0.04 * size)
        x, y, z = at[ankle].translation
        offset = 0.5 * inwards * (sole.inner - sole.outer)
        foot = mg.Box([0.28 * size, sole.inner + sole.outer, thickness])
        bar(
            chart.joint_names[ankle],
            "foot",
            _at(x, y + offset, z - sole.ankle_height + 0.5 * thickness),
            foot,
            0x384050,
        )
    x, y, z = 0.5 * (at[1].translation + at[2].translation)
    root = model.names[1]
    bar(root, "pelvis", _at(x, y, z), mg.Box([0.14 * size, biped.hip_width, 0.1 * size]), 0x384050)
    bar(root, "torso", _at(x, y, z + 0.3 * size), mg.Box([0.16 * size, 0.35 * size, 0.5 * size]), 0x9EABBD)


def _draw_markers(visualizer: Any, hip_height: float) -> None:
    import meshcat.geometry as mg

    def overlay(colour: str, **options: Any) -> Any:
        # drawn after the robot and through it; both points lie inside its shapes
        return mg.MeshBasicMaterial(color=COLOURS[colour], depthTest=False, transparent=True, **options)

    radius = 0.03 * hip_height
    arrow = FORCE_LENGTH * hip_height
    for foot in FEET:
        contact = visualizer[CONTACT][foot.value]
        contact["fri"].set_object(mg.Sphere(0.7 * radius), overlay("fri"))
        force = contact["force"]
        shaft = mg.Cylinder(0.86 * arrow, 0.012 * hip_height)
        force["shaft"].set_object(shaft, overlay("force", opacity=0.85))
        force["shaft"].set_transform(_at(0.0, 0.43 * arrow, 0.0))
        head = mg.Cylinder(0.14 * arrow, radiusTop=0.0, radiusBottom=0.03 * hip_height)
        force["head"].set_object(head, overlay("force", opacity=0.85))
        force["head"].set_transform(_at(0.0, 0.93 * arrow, 0.0))
    com = visualizer[COM]
    com["plumb"]["line"].set_object(mg.Cylinder(1.0, 0.004 * hip_height), overlay("rim", opacity=0.6))
    com["plumb"]["line"].set_transform(_hanging_cylinder())
    com["rim"].set_object(mg.Sphere(1.25 * radius), overlay("rim"))
    com["marker"].set_object(mg.Sphere(radius), overlay("com"))


# ---------------------------------------------------------------------- animation
def _body_poses(biped: FrontalBiped, motion: WorldMotion) -> Iterator[tuple[str, list[pin.SE3]]]:
    """Name and placements over time of each moving body."""
    model = biped.spatial_model
    data = model.createData()
    poses: dict[int, list[pin.SE3]] = {joint: [] for joint in range(1, model.njoints)}
    for q in motion.q:
        pin.forwardKinematics(model, data, q)
        for joint, history in poses.items():
            history.append(data.oMi[joint].copy())
    for joint, history in poses.items():
        yield model.names[joint], history


def _animate_markers(
    animation: Any, visualizer: Any, biped: FrontalBiped, motion: WorldMotion, frames: list[float], fps: float
) -> None:
    com = _clip(animation, visualizer[COM], fps)
    _track(com, "position", "vector3", frames, motion.com.tolist())
    plumb = _clip(animation, visualizer[COM]["plumb"], fps)  # stretched down to the ground
    _track(plumb, "scale", "vector3", frames, [[1.0, 1.0, float(z)] for z in motion.com[:, 2]])
    weights = np.linalg.norm(motion.force, axis=1) / biped.weight
    for foot in FEET:
        standing = np.array([stance_of(sign) is foot for sign in motion.stance])
        shown = _hold(standing)  # where the foot swings, its hidden marker waits at its last place
        contact = _clip(animation, visualizer[CONTACT][foot.value], fps)
        _track(contact, "visible", "bool", frames, standing.tolist())
        _track(contact, "position", "vector3", frames, motion.fri[shown].tolist())
        arrow = _clip(animation, visualizer[CONTACT][foot.value]["force"], fps)
        _track(arrow, "quaternion", "quaternion", frames, [_from_y_axis(f) for f in motion.force[shown]])
        _track(arrow, "scale", "vector3", frames, [[1.0, max(float(w), 1e-3), 1.0] for w in weights[shown]])


def _hold(active: np.ndarray[Any, np.dtype[np.bool_]]) -> np.ndarray[Any, np.dtype[np.intp]]:
    """For each frame the index of the latest active one, the first active one before that, 0 if there is none."""
    index = np.where(active, np.arange(len(active)), -1)
    latest = np.maximum.accumulate(index)
    first = int(np.argmax(active))
    return np.where(latest < 0, first, latest)


def _pose_tracks(clip: Any, frames: list[float], poses: list[pin.SE3]) -> None:
    _track(clip, "position", "vector3", frames, [pose.translation.tolist() for pose in poses])
    quaternions = [pin.Quaternion(pose.rotation).coeffs().tolist() for pose in poses]
    _track(clip, "quaternion", "quaternion", frames, quaternions)


def _clip(animation: Any, node: Any, fps: float) -> Any:
    from meshcat.animation import AnimationClip

    return animation.clips.setdefault(node.path, AnimationClip(fps=float(fps)))


def _track(clip: Any, name: str, kind: str, frames: list[float], values: list[Any]) -> None:
    from meshcat.animation import AnimationTrack

    clip.tracks[name] = AnimationTrack(name, kind, frames=list(frames), values=values)


def _from_y_axis(direction: FloatArray) -> list[float]:
    """Quaternion (x, y, z, w) that turns the y axis, along which MeshCat's cylinders point, into a direction."""
    turn: list[float] = pin.Quaternion.FromTwoVectors(pin.YAxis, direction).coeffs().tolist()
    return turn


def _hanging_cylinder() -> FloatArray:
    """A cylinder of length one from z = -1 to 0."""
    turned = pin.SE3(_Y_TO_Z, np.array([0.0, 0.0, -0.5]))
    return np.asarray(turned.homogeneous, dtype=float)


def _at(x: float, y: float, z: float) -> FloatArray:
    placement = np.eye(4)
    placement[:3, 3] = x, y, z
    return placement
