"""What a command is given: a gait or a run, and the robot it is of."""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from frontal_biped.cli.progress import Progress
from frontal_biped.exceptions import FrontalBipedError, GaitFileError
from frontal_biped.files.kinds import RUN, SPACE_RUN, archive_format
from frontal_biped.gait.file import any_gait_from_dict, gait_of_run, load_gait
from frontal_biped.gait.gait import Gait
from frontal_biped.gait.robot_path import description_file
from frontal_biped.gait.support_file import FiledGait, load_filed_gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.catalogue import load_robot
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.simulation.orbit import VIEWED_STEPS, orbit_trajectory
from frontal_biped.simulation.space.run import SpatialRun, load_spatial_run
from frontal_biped.simulation.trajectory import Trajectory, load_trajectory
from frontal_biped.simulation.walking import simulate


class Source(NamedTuple):
    """What a gait or run file holds.

    Attributes:
        biped: its robot.
        gait: its gait; None of a run that does not tell, or that travels sideways.
        run: the run, or one of the gait.
    """

    biped: FrontalBiped
    gait: Gait | None
    run: Trajectory


def walked(biped: FrontalBiped, gait: Gait) -> Trajectory:
    """A short walk at 1 kHz."""
    with Progress("walking: step", VIEWED_STEPS) as progress:
        return simulate(biped, gait, steps=VIEWED_STEPS, period=1e-3, on_step=lambda done: progress.update("", done))


def load_source(path: Path, robot: str | None, run_of: Callable[[FrontalBiped, Gait], Trajectory] = walked) -> Source:
    """Robot, gait and run of a run file, whoever made it; or of a gait file.

    Args:
        path: gait (.json) or run (.npz).
        robot: name or file of the robot; None: the one that the file names.
        run_of: makes a run of a gait.
    """
    if path.suffix != ".npz" and archive_format(path) != RUN:
        biped, gait = load_walker(path, robot)
        return Source(biped, gait, run_of(biped, gait))
    run = load_trajectory(path)
    if "format" in run.gait:
        told = any_gait_from_dict(dict(run.gait), f"{path}: gait")
        return Source(robot_of(told, robot, path), told if isinstance(told, Gait) else None, run)
    return Source(_robot_of_run(path, run.robot, robot), None, run)


def _robot_of_run(path: Path, named: str, robot: str | None) -> FrontalBiped:
    beside = path.with_name(f"{Path(named).name}.toml")
    try:
        return load_robot(robot or (beside if beside.is_file() else named))
    except FrontalBipedError as error:
        if robot:
            raise
        raise FrontalBipedError(f"{path}: its robot cannot be loaded: {error}; name it with --robot") from None


class SpatialSource(NamedTuple):
    """What the run file of a walk in space holds.

    Attributes:
        robot: its robot.
        gait: its gait; None of a run that does not tell.
        run: the walk.
        orbit: one step of the gait in closed form; None without a gait.
    """

    robot: FreeRobot
    gait: Gait | None
    run: SpatialRun
    orbit: Trajectory | None


def is_spatial(path: Path) -> bool:
    """Is a file the run file of a walk in space?"""
    return archive_format(path) == SPACE_RUN


def load_spatial_source(path: Path, robot: str | None) -> SpatialSource:
    """Robot, gait and walk of a run file for which `is_spatial` holds.

    Args:
        path: of the run file.
        robot: name or file of the robot; None: the one that the run names.

    Raises:
        FrontalBipedError: the robot is not found, or has other joints than the run.
    """
    run = load_spatial_run(path)
    gait = gait_of_run(run.gait, f"{path}: gait")
    biped = robot_of(gait, robot, path) if gait is not None else _robot_of_run(path, run.robot, robot)
    free = FreeRobot(biped.robot)
    if free.joint_names != run.joint_names:
        strange = set(free.joint_names) ^ set(run.joint_names)
        raise FrontalBipedError(
            f"{path}: the run has {len(run.joint_names)} joints, {free.name} moves {len(free.joint_names)}"
            f" ({', '.join(sorted(strange)[:4]) or 'in another order'}); name the robot of the run with --robot"
        )
    return SpatialSource(free, gait, run, None if gait is None else orbit_trajectory(biped, gait, 1))


def watched(path: Path, robot: str | None) -> tuple[FrontalBiped, Trajectory]:
    """Robot and run of `load_source`; of a gait its periodic orbit, which the page says."""
    source = load_source(path, robot, lambda biped, gait: orbit_trajectory(biped, gait, VIEWED_STEPS))
    return source.biped, source.run


def load_walker(path: Path, robot: str | None) -> tuple[FrontalBiped, Gait]:
    """The gait of a file, and the robot that walks it."""
    gait = load_gait(path)
    return robot_of(gait, robot, path), gait


def load_filed_walker(path: Path, robot: str | None) -> tuple[FrontalBiped, FiledGait]:
    """The gait of a file, of any kind, and the robot that walks it."""
    gait = load_filed_gait(path)
    return robot_of(gait, robot, path), gait


def robot_of(gait: FiledGait, robot: str | None, path: Path) -> FrontalBiped:
    """The robot asked for, or the one the gait names; says so when it is not the one the gait was designed for.

    Args:
        gait: the gait.
        robot: name or file of the robot; None: the one that the gait names.
        path: of the gait or run file, for complaints.
    """
    biped = load_robot(robot) if robot else _named_robot(gait, path)
    if biped.fingerprint != gait.robot.fingerprint:
        sys.stderr.write(
            f"frontal-biped: warning: the gait was designed for {gait.robot.name!r} with another URDF or description"
            f" than {biped.path.name}\n"
        )
    return biped


def _named_robot(gait: FiledGait, path: Path) -> FrontalBiped:
    file = description_file(gait.robot.description)
    if not file.is_file():
        raise GaitFileError(
            f"{path}: its robot {gait.robot.name!r} is not there: no {file}, no {file.name} beside {path.name}, and"
            f" none that comes with the package; name it with --robot"
        )
    try:
        return load_robot(file)
    except FrontalBipedError as error:
        raise GaitFileError(f"{path}: its robot cannot be loaded: {error}; name it with --robot") from None
