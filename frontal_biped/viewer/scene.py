"""The scene: the room, the robots in it with their markers, and their animation, as MeshCat nodes.

Works on any MeshCat visualizer, of the live server or of the exported page. Bodies are animated, not shapes: one
node per joint, the shapes below it placed once.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.trajectory import Trajectory
from frontal_biped.simulation.world import FEET, WorldMotion, drawable, frame_times, resample, world_motion
from frontal_biped.viewer.markers import COM, CONTACT, SwingTrace, draw_markers, draw_traces, swing_traces
from frontal_biped.viewer.placements import at, from_y_axis
from frontal_biped.viewer.robot_shapes import Colour, draw_robot
from frontal_biped.viewer.tracks import REPETITIONS, add_track, clip_of

GROUND, FIRST, GHOST, SECOND = "ground", "first", "ghost", "second"
"""Top nodes below ``/meshcat``: the ground; the run; its desired posture; a second run."""

ROBOT = "robot"
"""Node of the bodies below that of a run; those of its markers are in `markers`."""

GHOST_COLOUR: Colour = (0.36, 0.25, 0.75, 0.38)

ABOVE = 1.15
"""The top of a robot is about so much higher than the origin of its highest body."""

FLOOR, GLOW, LINE = 0xE4E9EF, 0x565A60, 0xAAB4C2


@dataclass(frozen=True)
class Actor:
    """A robot that moves in the scene.

    Attributes:
        biped: the robot.
        trajectory: its run.
        node: what its nodes hang below.
        shift: to the robot's left [m].
        colour: of all its shapes; None: its own.
        marked: with centre of mass, FRI, force and trace?
    """

    biped: FrontalBiped
    trajectory: Trajectory
    node: str = FIRST
    shift: float = 0.0
    colour: Colour | None = None
    marked: bool = True

    @property
    def duration(self) -> float:
        """Of its run [s]."""
        return float(self.trajectory.t[-1] - self.trajectory.t[0])

    @cached_property
    def traces(self) -> list[SwingTrace]:
        """Of its swing foot, where it is marked."""
        return swing_traces(self.biped, self.trajectory) if self.marked else []


def cast(
    biped: FrontalBiped,
    trajectory: Trajectory,
    *,
    ghost: bool = False,
    beside: tuple[FrontalBiped, Trajectory] | None = None,
    overlay: bool = False,
) -> list[Actor]:
    """Who is on the page.

    Args:
        biped: the robot.
        trajectory: its run.
        ghost: the desired posture (beta, h_d(beta)), translucent over the actual one.
        beside: a second robot and its run.
        overlay: the second run translucent over the first, instead of beside it.

    Returns:
        The first run, its ghost, the second run.
    """
    first = Actor(biped, drawable(trajectory))
    actors = [first]
    if ghost:
        wanted = np.concatenate([first.trajectory.q[:, :1], first.trajectory.q_b_desired], axis=1)
        actors.append(Actor(biped, replace(first.trajectory, q=wanted), GHOST, 0.0, GHOST_COLOUR, False))
    if beside is not None:
        second = Actor(beside[0], drawable(beside[1]), SECOND)
        if overlay:
            actors.append(replace(second, colour=GHOST_COLOUR, marked=False))
        else:
            # the first run on the left of the picture: on the robot's right
            apart = 0.5 * _size(biped) + 0.5 * _size(second.biped) + 0.35 * _size(biped)
            actors[:] = [replace(actor, shift=-0.5 * apart) for actor in actors]
            actors.append(replace(second, shift=0.5 * apart))
    return actors


def draw_room(visualizer: Any) -> None:
    """Put background and light into an empty scene."""
    for node in ("/Grid", "/Axes"):
        visualizer[node].set_property("visible", False)
    visualizer["/Background"].set_property("top_color", [0.80, 0.87, 0.94])
    visualizer["/Background"].set_property("bottom_color", [0.97, 0.98, 0.99])
    visualizer["/Cameras/default/rotated/<object>"].set_property("fov", 36.0)
    _light(visualizer)


def draw_scene(visualizer: Any, actors: Sequence[Actor]) -> None:
    """Put the ground, the robots and their markers into an empty scene.

    Args:
        visualizer: a ``meshcat.Visualizer``.
        actors: the robots, see `cast`.
    """
    draw_room(visualizer)
    _draw_ground(visualizer[GROUND])
    for actor in actors:
        place = visualizer[actor.node]
        place.set_transform(at(0.0, actor.shift, 0.0))
        draw_robot(place[ROBOT], actor.biped, actor.colour)
        if actor.marked:
            draw_markers(place, actor.biped)
            draw_traces(place, actor.biped, actor.traces)


def robot_camera(biped: FrontalBiped) -> dict[str, list[float]]:
    """Where a camera stands and what it looks at, xyz [m]: in front of the robot, facing it, a bit raised."""
    size = _size(biped)
    return {"position": [3.6 * size, 0.0, 1.2 * size], "target": [0.0, 0.0, 0.9 * size]}


def frontal_camera(actors: Sequence[Actor]) -> dict[str, Any]:
    """The camera of a page: as `robot_camera` of the tallest robot, before the middle of them all.

    The page sets this itself; MeshCat 0.3.2 has a command for the position but none for the target. ``half_width`` is
    what it must show to either side [m], however narrow the window.
    """
    tallest = max((actor.biped for actor in actors), key=_size)
    sides = [side for actor in actors for side in _reach(actor)]
    camera: dict[str, Any] = robot_camera(tallest)
    for place in camera.values():
        place[1] = 0.5 * (max(sides) + min(sides))
    return camera | {"half_width": 0.5 * (max(sides) - min(sides))}


def animate(visualizer: Any, actors: Sequence[Actor], fps: float = 30.0) -> None:
    """Animate a scene with its runs, at a fixed rate in their own time; a shorter run waits at its end.

    Args:
        visualizer: a ``meshcat.Visualizer`` that `draw_scene` has filled with the same robots.
        actors: the robots.
        fps: key frames per second.
    """
    from meshcat.animation import Animation

    longest = max(actors, key=lambda actor: actor.duration).trajectory
    times = frame_times(longest, fps) - longest.t[0]
    frames = [float(frame) for frame in times * fps]
    animation = Animation(default_framerate=float(fps))
    for actor in actors:
        place = visualizer[actor.node]
        motion = world_motion(actor.biped, resample(actor.trajectory, actor.trajectory.t[0] + times))
        for body, poses in body_poses(actor.biped, motion):
            _pose_tracks(clip_of(animation, place[ROBOT][body], fps), frames, poses)
        if actor.marked:
            _animate_markers(animation, place, actor.biped, motion, frames, fps)
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
    node["slab"].set_object(mg.Box([30.0, 30.0, slab]), mg.MeshLambertMaterial(color=FLOOR, emissive=GLOW))
    node["slab"].set_transform(at(0.0, 0.0, -0.5 * slab))
    # a line every 0.25 m of y, 1 mm above the slab lest it flicker: steps can be read off
    for k in range(-8, 9):
        line = node[f"line_{k + 8}"]
        line.set_object(mg.Box([8.0, 0.004, 2e-3]), mg.MeshBasicMaterial(color=LINE))
        line.set_transform(at(0.0, 0.25 * k, 0.0))


def _size(biped: FrontalBiped) -> float:
    """Half of about how much there is to see: to the hips, or half-way to the top of the head [m]."""
    model, data = biped.spatial_model, biped.spatial_model.createData()
    top = highest_body(model, data, biped.spatial_reference)
    ankle = data.oMi[model.getJointId(biped.stance_map.joint_names[0])].translation[2]
    return max(float(biped.chain.joints[1, 1]), 0.5 * ABOVE * float(top - ankle + biped.ankle_height))


def highest_body(model: pin.Model, data: pin.Data, q: FloatArray) -> float:
    """Height of the origin of the highest body at a configuration (nq,) [m]; leaves the placements in ``data``."""
    pin.framesForwardKinematics(model, data, q)
    return max(float(data.oMf[i].translation[2]) for i, f in enumerate(model.frames) if f.type == pin.FrameType.BODY)


def _reach(actor: Actor) -> tuple[float, float]:
    """How far to the right and to the left it gets [m]."""
    y, room = actor.trajectory.stance_y + actor.shift, 0.6 * _size(actor.biped)
    return float(y.min()) - room, float(y.max()) + room


# ---------------------------------------------------------------------- animation
def body_poses(biped: FrontalBiped, motion: WorldMotion) -> Iterator[tuple[str, list[pin.SE3]]]:
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
    animation: Any, place: Any, biped: FrontalBiped, motion: WorldMotion, frames: list[float], fps: float
) -> None:
    com = clip_of(animation, place[COM], fps)
    add_track(com, "position", "vector3", frames, motion.com.tolist())
    plumb = clip_of(animation, place[COM]["plumb"], fps)  # stretched down to the ground
    add_track(plumb, "scale", "vector3", frames, [[1.0, 1.0, float(z)] for z in motion.com[:, 2]])
    weights = np.linalg.norm(motion.force, axis=1) / biped.weight
    for foot in FEET:
        standing = np.array([Stance.of_sign(sign) is foot for sign in motion.stance])
        shown = _hold(standing)  # where the foot swings, its hidden marker waits at its last place
        contact = clip_of(animation, place[CONTACT][foot.value], fps)
        add_track(contact, "visible", "bool", frames, standing.tolist())
        add_track(contact, "position", "vector3", frames, motion.fri[shown].tolist())
        arrow = clip_of(animation, place[CONTACT][foot.value]["force"], fps)
        add_track(arrow, "quaternion", "quaternion", frames, [from_y_axis(f) for f in motion.force[shown]])
        add_track(arrow, "scale", "vector3", frames, [[1.0, max(float(w), 1e-3), 1.0] for w in weights[shown]])


def _hold(active: np.ndarray[Any, np.dtype[np.bool_]]) -> np.ndarray[Any, np.dtype[np.intp]]:
    """For each frame the index of the latest active one, the first active one before that, 0 if there is none."""
    index = np.where(active, np.arange(len(active)), -1)
    latest = np.maximum.accumulate(index)
    first = int(np.argmax(active))
    return np.where(latest < 0, first, latest)


def _pose_tracks(clip: Any, frames: list[float], poses: list[pin.SE3]) -> None:
    add_track(clip, "position", "vector3", frames, [pose.translation.tolist() for pose in poses])
    quaternions = [pin.Quaternion(pose.rotation).coeffs().tolist() for pose in poses]
    add_track(clip, "quaternion", "quaternion", frames, quaternions)
