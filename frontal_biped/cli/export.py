"""`frontal-biped export`: a run as CSV, GIF, PNG or page, by the ending of the file's name."""

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

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
from frontal_biped.cli.progress import Progress
from frontal_biped.exceptions import FrontalBipedError

if TYPE_CHECKING:
    from frontal_biped.model.biped import FrontalBiped
    from frontal_biped.simulation.trajectory import Trajectory

SUMMARY = (
    "A run as CSV of joint angles, velocities, torques and FRI, as GIF, PNG or page, by the ending of -o; of a gait"
    " its periodic orbit. GIF and PNG need the extra `browser`."
)
EXAMPLE = "frontal-biped export run.npz -o run.csv --rate 200"

ENDINGS = (".csv", ".gif", ".png", ".html")
ORBIT_STEPS = 2
"""Of a gait's periodic orbit: one on either foot."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The run, the file, and what each kind of file can be told."""
    add_source(parser)
    add_robot(parser)
    parser.add_argument("-o", "--output", metavar="FILE", type=Path, required=True, help=".csv, .gif, .png or .html")
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
    from frontal_biped.cli.sources import load_source
    from frontal_biped.files.atomic import require_parent
    from frontal_biped.simulation.orbit import orbit_trajectory

    target: Path = arguments.output
    if target.suffix.lower() not in ENDINGS:
        raise FrontalBipedError(f"-o {target}: its ending is none of {', '.join(ENDINGS)}")
    require_parent(target)
    steps: int | None = arguments.steps
    biped, _, run = load_source(
        arguments.source, arguments.robot, lambda biped, gait: orbit_trajectory(biped, gait, steps or ORBIT_STEPS)
    )
    if steps is not None:
        run = run.first_steps(steps)
    end = float(run.t[-1] - run.t[0])
    if not 0.0 <= arguments.time <= end:
        raise FrontalBipedError(f"--time {arguments.time:g}: the run takes {end:.3f} s; choose a time within it")
    with Progress(f"writing {target.name}"):
        _write(arguments, target, biped, run, end)
    sys.stdout.write(f"{target}: {target.stat().st_size / 1e6:.2f} MB\n")
    return SUCCESS


def _write(arguments: argparse.Namespace, target: Path, biped: "FrontalBiped", run: "Trajectory", end: float) -> None:
    import numpy as np

    from frontal_biped.files.atomic import write_text
    from frontal_biped.simulation.csv_table import run_table, table_csv
    from frontal_biped.viewer.headless import write_gif, write_png
    from frontal_biped.viewer.page import animation_page

    kind = target.suffix.lower()
    if kind == ".csv":
        write_text(target, table_csv(*run_table(biped, run, arguments.coordinates, arguments.rate)))
        return
    theme = "dark" if arguments.dark else "auto" if kind == ".html" else "light"
    page = animation_page(biped, run, title=biped.name, plots=kind != ".gif", theme=theme)
    if kind == ".html":
        write_text(target, page)
    elif kind == ".png":
        write_png(page, target, arguments.time, arguments.size or (1280, 800))
    else:
        # a GIF counts in hundredths of a second
        frame = max(2, round(100.0 / arguments.fps)) / 100.0
        write_gif(page, target, np.arange(0.0, end, frame).tolist(), 1.0 / frame, arguments.size or (640, 480))
