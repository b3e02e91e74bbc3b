"""`frontal-biped export`: a run as CSV, GIF, PNG or page, by the ending of the file's name."""

import argparse
import sys
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
from frontal_biped.exceptions import FrontalBipedError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    import numpy as np

SUMMARY = (
    "A run as CSV of joint angles, velocities, torques and FRI, as GIF, PNG or page, by the ending of -o; of a gait"
    " its periodic orbit; of a walk in space also NPZ, arrays in the conventions of Pinocchio and MuJoCo. GIF and PNG"
    " need the extra `browser`."
)
EXAMPLE = "frontal-biped export run.npz -o run.csv --rate 200"

ENDINGS = (".csv", ".npz", ".gif", ".png", ".html")
ORBIT_STEPS = 2
"""Of a gait's periodic orbit: one on either foot."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The run, the file, and what each kind of file can be told."""
    add_source(parser)
    add_robot(parser)
    parser.add_argument(
        "-o", "--output", metavar="FILE", type=Path, required=True, help=".csv, .npz, .gif, .png or .html"
    )
    parser.add_argument("--steps", metavar="N", type=positive_int, help="default: all of a run, two of a gait")
    parser.add_argument(
        "--coordinates",
        choices=("urdf", "stance", "both"),
        default="urdf",
        help="CSV: the URDF's joints by name, the paper's stance coordinates, or both; default: urdf",
    )
    parser.add_argument(
        "--rate", metavar="HZ", type=positive_float, help="CSV: rows per second; default: the samples of the run"
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
    with Progress(f"writing {target.name}"):
        _write(arguments, target, source)
    sys.stdout.write(f"{target}: {target.stat().st_size / 1e6:.2f} MB\n")
    return SUCCESS


class _Exported(NamedTuple):
    """What is written, in all the kinds of files there are.

    Attributes:
        duration: of the run [s].
        csv: its table as text.
        arrays: of an archive; None where there are none.
        page: its page, with or without plots, in a theme.
    """

    duration: float
    csv: "Callable[[], str]"
    arrays: "Callable[[], Mapping[str, np.ndarray[Any, Any]]] | None"
    page: "Callable[[bool, str], str]"


def _planar(arguments: argparse.Namespace) -> _Exported:
    from frontal_biped.cli.sources import load_source
    from frontal_biped.simulation.csv_table import run_table, table_csv
    from frontal_biped.simulation.orbit import orbit_trajectory
    from frontal_biped.viewer.page import animation_page

    steps: int | None = arguments.steps
    biped, _, run = load_source(
        arguments.source, arguments.robot, lambda biped, gait: orbit_trajectory(biped, gait, steps or ORBIT_STEPS)
    )
    if steps is not None:
        run = run.first_steps(steps)
    return _Exported(
        duration=float(run.t[-1] - run.t[0]),
        csv=lambda: table_csv(*run_table(biped, run, arguments.coordinates, arguments.rate)),
        arrays=None,
        page=lambda plots, theme: animation_page(biped, run, title=biped.name, plots=plots, theme=theme),
    )


def _spatial(arguments: argparse.Namespace) -> _Exported:
    from frontal_biped.cli.sources import load_spatial_source
    from frontal_biped.simulation.csv_table import table_csv
    from frontal_biped.simulation.space.conventions import convention_arrays
    from frontal_biped.simulation.space.table import spatial_table
    from frontal_biped.viewer.space_page import space_page

    robot, _, run, orbit = load_spatial_source(arguments.source, arguments.robot)
    if arguments.steps is not None:
        run = run.first_steps(arguments.steps)
    return _Exported(
        duration=float(run.t[-1] - run.t[0]),
        csv=lambda: table_csv(*spatial_table(robot, run, arguments.coordinates, arguments.rate)),
        arrays=lambda: convention_arrays(robot, run),
        page=lambda plots, theme: space_page(robot, run, orbit, plots=plots, theme=theme),
    )


def _write(arguments: argparse.Namespace, target: Path, source: _Exported) -> None:
    import numpy as np

    from frontal_biped.files.atomic import atomic_path, write_text
    from frontal_biped.viewer.headless import write_gif, write_png

    kind = target.suffix.lower()
    if kind == ".csv":
        write_text(target, source.csv())
        return
    if kind == ".npz":
        if source.arrays is None:
            raise FrontalBipedError(f"-o {target}: arrays are exported of walks in space; choose .csv")
        arrays = source.arrays()
        with atomic_path(target) as temporary, temporary.open("wb") as stream:
            np.savez_compressed(stream, **arrays)  # type: ignore[arg-type]
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
