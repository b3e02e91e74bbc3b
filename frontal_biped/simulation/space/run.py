"""A recorded walk in space: what every joint and both soles did, sampled in time, and the events. And its run file.

A run file is a NumPy archive (NPZ) without pickles. Its entries are the arrays of `SpatialRun` under their own names
and ``header``, a JSON text with format ("frontal-biped-space-run"), version (1) and the rest of `SpatialRun`.
`numpy.load` reads it without this package; a walk of another simulator can be written with `save_spatial_run` and
watched.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.files.archive import ArchiveKind, read_archive, write_archive
from frontal_biped.files.array_schema import ArraySchema
from frontal_biped.files.counted import counted
from frontal_biped.files.header_schema import NAMES
from frontal_biped.files.kinds import SPACE_RUN
from frontal_biped.files.shown import Plotted, ShownAsPage
from frontal_biped.gait.robot_path import with_found_description, with_stored_description
from frontal_biped.model.space.free_robot import BASE
from frontal_biped.model.space.joint_arrays import ROOT
from frontal_biped.numerics.by_name import Columns
from frontal_biped.simulation.trajectory import (
    COMPLETED,
    EITHER,
    FARTHEST,
    FRI_REACH,
    HEADER,
    STEP,
    TIME,
    event_schema,
    require_walk,
)

KIND = ArchiveKind(SPACE_RUN, 1, "write one with `frontal-biped walk ROBOT -o RUN.npz`")


@dataclass(frozen=True, eq=False)
class SpatialRun(ShownAsPage, Plotted):
    """A walk of a `FreeRobot`, time first, both soles left before right. World: X forward, Y left, Z up, ground z = 0.

    Events appear as two samples at one time, before and after. Frontal states are stance coordinates, as in the plane.

    Attributes:
        t: (T,) time [s].
        q: (T, 7 + n) configurations: xyz and quaternion xyzw of the root link, joint angles [m, rad].
        v: (T, 6 + n) velocities: root link linear and angular in its own axes, joint rates [m/s, rad/s].
        tau: (T, n) joint torques [N m].
        wrench: (T, 2, 6) ground on sole: force [N], moment about the origin of the sole's frame [N m]; world axes.
        contact: (T, 2) 1 where the foot touches the ground, else 0.
        com: (T, 3) centre of mass [m].
        com_velocity: (T, 3) [m/s].
        sole_position: (T, 2, 3) origins of the soles' frames, on the sole below the ankle [m].
        sole_yaw: (T, 2) where they point, about Z from X [rad].
        frontal_q: (T, 4) true frontal state of the stance leg [rad].
        frontal_dq: (T, 4) [rad/s].
        frontal_y: (T, 3) output error q_b - h_d [rad].
        p_fri: (T,) true FRI, along h from the stance ankle [m]; nan while the foot does not bear.
        p_fri_target: (T,) wanted FRI [m].
        cop_x: (T,) centre of pressure ahead of the stance ankle, in the foot's axes [m]; nan likewise.
        cop_target_x: (T,) wanted one [m].
        phase: (T,) +1 rising, -1 falling.
        stance: (T,) +1 left, -1 right.
        step: (T,) index of the step.
        speed_target: (T,) commanded speed forwards [m/s].
        yaw: (T,) of the pelvis [rad].
        foothold: (T, 3) planned x, y [m] and yaw [rad] of the next foot.
        solved: (T,) 1 where the quadratic program was solved with every limit kept, else 0.
        event_t: (E,) time of each event [s].
        event_kind: (E,) its name, as in `Trajectory`.
        event_step: (E,) step it belongs to.
        event_frontal: (E, 8) frontal q and dq right after it (of the new stance leg at an impact).
        robot: name of the robot.
        joint_names: (n) the URDF's, in the order of ``q``, ``v`` and ``tau``.
        locked: joints that were held at the posture.
        outcome: "completed", or what made the robot fall.
        steps_completed: landings survived.
        gait: the gait file's content, or {}.
        settings: of plant and controller, disturbances, what was measured.
    """

    t: FloatArray
    q: FloatArray
    v: FloatArray
    tau: FloatArray
    wrench: FloatArray
    contact: FloatArray
    com: FloatArray
    com_velocity: FloatArray
    sole_position: FloatArray
    sole_yaw: FloatArray
    frontal_q: FloatArray
    frontal_dq: FloatArray
    frontal_y: FloatArray
    p_fri: FloatArray
    p_fri_target: FloatArray
    cop_x: FloatArray
    cop_target_x: FloatArray
    phase: FloatArray
    stance: FloatArray
    step: FloatArray
    speed_target: FloatArray
    yaw: FloatArray
    foothold: FloatArray
    solved: FloatArray
    event_t: FloatArray
    event_kind: tuple[str, ...]
    event_step: FloatArray
    event_frontal: FloatArray
    robot: str
    joint_names: tuple[str, ...]
    locked: tuple[str, ...]
    outcome: str
    steps_completed: int
    gait: Mapping[str, Any] = field(default_factory=dict)
    settings: Mapping[str, Any] = field(default_factory=dict)

    def __repr__(self) -> str:
        way = float(self.com[-1, 0] - self.com[0, 0])
        return (
            f"SpatialRun of {self.robot!r}: {self.outcome}, {counted(self.steps_completed, 'step')}, {way:.2f} m in"
            f" {float(self.t[-1]):.2f} s, {counted(len(self.t), 'sample')};\n"
            f"  positions, velocities, torques by joint, of {len(self.joint_names)} joints"
        )

    @property
    def fell(self) -> bool:
        """Did the robot fall?"""
        return self.outcome != COMPLETED

    @property
    def positions(self) -> Columns:
        """(T,) positions of every joint that moves by its URDF name [rad]."""
        return Columns(self.joint_names, self.q[:, ROOT:])

    @property
    def velocities(self) -> Columns:
        """(T,) velocities of every joint that moves by its URDF name [rad/s]."""
        return Columns(self.joint_names, self.v[:, BASE:])

    @property
    def torques(self) -> Columns:
        """(T,) torques of every joint that moves by its URDF name [N m]."""
        return Columns(self.joint_names, self.tau)

    def events(self, kind: str) -> FloatArray:
        """(k,) indices of the events of one kind."""
        return np.array([i for i, name in enumerate(self.event_kind) if name == kind], dtype=np.int64)

    @property
    def post_impact_speeds(self) -> FloatArray:
        """(k,) frontal dbeta right after each landing [rad/s]."""
        return self.event_frontal[self.events("IMPACT"), self.frontal_q.shape[1]]

    def first_steps(self, count: int) -> "SpatialRun":
        """The part of the run up to the landing that ends step ``count``."""
        keep, events = self.step < count, self.event_step < count
        part: dict[str, Any] = {name: getattr(self, name)[keep] for name in SAMPLED}
        part |= {name: getattr(self, name)[events] for name in ("event_t", "event_step", "event_frontal")}
        part["event_kind"] = tuple(kind for kind, kept in zip(self.event_kind, events, strict=True) if kept)
        part["steps_completed"] = min(self.steps_completed, count)
        part["outcome"] = COMPLETED if count <= self.steps_completed else self.outcome
        return replace(self, **part)


UNIT = 1e-2
"""How far the length of a quaternion may be off from 1."""

_PLACE = ArraySchema(least=-FARTHEST, most=FARTHEST)
_FLAG = ArraySchema(among=(0.0, 1.0))
_PRESSURE = ArraySchema(least=-FRI_REACH, most=FRI_REACH, gaps=True)


def _schema(joints: int, events: int) -> dict[str, ArraySchema]:
    """What the arrays of a run file are to be; NaN where they do not know, and from where the robot has diverged on."""
    unknown, by_step = ArraySchema(gaps=True), event_schema(events)
    return {
        "t": TIME,
        "q": replace(_PLACE, row=(ROOT + joints,), posture=True),
        "v": replace(unknown, row=(BASE + joints,)),
        "tau": replace(unknown, row=(joints,)),
        "wrench": replace(unknown, row=(2, 6)),
        "contact": replace(_FLAG, row=(2,)),
        "com": replace(_PLACE, row=(3,)),
        "com_velocity": replace(unknown, row=(3,)),
        "sole_position": replace(_PLACE, row=(2, 3)),
        "sole_yaw": replace(_PLACE, row=(2,)),
        "frontal_q": replace(unknown, row=(4,)),
        "frontal_dq": replace(unknown, row=(4,)),
        "frontal_y": replace(unknown, row=(3,)),
        "p_fri": _PRESSURE,
        "p_fri_target": unknown,
        "cop_x": _PRESSURE,
        "cop_target_x": unknown,
        "phase": EITHER,
        "stance": EITHER,
        "step": STEP,
        "speed_target": unknown,
        "yaw": _PLACE,
        "foothold": replace(_PLACE, row=(3,), gaps=True),
        "solved": _FLAG,
        "event_t": by_step["event_t"],
        "event_step": by_step["event_step"],
        "event_frontal": ArraySchema((8,), rows=events, gaps=True),
    }


def _require_walk(content: Mapping[str, Any]) -> None:
    """As in the plane, and quaternions of length 1."""
    require_walk(content)
    q = content["q"]
    lengths = np.linalg.norm(q[np.abs(q).max(axis=1) <= FARTHEST, 3:ROOT], axis=1)  # until it diverges
    if len(wrong := np.flatnonzero(np.abs(lengths - 1.0) > UNIT)):
        raise ValueError(f"q[{wrong[0]}, 3:7] has the length {lengths[wrong[0]]:g}, a quaternion has 1")


_ARRAYS = tuple(_schema(0, 0))
SAMPLED = tuple(name for name, schema in _schema(0, 0).items() if schema.rows is None)
_HEADER = HEADER | {"joint_names": NAMES, "locked": NAMES}


def save_spatial_run(run: SpatialRun, path: Path | str) -> None:
    """Write a run file (NPZ, no pickles); it appears whole or not at all."""
    arrays = {name: np.asarray(getattr(run, name), dtype=float) for name in _ARRAYS}
    path = Path(path)
    header = {key: getattr(run, key) for key in _HEADER}
    write_archive(path, KIND, header | {"gait": with_stored_description(run.gait, path.parent)}, arrays)


def load_spatial_run(path: Path | str) -> SpatialRun:
    """Read a run file; what stands in it is checked, all of it.

    Raises:
        TrajectoryFileError: the file is missing, cut off, not a walk in space, or one whose parts are wrong or do not
            go together; one line.
    """
    path = Path(path)
    content = read_archive(
        path,
        KIND,
        _HEADER,
        lambda header: _schema(len(header["joint_names"]), len(header["event_kind"])),
        _require_walk,
    )
    content["gait"] = with_found_description(content["gait"], path.parent)
    return SpatialRun(**content | {key: tuple(content[key]) for key in ("event_kind", "joint_names", "locked")})
