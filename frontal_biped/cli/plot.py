"""`frontal-biped plot`."""

import argparse

from frontal_biped.cli.arguments import add_robot, add_source, add_value, figure_formats, folder
from frontal_biped.cli.exit_status import SUCCESS
from frontal_biped.cli.surroundings import write_out

SUMMARY = "Write the paper's figures and more; of a walk in space footsteps, pressure, limits and speed."
EXAMPLE = "frontal-biped plot run.npz -o figures"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The run, the folder, the formats."""
    add_source(parser)
    add_robot(parser)
    parser.add_argument(
        "-o", "--output", metavar="DIR", type=folder, default="figures", help="folder; default: %(default)s"
    )
    add_value(parser, "--format", "F,F", figure_formats, "svg,png", "svg, pdf, png, or several with commas")


def run(arguments: argparse.Namespace) -> int:
    """Write the figures, and name the files."""
    from frontal_biped.cli.sources import is_spatial, load_source, load_spatial_source
    from frontal_biped.figures.space import write_space_figures
    from frontal_biped.figures.write import write_figures
    from frontal_biped.files.atomic import require_folder

    require_folder(arguments.output)
    if is_spatial(arguments.source):
        walk = load_spatial_source(arguments.source, arguments.robot)
        paths = write_space_figures(
            arguments.output, walk.robot, walk.run, walk.gait, walk.orbit, formats=arguments.format
        )
    else:
        source = load_source(arguments.source, arguments.robot)
        paths = write_figures(arguments.output, source.biped, source.gait, source.run, arguments.format)
    for path in paths:
        write_out(f"{path}\n")
    return SUCCESS
