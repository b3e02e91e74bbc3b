"""A gait library on disk.

    DIR/sweep.json           what the library holds; a run that resumes must ask for the same
    DIR/gaits/000012.json    a gait file for every point of the grid that has a gait
    DIR/failures/000013.json what stands in the way where there is none
    DIR/index.csv            one row a point, written when all of them are done

Every file appears whole or not at all, so a library can be killed at any moment and taken up again.
"""

import csv
import io
import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

from frontal_biped.exceptions import LibraryError
from frontal_biped.files.atomic import write_json, write_text
from frontal_biped.gait.file import load_gait, save_gait
from frontal_biped.gait.gait import Gait, OrbitNumbers
from frontal_biped.library.sweep import GridPoint, Sweep, sweep_from_dict

INDEX = "index.csv"
SWEEP = "sweep.json"


class LibraryStore:
    """Files of a library.

    Args:
        folder: of the library.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def open_for(self, sweep: Sweep) -> None:
        """Create the library, or check that the one there holds the same grid.

        Raises:
            LibraryError: the folder holds a library of another grid.
        """
        path = self.folder / SWEEP
        content = json.loads(json.dumps(sweep.as_dict()))
        if path.is_file():
            if json.loads(path.read_text(encoding="utf-8")) != content:
                raise LibraryError(f"{path}: the folder holds a library of another sweep; choose a new folder")
        else:
            write_json(path, content)
        for name in ("gaits", "failures"):  # left behind by a run that was killed while writing
            for leftover in (self.folder / name).glob(".*"):
                leftover.unlink(missing_ok=True)

    def sweep(self) -> Sweep:
        """The grid of an existing library.

        Raises:
            LibraryError: there is no library.
        """
        path = self.folder / SWEEP
        try:
            table = json.loads(path.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            raise LibraryError(f"{path}: not a gait library; make one with `frontal-biped library`") from None
        return sweep_from_dict(table, str(path))

    def gait_path(self, number: int) -> Path:
        """Where the gait of a point is kept."""
        return self.folder / "gaits" / f"{number:06}.json"

    def failure_path(self, number: int) -> Path:
        """Where the reason is kept that a point has no gait."""
        return self.folder / "failures" / f"{number:06}.json"

    def finished(self, number: int) -> bool:
        """Has a point been designed, with or without success?"""
        return self.gait_path(number).is_file() or self.failure_path(number).is_file()

    def count_finished(self) -> int:
        """Number of points that have been designed."""
        return sum(len(list((self.folder / name).glob("[0-9]*.json"))) for name in ("gaits", "failures"))

    def gait(self, number: int) -> Gait | None:
        """The gait of a point, or None if it has none."""
        path = self.gait_path(number)
        return load_gait(path) if path.is_file() else None

    def save(self, point: GridPoint, gait: Gait | None, message: str) -> None:
        """Keep the outcome of a point."""
        if gait is not None:
            save_gait(gait, self.gait_path(point.number))
        else:
            content = {"robot": point.robot, "specification": point.specification.as_dict(), "message": message}
            write_json(self.failure_path(point.number), content)

    def write_index(self, sweep: Sweep) -> Path:
        """Write the table of all points; the same library gives the same bytes."""
        stream = io.StringIO()
        writer = csv.writer(stream, lineterminator="\n")
        figures = tuple(OrbitNumbers.__dataclass_fields__)
        writer.writerow(["point", "robot", *sweep.axes, "status", "file", *figures, "step_width_used", "message"])
        for point in sweep.points():
            writer.writerow(self._row(point, figures))
        path = self.folder / INDEX
        write_text(path, stream.getvalue())
        return path

    def _row(self, point: GridPoint, figures: tuple[str, ...]) -> list[Any]:
        head = [point.number, point.robot, *(_cell(value) for value in point.swept.values())]
        gait = self.gait(point.number)
        if gait is not None:
            orbit = asdict(gait.orbit)
            file = self.gait_path(point.number).relative_to(self.folder).as_posix()
            return [*head, "gait", file, *(repr(orbit[name]) for name in figures), repr(gait.step_width), ""]
        message = json.loads(self.failure_path(point.number).read_text(encoding="utf-8"))["message"]
        return [*head, "none", "", *("" for _ in figures), "", message]


def _cell(value: Any) -> str:
    return json.dumps(value) if isinstance(value, list | tuple) else str(value)
