"""A run as a table of numbers, for controllers that are not ours.

``frontal-biped export RUN.npz -o run.csv`` writes one line per sample (``--rate 200``: evenly spaced) with units in the
header: time, step, stance foot, phase; then, under the URDF's joint names, position, desired position, velocity and
torque of each of the four joints; ground reaction and FRI. ``--coordinates stance`` gives the paper's coordinates,
``both`` gives both. Of a gait file it is the periodic orbit in closed form.
"""

import csv
import io
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.chain import JOINTS
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.trajectory import Trajectory
from frontal_biped.simulation.world import drawable, resample
from frontal_biped.virtual_constraints.phase import StepPhase

COORDINATES = ("urdf", "stance", "both")
"""URDF joints by name; the paper's stance coordinates; or both."""

_CHAIN = tuple(name.replace(" ", "_") for name in JOINTS)


def run_table(
    biped: FrontalBiped, trajectory: Trajectory, coordinates: str = "urdf", rate: float | None = None
) -> tuple[list[str], list[list[str]]]:
    """Header and rows of a run.

    In URDF coordinates the joints carry the URDF's names, signs and zeros; the ground reaction is that of the room
    (y to the robot's left, z up) and the FRI is a place y in it. In stance coordinates they are the paper's.

    Args:
        biped: the robot.
        trajectory: the run.
        coordinates: one of `COORDINATES`.
        rate: rows per second; None: the samples of the run, of which an event has two at one time.

    Returns:
        Names with their units in brackets, and as many texts in each row; numbers at full precision.
    """
    check_coordinates(coordinates)
    run = drawable(trajectory)
    if rate is not None:
        run = resample(run, even_times(run.t, rate))
    columns: dict[str, list[Any]] = {
        "time [s]": run.t.tolist(),
        "step [-]": (run.step.astype(int) + 1).tolist(),
        "stance [left/right]": [Stance.of_sign(sign).value for sign in run.stance],
        "phase [rising/falling]": [StepPhase.of_sign(sign).value for sign in run.phase],
    }
    if coordinates != "stance":
        columns |= _urdf_columns(biped, run)
    if coordinates != "urdf":
        columns |= _stance_columns(run)
    return list(columns), table_rows(columns)


def check_coordinates(coordinates: str) -> None:
    """Raise ValueError for a name that is none of `COORDINATES`."""
    if coordinates not in COORDINATES:
        raise ValueError(f"coordinates = {coordinates!r} is none of {', '.join(COORDINATES)}")


def even_times(t: FloatArray, rate: float) -> FloatArray:
    """(K,) instants at a rate [1/s], from the first sample of a run to its last at t (T,) [s]."""
    return t[0] + np.arange(int(np.floor((t[-1] - t[0]) * rate + 1e-9)) + 1) / rate


def table_rows(columns: Mapping[str, Sequence[Any]]) -> list[list[str]]:
    """The rows of a table, numbers as texts at full precision."""
    return [
        [value if isinstance(value, str) else repr(value) for value in row]
        for row in zip(*columns.values(), strict=True)
    ]


def table_csv(header: list[str], rows: list[list[str]]) -> str:
    """The table as comma-separated text, one header line."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(rows)
    return text.getvalue()


def _urdf_columns(biped: FrontalBiped, run: Trajectory) -> dict[str, list[float]]:
    chart = biped.stance_map

    def mapped(convert: Any, values: FloatArray) -> FloatArray:
        return np.array([convert(row, Stance.of_sign(sign)) for row, sign in zip(values, run.stance, strict=True)])

    table: dict[str, list[float]] = {}
    wanted = np.concatenate([run.q[:, :1], run.q_b_desired], axis=1)
    for kind, unit, values in (
        ("position", "rad", mapped(chart.positions_to_urdf, run.q)),
        ("desired position", "rad", mapped(chart.positions_to_urdf, wanted)),
        ("velocity", "rad/s", mapped(chart.velocities_to_urdf, run.dq)),
        ("torque", "N m", mapped(chart.torques_to_urdf, run.u)),
    ):
        table |= {f"{name} {kind} [{unit}]": values[:, i].tolist() for i, name in enumerate(chart.joint_names)}
    table["fri y [m]"] = (run.stance_y - run.stance * run.p_fri).tolist()
    table["desired fri y [m]"] = (run.stance_y - run.stance * run.p_fri_target).tolist()
    table["stance ankle y [m]"] = run.stance_y.tolist()
    table["ground reaction y [N]"] = (-run.stance * run.force[:, 0]).tolist()
    table["ground reaction z [N]"] = run.force[:, 1].tolist()
    return table


def _stance_columns(run: Trajectory) -> dict[str, list[float]]:
    table: dict[str, list[float]] = {}
    for kind, unit, values in (("q", "rad", run.q), ("dq", "rad/s", run.dq), ("u", "N m", run.u)):
        table |= {f"{kind}{i + 1} {name} [{unit}]": values[:, i].tolist() for i, name in enumerate(_CHAIN)}
    table |= {f"h_d{i + 2} {name} [rad]": run.q_b_desired[:, i].tolist() for i, name in enumerate(_CHAIN[1:])}
    table["p_FRI [m]"] = run.p_fri.tolist()
    table["desired p_FRI [m]"] = run.p_fri_target.tolist()
    table["F_h [N]"] = run.force[:, 0].tolist()
    table["F_v [N]"] = run.force[:, 1].tolist()
    return table
