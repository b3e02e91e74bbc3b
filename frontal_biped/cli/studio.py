"""`frontal-biped studio`."""

import argparse
from pathlib import Path

from frontal_biped.cli.arguments import add_no_open, add_robot, folder, port
from frontal_biped.cli.exit_status import SUCCESS

SUMMARY = "Set the specification with sliders in the browser, watch the gait designed anew, push the robot."
EXAMPLE = "frontal-biped studio --robot talos_full"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The robot, where its gaits are saved, and where to serve."""
    add_robot(parser, "frontal_biped")
    parser.add_argument(
        "--port", metavar="P", type=port, default=0, help="port; default: the first free one from 8080 on"
    )
    parser.add_argument(
        "-o", "--output", metavar="DIR", type=folder, default=Path(),
        help="folder where Save writes gaits and pages; default: the one it is started in",
    )  # fmt: skip
    add_no_open(parser)


def run(arguments: argparse.Namespace) -> int:
    """Serve the studio until it is interrupted."""
    from frontal_biped.studio import app

    app.run_studio(arguments.robot, arguments.port, not arguments.no_open, arguments.output)
    return SUCCESS
