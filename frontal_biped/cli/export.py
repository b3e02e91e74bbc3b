"""`frontal-biped export`: a run as CSV, GIF, PNG or page, by the ending of the file's name."""

import argparse
import sys
from pathlib import Path

import numpy as np

from frontal_biped.cli.main import SUCCESS
from frontal_biped.cli.progress import Progress
from frontal_biped.cli.view import Watched, watched
from frontal_biped.exceptions import FrontalBipedError
from frontal_biped.files.atomic import require_parent, write_text
from frontal_biped.gait.file import load_gait

ENDINGS = (".csv", ".gif", ".png", ".html")
ORBIT_STEPS = 2
"""Of a gait's periodic orbit: one on either foot."""


def run_export(arguments: argparse.Namespace) -> int:
    """`frontal-biped export`."""
    target: Path = arguments.output
    if target.suffix.lower() not in ENDINGS:
        raise FrontalBipedError(f"-o {target}: its ending is none of {', '.join(ENDINGS)}")
    require_parent(target)
    biped, run = _exported(arguments)
    end = float(run.t[-1] - run.t[0])
    if not 0.0 <= arguments.time <= end:
        raise FrontalBipedError(f"--time {arguments.time:g}: the run takes {end:.3f} s; choose a time within it")
    with Progress(f"writing {target.name}"):
        _write(arguments, target, (biped, run), end)
    sys.stdout.write(f"{target}: {target.stat().st_size / 1e6:.2f} MB\n")
    return SUCCESS


def _exported(arguments: argparse.Namespace) -> Watched:
    """Robot and run; a gait gives its periodic orbit, from the zero dynamics in closed form."""
    source: Path = arguments.source
    if source.suffix == ".npz":
        biped, run = watched(source, arguments.robot)
        return biped, run if arguments.steps is None else run.first_steps(arguments.steps)
    from frontal_biped.cli.commands import _robot_of
    from frontal_biped.simulation.orbit import orbit_trajectory

    gait = load_gait(source)
    biped = _robot_of(gait, arguments)
    return biped, orbit_trajectory(biped, gait, steps=arguments.steps or ORBIT_STEPS)


def _write(arguments: argparse.Namespace, target: Path, shown: Watched, end: float) -> None:
    from frontal_biped.simulation.csv_table import run_table, table_csv
    from frontal_biped.viewer.headless import write_gif, write_png
    from frontal_biped.viewer.page import animation_page

    biped, run = shown
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
