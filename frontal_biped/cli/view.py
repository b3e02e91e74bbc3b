"""`frontal-biped view`: runs in the browser, live or as one offline page."""

import argparse
import sys
from pathlib import Path

from frontal_biped.cli.main import SUCCESS
from frontal_biped.cli.progress import Progress
from frontal_biped.exceptions import FrontalBipedError
from frontal_biped.files.atomic import require_parent, write_text
from frontal_biped.gait.file import load_gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.catalogue import load_robot
from frontal_biped.simulation.trajectory import Trajectory, load_trajectory

VIEWED_STEPS = 6
"""Walked when a gait is viewed."""

Watched = tuple[FrontalBiped, Trajectory]


def watched(source: Path, robot: str | None, steps: int = VIEWED_STEPS) -> Watched:
    """Robot and run of a run file, whoever made it; or of a gait file, which is walked first.

    Args:
        source: gait (.json) or run (.npz).
        robot: name or file of the robot; None: the one that the file names.
        steps: of the walk.
    """
    from frontal_biped.cli.commands import _gait_of, _robot_of, _walk

    if source.suffix == ".npz":
        run = load_trajectory(source)
        if "format" in run.gait:
            return _robot_of(_gait_of(run, source), argparse.Namespace(robot=robot)), run
        try:
            return load_robot(robot or run.robot), run
        except FrontalBipedError as error:
            if robot:
                raise
            raise FrontalBipedError(f"{source}: its robot cannot be loaded: {error}; name it with --robot") from None
    gait = load_gait(source)
    biped = _robot_of(gait, argparse.Namespace(robot=robot))
    return biped, _walk(biped, gait, steps, period=1e-3)


def run_view(arguments: argparse.Namespace) -> int:
    """`frontal-biped view`."""
    from frontal_biped.viewer.live import view_live
    from frontal_biped.viewer.page import animation_page

    if arguments.html is not None:
        require_parent(arguments.html)
    if arguments.overlay and arguments.beside is None:
        raise FrontalBipedError("--overlay: lays a second run over the first; name a second file")
    biped, run = watched(arguments.source, arguments.robot)
    beside = None if arguments.beside is None else watched(arguments.beside, arguments.robot)
    title = biped.name if beside is None else f"{arguments.source.stem} and {arguments.beside.stem}"
    if arguments.html is not None:
        with Progress("drawing the page"):
            page = animation_page(
                biped, run, title=title, ghost=arguments.ghost, beside=beside, overlay=arguments.overlay
            )
        write_text(arguments.html, page)
        sys.stdout.write(
            f"{arguments.html}: {arguments.html.stat().st_size / 1e6:.2f} MB, opens in any browser, offline\n"
        )
        return SUCCESS
    view_live(
        biped,
        run,
        open_browser=not arguments.no_open,
        title=title,
        port=arguments.port,
        ghost=arguments.ghost,
        beside=beside,
        overlay=arguments.overlay,
    )
    return SUCCESS
