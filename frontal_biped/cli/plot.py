"""`frontal-biped plot`."""

import argparse
import sys
from pathlib import Path

from frontal_biped.cli.arguments import add_robot, add_source, add_value, figure_formats
from frontal_biped.cli.exit_status import SUCCESS

SUMMARY = "Write the paper's figures and more."
EXAMPLE = "frontal-biped plot run.npz -o figures"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The run, the folder, the formats."""
    add_source(parser)
    add_robot(parser)
    parser.add_argument(
        "-o", "--output", metavar="DIR", type=Path, default="figures", help="folder; default: %(default)s"
    )
    add_value(parser, "--format", "F,F", figure_formats, "svg,png", "svg, pdf, png, or several with commas")


def run(arguments: argparse.Namespace) -> int:
    """Write the figures, and name the files."""
    from frontal_biped.cli.sources import load_source
    from frontal_biped.figures.write import write_figures

    source = load_source(arguments.source, arguments.robot)
    for path in write_figures(arguments.output, source.biped, source.gait, source.run, arguments.format):
        sys.stdout.write(f"{path}\n")
    return SUCCESS
