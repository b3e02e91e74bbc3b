"""What a command is given: a gait or a run, and the robot it is of."""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from frontal_biped.cli.progress import Progress
from frontal_biped.exceptions import FrontalBipedError, GaitFileError
from frontal_biped.gait.file import gait_from_dict, load_gait
from frontal_biped.gait.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.catalogue import load_robot
from frontal_biped.simulation.trajectory import Trajectory, load_trajectory
from frontal_biped.simulation.walking import simulate

VIEWED_STEPS = 6
"""Walked when a gait is shown."""


class Source(NamedTuple):
    """What a gait or run file holds.

    Attributes:
        biped: its robot.
        gait: its gait; None of a run that does not tell.
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
    if path.suffix != ".npz":
        biped, gait = load_walker(path, robot)
        return Source(biped, gait, run_of(biped, gait))
    run = load_trajectory(path)
    if "format" in run.gait:
        gait = gait_from_dict(dict(run.gait), f"{path}: gait")
        return Source(robot_of(gait, robot), gait, run)
    try:
        return Source(load_robot(robot or run.robot), None, run)
    except FrontalBipedError as error:
        if robot:
            raise
        raise FrontalBipedError(f"{path}: its robot cannot be loaded: {error}; name it with --robot") from None


def watched(path: Path, robot: str | None) -> tuple[FrontalBiped, Trajectory]:
    """Robot and run of `load_source`."""
    source = load_source(path, robot)
    return source.biped, source.run


def load_walker(path: Path, robot: str | None) -> tuple[FrontalBiped, Gait]:
    """The gait of a file, and the robot that walks it."""
    gait = load_gait(path)
    return robot_of(gait, robot), gait


def robot_of(gait: Gait, robot: str | None) -> FrontalBiped:
    """The robot asked for, or the one the gait names; says so when it is not the one the gait was designed for."""
    try:
        biped = load_robot(robot or gait.robot.name)
    except FrontalBipedError as error:
        if robot:
            raise
        raise GaitFileError(f"the gait's robot cannot be loaded: {error}; name it with --robot") from None
    if biped.fingerprint != gait.robot.fingerprint:
        sys.stderr.write(
            f"frontal-biped: warning: the gait was designed for {gait.robot.name!r} with another URDF or description"
            f" than {biped.path.name}\n"
        )
    return biped
