"""What both soles leave and feel in a walk in space: footsteps, centres of pressure, friction and yaw moment."""

from typing import NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.model.robot import FootSole
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.space.run import SpatialRun
from frontal_biped.simulation.world import phase_spans

BEARING = 0.02
"""A foot that carries less than this share of the largest load of the run has no centre of pressure worth telling."""


class Footstep(NamedTuple):
    """A place where a foot stood.

    Attributes:
        step: index of the step it carried; -1 for the foot that waits behind at the start.
        side: which foot.
        time: when it came to stand there [s].
        x: of the origin of the sole's frame, below the ankle [m].
        y: [m].
        yaw: of the foot [rad].
    """

    step: int
    side: Stance
    time: float
    x: float
    y: float
    yaw: float


def footsteps(run: SpatialRun) -> list[Footstep]:
    """Where the feet stood, in the order of time: half-way through the step they carried."""
    spans = phase_spans(run)
    first = spans[0]
    waiting = first.stance.other
    found = [Footstep(-1, waiting, first.start, *_place(run, first.samples.start, waiting))]
    for step in dict.fromkeys(span.step for span in spans):
        own = [span for span in spans if span.step == step]
        middle = (own[0].samples.start + own[-1].samples.stop - 1) // 2
        found.append(Footstep(step, own[0].stance, own[0].start, *_place(run, middle, own[0].stance)))
    return found


def footprint(sole: FootSole, x: float, y: float, yaw: float) -> FloatArray:
    """(4, 2) corners of a sole on the ground, going round [m].

    Args:
        sole: of the foot.
        x: of the origin of its frame [m].
        y: [m].
        yaw: of the foot [rad].
    """
    around = sole.corners[[0, 1, 3, 2], :2]
    c, s = np.cos(yaw), np.sin(yaw)
    return around @ np.array([[c, s], [-s, c]]) + np.array([x, y])


def bearing(run: SpatialRun) -> "np.ndarray[tuple[int, ...], np.dtype[np.bool_]]":
    """(T, 2) does the left, the right foot carry enough to speak of a centre of pressure?"""
    load = run.wrench[:, :, 2]
    return load > BEARING * max(float(load.max(initial=0.0)), 1e-9)


def standing(run: SpatialRun) -> "np.ndarray[tuple[int, ...], np.dtype[np.bool_]]":
    """(T, 2) is the left, the right foot the stance foot? Under one that leaves, pressure has to come to an edge."""
    signs = [Stance.LEFT.sign, Stance.RIGHT.sign]
    return np.asarray(np.sign(run.stance)[:, None] == np.array(signs)[None, :])


def pressure_in_sole(run: SpatialRun) -> FloatArray:
    """(T, 2, 2) centres of pressure in their soles' axes, x forwards, y to the left [m]; nan off the ground."""
    offset = _pressure_offset(run)
    c, s = np.cos(run.sole_yaw), np.sin(run.sole_yaw)
    return np.stack(
        [c * offset[..., 0] + s * offset[..., 1], -s * offset[..., 0] + c * offset[..., 1]],
        axis=-1,
    )


def pressure_in_world(run: SpatialRun) -> FloatArray:
    """(T, 2, 3) centres of pressure in the world [m]; nan off the ground."""
    offset = _pressure_offset(run)
    return run.sole_position + np.concatenate([offset, 0.0 * offset[..., :1]], axis=-1)


def yaw_moments(run: SpatialRun) -> FloatArray:
    """(T, 2) moments about the vertical through the centre of pressure [N m]; nan off the ground."""
    offset, force = _pressure_offset(run), run.wrench[..., :2]
    return run.wrench[..., 5] - (offset[..., 0] * force[..., 1] - offset[..., 1] * force[..., 0])


def friction_used(run: SpatialRun) -> FloatArray:
    """(T, 2) horizontal over vertical force [-]; nan off the ground."""
    horizontal = np.linalg.norm(run.wrench[..., :2], axis=-1)
    return np.divide(horizontal, run.wrench[..., 2], out=np.full(horizontal.shape, np.nan), where=bearing(run))


def _place(run: SpatialRun, sample: int, side: Stance) -> tuple[float, float, float]:
    foot = 0 if side is Stance.LEFT else 1
    x, y, _ = run.sole_position[sample, foot]
    return float(x), float(y), float(run.sole_yaw[sample, foot])


def _pressure_offset(run: SpatialRun) -> FloatArray:
    """(T, 2, 2) from the origins of the soles' frames to the centres of pressure, world axes [m]."""
    where = np.where(bearing(run), run.wrench[..., 2], np.nan)
    return np.stack([-run.wrench[..., 4] / where, run.wrench[..., 3] / where], axis=-1)
