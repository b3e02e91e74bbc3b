"""How gait and run files name the description of their robot, and how it is found again.

    in memory   the file name of a packaged description, as ``g1.toml``; of any other its absolute path
    in a file   the same file name; of any other its path from the folder of the gait or run file

So a folder with robot and gait can be moved, and a gait of a packaged robot is one wherever it lies. A file that moved
without its robot is told from one that moved with it: the path is followed first, then the file name is looked for
beside the file, then among the packaged descriptions.
"""

import os
from collections.abc import Callable, Mapping
from pathlib import Path, PurePosixPath
from typing import Any

from frontal_biped.model.catalogue import is_packaged, models_dir


def named_description(path: Path) -> str:
    """How a description is named in memory: see the module."""
    # the folder resolved, not the file itself: its URDF lies beside the name that it was given
    return path.name if is_packaged(path) else str(path.parent.resolve() / path.name)


def description_file(name: str) -> Path:
    """The file of a description that is named as in memory."""
    return models_dir() / name if _is_bare(name) else Path(name)


def stored_description(name: str, folder: Path) -> str:
    """What a file in a folder says of a description that is named as in memory."""
    if not name or _is_bare(name):
        return name
    try:
        return PurePosixPath(Path(os.path.relpath(name, folder.resolve()))).as_posix()
    except ValueError:  # on another drive, where no path leads
        return name


def found_description(stored: str, folder: Path) -> str:
    """The description that a file in a folder names, as in memory; where none is found, the path that was followed."""
    if not stored:
        return stored
    followed = folder / stored
    beside = folder / PurePosixPath(stored).name
    for path in (followed, beside):
        if _is_there(path):
            return named_description(path)
    if _is_bare(stored) and _is_there(models_dir() / stored):
        return stored
    return os.path.normpath(folder.resolve() / stored)


def with_stored_description(gait: Mapping[str, Any], folder: Path) -> Mapping[str, Any]:
    """The content of a gait file as it is told by a run file in a folder; what is not a gait's is left as it is."""
    return _renamed(gait, lambda name: stored_description(name, folder))


def with_found_description(gait: Mapping[str, Any], folder: Path) -> Mapping[str, Any]:
    """The content of a gait file that a run file in a folder tells, its robot found."""
    return _renamed(gait, lambda stored: found_description(stored, folder))


def _renamed(gait: Mapping[str, Any], rename: Callable[[str], str]) -> Mapping[str, Any]:
    robot = gait.get("robot") if isinstance(gait, Mapping) else None
    if not isinstance(robot, Mapping) or not isinstance(robot.get("description"), str):
        return gait
    return {**gait, "robot": {**robot, "description": rename(robot["description"])}}


def _is_there(path: Path) -> bool:
    try:
        return path.is_file()
    except OSError:  # a name longer than names can be
        return False


def _is_bare(name: str) -> bool:
    return PurePosixPath(name).name == name and Path(name).name == name
