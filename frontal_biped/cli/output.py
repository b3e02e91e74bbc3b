"""What a command prints, and which files it may write, also where it is not told."""

import argparse
import errno
import json
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from frontal_biped.cli.surroundings import write_out
from frontal_biped.files.json_values import for_json


def emit(arguments: argparse.Namespace, table: dict[str, Any], text: str) -> None:
    """Print a report: as JSON with ``--json``, else as text."""
    write_out((json.dumps(for_json(table), indent=1) if arguments.json else text) + "\n")


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


def require_output(target: Path | None, *inputs: Path | str | None, robot: str | None = None) -> None:
    """Raise now what would go wrong when a file is written at the end, or what it would destroy.

    Args:
        target: of ``-o`` or ``--html``; None: nothing is written.
        inputs: files that the command reads, or writes besides; text that is no file's name is the name of something
            packaged.
        robot: name or file of the robot it loads, whose description and URDF are inputs too.

    Raises:
        FileExistsError: the target is one of the inputs, be it through a link.
        OSError: it could not be written.
    """
    from frontal_biped.files.atomic import require_parent

    if target is None:
        return
    require_parent(target)
    for path in (*inputs, *_robot_files(robot)):
        if path is None or (isinstance(path, str) and not Path(path).is_file()):
            continue
        if _same_file(target, Path(path)):
            raise FileExistsError(errno.EEXIST, "is a file that the command reads or writes as well", str(target))


def _same_file(a: Path, b: Path) -> bool:
    return a.samefile(b) if a.exists() and b.exists() else a.resolve() == b.resolve()


def _robot_files(robot: str | None) -> Iterator[Path | str]:
    from frontal_biped.exceptions import RobotError
    from frontal_biped.model.catalogue import description_path
    from frontal_biped.model.urdf.description import read_description

    if robot is None:
        return
    yield robot
    try:
        path = description_path(robot)
        yield path
        yield read_description(path).urdf
    except RobotError:  # said, better, by whatever loads the robot
        return
