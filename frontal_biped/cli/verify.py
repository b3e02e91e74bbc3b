"""`frontal-biped verify`."""

import argparse
from pathlib import Path

from frontal_biped.cli.arguments import add_json, add_robot
from frontal_biped.cli.exit_status import SUCCESS
from frontal_biped.cli.output import emit
from frontal_biped.cli.progress import Progress

SUMMARY = "Check a proof again from its certificate (extra proof). Exit status 2 if it does not hold."
EXAMPLE = "frontal-biped verify gait.proof.json --gait gait.json"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Certificate, gait, robot, JSON."""
    parser.add_argument("certificate", metavar="C.json", type=Path, help="written by `analyze --prove`")
    parser.add_argument("--gait", metavar="G.json", type=Path, help="must be the very gait that was proved")
    add_robot(parser)
    add_json(parser)


def run(arguments: argparse.Namespace) -> int:
    """Check it."""
    from frontal_biped.analysis.proof import verify

    with Progress("verifying:") as progress:
        progress.update("every ball afresh")
        found = verify(arguments.certificate, arguments.robot, arguments.gait)
    emit(arguments, found.as_dict(arguments.certificate.parent), str(found))
    return SUCCESS
