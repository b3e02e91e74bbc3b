"""The gait file (JSON): written whole or not at all, read field by field. Format "frontal-biped-gait", version 1.

    format, version          what the file is
    robot                    name, description, fingerprint (SHA-256 of URDF and description); the description is a
                             path from the folder of this file, or the file name of a packaged one (`robot_path`)
    rising, falling          each: beta_start, beta_end [rad]; joint_bezier, 3 rows (stance hip, swing hip, swing
                             ankle) of M + 1 coefficients [rad]; fri_bezier, one row [m]
    step_width               L_s, distance between the ankles [m]
    orbit                    beta_dot_after_impact [rad/s], zeta_f_star [kg^2 m^4/s^2], step_duration [s],
                             cost [N^2 m s], multiplier [-]
    specification            what it was designed for, keys of a specification file
    provenance               versions, seed, solver status, residuals

Numbers are written so that reading gives back the same bits. An unknown or missing field, a wrong shape, a text that is
not one line, a number that is not finite or out of its range (`gait.ranges`) is refused with file, field, value and
remedy.
"""

import json
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import GaitFileError, SpecificationError
from frontal_biped.files.atomic import write_text
from frontal_biped.files.kinds import GAIT, WORDS, archive_format, named_kind
from frontal_biped.files.quoted import quoted
from frontal_biped.files.reading import MOST_JSON_BYTES, load_json
from frontal_biped.files.toml import as_finite
from frontal_biped.gait.gait import Gait, OrbitNumbers, RobotReference
from frontal_biped.gait.ranges import GAIT as RANGES
from frontal_biped.gait.ranges import MOST_COEFFICIENTS, require_in_range
from frontal_biped.gait.robot_path import found_description, stored_description
from frontal_biped.gait.shipped import gait_path
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.virtual_constraints.phase import Phase

VERSION = 1

LONGEST_TEXT = 4096
"""Characters of a text of the robot; what a path has at most."""

MOST_PROVENANCE, DEEPEST_PROVENANCE = 10_000, 20
"""Values of the provenance, and tables within tables; designs write some thirty, three deep."""


def save_gait(gait: Gait, path: Path | str) -> None:
    """Write a gait file (JSON); numbers round-trip exactly, and the file appears whole or not at all."""
    path = Path(path)
    stored = _of_robot(gait, stored_description(gait.robot.description, path.parent))
    write_text(path, json.dumps(gait_to_dict(stored), indent=1, allow_nan=False) + "\n")


def gait_to_dict(gait: Gait) -> dict[str, Any]:
    """Content of a gait file, its robot's description named as in memory."""
    return {
        "format": GAIT,
        "version": VERSION,
        "robot": asdict(gait.robot),
        "rising": _phase_to_dict(gait.rising),
        "falling": _phase_to_dict(gait.falling),
        "step_width": gait.step_width,
        "orbit": asdict(gait.orbit),
        "specification": gait.specification.as_dict(),
        "provenance": dict(gait.provenance),
    }


def load_gait(path: Path | str) -> Gait:
    """Read a gait file, or a packaged gait by the name of its robot; see `gait_path`.

    Raises:
        GaitFileError: there is none, or the file is missing, not JSON, of another format or version, or a field is
            absent, unknown, of the wrong type or shape, or not finite. The message names file, field, value and remedy.
            Only the specification need not be complete: defaults hold where it says nothing.
    """
    path = gait_path(path)
    gait = gait_from_dict(_load_json(path), str(path))
    return _of_robot(gait, found_description(gait.robot.description, path.parent))


def gait_from_dict(table: Any, where: str) -> Gait:
    """Gait from the content of a gait file; ``where`` begins every complaint.

    Raises:
        GaitFileError: as `load_gait`.
    """
    if not isinstance(table, dict) or table.get("format") != GAIT:
        raise GaitFileError(
            f'{where}: not a gait file, "format" is not {GAIT!r}; write one with `frontal-biped design`'
        )
    if isinstance(table.get("version"), bool) or table.get("version") != VERSION:  # JSON's true equals 1 in Python
        raise GaitFileError(
            f'{where}: "version" is {quoted(table.get("version"))}, this program reads {VERSION}; design it again'
        )
    reader = _Reader(where)
    known = ("format", "version", "robot", "rising", "falling", "step_width", "orbit", "specification", "provenance")
    reader.no_others("", table, known)
    robot = reader.table(table, "robot", ("name", "description", "fingerprint"))
    orbit = reader.table(table, "orbit", tuple(OrbitNumbers.__dataclass_fields__))
    rising, falling = (reader.phase(table, name) for name in ("rising", "falling"))
    if not rising.beta_start < rising.beta_end:
        raise GaitFileError(f"{where}: rising: beta_start must be below beta_end, rising means dbeta > 0")
    if not falling.beta_start > falling.beta_end:
        raise GaitFileError(f"{where}: falling: beta_start must be above beta_end, falling means dbeta < 0")
    return Gait(
        RobotReference(*(reader.text(robot, "robot", key) for key in ("name", "description", "fingerprint"))),
        rising,
        falling,
        reader.number(table, "", "step_width"),
        OrbitNumbers(*(reader.number(orbit, "orbit", key) for key in OrbitNumbers.__dataclass_fields__)),
        reader.specification(table),
        reader.provenance(table),
    )


def _of_robot(gait: Gait, description: str) -> Gait:
    return replace(gait, robot=replace(gait.robot, description=description))


def _phase_to_dict(phase: Phase) -> dict[str, Any]:
    return {
        "beta_start": phase.beta_start,
        "beta_end": phase.beta_end,
        "joint_bezier": phase.joint_bezier.tolist(),
        "fri_bezier": phase.fri_bezier.tolist(),
    }


def _load_json(path: Path) -> Any:
    other = _other_kind(path)
    if other is not None and other != WORDS[GAIT]:
        raise GaitFileError(f"{path}: is {other}, not {WORDS[GAIT]}; write one with `frontal-biped design`")
    try:
        return load_json(path, GaitFileError, "is the file cut off? design the gait again", finite=False)
    except FileNotFoundError:
        raise GaitFileError(
            f"{path}: no such gait file; write one with `frontal-biped design -o {path.name}`"
        ) from None


def _other_kind(path: Path) -> str | None:
    """What a file is, in words; only archives may be large."""
    if path.is_file() and path.stat().st_size > MOST_JSON_BYTES:
        return WORDS.get(archive_format(path))
    return named_kind(path)


class _Reader:
    """Checked access to the fields of a gait file; every complaint names file, field and value."""

    def __init__(self, where: str) -> None:
        self.where = where

    def no_others(self, section: str, table: dict[str, Any], known: tuple[str, ...]) -> None:
        for key in table:
            if key not in known:
                place = f"{section}: " if section else ""
                raise GaitFileError(
                    f"{self.where}: {place}unknown field {quoted(key)}; known fields: {', '.join(known)}"
                )

    def table(self, parent: dict[str, Any], key: str, known: tuple[str, ...] | None) -> dict[str, Any]:
        if not isinstance(parent.get(key), dict):
            raise GaitFileError(f"{self.where}: field {key!r} is missing or not an object; design the gait again")
        table: dict[str, Any] = parent[key]
        if known is not None:
            self.no_others(key, table, known)
        return table

    def text(self, table: dict[str, Any], section: str, key: str) -> str:
        value = table.get(key)
        if not isinstance(value, str):
            raise GaitFileError(f"{self.where}: {section}.{key} = {quoted(value)} is not text")
        if not value.isprintable() or len(value) > LONGEST_TEXT:
            raise GaitFileError(
                f"{self.where}: {section}.{key} = {quoted(value)} is not one line of at most {LONGEST_TEXT} printable"
                " characters; write it so"
            )
        return value

    def number(self, table: dict[str, Any], section: str, key: str) -> float:
        name = f"{section}.{key}" if section else key
        value = as_finite(table.get(key))
        if value is None:
            raise GaitFileError(f"{self.where}: {name} = {quoted(table.get(key))} is not a finite number")
        if key in _POSITIVE and value <= 0.0:
            raise GaitFileError(f"{self.where}: {name} = {value:g} must be positive; design the gait again")
        require_in_range(f"{self.where}: {name}", value, RANGES[key], GaitFileError)
        return value

    def phase(self, table: dict[str, Any], name: str) -> Phase:
        fields = self.table(table, name, ("beta_start", "beta_end", "joint_bezier", "fri_bezier"))
        joints, fri = self.array(fields, name, "joint_bezier"), self.array(fields, name, "fri_bezier")
        if joints.ndim != 2 or joints.shape[0] != 3 or joints.shape[1] < 4:
            raise GaitFileError(
                f"{self.where}: {name}.joint_bezier has shape {joints.shape}, not 3 rows (stance hip, swing hip,"
                " swing ankle) of at least 4 coefficients"
            )
        for row, key in ((joints[0], "joint_bezier"), (fri, "fri_bezier")):
            if row.size > MOST_COEFFICIENTS:
                raise GaitFileError(
                    f"{self.where}: {name}.{key} has {row.size} coefficients, more than {MOST_COEFFICIENTS}; they do"
                    " not determine a polynomial of such a degree, write some of a lower one"
                )
        if fri.ndim != 1 or fri.size < 2:
            raise GaitFileError(f"{self.where}: {name}.fri_bezier has shape {fri.shape}, not one row of at least 2")
        return Phase(self.number(fields, name, "beta_start"), self.number(fields, name, "beta_end"), joints, fri)

    def specification(self, table: dict[str, Any]) -> GaitSpecification:
        try:
            return GaitSpecification.from_dict(self.table(table, "specification", None), f"{self.where}: specification")
        except SpecificationError as error:
            raise GaitFileError(str(error)) from None

    def provenance(self, table: dict[str, Any]) -> dict[str, Any]:
        """Any JSON, so that it can be written again and shown."""
        found = self.table(table, "provenance", None)
        left: list[tuple[Any, int]] = [(found, 0)]
        seen = 0
        while left:
            value, depth = left.pop()
            parts = list(value.values()) if isinstance(value, dict) else value if isinstance(value, list) else []
            seen += len(parts)
            if seen > MOST_PROVENANCE or depth > DEEPEST_PROVENANCE:
                raise GaitFileError(
                    f"{self.where}: provenance has more than {MOST_PROVENANCE} values, or is more than"
                    f" {DEEPEST_PROVENANCE} tables deep; keep in it how the gait was made"
                )
            if isinstance(value, int | float) and not isinstance(value, bool) and as_finite(value) is None:
                raise GaitFileError(f"{self.where}: provenance holds {quoted(value)}, which is not a finite number")
            left += [(part, depth + 1) for part in parts]
        return found

    def array(self, table: dict[str, Any], section: str, key: str) -> FloatArray:
        name = f"{self.where}: {section}.{key}"
        value = table.get(key)
        rows = value if isinstance(value, list) else []
        nested = [row if isinstance(row, list) else [row] for row in rows]
        if not rows or len({(isinstance(row, list), len(flat)) for row, flat in zip(rows, nested, strict=True)}) != 1:
            raise GaitFileError(f"{name} is not an array of numbers with rows of equal length")
        for entry in (entry for flat in nested for entry in flat):
            number = as_finite(entry)
            if number is None:
                raise GaitFileError(f"{name} holds {quoted(entry)}, which is not a finite number; write plain numbers")
            require_in_range(name, number, RANGES[key], GaitFileError)
        return np.array(rows, dtype=float)


_POSITIVE = ("step_width", *OrbitNumbers.__dataclass_fields__)
