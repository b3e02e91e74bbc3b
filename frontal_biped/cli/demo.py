"""`frontal-biped demo`."""

import argparse
import gc
from collections.abc import Iterator
from contextlib import contextmanager

from frontal_biped.cli.arguments import add_json, add_robot, add_value, folder
from frontal_biped.cli.exit_status import SUCCESS, TASK_FAILED
from frontal_biped.cli.output import emit
from frontal_biped.cli.progress import Progress

SUMMARY = "Design, certify, simulate, and make page and figures for the Table I robot."
EXAMPLE = "frontal-biped demo --out demo"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Folder, proof, robot, JSON."""
    add_value(parser, "--out", "DIR", folder, "demo", "folder to write")
    parser.add_argument(
        "--prove",
        action="store_true",
        help="prove the gait in ball arithmetic as well (extra proof), 40 s; the page then has both verdicts",
    )
    add_robot(parser, "frontal_biped")
    add_json(parser)


def run(arguments: argparse.Namespace) -> int:
    """Make the demonstration's folder."""
    with _lasting():
        from frontal_biped.demo.demo import make_demo
        from frontal_biped.demo.page import report_page  # noqa: F401  for the end, and imported best with the rest
        from frontal_biped.figures.style import require_matplotlib
        from frontal_biped.model.catalogue import load_robot

        require_matplotlib()
        biped = load_robot(arguments.robot)
    with Progress("demo:") as progress:
        report = make_demo(biped, arguments.out, on_progress=progress.update, prove=arguments.prove)
    emit(arguments, report.as_dict(), str(report))
    return SUCCESS if report.success else TASK_FAILED


@contextmanager
def _lasting() -> Iterator[None]:
    """What is imported stays: to look through it for garbage, now and later, takes as long as to draw a figure."""
    gc.disable()
    try:
        yield
        gc.freeze()
    finally:
        gc.enable()
