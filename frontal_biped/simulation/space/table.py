"""A walk in space as a table of numbers: ``frontal-biped export RUN.npz -o run.csv``.

One line a sample (``--rate 200``: evenly spaced), units in the header: time, step, stance foot, phase; pose and
velocity of the root link; position, velocity and torque of every joint under its URDF name, the position alone of a
joint that is held; wrench and contact of both soles, centres of mass and pressure. ``--coordinates stance`` gives the
frontal state in the paper's coordinates instead, ``both`` gives both.
"""

from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.model.chain import JOINTS
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.simulation.csv_table import Column, check_coordinates, step_columns, table_rows
from frontal_biped.simulation.space.resampling import drawable_part, resample_spatial
from frontal_biped.simulation.space.run import SpatialRun
from frontal_biped.simulation.space.soles import pressure_in_sole
from frontal_biped.simulation.whole_columns import base_columns, joint_columns
from frontal_biped.simulation.whole_robot import whole_motion
from frontal_biped.simulation.world import FEET, even_times


def spatial_table(
    robot: FreeRobot, run: SpatialRun, coordinates: str = "urdf", rate: float | None = None
) -> tuple[list[str], list[list[str]]]:
    """Header and rows of a walk in space.

    Args:
        robot: the robot.
        run: its walk.
        coordinates: one of `COORDINATES`.
        rate: rows per second; None: the samples of the run, of which an event has two at one time.

    Returns:
        Names with their units in brackets, and as many texts in each row; numbers at full precision, none where there
        is none.
    """
    columns = spatial_columns(robot, run, coordinates, rate)
    return list(columns), list(table_rows(columns))


def spatial_columns(
    robot: FreeRobot, run: SpatialRun, coordinates: str = "urdf", rate: float | None = None
) -> dict[str, Column]:
    """The columns of `spatial_table` by their names."""
    check_coordinates(coordinates)
    motion = whole_motion(robot, run, rate)
    run = drawable_part(run)
    if rate is not None:
        run = resample_spatial(run, even_times(run.t, rate))
    columns: dict[str, Column] = step_columns(run)
    if coordinates != "stance":
        columns |= {**base_columns(motion), **joint_columns(motion, held_torques=False), **_ground_columns(run)}
    if coordinates != "urdf":
        columns |= _frontal_columns(run)
    return columns


def _ground_columns(run: SpatialRun) -> dict[str, Column]:
    table: dict[str, Column] = {}
    pressure = pressure_in_sole(run)
    for i, foot in enumerate(FEET):
        sole = f"{foot.value} sole"
        table[f"{sole} contact [0/1]"] = run.contact[:, i].astype(np.int64)
        table |= {f"{sole} force {axis} [N]": run.wrench[:, i, j] for j, axis in enumerate("xyz")}
        table |= {f"{sole} moment {axis} [N m]": run.wrench[:, i, 3 + j] for j, axis in enumerate("xyz")}
        table |= {f"{sole} {axis} [m]": run.sole_position[:, i, j] for j, axis in enumerate("xyz")}
        table[f"{sole} yaw [rad]"] = run.sole_yaw[:, i]
        table |= {f"{sole} centre of pressure {axis} [m]": _or_empty(pressure[:, i, j]) for j, axis in enumerate("xy")}
    table |= {f"centre of mass {axis} [m]": run.com[:, i] for i, axis in enumerate("xyz")}
    table |= {f"centre of mass velocity {axis} [m/s]": run.com_velocity[:, i] for i, axis in enumerate("xyz")}
    table["commanded speed [m/s]"] = run.speed_target
    return table


def _or_empty(values: FloatArray) -> list[Any]:
    return [value if np.isfinite(value) else "" for value in values.tolist()]


def _frontal_columns(run: SpatialRun) -> dict[str, Column]:
    chain = [name.replace(" ", "_") for name in JOINTS]
    table: dict[str, Column] = {}
    for kind, unit, values in (("q", "rad", run.frontal_q), ("dq", "rad/s", run.frontal_dq)):
        table |= {f"{kind}{i + 1} {name} [{unit}]": values[:, i] for i, name in enumerate(chain)}
    table |= {f"y{i + 1} {name} [rad]": run.frontal_y[:, i] for i, name in enumerate(chain[1:])}
    table["p_FRI [m]"] = run.p_fri
    table["desired p_FRI [m]"] = run.p_fri_target
    table["CoP_x [m]"] = run.cop_x
    table["desired CoP_x [m]"] = run.cop_target_x
    return table
