"""`frontal-biped library`."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from frontal_biped.cli.arguments import add_jobs, add_json, folder
from frontal_biped.cli.exit_status import SUCCESS
from frontal_biped.cli.output import emit
from frontal_biped.cli.progress import Progress
from frontal_biped.files.counted import counted

if TYPE_CHECKING:
    from frontal_biped.library.build import LibraryReport
    from frontal_biped.library.sweep import Sweep

SUMMARY = "Design a gait for every point of a grid of specifications; run it again to resume one that was interrupted."
EXAMPLE = "frontal-biped library sweep.toml -o gaits"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Grid, folder, who designs."""
    parser.add_argument("sweep", metavar="SWEEP.toml", type=Path, help="robots, shared keys and axes of the grid")
    parser.add_argument("-o", "--output", metavar="DIR", type=folder, required=True, help="folder of the library")
    where = parser.add_mutually_exclusive_group()
    add_jobs(where)
    where.add_argument("--dask", metavar="ADDRESS", help="address of a Dask scheduler instead, tcp://host:8786")
    add_json(parser)


def run(arguments: argparse.Namespace) -> int:
    """Design what the folder lacks."""
    from dataclasses import asdict

    from frontal_biped.files.atomic import require_folder
    from frontal_biped.library.sweep import read_sweep

    sweep = read_sweep(arguments.sweep)
    require_folder(arguments.output)
    try:
        report = _built(arguments, sweep)
    except KeyboardInterrupt as stop:
        stop.add_note("run the same command again to go on: what is finished is kept")
        raise
    table = {**asdict(report), "index": str(report.index), "gaits_per_second": report.gaits_per_second}
    earlier = f", {report.found} of them by an earlier run" if report.found else ""
    emit(
        arguments,
        table,
        f"{counted(report.points, 'point')}{earlier}: {counted(report.gaits, 'gait')}, {report.failures} without one\n"
        f"{report.seconds:.1f} s, {report.gaits_per_second:.2f} points a second; table in {report.index}",
    )
    return SUCCESS


def _built(arguments: argparse.Namespace, sweep: "Sweep") -> "LibraryReport":
    from frontal_biped.cli.workers import workers
    from frontal_biped.library.build import build_library
    from frontal_biped.library.executors import dask_executor

    jobs = min(arguments.jobs, len(sweep.batches()))  # a batch is designed by one process
    designers = workers(jobs) if arguments.dask is None else dask_executor(arguments.dask)
    with Progress("designing: gait", len(sweep.points())) as progress, designers as executor:
        before: list[int] = []

        def show(done: int, total: int, seconds: float) -> None:
            before.append(done)
            rate = (done - before[0]) / seconds if seconds > 0.0 else 0.0
            left = f"{rate:.2f} a second, about {(total - done) / rate:.0f} s to go" if rate > 0.0 else ""
            progress.update(left, done)

        return build_library(sweep, arguments.output, executor, show)
