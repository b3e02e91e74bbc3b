"""A run as a table of numbers, for controllers that are not ours.

``frontal-biped export RUN.npz -o run.csv`` writes one line per sample (``--rate 200``: evenly spaced) with units in the
header: time, step, stance foot, phase; pose and velocity of the root link, world X forward, Y left, Z up; then, under
the URDF's names, position, velocity and torque of each joint that moves, position, held and torque, held of every
other; which sole is in contact; desired position of each of the four roll joints (not with virtual legs, where none of
the joints is one of the planar robot's); ground reaction and FRI. `frontal_biped.model.space.whole_placing` says where
pose and torques come from. ``--coordinates stance`` gives the paper's coordinates, ``both`` gives both. Of a gait file
it is the periodic orbit in closed form.
"""

import csv
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, TextIO

import numpy as np

from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.chain import JOINTS
from frontal_biped.model.space.whole_motion import WholeMotion
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.trajectory import Trajectory
from frontal_biped.simulation.whole_columns import base_columns, contact_columns, joint_columns
from frontal_biped.simulation.whole_robot import whole_motion
from frontal_biped.simulation.world import Phased, drawable, even_times, resample
from frontal_biped.virtual_constraints.phase import StepPhase

COORDINATES = ("urdf", "stance", "both")
"""URDF joints by name; the paper's stance coordinates; or both."""

Column = Sequence[Any] | np.ndarray[Any, Any]
"""What stands under one name: numbers or texts."""

_BLOCK = 1000  # rows that are there as texts at a time
_CHAIN = tuple(name.replace(" ", "_") for name in JOINTS)


def run_table(
    biped: FrontalBiped, trajectory: Trajectory, coordinates: str = "urdf", rate: float | None = None
) -> tuple[list[str], list[list[str]]]:
    """Header and rows of a run.

    In URDF coordinates every joint of the URDF carries its name, sign and zero there; the ground reaction is that of
    the room (y to the robot's left, z up) and the FRI is a place y in it. In stance coordinates they are the paper's.

    Args:
        biped: the robot.
        trajectory: the run.
        coordinates: one of `COORDINATES`.
        rate: rows per second; None: the samples of the run, of which an event has two at one time.

    Returns:
        Names with their units in brackets, and as many texts in each row; numbers at full precision.
    """
    columns = run_columns(biped, trajectory, coordinates, rate)
    return list(columns), list(table_rows(columns))


def run_columns(
    biped: FrontalBiped, trajectory: Trajectory, coordinates: str = "urdf", rate: float | None = None
) -> dict[str, Column]:
    """The columns of `run_table` by their names."""
    check_coordinates(coordinates)
    run = drawable(trajectory)
    if rate is not None:
        run = resample(run, even_times(run.t, rate))
    columns: dict[str, Column] = step_columns(run)
    if coordinates != "stance":
        columns |= _urdf_columns(biped, run, whole_motion(biped, trajectory, rate))
    if coordinates != "urdf":
        columns |= _stance_columns(run)
    return columns


def step_columns(run: Phased) -> dict[str, Column]:
    """Time, step, stance foot and phase: how every table begins."""
    return {
        "time [s]": run.t,
        "step [-]": run.step.astype(np.int64) + 1,
        "stance [left/right]": [Stance.of_sign(sign).value for sign in run.stance],
        "phase [rising/falling]": [StepPhase.of_sign(sign).value for sign in run.phase],
    }


def check_coordinates(coordinates: str) -> None:
    """Raise ValueError for a name that is none of `COORDINATES`."""
    if coordinates not in COORDINATES:
        raise ValueError(f"coordinates = {coordinates!r} is none of {', '.join(COORDINATES)}")


def table_rows(columns: Mapping[str, Column]) -> Iterator[list[str]]:
    """The rows of a table, one after the other, numbers as texts at full precision."""
    count = len(next(iter(columns.values())))
    for start in range(0, count, _BLOCK):
        parts = [column[start : start + _BLOCK] for column in columns.values()]
        for row in zip(*(part.tolist() if isinstance(part, np.ndarray) else part for part in parts), strict=True):
            yield [value if isinstance(value, str) else repr(value) for value in row]


def write_csv(stream: TextIO, header: Iterable[str], rows: Iterable[list[str]]) -> None:
    """Write a table as comma-separated text, one header line."""
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(rows)


def _urdf_columns(biped: FrontalBiped, run: Trajectory, motion: WholeMotion) -> dict[str, Column]:
    table: dict[str, Column] = {
        **base_columns(motion),
        **joint_columns(motion, held_torques=True),
        **contact_columns(motion),
    }
    if not biped.description.virtual_legs:
        chart = biped.stance_map
        wanted = np.concatenate([run.q[:, :1], run.q_b_desired], axis=1)
        places = np.array(
            [chart.positions_to_urdf(row, Stance.of_sign(sign)) for row, sign in zip(wanted, run.stance, strict=True)]
        )
        table |= {f"{name} desired position [rad]": places[:, i] for i, name in enumerate(chart.joint_names)}
    table["fri y [m]"] = run.stance_y - run.stance * run.p_fri
    table["desired fri y [m]"] = run.stance_y - run.stance * run.p_fri_target
    table["stance ankle y [m]"] = run.stance_y
    table["ground reaction y [N]"] = -run.stance * run.force[:, 0]
    table["ground reaction z [N]"] = run.force[:, 1]
    return table


def _stance_columns(run: Trajectory) -> dict[str, Column]:
    table: dict[str, Column] = {}
    for kind, unit, values in (("q", "rad", run.q), ("dq", "rad/s", run.dq), ("u", "N m", run.u)):
        table |= {f"{kind}{i + 1} {name} [{unit}]": values[:, i] for i, name in enumerate(_CHAIN)}
    table |= {f"h_d{i + 2} {name} [rad]": run.q_b_desired[:, i] for i, name in enumerate(_CHAIN[1:])}
    table["p_FRI [m]"] = run.p_fri
    table["desired p_FRI [m]"] = run.p_fri_target
    table["F_h [N]"] = run.force[:, 0]
    table["F_v [N]"] = run.force[:, 1]
    return table
