"""A recorded run: what the robot did, sampled in time, and the events of every step. And the run file.

A run file is a NumPy archive (NPZ) without pickles. Its entries are the arrays of `Trajectory` under their own names
(t, q, dq, u, force, p_fri, p_fri_target, q_b_desired, phase, stance, stance_y, step, event_t, event_step, event_state)
and ``header``, a JSON text with format ("frontal-biped-run"), version (1), event_kind, robot, outcome,
steps_completed, gait (the whole gait file) and settings. `numpy.load` reads it without this package; a run from another
simulator can be written with `save_trajectory` and watched.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import RobotError
from frontal_biped.files.archive import ArchiveKind, read_archive, write_archive
from frontal_biped.files.array_schema import ArraySchema
from frontal_biped.files.counted import counted
from frontal_biped.files.header_schema import COUNT, LINE, TABLE, words_among
from frontal_biped.files.kinds import RUN
from frontal_biped.files.shown import Plotted, ShownAsPage
from frontal_biped.gait.robot_path import with_found_description, with_stored_description
from frontal_biped.gait.told_robot import told_robot
from frontal_biped.model.stance_map import Stance, StanceMap
from frontal_biped.model.urdf.description import ROLL_JOINTS
from frontal_biped.numerics.by_name import Columns
from frontal_biped.simulation.hybrid_system import EventKind

KIND = ArchiveKind(RUN, 1, "write one with `frontal-biped simulate GAIT.json -o RUN.npz`")

_ABOUT_X = StanceMap(np.ones(4), np.zeros(4), ROLL_JOINTS)
"""As if every URDF axis pointed along +X and every joint were at 0 upright."""

COMPLETED = "completed"
"""Outcome of a walk that took all its steps."""


@dataclass(frozen=True)
class Trajectory(ShownAsPage, Plotted):
    """A simulated walk, time first. Left stance is +1, right stance -1; rising is +1, falling -1.

    Events appear as two samples at one time, before and after.

    Attributes:
        t: (T,) time [s].
        q: (T, 4) stance coordinates [rad].
        dq: (T, 4) [rad/s].
        u: (T, 4) torques [N m].
        force: (T, 2) ground reaction F_h, F_v [N].
        p_fri: (T,) FRI from the stance ankle [m].
        p_fri_target: (T,) wanted FRI [m].
        q_b_desired: (T, 3) h_d(beta) [rad].
        phase: (T,) +1 rising, -1 falling.
        stance: (T,) +1 left, -1 right.
        stance_y: (T,) world y of the stance ankle [m].
        step: (T,) index of the step.
        event_t: (E,) time of each event [s].
        event_kind: (E,) its name.
        event_step: (E,) step it belongs to.
        event_state: (E, 8) q and dq right after it (after relabelling at an impact).
        robot: name of the robot.
        gait: the gait file's content, or {}.
        settings: of simulator and controller.
        outcome: "completed", or what made the robot fall.
        steps_completed: impacts survived.
    """

    t: FloatArray
    q: FloatArray
    dq: FloatArray
    u: FloatArray
    force: FloatArray
    p_fri: FloatArray
    p_fri_target: FloatArray
    q_b_desired: FloatArray
    phase: FloatArray
    stance: FloatArray
    stance_y: FloatArray
    step: FloatArray
    event_t: FloatArray
    event_kind: tuple[str, ...]
    event_step: FloatArray
    event_state: FloatArray
    robot: str
    outcome: str
    steps_completed: int
    gait: Mapping[str, Any] = field(default_factory=dict)
    settings: Mapping[str, Any] = field(default_factory=dict)

    def __repr__(self) -> str:
        steps = counted(self.steps_completed, "step")
        return (
            f"Trajectory of {self.robot!r}: {self.outcome}, {steps} in {float(self.t[-1]):.2f} s,"
            f" {counted(len(self.t), 'sample')};\n  positions, velocities, torques by joint: {', '.join(ROLL_JOINTS)}"
        )

    @property
    def fell(self) -> bool:
        """Did the robot fall?"""
        return self.outcome != COMPLETED

    @property
    def output_error(self) -> FloatArray:
        """(T, 3) y = q_b - h_d(beta) [rad]."""
        return self.q[:, 1:] - self.q_b_desired

    @property
    def positions(self) -> Columns:
        """(T,) angles of the four roll joints by `ROLL_JOINTS`, of child against parent about +X, 0 upright [rad].

        These names tell a leg, whichever foot stands. The URDF's own names of these joints are taken too, where the
        robot that the run names is found: about their axes and from their zeros, which may be others. `whole_motion`
        has every joint of the robot under its URDF name.
        """
        return self._by_name(StanceMap.positions_to_urdf, self.q)

    @property
    def velocities(self) -> Columns:
        """(T,) rates of the four roll joints, as `positions` [rad/s]."""
        return self._by_name(StanceMap.velocities_to_urdf, self.dq)

    @property
    def torques(self) -> Columns:
        """(T,) torques of the four roll joints, as `positions` [N m]."""
        return self._by_name(StanceMap.torques_to_urdf, self.u)

    def _by_name(self, convert: Callable[[StanceMap, FloatArray, Stance], FloatArray], values: FloatArray) -> Columns:
        left = (self.stance > 0.0)[:, None]

        def columns(by: StanceMap, others: Callable[[], Columns | None] | None = None) -> Columns:
            found = np.where(left, convert(by, values, Stance.LEFT), convert(by, values, Stance.RIGHT))
            return Columns(by.joint_names, found, others=others)

        return columns(_ABOUT_X, lambda: None if self._urdf_joints is None else columns(self._urdf_joints))

    @cached_property
    def _urdf_joints(self) -> StanceMap | None:
        """The roll joints as the URDF has them; None where the robot of the run is not found."""
        try:
            return told_robot(self.gait, self.robot, unchanged=False).stance_map
        except RobotError:
            return None

    def events(self, kind: str) -> FloatArray:
        """(k,) indices of the events of one kind."""
        return np.array([i for i, name in enumerate(self.event_kind) if name == kind], dtype=np.int64)

    def first_steps(self, count: int) -> "Trajectory":
        """The part of the run up to the impact that ends step ``count``."""
        keep, events = self.step < count, self.event_step < count
        part: dict[str, Any] = {name: getattr(self, name)[keep] for name in SAMPLED}
        part |= {name: getattr(self, name)[events] for name in ("event_t", "event_step", "event_state")}
        part["event_kind"] = tuple(kind for kind, kept in zip(self.event_kind, events, strict=True) if kept)
        part["steps_completed"] = min(self.steps_completed, count)
        part["outcome"] = COMPLETED if count <= self.steps_completed else self.outcome
        return replace(self, **part)

    def post_impact_states(self) -> FloatArray:
        """(k, 8) q and dq right after each impact."""
        return self.event_state[self.events("IMPACT")]

    @property
    def post_impact_speeds(self) -> FloatArray:
        """(k,) dbeta right after each impact [rad/s]."""
        return self.post_impact_states()[:, self.q.shape[1]]


FARTHEST = 1e6
"""Size of a coordinate of a robot that has not diverged [m, rad]."""

FRI_REACH = 1e30
"""Where the ground reaction acts [m]: a force that has all but vanished acts far away."""

LATEST = 1e10
"""Of times [s]: they may count from 1970."""

LONGEST = 30_000.0
"""Of a run [s]: 3000 steps, each of whose two phases lasts as long as the simulator lets it."""

SHORTEST = 1e-30
"""Time between two samples [s] that are not at one time: what is divided by it stays finite."""

EVENT_SLACK = 5.0
"""How far events may lie outside of the samples [s]: as long as a phase lasts at most."""

EVENT_NAMES = frozenset(kind.name for kind in EventKind)

TIME = ArraySchema(least=-LATEST, most=LATEST, ordered=True)
EITHER = ArraySchema(among=(-1.0, 1.0))
STEP = ArraySchema(least=0.0, whole=True, ordered=True)


def event_schema(count: int) -> dict[str, ArraySchema]:
    """What the arrays of so many events are to be, beside the states."""
    return {"event_t": replace(TIME, rows=count), "event_step": ArraySchema(rows=count, least=-1.0, whole=True)}


def require_walk(content: Mapping[str, Any]) -> None:
    """Raise ValueError where the times, steps and events of a run, each of them right, do not go together."""
    t, events, last = content["t"], content["event_t"], int(content["step"][-1])
    if not t[-1] - t[0] <= LONGEST:
        raise ValueError(f"t lasts {t[-1] - t[0]:g} s, a run at most {LONGEST:g}")
    if ((steps := np.diff(t)) > 0.0).any() and (shortest := steps[steps > 0.0].min()) < SHORTEST:
        raise ValueError(f"t has samples {shortest:g} s apart, less than {SHORTEST:g}")
    for time in events[[0, -1]] if len(events) else ():
        if not t[0] - EVENT_SLACK <= time <= t[-1] + EVENT_SLACK:
            raise ValueError(f"event_t = {time:g} lies outside of the run, {t[0]:g} to {t[-1]:g} s")
    if content["steps_completed"] > last + 1:
        raise ValueError(f"steps_completed = {content['steps_completed']}, but the last step has the index {last}")


def _schema(events: int) -> dict[str, ArraySchema]:
    """What the arrays of a run file are to be; NaN where they do not know, and from where the robot has diverged on."""
    by_step = event_schema(events)
    unknown = ArraySchema(gaps=True)
    return {
        "t": TIME,
        "q": ArraySchema((4,), least=-FARTHEST, most=FARTHEST, posture=True),
        "dq": replace(unknown, row=(4,)),
        "u": replace(unknown, row=(4,)),
        "force": replace(unknown, row=(2,)),
        "p_fri": ArraySchema(least=-FRI_REACH, most=FRI_REACH, gaps=True),
        "p_fri_target": unknown,
        "q_b_desired": replace(unknown, row=(3,)),
        "phase": EITHER,
        "stance": EITHER,
        "stance_y": ArraySchema(least=-FARTHEST, most=FARTHEST, posture=True),
        "step": STEP,
        "event_t": by_step["event_t"],
        "event_step": by_step["event_step"],
        "event_state": ArraySchema((8,), rows=events, gaps=True),
    }


_ARRAYS = tuple(_schema(0))
SAMPLED = tuple(name for name, schema in _schema(0).items() if schema.rows is None)
HEADER = {
    "event_kind": words_among(EVENT_NAMES),
    "robot": LINE,
    "outcome": LINE,
    "steps_completed": COUNT,
    "gait": TABLE,
    "settings": TABLE,
}
"""What stands in the header of every run file."""


def save_trajectory(trajectory: Trajectory, path: Path | str) -> None:
    """Write a run file (NPZ, no pickles); it appears whole or not at all."""
    arrays = {name: np.asarray(getattr(trajectory, name), dtype=float) for name in _ARRAYS}
    path = Path(path)
    header = {key: getattr(trajectory, key) for key in HEADER}
    write_archive(path, KIND, header | {"gait": with_stored_description(trajectory.gait, path.parent)}, arrays)


def load_trajectory(path: Path | str) -> Trajectory:
    """Read a run file; what stands in it is checked, all of it.

    Raises:
        TrajectoryFileError: the file is missing, cut off, not a run, or one whose parts are wrong or do not go
            together; one line.
    """
    path = Path(path)
    content = read_archive(path, KIND, HEADER, lambda header: _schema(len(header["event_kind"])), require_walk)
    content["event_kind"] = tuple(content["event_kind"])
    content["gait"] = with_found_description(content["gait"], path.parent)
    return Trajectory(**content)
