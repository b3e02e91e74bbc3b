"""What a command prints, and where it writes that is not told where."""

import argparse
import json
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any


def emit(arguments: argparse.Namespace, table: Mapping[str, Any], text: str) -> None:
    """Print a report: as JSON with ``--json``, else as text."""
    sys.stdout.write((json.dumps(table, indent=1) if arguments.json else text) + "\n")


def report(
    arguments: argparse.Namespace, lines: Iterable[str], tables: Iterable[str], written: Iterable[Path | str]
) -> str:
    """The verdict first, then with ``--verbose`` the tables, last what was written; for `emit`."""
    more = [f"\n{table}" for table in tables] if arguments.verbose else []
    return "\n".join([*lines, *more, *(f"written: {path}" for path in written)])


def free_path(target: Path) -> Path:
    """The target, or where it is taken the first of NAME-2, NAME-3, ... that is not."""
    number, path = 1, target
    while path.exists():
        number += 1
        path = target.with_name(f"{target.stem}-{number}{target.suffix}")
    return path
