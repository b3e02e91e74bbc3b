"""`frontal-biped view`: runs in the browser, live or as one offline page."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from frontal_biped.cli.arguments import add_no_open, add_page, add_robot, add_source, port
from frontal_biped.cli.exit_status import SUCCESS
from frontal_biped.cli.output import require_output
from frontal_biped.cli.progress import Progress
from frontal_biped.cli.surroundings import write_out
from frontal_biped.exceptions import FrontalBipedError

if TYPE_CHECKING:
    from frontal_biped.viewer.page import Show

SUMMARY = "Watch a gait, a run or a robot's joints in the browser: live, or as one self-contained page."
EXAMPLE = "frontal-biped view run.npz --html page.html"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """One or two runs, how they are drawn, and where."""
    add_source(parser, robot=True)
    parser.add_argument("beside", metavar="SECOND", type=Path, nargs="?", help="a second one, shown beside the first")
    add_robot(parser)
    parser.add_argument("--ghost", action="store_true", help="the desired posture as well, translucent")
    parser.add_argument(
        "--overlay", action="store_true", help="the second run translucent over the first, not beside it"
    )
    add_page(parser, "write one offline page instead of a live view")
    add_no_open(parser)
    parser.add_argument(
        "--port", metavar="N", type=port, default=0, help="of the live view; default: the first free one"
    )


def run(arguments: argparse.Namespace) -> int:
    """Write the page, or serve the view until it is interrupted."""
    from frontal_biped.cli.sources import is_spatial
    from frontal_biped.model.catalogue import is_robot
    from frontal_biped.viewer.live import serve
    from frontal_biped.viewer.page import exported_page

    robot = str(arguments.source) if is_robot(arguments.source) else arguments.robot
    require_output(arguments.html, arguments.source, arguments.beside, robot=robot)
    if arguments.overlay and arguments.beside is None:
        raise FrontalBipedError("--overlay: lays a second run over the first; name a second file")
    if is_robot(arguments.source):
        return _robot(arguments)
    show = _spatial(arguments) if is_spatial(arguments.source) else _planar(arguments)
    if arguments.html is None:
        serve(show, open_browser=not arguments.no_open, port=arguments.port)
        return SUCCESS
    with Progress("drawing the page"):
        page = exported_page(show)
    _write(arguments.html, page)
    return SUCCESS


def _write(path: Path, page: str) -> None:
    from frontal_biped.files.atomic import write_text

    write_text(path, page)
    write_out(f"{path}: {path.stat().st_size / 1e6:.2f} MB, opens in any browser, offline\n")


def _robot(arguments: argparse.Namespace) -> int:
    """A robot without a gait, with a slider for every joint."""
    from frontal_biped.model.catalogue import load_whole_robot
    from frontal_biped.model.space.free_robot import FreeRobot
    from frontal_biped.viewer.joints_page import joints_page
    from frontal_biped.viewer.live import serve_page

    if arguments.beside is not None or arguments.ghost or arguments.robot is not None:
        raise FrontalBipedError(
            f"{arguments.source}: a robot is shown alone; leave out a second file, --ghost and --robot, or name a gait"
            f" file or {arguments.source.stem}.gait.json in its place"
        )
    with Progress("drawing the robot"):
        page = joints_page(FreeRobot(load_whole_robot(arguments.source)))
    if arguments.html is None:
        serve_page(page, open_browser=not arguments.no_open, port=arguments.port)
    else:
        _write(arguments.html, page)
    return SUCCESS


def _planar(arguments: argparse.Namespace) -> "Show":
    from frontal_biped.cli.sources import is_spatial, watched
    from frontal_biped.viewer.page import planar_show
    from frontal_biped.viewer.scene import cast

    if arguments.beside is not None and is_spatial(arguments.beside):
        raise FrontalBipedError(f"{arguments.beside}: a walk in space is shown alone; leave out one of the two files")
    biped, run = watched(arguments.source, arguments.robot)
    beside = None if arguments.beside is None else watched(arguments.beside, arguments.robot)
    title = biped.name if beside is None else f"{arguments.source.stem} and {arguments.beside.stem}"
    return planar_show(title, cast(biped, run, ghost=arguments.ghost, beside=beside, overlay=arguments.overlay))


def _spatial(arguments: argparse.Namespace) -> "Show":
    from frontal_biped.cli.sources import load_spatial_source
    from frontal_biped.viewer.space_page import space_show

    if arguments.beside is not None:
        raise FrontalBipedError(f"{arguments.source}: a walk in space is shown alone; leave out {arguments.beside}")
    if arguments.ghost:
        raise FrontalBipedError(f"{arguments.source}: a walk in space has no desired posture; leave out --ghost")
    walk = load_spatial_source(arguments.source, arguments.robot)
    return space_show(walk.robot, walk.run, walk.orbit)
