"""Files that live outside a description's folder: the robots of the installed `example-robot-data`, and meshes.

The data are found without their loaders package, which pins another version of them: first by the metadata of the
installed distribution (wheels of 5.x and 6.x), then in the ``share`` folders that ROS, conda and robotpkg use.
"""

import contextlib
import os
import sys
import xml.etree.ElementTree as ElementTree
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


def found_meshes(urdf: Path, urdf_text: str) -> str:
    """The URDF in which meshes of a package that is nowhere name files that are there.

    ``package://name/meshes/...`` is looked up in every folder above the URDF, where descriptions live whatever the
    installer, in ``ROS_PACKAGE_PATH`` and in the ``share`` folders of ``AMENT_PREFIX_PATH``. That is left to Pinocchio.
    Where no such folder has the mesh, for a package's name is not always that of its folder, the path is tried without
    the name: beside the URDF and in the folders above it.

    Args:
        urdf: the file.
        urdf_text: its text.
    """
    folders = urdf.resolve().parents
    prefixes = [Path(entry) for entry in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if entry]
    ros = [Path(entry) for entry in os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep) if entry]
    homes = [*folders, *ros, *(prefix / "share" for prefix in prefixes)]
    root, moved = ElementTree.fromstring(urdf_text), False
    for mesh in root.iter("mesh"):
        name = mesh.get("filename", "")
        if not name.startswith(PACKAGE):
            continue
        inside = PurePosixPath(name.removeprefix(PACKAGE))
        if ".." in inside.parts or any((home / inside).exists() for home in homes):
            continue
        there = next((path for folder in folders if (path := folder.joinpath(*inside.parts[1:])).is_file()), None)
        if there is not None:
            mesh.set("filename", str(there))
            moved = True
    return ElementTree.tostring(root, encoding="unicode") if moved else urdf_text
