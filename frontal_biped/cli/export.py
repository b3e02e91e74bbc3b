"""`frontal-biped export`: the whole robot of a run as CSV, NPZ or MCAP, or GIF, PNG or page, by the file's ending."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

from frontal_biped.cli.arguments import (
    add_robot,
    add_source,
    add_value,
    not_negative_float,
    positive_float,
    positive_int,
    size,
)
from frontal_biped.cli.exit_status import SUCCESS
from frontal_biped.cli.output import require_output
from frontal_biped.cli.progress import Progress
from frontal_biped.cli.surroundings import write_out
from frontal_biped.exceptions import FrontalBipedError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    import numpy as np

    from frontal_biped.model.robot import Robot
    from frontal_biped.model.space.whole_motion import WholeMotion
    from frontal_biped.simulation.csv_table import Column
    from frontal_biped.simulation.space.run import SpatialRun
    from frontal_biped.simulation.trajectory import Trajectory

_Run = TypeVar("_Run", "Trajectory", "SpatialRun")

SUMMARY = (
    "The whole robot of a run, or of a gait's periodic orbit: every joint, the base, contact and torques as CSV; as NPZ"
    " in the conventions of Pinocchio and MuJoCo; as MCAP for ROS 2; or GIF, PNG, page; by the ending of -o. MCAP needs"
    " the extra `mcap`, GIF and PNG `browser`."
)
EXAMPLE = "frontal-biped export run.npz -o full.csv --rate 200"

ENDINGS = (".csv", ".npz", ".gif", ".png", ".html", ".mcap")
ORBIT_STEPS = 2
"""Of a gait's periodic orbit: one on either foot."""

ORBIT_SAMPLES = 121
"""Of a phase of it, where its samples are written."""

DENSE_SAMPLES = 1921
"""Of a phase of it, where a rate is asked for: what lies between them is then on the orbit to 1e-8 rad."""

MOST_NUMBERS = 30_000_000
"""Of a file with a --rate: ten minutes of four joints, or three of thirty, at 1 kHz; more is a slip of the pen."""

MOST_FPS = 50.0
"""Pictures a second that browsers show of a GIF, which counts in hundredths of a second."""

MOST_PICTURES = 5000
"""Of a GIF; each takes a tenth of a second or more to draw, and all of them are held until it is written."""

GIF_SIZE, SPATIAL_GIF_SIZE = (400, 480), (660, 480)
"""Width and height [px]. In the plane the robot is as large as in a wider one, which takes longer to draw; in space the
phase portrait has room beside the robot from 641 pixels on."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The run, the file, and what each kind of file can be told."""
    add_source(parser)
    add_robot(parser)
    parser.add_argument(
        "-o", "--output", metavar="FILE", type=Path, required=True, help=".csv, .npz, .mcap, .gif, .png or .html"
    )
    parser.add_argument("--steps", metavar="N", type=positive_int, help="default: all of a run, two of a gait")
    parser.add_argument(
        "--coordinates",
        choices=("urdf", "stance", "both"),
        default="urdf",
        help="CSV: the URDF's joints by name, the paper's stance coordinates, or both; default: urdf",
    )
    parser.add_argument(
        "--rate",
        metavar="HZ",
        type=positive_float,
        help="CSV, NPZ, MCAP: samples per second; default: the samples of the run",
    )
    add_value(parser, "--time", "T", not_negative_float, "0", "PNG: time of the run, s")
    parser.add_argument("--fps", metavar="F", type=positive_float, default="12.5", help="GIF: default: %(default)s")
    parser.add_argument(
        "--size", metavar="WxH", type=size, help="pixels; default: 1280x800, of a GIF 400x480, in space 660x480"
    )
    parser.add_argument("--dark", action="store_true", help="light on dark")


def run(arguments: argparse.Namespace) -> int:
    """Write the file; a gait gives its periodic orbit, from the zero dynamics in closed form."""
    from frontal_biped.cli.sources import is_spatial

    target: Path = arguments.output
    if target.suffix.lower() not in ENDINGS:
        raise FrontalBipedError(f"-o {target}: its ending is none of {', '.join(ENDINGS)}")
    require_output(target, arguments.source, robot=arguments.robot)
    source = _spatial(arguments) if is_spatial(arguments.source) else _planar(arguments)
    if not 0.0 <= arguments.time <= source.duration:
        raise FrontalBipedError(
            f"--time {arguments.time:g}: the run takes {source.duration:.3f} s; choose a time within it"
        )
    _require_number("--rate", arguments.rate, "samples", source.duration, MOST_NUMBERS // source.width)
    if target.suffix.lower() == ".gif":
        if source.duration <= 0.0:
            raise FrontalBipedError(f"{arguments.source}: does not move, it has one instant; write a .png")
        if arguments.fps > MOST_FPS:
            raise FrontalBipedError(f"--fps {arguments.fps:g}: a GIF shows at most {MOST_FPS:g}; choose one up to this")
        _require_number("--fps", arguments.fps, "pictures", source.duration, MOST_PICTURES)
    with Progress(f"writing {target.name}") as progress:
        _write(arguments, target, source, progress)
    write_out(f"{target}: {target.stat().st_size / 1e6:.2f} MB\n")
    return SUCCESS


def _require_number(option: str, rate: float | None, what: str, duration: float, most: int) -> None:
    """Refuse a rate [1/s] that gives a run of some duration [s] too many of something, or only one."""
    if rate is None or duration <= 0.0:  # of a run of one sample any rate is right
        return
    if rate * duration > most:
        raise FrontalBipedError(
            f"{option} {rate:g}: {rate * duration:.2g} {what} of {duration:.3f} s; choose at most"
            f" {0.999 * most / duration:.3g}"
        )
    if rate * duration < 1.0:
        raise FrontalBipedError(
            f"{option} {rate:g}: a single one of the {what} of {duration:.3g} s; choose at least {1.01 / duration:.4g}"
        )


class _Exported(NamedTuple):
    """What is written, in all the kinds of files there are.

    Attributes:
        duration: of the run [s].
        width: numbers of a sample, about.
        csv: the columns of its table.
        arrays: of an archive.
        motion: of the whole robot.
        page: its page, with or without plots, in a theme.
        gif_size: width and height of its GIF unless asked otherwise [px].
    """

    duration: float
    width: int
    csv: "Callable[[], Mapping[str, Column]]"
    arrays: "Callable[[], Mapping[str, np.ndarray[Any, Any]]]"
    motion: "Callable[[], WholeMotion]"
    page: "Callable[[bool, str], str]"
    gif_size: tuple[int, int]


def _planar(arguments: argparse.Namespace) -> _Exported:
    from frontal_biped.cli.sources import load_source
    from frontal_biped.simulation.csv_table import run_columns
    from frontal_biped.simulation.orbit import orbit_trajectory
    from frontal_biped.simulation.whole_arrays import planar_arrays
    from frontal_biped.simulation.whole_robot import whole_motion
    from frontal_biped.viewer.page import animation_page

    steps: int | None = arguments.steps
    samples = ORBIT_SAMPLES if arguments.rate is None else DENSE_SAMPLES
    biped, _, run = load_source(
        arguments.source,
        arguments.robot,
        lambda biped, gait: orbit_trajectory(biped, gait, steps or ORBIT_STEPS, samples),
    )
    if steps is not None:
        run = _first_steps(arguments, run, run.first_steps(steps))
    return _Exported(
        duration=float(run.t[-1] - run.t[0]),
        width=_width(biped.robot),
        csv=lambda: run_columns(biped, run, arguments.coordinates, arguments.rate),
        arrays=lambda: planar_arrays(biped, run, arguments.rate),
        motion=lambda: whole_motion(biped, run, arguments.rate),
        page=lambda plots, theme: animation_page(biped, run, title=biped.name, plots=plots, theme=theme),
        gif_size=GIF_SIZE,
    )


def _spatial(arguments: argparse.Namespace) -> _Exported:
    from frontal_biped.cli.sources import load_spatial_source
    from frontal_biped.simulation.space.table import spatial_columns
    from frontal_biped.simulation.whole_arrays import spatial_arrays
    from frontal_biped.simulation.whole_robot import whole_motion
    from frontal_biped.viewer.space_page import space_page

    robot, _, run, orbit = load_spatial_source(arguments.source, arguments.robot)
    if arguments.steps is not None:
        run = _first_steps(arguments, run, run.first_steps(arguments.steps))
    return _Exported(
        duration=float(run.t[-1] - run.t[0]),
        width=_width(robot.robot),
        csv=lambda: spatial_columns(robot, run, arguments.coordinates, arguments.rate),
        arrays=lambda: spatial_arrays(robot, run, arguments.rate),
        motion=lambda: whole_motion(robot, run, arguments.rate),
        page=lambda plots, theme: space_page(robot, run, orbit, plots=plots, theme=theme),
        gif_size=SPATIAL_GIF_SIZE,
    )


def _first_steps(arguments: argparse.Namespace, run: "_Run", part: "_Run") -> "_Run":
    """A part of a run, of which there must be something."""
    if not len(part.t):
        raise FrontalBipedError(
            f"{arguments.source}: begins with step {run.step[0] + 1:g}; choose --steps {run.step[0] + 1:g} or more"
        )
    return part


def _width(robot: "Robot") -> int:
    return 40 + robot.model.nq + 2 * robot.model.nv


def _write(arguments: argparse.Namespace, target: Path, source: _Exported, progress: Progress) -> None:
    import numpy as np

    from frontal_biped.files.atomic import atomic_path, write_text
    from frontal_biped.simulation.csv_table import table_rows, write_csv
    from frontal_biped.simulation.mcap_log import write_mcap
    from frontal_biped.viewer.headless import write_gif, write_png

    kind = target.suffix.lower()
    if kind == ".csv":
        columns = source.csv()
        with atomic_path(target) as temporary, temporary.open("w", encoding="utf-8") as stream:
            write_csv(stream, columns, table_rows(columns))
        return
    if kind == ".npz":
        arrays = source.arrays()
        with atomic_path(target) as temporary, temporary.open("wb") as stream:
            np.savez_compressed(stream, **arrays)  # type: ignore[arg-type]
        return
    if kind == ".mcap":
        write_mcap(source.motion(), target)
        return
    page = source.page(kind != ".gif", "dark" if arguments.dark else "auto" if kind == ".html" else "light")
    if kind == ".html":
        write_text(target, page)
    elif kind == ".png":
        write_png(page, target, arguments.time, arguments.size or (1280, 800))
    else:
        # a GIF counts in hundredths of a second
        frame = round(100.0 / arguments.fps) / 100.0
        times = np.arange(0.0, source.duration, frame).tolist()
        write_gif(
            page,
            target,
            times,
            1.0 / frame,
            arguments.size or source.gif_size,
            lambda taken: progress.update(f"picture {taken} of {len(times)}"),
        )
