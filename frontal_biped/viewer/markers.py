"""What the eye cannot see: ground reaction, FRI, centre of mass and the path of the swing foot, as MeshCat nodes."""

from typing import Any, NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.trajectory import Trajectory
from frontal_biped.simulation.world import FEET, phase_spans, resample, sole_ends, world_configurations
from frontal_biped.viewer.placements import at, hanging_cylinder

CONTACT, COM, TRACE = "contact", "centre_of_mass", "trace"
"""Top nodes of a robot's markers."""

FORCE_LENGTH = 0.6  # length of the arrow that carries the whole weight, over the hip's height
TRACE_RATE, FEWEST_POINTS = 60.0, 12  # points of a trace [1/s], and at least

MOST_POINTS = 16_000
"""Of all traces of a run together, about; those of a longer run have fewer a second."""

COLOURS = {
    "force": 0x009E73,
    "fri": 0xCC1F7A,
    "com": 0xF0C000,
    "rim": 0x222222,
    "trace": 0xE06A00,
    "moment": 0x5C40BF,
    "push": 0xD62728,
    "left": 0x2A6CB8,
    "right": 0xDE7329,
}


class SwingTrace(NamedTuple):
    """The way of the swing sole's middle during one step.

    Attributes:
        step: its index.
        foot: that swings.
        start: time from the start of the run [s].
        end: [s].
        points: (n, 3) at even times from start to end [m].
    """

    step: int
    foot: Stance
    start: float
    end: float
    points: FloatArray


def swing_traces(biped: FrontalBiped, trajectory: Trajectory) -> list[SwingTrace]:
    """The way of the swing foot, step by step; steps of no duration are left out."""
    spans = phase_spans(trajectory)
    rate = min(TRACE_RATE, MOST_POINTS / max(spans[-1].end - spans[0].start, 1e-9))
    swings: list[tuple[int, Stance, float, float]] = []
    times: list[FloatArray] = []
    for step in dict.fromkeys(span.step for span in spans):
        own = [span for span in spans if span.step == step]
        start, end = own[0].start, own[-1].end
        if end - start < 1e-3:
            continue
        inside = np.linspace(start, end, max(FEWEST_POINTS, int(np.ceil(rate * (end - start)))))
        inside[[0, -1]] += np.array([1e-9, -1e-9])  # at its ends two samples share one time
        times.append(inside)
        swings.append((step, own[0].stance.other, start - float(trajectory.t[0]), end - float(trajectory.t[0])))
    if not swings:
        return []
    poses = resample(trajectory, np.concatenate(times))
    centres = sole_ends(biped, world_configurations(biped, poses)).mean(axis=2)
    parts = np.split(centres, np.cumsum([len(inside) for inside in times[:-1]]))
    return [
        SwingTrace(step, foot, start, end, both[:, FEET.index(foot)])
        for (step, foot, start, end), both in zip(swings, parts, strict=True)
    ]


def draw_markers(visualizer: Any, biped: FrontalBiped) -> None:
    """Put force arrows, FRI and centre of mass into a node."""
    hip_height = float(biped.chain.joints[1, 1])
    for foot in FEET:
        draw_contact(visualizer[CONTACT][foot.value], "fri", hip_height)
    draw_com(visualizer[COM], hip_height)


def draw_contact(contact: Any, point: str, hip_height: float) -> None:
    """Put an arrow along y that carries the whole weight, "force", and the point where it acts into a node."""
    import meshcat.geometry as mg

    arrow = FORCE_LENGTH * hip_height
    contact[point].set_object(mg.Sphere(0.028 * hip_height), overlay("fri"))
    force = contact["force"]
    force["shaft"].set_object(mg.Cylinder(0.86 * arrow, 0.012 * hip_height), overlay("force", opacity=0.85))
    force["shaft"].set_transform(at(0.0, 0.43 * arrow, 0.0))
    head = mg.Cylinder(0.14 * arrow, radiusTop=0.0, radiusBottom=0.03 * hip_height)
    force["head"].set_object(head, overlay("force", opacity=0.85))
    force["head"].set_transform(at(0.0, 0.93 * arrow, 0.0))


def draw_com(com: Any, hip_height: float) -> None:
    """Put the centre of mass, and below it a line of length one that is stretched to the ground, into a node."""
    import meshcat.geometry as mg

    radius = 0.03 * hip_height
    com["plumb"]["line"].set_object(mg.Cylinder(1.0, 0.004 * hip_height), overlay("rim", opacity=0.6))
    com["plumb"]["line"].set_transform(hanging_cylinder())
    com["rim"].set_object(mg.Sphere(1.25 * radius), overlay("rim"))
    com["marker"].set_object(mg.Sphere(radius), overlay("com"))


def draw_traces(visualizer: Any, biped: FrontalBiped, traces: list[SwingTrace]) -> None:
    """Put the ways of the swing foot into a node, ribbons that face the frontal camera: one mesh for each foot.

    It holds the ribbons of the foot's steps one after another; the page shows the latest.
    """
    import meshcat.geometry as mg

    width = 0.012 * float(biped.chain.joints[1, 1])
    for foot in FEET:
        ribbons = [ribbon(trace.points, width) for trace in traces if trace.foot is foot]
        if not ribbons:
            continue
        starts = np.cumsum([0, *(len(vertices) for vertices, _ in ribbons)])
        vertices = np.concatenate([vertices for vertices, _ in ribbons])
        faces = np.concatenate([faces + start for start, (_, faces) in zip(starts, ribbons, strict=False)])
        mesh = mg.TriangularMeshGeometry(vertices, faces)
        visualizer[TRACE][foot.value].set_object(mesh, overlay("trace", opacity=0.9))


def ribbon(points: FloatArray, width: float) -> tuple[FloatArray, "np.ndarray[Any, np.dtype[np.int64]]"]:
    """A band along a way in the frontal plane.

    Args:
        points: (n, 3) [m].
        width: [m].

    Returns:
        (2 n, 3) vertices, and (2 n - 2, 3) triangles in the order of the way: two for each of its n - 1 pieces.
    """
    tangent = np.gradient(points[:, 1:], axis=0)
    tangent /= np.maximum(np.linalg.norm(tangent, axis=1, keepdims=True), 1e-12)
    across = np.stack([np.zeros(len(points)), -tangent[:, 1], tangent[:, 0]], axis=1)
    vertices = np.stack([points + 0.5 * width * across, points - 0.5 * width * across], axis=1).reshape(-1, 3)
    first = 2 * np.arange(len(points) - 1)
    corners = (0, 1, 2, 1, 3, 2)
    faces = np.stack([first + k for k in corners], axis=1).reshape(-1, 3)
    return vertices, faces


def overlay(colour: str, **options: Any) -> Any:
    """Material of a marker, in one of `COLOURS`."""
    import meshcat.geometry as mg

    # drawn after the robot and through it: the points lie inside its shapes
    return mg.MeshBasicMaterial(color=COLOURS[colour], depthTest=False, transparent=True, **options)
