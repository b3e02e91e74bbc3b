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
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.csv_table import check_coordinates, table_rows
from frontal_biped.simulation.space.resampling import drawable_part, resample_spatial
from frontal_biped.simulation.space.run import SpatialRun
from frontal_biped.simulation.space.soles import pressure_in_sole
from frontal_biped.simulation.whole_columns import base_columns, joint_columns
from frontal_biped.simulation.whole_robot import whole_motion
from frontal_biped.simulation.world import FEET, even_times
from frontal_biped.virtual_constraints.phase import StepPhase


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
    check_coordinates(coordinates)
    motion = whole_motion(robot, run, rate)
    run = drawable_part(run)
    if rate is not None:
        run = resample_spatial(run, even_times(run.t, rate))
    columns: dict[str, list[Any]] = {
        "time [s]": run.t.tolist(),
        "step [-]": (run.step.astype(int) + 1).tolist(),
        "stance [left/right]": [Stance.of_sign(sign).value for sign in run.stance],
        "phase [rising/falling]": [StepPhase.of_sign(sign).value for sign in run.phase],
    }
    if coordinates != "stance":
        columns |= base_columns(motion) | joint_columns(motion, held_torques=False) | _ground_columns(run)
    if coordinates != "urdf":
        columns |= _frontal_columns(run)
    return list(columns), table_rows(columns)


def _ground_columns(run: SpatialRun) -> dict[str, list[Any]]:
    table: dict[str, list[Any]] = {}
    pressure = pressure_in_sole(run)
    for i, foot in enumerate(FEET):
        sole = f"{foot.value} sole"
        table[f"{sole} contact [0/1]"] = run.contact[:, i].astype(int).tolist()
        table |= {f"{sole} force {axis} [N]": run.wrench[:, i, j].tolist() for j, axis in enumerate("xyz")}
        table |= {f"{sole} moment {axis} [N m]": run.wrench[:, i, 3 + j].tolist() for j, axis in enumerate("xyz")}
        table |= {f"{sole} {axis} [m]": run.sole_position[:, i, j].tolist() for j, axis in enumerate("xyz")}
        table[f"{sole} yaw [rad]"] = run.sole_yaw[:, i].tolist()
        table |= {f"{sole} centre of pressure {axis} [m]": _or_empty(pressure[:, i, j]) for j, axis in enumerate("xy")}
    table |= {f"centre of mass {axis} [m]": run.com[:, i].tolist() for i, axis in enumerate("xyz")}
    table |= {f"centre of mass velocity {axis} [m/s]": run.com_velocity[:, i].tolist() for i, axis in enumerate("xyz")}
    table["commanded speed [m/s]"] = run.speed_target.tolist()
    return table


def _or_empty(values: FloatArray) -> list[Any]:
    return [value if np.isfinite(value) else "" for value in values.tolist()]


def _frontal_columns(run: SpatialRun) -> dict[str, list[float]]:
    chain = [name.replace(" ", "_") for name in JOINTS]
    table: dict[str, list[float]] = {}
    for kind, unit, values in (("q", "rad", run.frontal_q), ("dq", "rad/s", run.frontal_dq)):
        table |= {f"{kind}{i + 1} {name} [{unit}]": values[:, i].tolist() for i, name in enumerate(chain)}
    table |= {f"y{i + 1} {name} [rad]": run.frontal_y[:, i].tolist() for i, name in enumerate(chain[1:])}
    table["p_FRI [m]"] = run.p_fri.tolist()
    table["desired p_FRI [m]"] = run.p_fri_target.tolist()
    table["CoP_x [m]"] = run.cop_x.tolist()
    table["desired CoP_x [m]"] = run.cop_target_x.tolist()
    return table
