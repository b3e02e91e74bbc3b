"""`frontal-biped studio`."""

import argparse

from frontal_biped.cli.main import SUCCESS


def run_studio(arguments: argparse.Namespace) -> int:
    """Serve the studio until it is interrupted."""
    from frontal_biped.studio import app

    app.run_studio(arguments.robot, arguments.port, open_browser=not arguments.no_open)
    return SUCCESS
