"""From stance coordinates to the room: where the robot, its feet and the ground reaction are, X forward, Y left, Z up.

The paper's h axis runs from the stance foot towards the swing foot, hence to the right of the robot when the left
foot stands: with side = +1 in left stance and -1 in right stance,

    y = y_stance - side h,        z = v.

The 3D pose follows from one condition: the stance foot lies flat on z = 0 below its ankle.
"""

from dataclasses import dataclass, replace
from typing import Any, NamedTuple, Protocol

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.space.standing import ANKLE, standing_configurations
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.trajectory import FARTHEST, SAMPLED, Trajectory
from frontal_biped.virtual_constraints.phase import StepPhase

FEET = (Stance.LEFT, Stance.RIGHT)

_INTERPOLATED = ("q", "dq", "u", "force", "p_fri", "p_fri_target", "q_b_desired")
_HELD = ("phase", "stance", "stance_y", "step")


class Phased(Protocol):
    """A run with phases and steps, in the plane or in space: `Trajectory`, `SpatialRun`."""

    @property
    def t(self) -> FloatArray:
        """(T,) time [s]."""

    @property
    def phase(self) -> FloatArray:
        """(T,) +1 rising, -1 falling."""

    @property
    def stance(self) -> FloatArray:
        """(T,) +1 left, -1 right."""

    @property
    def step(self) -> FloatArray:
        """(T,) index of the step."""


class PhaseSpan(NamedTuple):
    """One phase of one step.

    Attributes:
        start: its time [s].
        end: [s].
        phase: rising or falling.
        stance: the foot that stands.
        step: index of the step.
        samples: the samples of the trajectory it owns.
    """

    start: float
    end: float
    phase: StepPhase
    stance: Stance
    step: int
    samples: slice


@dataclass(frozen=True)
class WorldMotion:
    """A run in the room.

    Attributes:
        t: (T,) [s], from 0.
        q: (T, nq) configurations of ``biped.spatial_model``: free-flyer (xyz, quaternion xyzw) and roll joints.
        com: (T, 3) centre of mass [m].
        fri: (T, 3) where the ground reaction acts [m].
        force: (T, 3) ground reaction [N].
        stance: (T,) +1 left, -1 right.
    """

    t: FloatArray
    q: FloatArray
    com: FloatArray
    fri: FloatArray
    force: FloatArray
    stance: FloatArray


def phase_spans(trajectory: Phased) -> list[PhaseSpan]:
    """The phases of a run in the order of time."""
    changes = (np.diff(trajectory.phase) != 0.0) | (np.diff(trajectory.step) != 0.0)
    starts = [0, *(np.flatnonzero(changes) + 1).tolist()]
    ends = [*starts[1:], len(trajectory.t)]
    return [
        PhaseSpan(
            float(trajectory.t[i]),
            float(trajectory.t[j - 1]),
            StepPhase.of_sign(trajectory.phase[i]),
            Stance.of_sign(trajectory.stance[i]),
            int(trajectory.step[i]),
            slice(i, j),
        )
        for i, j in zip(starts, ends, strict=True)
    ]


def resample(trajectory: Trajectory, times: FloatArray) -> Trajectory:
    """The run at other instants.

    Samples are interpolated within a phase only: stance coordinates jump at an impact, when the feet change roles.

    Args:
        trajectory: the run; its two samples at one event time bound the phases.
        times: (K,) instants in the run's own time, increasing [s].

    Returns:
        The run at these instants, events unchanged.
    """
    between = neighbours(trajectory.t, times)
    arrays: dict[str, Any] = {"t": np.asarray(times, dtype=float)}
    arrays |= {name: between.mix(getattr(trajectory, name)) for name in _INTERPOLATED}
    arrays |= {name: getattr(trajectory, name)[between.left] for name in _HELD}
    return replace(trajectory, **arrays)


def even_times(t: FloatArray, rate: float) -> FloatArray:
    """(K,) instants at a rate [1/s], from the first sample of a run to its last at t (T,) [s]."""
    return t[0] + np.arange(int(np.floor((t[-1] - t[0]) * rate + 1e-9)) + 1) / rate


class Neighbours(NamedTuple):
    """The samples before and after some instants.

    Attributes:
        left: (K,) index of the sample before, of two at one time the later.
        right: (K,) index of the one behind it.
        weight: (K,) of the right one, 0 to 1; the last instant of a run is reached from the left at weight 1.
    """

    left: np.ndarray[Any, np.dtype[np.intp]]
    right: np.ndarray[Any, np.dtype[np.intp]]
    weight: FloatArray

    def mix(self, values: FloatArray) -> FloatArray:
        """Values (T, ...) of the samples, at the instants (K, ...)."""
        w = self.weight.reshape(-1, *([1] * (values.ndim - 1)))
        return (1.0 - w) * values[self.left] + w * values[self.right]


def neighbours(t: FloatArray, times: FloatArray) -> Neighbours:
    """Between which samples, at t (T,) [s], the instants (K,) lie."""
    last = max(len(t) - 2, 0)
    left = np.clip(np.searchsorted(t, times, side="right") - 1, 0, last)
    right = np.minimum(left + 1, len(t) - 1)
    width = t[right] - t[left]
    weight = np.clip(np.divide(times - t[left], width, out=np.zeros_like(width), where=width > 0.0), 0.0, 1.0)
    return Neighbours(left, right, weight)


def rows_before_divergence(t: FloatArray, postures: FloatArray) -> int:
    """How many postures (T, k) there are before the first that is none: not finite, or farther than `FARTHEST`.

    Args:
        t: (T,) their times, which must be finite too [s].
        postures: of the robot.

    Raises:
        ValueError: not one.
    """
    gone = np.flatnonzero(~(np.isfinite(t) & (np.abs(postures) <= FARTHEST).all(axis=1)))  # nan is not below it
    count = int(gone[0]) if len(gone) else len(t)
    if not count:
        raise ValueError("the run has no posture to draw")
    return count


def before_divergence(trajectory: Trajectory) -> Trajectory:
    """The samples of a run before the robot has diverged.

    Raises:
        ValueError: there is none.
    """
    count = rows_before_divergence(trajectory.t, np.column_stack([trajectory.q, trajectory.stance_y]))
    if count == len(trajectory.t):
        return trajectory
    kept: dict[str, Any] = {name: getattr(trajectory, name)[:count] for name in SAMPLED}
    return replace(trajectory, **kept)


def drawable(trajectory: Trajectory) -> Trajectory:
    """The run as far as it can be drawn: up to where the robot has diverged, gaps filled.

    Runs of other simulators may lack the desired posture, or the FRI and force while nothing touches the ground: the
    actual posture, the ankle's place and no force stand in for them.

    Raises:
        ValueError: the run has no sample that can be drawn.
    """
    run = before_divergence(trajectory)

    def filled(name: str, otherwise: FloatArray | float) -> FloatArray:
        values = getattr(run, name)
        return np.where(np.isfinite(values), values, otherwise)

    p_fri = filled("p_fri", 0.0)
    return replace(
        run,
        dq=filled("dq", 0.0),
        u=filled("u", 0.0),
        force=filled("force", 0.0),
        q_b_desired=filled("q_b_desired", run.q[:, 1:]),
        p_fri=p_fri,
        p_fri_target=filled("p_fri_target", p_fri),
    )


def frame_times(trajectory: Phased, fps: float) -> FloatArray:
    """(K,) instants at a fixed rate from the first sample on [s]; the last one is the end of the run exactly."""
    start, end = float(trajectory.t[0]), float(trajectory.t[-1])
    whole = int(np.floor((end - start) * fps + 1e-9))
    times = start + np.arange(whole + 1) / fps
    if end - times[-1] > 1e-6:
        return np.append(times, end)
    times[-1] = end
    return times


def world_configurations(biped: FrontalBiped, trajectory: Trajectory) -> FloatArray:
    """(T, nq) configurations of ``biped.spatial_model``, the stance foot flat on z = 0 at its recorded place."""
    return standing_configurations(biped, trajectory.q, trajectory.stance, trajectory.stance_y)


def world_motion(biped: FrontalBiped, trajectory: Trajectory) -> WorldMotion:
    """The run in the room: configurations, centre of mass and ground reaction."""
    model = biped.spatial_model
    data = model.createData()
    q = world_configurations(biped, trajectory)
    com = np.array([pin.centerOfMass(model, data, row).copy() for row in q])
    ankle_x = _sole_x(biped)
    forward = np.where(trajectory.stance > 0.0, ankle_x[0], ankle_x[1])
    zero = np.zeros_like(trajectory.t)
    fri = np.stack([forward, trajectory.stance_y - trajectory.stance * trajectory.p_fri, zero], axis=1)
    force = np.stack([zero, -trajectory.stance * trajectory.force[:, 0], trajectory.force[:, 1]], axis=1)
    return WorldMotion(trajectory.t - trajectory.t[0], q, com, fri, force, trajectory.stance.copy())


def sole_ends(biped: FrontalBiped, configurations: FloatArray) -> FloatArray:
    """(T, 2, 2, 3) ends of the soles in the room [m]: [time, left or right foot, inner or outer end, xyz]."""
    model, chart, sole = biped.spatial_model, biped.stance_map, biped.description.sole
    data = model.createData()
    pin.forwardKinematics(model, data, biped.spatial_reference)
    ends = []
    for foot, inwards in zip(FEET, (-1.0, 1.0), strict=True):
        joint = model.getJointId(chart.joint_names[ANKLE[foot]])
        upright = data.oMi[joint].rotation.T
        for extent in (sole.inner, -sole.outer):
            ends.append((joint, upright @ np.array([0.0, inwards * extent, -sole.ankle_height])))
    points = np.empty((len(configurations), 4, 3))
    for row, q in zip(points, configurations, strict=True):
        pin.forwardKinematics(model, data, q)
        row[:] = [data.oMi[joint].act(local) for joint, local in ends]
    return points.reshape(-1, 2, 2, 3)


def plane_to_world(points: FloatArray, stance: FloatArray | float, stance_y: FloatArray | float) -> FloatArray:
    """(..., 2) world (y, z) [m] of points (h, v) (..., 2) [m]; stance and stance_y broadcast over the points."""
    return np.stack([stance_y - stance * points[..., 0], points[..., 1] + np.zeros_like(stance_y)], axis=-1)


def _sole_x(biped: FrontalBiped) -> tuple[float, float]:
    data = biped.spatial_model.createData()
    pin.forwardKinematics(biped.spatial_model, data, biped.spatial_reference)
    names = biped.stance_map.joint_names
    left, right = (float(data.oMi[biped.spatial_model.getJointId(names[ANKLE[foot]])].translation[0]) for foot in FEET)
    return left, right
