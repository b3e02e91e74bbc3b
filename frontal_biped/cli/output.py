"""What a command prints."""

import argparse
import json
import sys
from collections.abc import Mapping
from typing import Any


def emit(arguments: argparse.Namespace, table: Mapping[str, Any], text: str) -> None:
    """Print a report: as JSON with ``--json``, else as text."""
    sys.stdout.write((json.dumps(table, indent=1) if arguments.json else text) + "\n")
