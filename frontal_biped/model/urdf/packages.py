"""The robots of the installed `example-robot-data`, which live outside a description's folder.

The data are found without their loaders package, which pins another version of them: first by the metadata of the
installed distribution (wheels of 5.x and 6.x), then in the ``share`` folders that ROS, conda and robotpkg use.
"""

import contextlib
import os
import sys
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path, PurePosixPath

from frontal_biped.exceptions import RobotError
from frontal_biped.files.extras import pip_install

EXAMPLE_ROBOT_DATA = "example-robot-data"
PACKAGE = "package://"
_SHARE = Path("share") / EXAMPLE_ROBOT_DATA / "robots"


def example_robot_data_dir() -> Path:
    """Folder ``robots`` of the installed example-robot-data.

    Raises:
        RobotError: it is not installed.
    """
    candidates: list[Path] = []
    with contextlib.suppress(PackageNotFoundError):
        candidates.append(Path(str(distribution(EXAMPLE_ROBOT_DATA).locate_file(f"cmeel.prefix/{_SHARE.as_posix()}"))))
    prefixes = [entry for entry in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if entry]
    candidates += [Path(prefix) / _SHARE for prefix in (*prefixes, sys.prefix)]
    for folder in candidates:
        if folder.is_dir():
            return folder
    searched = ", ".join(str(folder) for folder in candidates)
    raise RobotError(f"{EXAMPLE_ROBOT_DATA} is not installed; {pip_install(EXAMPLE_ROBOT_DATA)} (searched {searched})")


def resolve_urdf(where: str, urdf: str, folder: Path) -> Path:
    """The file that the ``urdf`` of a description names.

    Args:
        where: file and key, for messages.
        urdf: ``"robot.urdf"``, below the folder of the description, or ``"example-robot-data:path"``.
        folder: of the description.

    Returns:
        The path; a file of the folder need not exist yet.

    Raises:
        RobotError: the scheme is unknown, the path leaves its folder, or the data are not installed.
    """
    scheme, colon, inside = urdf.partition(":")
    if colon and scheme != EXAMPLE_ROBOT_DATA:
        raise RobotError(
            f"{where}: urdf scheme {scheme!r} is not supported; give a path relative to this file,"
            f' or "{EXAMPLE_ROBOT_DATA}:talos_data/robots/..."'
        )
    path = PurePosixPath(inside if colon else urdf)
    if path.is_absolute() or ".." in path.parts:
        raise RobotError(
            f"{where} = {urdf!r} leaves its folder; put the description beside the URDF and give a path without '..'"
        )
    if not colon:
        return folder / path
    found = example_robot_data_dir() / path
    if not found.is_file():
        raise RobotError(
            f"{where} = {urdf!r}: the installed {EXAMPLE_ROBOT_DATA} has no such file; give a path below"
            f" {example_robot_data_dir()}"
        )
    return found
