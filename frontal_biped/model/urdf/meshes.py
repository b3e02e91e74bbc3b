"""Mesh files of a URDF: found in the robot's folders, and nowhere else on the disk, and known to be readable.

What a URDF names ends in pages that are mailed, so a URDF of a stranger must not name what it likes. Meshes lie below

- the URDF's folder, or the one above it, where many keep ``urdf/`` beside ``meshes/``;
- the ROS package that holds the URDF: the nearest folder above with a ``package.xml``;
- a folder that a ``package://`` path names: one above the URDF by its name, a package beside one of those, or one in
  ``ROS_PACKAGE_PATH`` or in the ``share`` folders of ``AMENT_PREFIX_PATH``;
- the installed example-robot-data.

The user's home, what holds it, and folders at the top of the disk are no robot's, whatever their name. A package's name
is not always that of its folder: where none has the name, the path is tried without it. A link counts for what it
leads to; but in folders that the environment names links may lead anywhere, for ``colcon build --symlink-install``
makes such.

Pinocchio gets absolute names of files that were checked. The library it reads meshes with, Assimp, can be made to
crash, to wait for ever and to fill the memory by files that are broken, or made for that; so what is not simple to
check beforehand is first read in a process of its own, once.
"""

import os
import re
import stat
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from enum import Enum
from pathlib import Path
from typing import Any

import numpy as np

from frontal_biped.exceptions import RobotError
from frontal_biped.files.reading import load_json, require_regular
from frontal_biped.model.urdf.packages import EXAMPLE_ROBOT_DATA, PACKAGE, example_robot_data_dir

MOST_MESH_BYTES = 200_000_000
"""Of a mesh file; the largest of the robots that we know has 29 million."""

FORMATS = (".stl", ".dae", ".obj", ".gltf")
"""Of mesh files, by their endings: those that robots come with, and whose readers check what they read."""

FARTHEST_NAMED = 2
"""How far above the URDF's folder one without a package.xml may be named by a ``package://`` path."""

TRIAL_SECONDS, TRIAL_BYTES = 30.0, 4 << 30
"""What reading one robot's meshes may take at most."""

_STL_HEAD, _STL_FACET = 84, np.dtype([("normal", "<f4", 3), ("corners", "<f4", 9), ("attribute", "<u2")])
_known_good: set[tuple[str, int, int]] = set()


def with_found_meshes(urdf: Path, urdf_text: str, kind: str) -> str:
    """The URDF with absolute file names for the meshes of one kind, and without shapes of another kind and textures.

    Args:
        urdf: the file.
        urdf_text: its text, or a part of it.
        kind: ``"visual"`` or ``"collision"``.

    Raises:
        RobotError: a mesh is not found, lies outside the robot's folders, or cannot be read.
    """
    root = ElementTree.fromstring(urdf_text)
    places = _Places(urdf)
    doubtful: dict[Path, str] = {}
    for link in root.iter("link"):
        for other in link.findall("collision" if kind == "visual" else "visual"):
            link.remove(other)
    for material in root.iter("material"):
        for texture in material.findall("texture"):
            material.remove(texture)
    for mesh in root.iter("mesh"):
        name = mesh.get("filename", "")
        where = f"{urdf}: mesh {name[:200]!r}"
        found = places.find(where, name)
        if not places.is_installed(found) and not _is_plain_stl(where, found):
            doubtful[found] = where
        mesh.set("filename", str(found))
    _try(doubtful)
    return ElementTree.tostring(root, encoding="unicode")


# ------------------------------------------------------------------------ where
class _Claim(Enum):
    """What a folder in which a mesh is looked for adds to the robot's own ones."""

    NOTHING = "nothing"
    ITSELF = "itself"
    LINKS_TOO = "itself, and whatever links in it lead to"


class _Places:
    """Where the meshes of one URDF may lie."""

    def __init__(self, urdf: Path) -> None:
        self._above = list(urdf.resolve().parents)
        package = next((folder for folder in self._above if (folder / "package.xml").is_file()), None)
        own = [self._above[0], *(folder for folder in (package, *self._above[1:2]) if folder and _is_robots(folder))]
        self.own = list(dict.fromkeys(own))
        try:
            self._installed: Path | None = example_robot_data_dir().resolve().parent
        except RobotError:
            self._installed = None

    def is_installed(self, path: Path) -> bool:
        """Does a file come with example-robot-data?"""
        return self._installed is not None and path.is_relative_to(self._installed)

    def find(self, where: str, name: str) -> Path:
        """The file that a mesh name stands for, with no link in its path.

        Args:
            where: URDF and mesh, for messages.
            name: of the mesh.

        Raises:
            RobotError: there is none, or none in the robot's folders.
        """
        outside = False
        for base, inside, claim in self._candidates(name):
            path = Path(os.path.normpath(base / inside))
            if not os.path.lexists(path):
                continue
            real = Path(os.path.realpath(path))
            homes = [
                *self.own,
                *([self._installed] if self._installed else []),
                *([base] if claim is not _Claim.NOTHING else []),
            ]
            if any(real.is_relative_to(os.path.realpath(home)) for home in homes):
                return real
            if claim is _Claim.LINKS_TOO and path.is_relative_to(base):
                return real
            outside = True
        if outside or self._is_elsewhere(name):
            raise RobotError(
                f"{where} is outside the robot's folders; copy it below {self._above[0]}, or into a"
                " package with a package.xml, and name it by a relative or package:// path"
            )
        raise RobotError(
            f"{where} could not be found; searched {self._above[0]} and the robot's folders above"
            " it, with and without the package's name; put the package there, or its parent folder into"
            " ROS_PACKAGE_PATH (its prefix into AMENT_PREFIX_PATH)"
        )

    def _candidates(self, name: str) -> Iterator[tuple[Path, str, _Claim]]:
        """Folders, the path below each, and what the folder adds."""
        scheme, colon, inside = name.partition("://")
        if not colon or scheme == "file":
            yield from ((folder, inside if colon else name, _Claim.NOTHING) for folder in self.own)
        elif f"{scheme}://" == PACKAGE:
            package, _, below = inside.lstrip("/").partition("/")
            for folder, claim in self._packages(package):
                yield folder, below, claim
            for without in (f"{package}/{below}", below):
                yield from ((folder, without, _Claim.NOTHING) for folder in self.own)

    def _packages(self, package: str) -> Iterator[tuple[Path, _Claim]]:
        if package in ("", ".", ".."):
            return
        for height, folder in enumerate(self._above):
            if folder.name == package:
                named = height <= FARTHEST_NAMED or (folder / "package.xml").is_file()
                yield folder, _claimed(named and _is_robots(folder))
            beside = folder / package
            if (beside / "package.xml").is_file():
                yield beside, _claimed(_is_robots(beside))
        for variable, share in (("ROS_PACKAGE_PATH", ""), ("AMENT_PREFIX_PATH", "share")):
            for entry in os.environ.get(variable, "").split(os.pathsep):
                if entry:
                    yield Path(entry).absolute() / share / package, _Claim.LINKS_TOO
        if package == EXAMPLE_ROBOT_DATA and self._installed is not None:
            yield self._installed, _Claim.ITSELF

    def _is_elsewhere(self, name: str) -> bool:
        """Does a name, as it is written, lead out of the robot's folders?"""
        scheme, colon, inside = name.partition("://")
        if colon and f"{scheme}://" not in (PACKAGE, "file://"):
            return True
        path = Path(os.path.normpath(self._above[0] / (inside if colon else name)))
        return f"{scheme}://" != PACKAGE and not any(path.is_relative_to(folder) for folder in self.own)


def _claimed(itself: bool) -> _Claim:
    return _Claim.ITSELF if itself else _Claim.NOTHING


def _is_robots(folder: Path) -> bool:
    """May a folder be a robot's? Not if it is, or holds, the user's home, or is at the top of the disk."""
    try:
        home = Path.home().resolve()
    except RuntimeError:  # there is no such user
        home = folder.parent
    return len(folder.parts) > 2 and not home.is_relative_to(folder)


# ------------------------------------------------------------------------- what
def _is_plain_stl(where: str, path: Path) -> bool:
    """Is it an STL file of numbers that is as long as it says? Assimp reads such safely.

    Raises:
        RobotError: it is no mesh file, or refers to other files than those beside it.
    """
    ending = path.suffix.lower()
    if ending not in FORMATS:
        raise RobotError(f"{where} is no {', '.join(FORMATS)} file; convert it to .stl")
    _require_readable(where, path, "mesh file")
    if ending == ".gltf":
        try:
            table = load_json(path, RobotError, "export the mesh again, as .stl")
        except RobotError as error:
            raise RobotError(f"{where}: {error}") from None
        for uri in _uris(table):
            if not uri.startswith("data:"):
                _require_beside(where, path, uri)
    elif ending == ".obj":
        for library in _material_libraries(path):
            _require_beside(where, path, library)
    if ending != ".stl":
        return False
    size = path.stat().st_size
    with path.open("rb") as stream:
        head = stream.read(_STL_HEAD)
        count = int.from_bytes(head[80:84], "little")
        if size < _STL_HEAD or size != _STL_HEAD + _STL_FACET.itemsize * count:
            return False  # written as text, or broken
        corners = np.fromfile(stream, dtype=_STL_FACET, count=count)["corners"]
    if not count or not np.isfinite(corners).all():
        wrong = "corners that are no numbers" if count else "no triangles"
        raise RobotError(f"{where} has {wrong}; export it again")
    return True


def _require_readable(where: str, path: Path, what: str) -> None:
    try:
        require_regular(path, MOST_MESH_BYTES, RobotError, what)
        with path.open("rb"):
            pass
    except RobotError as error:
        raise RobotError(f"{where}: {error}") from None
    except OSError as error:
        raise RobotError(f"{where}: {path}: {error.strerror}; make it a {what} that can be read") from None


def _require_beside(where: str, path: Path, name: str) -> None:
    """Only a plain file beside a mesh may be part of it; one that is not there does no harm."""
    part = path.parent / name
    plain = name not in ("", ".", "..") and not any(character in name for character in "/\\:%\0")
    if not plain or (os.path.lexists(part) and not stat.S_ISREG(part.lstat().st_mode)):
        raise RobotError(f"{where} refers to {name[:80]!r}, which is no file beside it; export it again, as .stl")
    if part.exists():
        _require_readable(where, part, "part of a mesh")


def _uris(value: Any) -> Iterator[str]:
    """Every text under a key ``uri`` of a glTF file."""
    if isinstance(value, dict):
        for key, part in value.items():
            if key == "uri" and isinstance(part, str):
                yield part
            else:
                yield from _uris(part)
    elif isinstance(value, list):
        for part in value:
            yield from _uris(part)


def _material_libraries(path: Path) -> Iterator[str]:
    """Every file that an OBJ file names as a library of materials, and the one that is looked for besides."""
    yield f"{path.stem}.mtl"
    content = path.read_bytes().replace(b"\\\r\n", b"").replace(b"\\\n", b"")  # a line that goes on in the next
    for names in re.findall(rb"mtllib([^\r\n\f\0]*)", content):
        yield names.decode("utf-8", "replace").strip().removeprefix("./")


# ------------------------------------------------------------------------ trial
_TRIAL = """
import resource, sys
for limit, most in ((resource.RLIMIT_AS, {most}), (resource.RLIMIT_STACK, 4 << 20), (resource.RLIMIT_CORE, 0)):
    hard = resource.getrlimit(limit)[1]
    try:
        resource.setrlimit(limit, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard))
    except (ValueError, OSError):  # the system has no such limit
        pass
import coal, numpy
loader = coal.MeshLoader(coal.NODE_TYPE.BV_OBBRSS)
for path in sys.stdin.buffer.read().split(b"\\0"):
    print("reading", flush=True)
    mesh = loader.load(path.decode("utf-8", "surrogateescape"), numpy.ones(3))
    assert mesh.num_tris > 0 and numpy.isfinite(mesh.vertices()).all()
    print("read", flush=True)
"""


def _try(doubtful: dict[Path, str]) -> None:
    """Read meshes in a process of its own, which may crash, hang or take all memory; what it has read is safe to read.

    Args:
        doubtful: what to say of each.

    Raises:
        RobotError: one of them cannot be read.
    """
    new = {path: key for path in doubtful if (key := _key(path)) not in _known_good}
    if not new:
        return
    # the path of modules is that of the user, but never the folder he works in, which may be a stranger's
    program = [sys.executable, "-P", "-c", _TRIAL.format(most=TRIAL_BYTES)]
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    paths = b"\0".join(os.fsencode(path) for path in new)
    try:
        trial = subprocess.run(
            program, input=paths, capture_output=True, timeout=TRIAL_SECONDS, check=False, env=environment
        )
        told, took = trial.stdout, ""
    except subprocess.TimeoutExpired as error:
        told, took = error.stdout or b"", f" within {TRIAL_SECONDS:g} s"
    read = told.split().count(b"read")
    _known_good.update(list(new.values())[:read])
    if read < len(new):
        raise RobotError(f"{doubtful[list(new)[read]]} cannot be read{took}; export it again, as .stl")


def _key(path: Path) -> tuple[str, int, int]:
    status = path.stat()
    return str(path), status.st_size, status.st_mtime_ns
