"""A gait library on disk.

    DIR/sweep.json           what the library holds, with the fingerprints of its robots; a run that resumes must ask
                             for the same
    DIR/gaits/000012.json    a gait file for every point of the grid that has a gait
    DIR/failures/000013.json what stands in the way where there is none
    DIR/index.csv            one row a point, written when all of them are done

Every file appears whole or not at all, so a library can be killed at any moment and taken up again. A file that is not
of its point, or not of the library's robot, is refused by name.
"""

import csv
import io
import json
import re
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from frontal_biped.exceptions import GaitFileError, LibraryError, SpecificationError
from frontal_biped.files.atomic import write_json, write_text
from frontal_biped.files.reading import load_json
from frontal_biped.gait.file import load_gait, save_gait
from frontal_biped.gait.gait import Gait, OrbitNumbers
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.library.sweep import GridPoint, Sweep, sweep_from_dict

INDEX = "index.csv"
SWEEP = "sweep.json"

AGAIN = "delete it and run `frontal-biped library` again"
"""Remedy for a file of the library that cannot be used: what is missing is designed."""

_FINGERPRINTS = "fingerprints"
_LEFTOVER = re.compile(r"\.\d{6,}\..+\.json|\.(sweep|index)\.[0-9a-f]{8}\.(json|csv)")
"""Temporary files of what the library writes."""


class LibraryStore:
    """Files of a library.

    Args:
        folder: of the library.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def open_for(self, sweep: Sweep, fingerprints: Mapping[str, str]) -> None:
        """Create the library, or check that the one there holds the same grid, of the same robots, and nothing else.

        Only for the one process that builds the library: what one that was killed while writing left behind is removed.

        Args:
            sweep: the grid.
            fingerprints: of its robots, by the names in the grid.

        Raises:
            LibraryError: the folder holds a library of another grid or other robots, or a file that is not of its
                point.
        """
        path = self.folder / SWEEP
        asked = json.loads(json.dumps(sweep.as_dict()))
        known: dict[str, str] = {}
        if path.exists():
            content = self._content()
            known = _known(content, path)
            if content != asked:
                raise LibraryError(f"{path}: the folder holds a library of another sweep; choose a new folder")
            for robot, fingerprint in known.items():
                if fingerprints.get(robot) != fingerprint:
                    raise LibraryError(
                        f"{path}: the library was designed for another URDF or description of {robot!r} than the one"
                        " at hand; choose a new folder, or put the robot back"
                    )
        for point in sweep.points():  # of a library that does not know its robots these files decide whose it is
            self.read(point, fingerprints)
        if not known:
            write_json(path, {**asked, _FINGERPRINTS: dict(fingerprints)})
        for folder in (self.folder, self.folder / "gaits", self.folder / "failures"):
            for leftover in folder.glob(".*"):
                if _LEFTOVER.fullmatch(leftover.name) and not leftover.is_dir():
                    leftover.unlink(missing_ok=True)

    def sweep(self) -> Sweep:
        """The grid of an existing library.

        Raises:
            LibraryError: there is no library, or what says what it holds cannot be read.
        """
        path = self.folder / SWEEP
        content = self._content()
        _known(content, path)
        try:
            return sweep_from_dict(content, str(path))
        except SpecificationError as error:
            raise LibraryError(f"{error}: {_REMADE}") from None

    def fingerprints(self) -> dict[str, str]:
        """Fingerprints of the robots by their names in the grid; empty: an older library, which does not know them.

        Raises:
            LibraryError: as `sweep`.
        """
        return _known(self._content(), self.folder / SWEEP)

    def _content(self) -> dict[str, Any]:
        path = self.folder / SWEEP
        try:
            content = load_json(path, LibraryError, _REMADE)
        except (FileNotFoundError, NotADirectoryError):
            raise LibraryError(f"{path}: not a gait library; make one with `frontal-biped library`") from None
        if not isinstance(content, dict):
            raise LibraryError(f"{path}: not the content of a sweep file; {_REMADE}")
        return content

    def gait_path(self, number: int) -> Path:
        """Where the gait of a point is kept."""
        return self.folder / "gaits" / f"{number:06}.json"

    def failure_path(self, number: int) -> Path:
        """Where the reason is kept that a point has no gait."""
        return self.folder / "failures" / f"{number:06}.json"

    def finished(self, number: int) -> bool:
        """Has a point been designed, with or without success?"""
        return self.gait_path(number).is_file() or self.failure_path(number).is_file()

    def gait(self, point: GridPoint, fingerprints: Mapping[str, str]) -> Gait | None:
        """The gait of a point, or None if it has none.

        Args:
            point: of the grid.
            fingerprints: of the robots by name; those that are not there are not checked.

        Raises:
            LibraryError: the file cannot be read, or is of another point or robot; one line that names it.
        """
        path = self.gait_path(point.number)
        if not path.is_file():
            return None
        try:
            gait = load_gait(path)
        except GaitFileError as error:
            raise LibraryError(f"{error}: {AGAIN}") from None
        fingerprint = fingerprints.get(point.robot)
        if fingerprint is not None and gait.robot.fingerprint != fingerprint:
            raise LibraryError(
                f"{path}: holds a gait of {gait.robot.name!r} with another URDF or description than the library's"
                f" {point.robot!r}; {AGAIN}"
            )
        _require_of_point(path, gait.specification, point)
        return gait

    def failure(self, point: GridPoint, fingerprints: Mapping[str, str]) -> str | None:
        """What stands in the way of a point's gait, or None if nothing is kept.

        Args:
            point: of the grid.
            fingerprints: as `gait`.

        Raises:
            LibraryError: as `gait`.
        """
        path = self.failure_path(point.number)
        if not path.is_file():
            return None
        content = load_json(path, LibraryError, AGAIN)
        message = content.get("message") if isinstance(content, dict) else None
        if not isinstance(message, str):
            raise LibraryError(f"{path}: does not say why its point has no gait; {AGAIN}")
        known = content.get("fingerprint", fingerprints.get(point.robot))  # older files have none
        if content.get("robot") != point.robot or known != fingerprints.get(point.robot, known):
            raise LibraryError(f"{path}: holds a failure of another robot than the library's {point.robot!r}; {AGAIN}")
        table = content.get("specification")
        if not isinstance(table, dict):
            raise LibraryError(f"{path}: specification = {str(table)[:40]} is not a table; {AGAIN}")
        try:
            specification = GaitSpecification.from_dict(table, f"{path}: specification")
        except SpecificationError as error:
            raise LibraryError(f"{error}: {AGAIN}") from None
        _require_of_point(path, specification, point)
        return message

    def read(self, point: GridPoint, fingerprints: Mapping[str, str]) -> Gait | str | None:
        """What is kept of a point: its gait, why it has none, or nothing yet; raises what `gait` does."""
        return self.gait(point, fingerprints) or self.failure(point, fingerprints)

    def save(self, point: GridPoint, gait: Gait | None, message: str, fingerprint: str) -> None:
        """Keep the outcome of a point, for a robot with this fingerprint."""
        if gait is not None:
            save_gait(gait, self.gait_path(point.number))
        else:
            content = {
                "robot": point.robot,
                "fingerprint": fingerprint,
                "specification": point.specification.as_dict(),
                "message": message,
            }
            write_json(self.failure_path(point.number), content)

    def write_index(self, sweep: Sweep) -> Path:
        """Write the table of all points, which are finished; the same library gives the same bytes.

        Raises:
            LibraryError: as `gait`, or a point is not finished.
        """
        stream = io.StringIO()
        writer = csv.writer(stream, lineterminator="\n")
        figures = tuple(OrbitNumbers.__dataclass_fields__)
        writer.writerow(["point", "robot", *sweep.axes, "status", "file", *figures, "step_width_used", "message"])
        fingerprints = self.fingerprints()
        for point in sweep.points():
            writer.writerow(self._row(point, fingerprints, figures))
        path = self.folder / INDEX
        write_text(path, stream.getvalue())
        return path

    def _row(self, point: GridPoint, fingerprints: Mapping[str, str], figures: tuple[str, ...]) -> list[Any]:
        head = [point.number, point.robot, *(_cell(value) for value in point.swept.values())]
        found = self.read(point, fingerprints)
        if found is None:
            raise LibraryError(f"{self.gait_path(point.number)}: has gone while the library was built; run it again")
        if isinstance(found, str):
            return [*head, "none", "", *("" for _ in figures), "", found]
        orbit = asdict(found.orbit)
        file = self.gait_path(point.number).relative_to(self.folder).as_posix()
        return [*head, "gait", file, *(repr(orbit[name]) for name in figures), repr(found.step_width), ""]


_REMADE = "delete it and run the same sweep again: the gaits that are there are checked and kept"


def _known(content: dict[str, Any], path: Path) -> dict[str, str]:
    """Take the fingerprints out of the content of a sweep.json."""
    known = content.pop(_FINGERPRINTS, {})
    if not isinstance(known, dict) or not all(isinstance(value, str) for value in known.values()):
        raise LibraryError(f"{path}: fingerprints = {str(known)[:40]} is not a table of texts; {_REMADE}")
    return known


def _require_of_point(path: Path, specification: GaitSpecification, point: GridPoint) -> None:
    if specification == point.specification:
        return
    held, wanted = specification.as_dict(), point.specification.as_dict()
    key = next(key for key in held | wanted if held.get(key) != wanted.get(key))
    raise LibraryError(
        f"{path}: is of {key} = {_cell(held.get(key))}, point {point.number} of {_cell(wanted.get(key))}; {AGAIN}"
    )


def _cell(value: Any) -> str:
    return json.dumps(value) if isinstance(value, list | tuple) else str(value)
