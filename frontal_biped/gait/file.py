"""The gait file (JSON): written whole or not at all, read field by field. Format "frontal-biped-gait", version 2.

    format, version          what the file is
    robot                    name, description, fingerprint (SHA-256 of URDF and description); the description is a
                             path from the folder of this file, or the file name of a packaged one (`robot_path`)
    steps                    list of one step that is walked again and again (`Gait`), or of two that are walked in
                             turn, the wide one first (`SidewaysGait`); each:
      rising, falling        each: beta_start, beta_end [rad]; joint_bezier, 3 rows (stance hip, swing hip, swing
                             ankle) of M + 1 coefficients [rad]; fri_bezier, one row [m]
      step_width             L_s, distance between the ankles where it lands [m]
      orbit                  beta_dot_after_impact [rad/s], zeta_f_star [kg^2 m^4/s^2], step_duration [s],
                             cost [N^2 m s], multiplier [-] of the step
    specification            what it was designed for, keys of a specification file
    provenance               versions, seed, solver status, residuals
    look_ahead               of one step, may be left out: what looking ahead answers (`gait.look_ahead_table`)

Numbers are written so that reading gives back the same bits. An unknown or missing field, a wrong shape, a text that is
not one line, a number that is not finite or out of its range (`gait.ranges`) is refused with file, field, value and
remedy. A gait with a finite double support holds a support_step in place of steps (`gait.support_file`).

Version 1, which is read as well, has the fields of its one step beside robot and specification, without a list.
"""

import json
from collections.abc import Mapping
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
from frontal_biped.gait.look_ahead_table import table_from_dict, table_to_dict
from frontal_biped.gait.ranges import GAIT as RANGES
from frontal_biped.gait.ranges import MOST_COEFFICIENTS, require_in_range
from frontal_biped.gait.robot_path import found_description, stored_description
from frontal_biped.gait.shipped import gait_path
from frontal_biped.gait.sideways import AnyGait, SidewaysGait, SidewaysStep, steps_in_turn
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.virtual_constraints.phase import Phase

VERSION = 2

LONGEST_TEXT = 4096
"""Characters of a text of the robot; what a path has at most."""

MOST_PROVENANCE, DEEPEST_PROVENANCE = 10_000, 20
"""Values of the provenance, and tables within tables; designs write some thirty, three deep."""


def save_gait(gait: AnyGait, path: Path | str) -> None:
    """Write a gait file (JSON); numbers round-trip exactly, and the file appears whole or not at all."""
    path = Path(path)
    stored = _of_robot(gait, stored_description(gait.robot.description, path.parent))
    write_text(path, json.dumps(gait_to_dict(stored), indent=1, allow_nan=False) + "\n")


def gait_to_dict(gait: AnyGait) -> dict[str, Any]:
    """Content of a gait file, its robot's description named as in memory."""
    table = gait.look_ahead if isinstance(gait, Gait) else None
    return {
        "format": GAIT,
        "version": VERSION,
        "robot": asdict(gait.robot),
        "steps": [
            {
                "rising": phase_to_dict(step.rising),
                "falling": phase_to_dict(step.falling),
                "step_width": step.step_width,
                "orbit": asdict(step.orbit),
            }
            for step in steps_in_turn(gait)
        ],
        "specification": gait.specification.as_dict(),
        "provenance": dict(gait.provenance),
        **({} if table is None else {"look_ahead": table_to_dict(table)}),
    }


def load_gait(path: Path | str) -> Gait:
    """Read the file of a gait of equal steps, or a packaged gait by the name of its robot; see `gait_path`.

    Raises:
        GaitFileError: there is none, or the file is missing, not JSON, of another format or version, or a field is
            absent, unknown, of the wrong type or shape, or not finite. The message names file, field, value and remedy.
            Only the specification need not be complete: defaults hold where it says nothing. Or it holds two steps.
    """
    path = gait_path(path)
    return _equal_steps(load_any_gait(path), str(path))


def load_any_gait(path: Path | str) -> AnyGait:
    """Read a gait file of equal steps or of two in turn; see `load_gait`.

    Raises:
        GaitFileError: as `load_gait`, but for files of two steps.
    """
    path = gait_path(path)
    gait = any_gait_from_dict(load_gait_json(path), str(path))
    return _of_robot(gait, found_description(gait.robot.description, path.parent))


def gait_from_dict(table: Any, where: str) -> Gait:
    """Gait of equal steps from the content of a gait file; ``where`` begins every complaint.

    Raises:
        GaitFileError: as `load_gait`.
    """
    return _equal_steps(any_gait_from_dict(table, where), where)


def any_gait_from_dict(table: Any, where: str) -> AnyGait:
    """Gait of equal steps, or of two in turn, from the content of a gait file; ``where`` begins every complaint.

    Raises:
        GaitFileError: as `load_any_gait`.
    """
    version = version_of(table, where)
    if SUPPORT_STEP in table and version != 1:
        raise GaitFileError(
            f"{where}: holds a gait with a finite double support; simulate or analyze it, for this design one without"
            " double_support"
        )
    reader = FieldReader(where)
    around = ("format", "version", "robot"), ("specification", "provenance")
    if version == 1:
        reader.no_others("", table, (*around[0], *_STEP, *around[1]))
        steps = [reader.step(table, "")]
    else:
        reader.no_others("", table, (*around[0], "steps", *around[1], "look_ahead"))
        steps = reader.steps(table)
    reference = reader.robot(table)
    specification, provenance = reader.specification(table), reader.provenance(table)
    look_ahead = table_from_dict(table["look_ahead"], where) if "look_ahead" in table else None
    if len(steps) == 1:
        return Gait(reference, *steps[0], specification, provenance, look_ahead)
    if look_ahead is not None:
        raise GaitFileError(f"{where}: look_ahead beside two steps; leave it out, only one step is looked ahead to")
    a, b = (SidewaysStep(*step, specification) for step in steps)
    if a.step_width < b.step_width:
        raise GaitFileError(
            f"{where}: steps[0].step_width = {a.step_width:g} is below steps[1].step_width = {b.step_width:g}; the step"
            " that lands wide comes first, exchange them"
        )
    return SidewaysGait(reference, a, b, provenance)


def version_of(table: Any, where: str) -> int:
    """Version of the content of a gait file.

    Raises:
        GaitFileError: it is none, or of a version that is not read.
    """
    if not isinstance(table, dict) or table.get("format") != GAIT:
        raise GaitFileError(
            f'{where}: not a gait file, "format" is not {GAIT!r}; write one with `frontal-biped design`'
        )
    version = table.get("version")
    if isinstance(version, bool) or version not in (1, VERSION):  # JSON's true equals 1 in Python
        raise GaitFileError(
            f'{where}: "version" is {quoted(version)}, this program reads 1 and {VERSION}; design it again'
        )
    return int(version)


def gait_of_run(content: Mapping[str, Any], where: str) -> Gait | None:
    """The gait of equal steps that a run tells of, to be drawn beside it; None where it tells of none, or of two steps.

    Raises:
        GaitFileError: as `load_any_gait`.
    """
    gait = any_gait_from_dict(dict(content), where) if "format" in content else None
    return gait if isinstance(gait, Gait) else None


def _equal_steps(gait: AnyGait, where: str) -> Gait:
    if isinstance(gait, SidewaysGait):
        raise GaitFileError(
            f"{where}: holds two steps, the gait travels sideways; simulate or analyze it, for this design one on the"
            " spot, without travel"
        )
    return gait


def _of_robot(gait: AnyGait, description: str) -> AnyGait:
    return replace(gait, robot=replace(gait.robot, description=description))


def phase_to_dict(phase: Phase) -> dict[str, Any]:
    """A phase as a gait file holds it."""
    return {
        "beta_start": phase.beta_start,
        "beta_end": phase.beta_end,
        "joint_bezier": phase.joint_bezier.tolist(),
        "fri_bezier": phase.fri_bezier.tolist(),
    }


def load_gait_json(path: Path) -> Any:
    """What a gait file holds, not looked at.

    Raises:
        GaitFileError: the file is missing, of another kind, or not JSON.
    """
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


SUPPORT_STEP = "support_step"
"""Field of a gait with a finite double support, in place of the steps."""

_STEP = ("rising", "falling", "step_width", "orbit")
"""Fields of a step."""

_Step = tuple[Phase, Phase, float, OrbitNumbers]


class FieldReader:
    """Checked access to the fields of a gait file; every complaint names file, field and value."""

    def __init__(self, where: str) -> None:
        self.where = where

    def no_others(self, section: str, table: dict[str, Any], known: tuple[str, ...]) -> None:
        """Refuse fields that are not known."""
        for key in table:
            if key not in known:
                place = f"{section}: " if section else ""
                raise GaitFileError(
                    f"{self.where}: {place}unknown field {quoted(key)}; known fields: {', '.join(known)}"
                )

    def table(self, parent: dict[str, Any], key: str, known: tuple[str, ...] | None, place: str = "") -> dict[str, Any]:
        """A table within a table, its fields known; None: any."""
        name = f"{place}{key}"
        if not isinstance(parent.get(key), dict):
            raise GaitFileError(f"{self.where}: field {name!r} is missing or not an object; design the gait again")
        table: dict[str, Any] = parent[key]
        if known is not None:
            self.no_others(name, table, known)
        return table

    def robot(self, table: dict[str, Any]) -> RobotReference:
        """Which robot."""
        keys = ("name", "description", "fingerprint")
        robot = self.table(table, "robot", keys)
        return RobotReference(*(self.text(robot, "robot", key) for key in keys))

    def text(self, table: dict[str, Any], section: str, key: str) -> str:
        """One line of text."""
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
        """A finite number in its range."""
        name = f"{section}.{key}" if section else key
        value = as_finite(table.get(key))
        if value is None:
            raise GaitFileError(f"{self.where}: {name} = {quoted(table.get(key))} is not a finite number")
        if key in _POSITIVE and value <= 0.0:
            raise GaitFileError(f"{self.where}: {name} = {value:g} must be positive; design the gait again")
        require_in_range(f"{self.where}: {name}", value, RANGES[key], GaitFileError)
        return value

    def steps(self, table: dict[str, Any]) -> list[_Step]:
        """One step, or two."""
        found = table.get("steps")
        if not isinstance(found, list) or len(found) not in (1, 2):
            raise GaitFileError(
                f"{self.where}: field 'steps' is missing or no list of one step or of two; design the gait again"
            )
        steps = []
        for i, fields in enumerate(found):
            if not isinstance(fields, dict):
                raise GaitFileError(f"{self.where}: steps[{i}] = {quoted(fields)} is not an object; design it again")
            self.no_others(f"steps[{i}]", fields, _STEP)
            steps.append(self.step(fields, f"steps[{i}]."))
        return steps

    def step(self, table: dict[str, Any], place: str) -> _Step:
        """One step; ``place`` goes before the names of its fields."""
        rising, falling = (self.phase(table, name, place) for name in ("rising", "falling"))
        if not rising.beta_start < rising.beta_end:
            raise GaitFileError(
                f"{self.where}: {place}rising: beta_start must be below beta_end, rising means dbeta > 0"
            )
        if not falling.beta_start > falling.beta_end:
            raise GaitFileError(
                f"{self.where}: {place}falling: beta_start must be above beta_end, falling means dbeta < 0"
            )
        orbit = self.table(table, "orbit", tuple(OrbitNumbers.__dataclass_fields__), place)
        numbers = OrbitNumbers(*(self.number(orbit, f"{place}orbit", key) for key in OrbitNumbers.__dataclass_fields__))
        return rising, falling, self.number(table, place.removesuffix("."), "step_width"), numbers

    def phase(self, table: dict[str, Any], name: str, place: str) -> Phase:
        """A phase of a step."""
        fields = self.table(table, name, ("beta_start", "beta_end", "joint_bezier", "fri_bezier"), place)
        name = f"{place}{name}"
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
        """What it was designed for."""
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
        """Numbers, in one row or in rows of equal length."""
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


_POSITIVE = ("step_width", "double_support", "setting_off", *OrbitNumbers.__dataclass_fields__)
