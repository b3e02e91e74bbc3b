"""`frontal-biped export`: the whole robot of a run as CSV, NPZ or MCAP, or GIF, PNG or page, by the file's ending."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

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

    from frontal_biped.model.space.whole_motion import WholeMotion

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

MOST_SAMPLES = 2_000_000
"""Of a file: more is a slip of the pen in --rate."""


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
    parser.add_argument("--fps", metavar="F", type=positive_float, default="20", help="GIF: default: %(default)s")
    parser.add_argument("--size", metavar="WxH", type=size, help="pixels; default: 1280x800, of a GIF 640x480")
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
    if arguments.rate is not None and arguments.rate * source.duration > MOST_SAMPLES:
        raise FrontalBipedError(
            f"--rate {arguments.rate:g}: {arguments.rate * source.duration:.2g} samples of {source.duration:.3f} s;"
            f" choose at most {MOST_SAMPLES / source.duration:.0f}"
        )
    with Progress(f"writing {target.name}"):
        _write(arguments, target, source)
    write_out(f"{target}: {target.stat().st_size / 1e6:.2f} MB\n")
    return SUCCESS


class _Exported(NamedTuple):
    """What is written, in all the kinds of files there are.

    Attributes:
        duration: of the run [s].
        csv: its table as text.
        arrays: of an archive.
        motion: of the whole robot.
        page: its page, with or without plots, in a theme.
    """

    duration: float
    csv: "Callable[[], str]"
    arrays: "Callable[[], Mapping[str, np.ndarray[Any, Any]]]"
    motion: "Callable[[], WholeMotion]"
    page: "Callable[[bool, str], str]"


def _planar(arguments: argparse.Namespace) -> _Exported:
    from frontal_biped.cli.sources import load_source
    from frontal_biped.simulation.csv_table import run_table, table_csv
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
        run = run.first_steps(steps)
    return _Exported(
        duration=float(run.t[-1] - run.t[0]),
        csv=lambda: table_csv(*run_table(biped, run, arguments.coordinates, arguments.rate)),
        arrays=lambda: planar_arrays(biped, run, arguments.rate),
        motion=lambda: whole_motion(biped, run, arguments.rate),
        page=lambda plots, theme: animation_page(biped, run, title=biped.name, plots=plots, theme=theme),
    )


def _spatial(arguments: argparse.Namespace) -> _Exported:
    from frontal_biped.cli.sources import load_spatial_source
    from frontal_biped.simulation.csv_table import table_csv
    from frontal_biped.simulation.space.table import spatial_table
    from frontal_biped.simulation.whole_arrays import spatial_arrays
    from frontal_biped.simulation.whole_robot import whole_motion
    from frontal_biped.viewer.space_page import space_page

    robot, _, run, orbit = load_spatial_source(arguments.source, arguments.robot)
    if arguments.steps is not None:
        run = run.first_steps(arguments.steps)
    return _Exported(
        duration=float(run.t[-1] - run.t[0]),
        csv=lambda: table_csv(*spatial_table(robot, run, arguments.coordinates, arguments.rate)),
        arrays=lambda: spatial_arrays(robot, run, arguments.rate),
        motion=lambda: whole_motion(robot, run, arguments.rate),
        page=lambda plots, theme: space_page(robot, run, orbit, plots=plots, theme=theme),
    )


def _write(arguments: argparse.Namespace, target: Path, source: _Exported) -> None:
    import numpy as np

    from frontal_biped.files.atomic import atomic_path, write_text
    from frontal_biped.simulation.mcap_log import write_mcap
    from frontal_biped.viewer.headless import write_gif, write_png

    kind = target.suffix.lower()
    if kind == ".csv":
        write_text(target, source.csv())
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
        frame = max(2, round(100.0 / arguments.fps)) / 100.0
        times = np.arange(0.0, source.duration, frame).tolist()
        write_gif(page, target, times, 1.0 / frame, arguments.size or (640, 480))
