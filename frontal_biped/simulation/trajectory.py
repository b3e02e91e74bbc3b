"""A recorded run: what the robot did, sampled in time, and the events of every step. And the run file.

A run file is a NumPy archive (NPZ) without pickles. Its entries are the arrays of `Trajectory` under their own names
(t, q, dq, u, force, p_fri, p_fri_target, q_b_desired, phase, stance, stance_y, step, event_t, event_step, event_state)
and ``header``, a JSON text with format ("frontal-biped-run"), version (1), event_kind, robot, outcome,
steps_completed, gait (the whole gait file) and settings. `numpy.load` reads it without this package; a run from another
simulator can be written with `save_trajectory` and watched.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import RobotError
from frontal_biped.files.archive import ArchiveKind, read_archive, write_archive
from frontal_biped.files.counted import counted
from frontal_biped.files.kinds import RUN
from frontal_biped.files.shown import Plotted, ShownAsPage
from frontal_biped.gait.robot_path import with_found_description, with_stored_description
from frontal_biped.gait.told_robot import told_robot
from frontal_biped.model.stance_map import Stance, StanceMap
from frontal_biped.model.urdf.description import ROLL_JOINTS
from frontal_biped.numerics.by_name import Columns

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


_ARRAYS = tuple(f.name for f in fields(Trajectory) if f.type is FloatArray or f.type == "FloatArray")
SAMPLED = tuple(name for name in _ARRAYS if not name.startswith("event_"))
_TEXT = ("event_kind", "robot", "outcome", "steps_completed", "gait", "settings")


def save_trajectory(trajectory: Trajectory, path: Path | str) -> None:
    """Write a run file (NPZ, no pickles); it appears whole or not at all."""
    arrays = {name: getattr(trajectory, name) for name in _ARRAYS}
    path = Path(path)
    header = {key: getattr(trajectory, key) for key in _TEXT}
    write_archive(path, KIND, header | {"gait": with_stored_description(trajectory.gait, path.parent)}, arrays)


def load_trajectory(path: Path | str) -> Trajectory:
    """Read a run file.

    Raises:
        TrajectoryFileError: the file is missing, cut off, or not a run.
    """
    path = Path(path)
    content = read_archive(path, KIND, _TEXT, _ARRAYS)
    content["event_kind"] = tuple(content["event_kind"])
    content["gait"] = with_found_description(content["gait"], path.parent)
    return Trajectory(**content)
