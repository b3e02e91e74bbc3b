"""Gait files of gaits with a finite double support, and files of any kind of gait.

Format, version, robot, specification and provenance are those of every gait file (`gait.file`); in place of the steps:

    support_step
      rising                 curve from the lift-off to the reversal, as of any gait; falling is the same backwards
      step_width             distance between the ankles [m]
      setting_off            duration of the motion from rest to the first lift-off [s]
      pressure_margin        kept by the pressure point on that way, besides the FRI margin [m]
      orbit                  beta_dot_after_impact, at the lift-off [rad/s]; step_duration, double_support [s];
                             cost [N^2 m s]

The specification holds double_support. What is read is written again byte for byte.
"""

import json
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any, TypeVar

from frontal_biped.exceptions import GaitFileError, SpecificationError
from frontal_biped.files.atomic import write_text
from frontal_biped.files.kinds import GAIT
from frontal_biped.gait.file import (
    SUPPORT_STEP,
    VERSION,
    FieldReader,
    any_gait_from_dict,
    load_gait_json,
    phase_to_dict,
    version_of,
)
from frontal_biped.gait.robot_path import found_description, stored_description
from frontal_biped.gait.shipped import gait_path
from frontal_biped.gait.sideways import AnyGait
from frontal_biped.gait.support_gait import SupportGait, SupportNumbers, SupportSpecification

FiledGait = AnyGait | SupportGait
"""What a gait file can hold."""

_G = TypeVar("_G", bound=FiledGait)

_STEP = ("rising", "step_width", "setting_off", "pressure_margin", "orbit")
_ORBIT = ("beta_dot_after_impact", "step_duration", "double_support", "cost")


def save_support_gait(gait: SupportGait, path: Path | str) -> None:
    """Write a gait file (JSON); numbers round-trip exactly, and the file appears whole or not at all.

    Raises:
        GaitFileError: the gait is not designed to its end, it has no numbers.
    """
    path = Path(path)
    stored = _of_robot(gait, stored_description(gait.robot.description, path.parent))
    write_text(path, json.dumps(support_gait_to_dict(stored), indent=1, allow_nan=False) + "\n")


def support_gait_to_dict(gait: SupportGait) -> dict[str, Any]:
    """Content of a gait file, its robot's description named as in memory.

    Raises:
        GaitFileError: the gait has no numbers.
    """
    if gait.numbers is None:
        raise GaitFileError(f"gait = {gait!r}: its orbit is not known yet; write one of `design_support_gait`")
    duration, double_support, cost = gait.numbers
    return {
        "format": GAIT,
        "version": VERSION,
        "robot": asdict(gait.robot),
        SUPPORT_STEP: {
            "rising": phase_to_dict(gait.rising),
            "step_width": gait.width,
            "setting_off": gait.setting_off,
            "pressure_margin": gait.asked.pressure_margin,
            "orbit": dict(zip(_ORBIT, (gait.speed, duration, double_support, cost), strict=True)),
        },
        "specification": gait.specification.as_dict(),
        "provenance": dict(gait.provenance),
    }


def load_support_gait(path: Path | str) -> SupportGait:
    """Read the file of a gait with a finite double support.

    Raises:
        GaitFileError: as `load_filed_gait`, or the file holds another kind of gait.
    """
    gait = load_filed_gait(path)
    if not isinstance(gait, SupportGait):
        raise GaitFileError(
            f"{path}: holds a gait with impacts; design one with double_support in its specification for this"
        )
    return gait


def load_filed_gait(path: Path | str) -> FiledGait:
    """Read a gait file of any kind, or a packaged gait by the name of its robot.

    Raises:
        GaitFileError: there is none, or the file is missing, not JSON, of another format or version, or a field is
            absent, unknown, of the wrong type or shape, not finite or out of range; one line.
    """
    path = gait_path(path)
    table, where = load_gait_json(path), str(path)
    version = version_of(table, where)
    of_support = SUPPORT_STEP in table and version == VERSION
    gait = support_gait_from_dict(table, where) if of_support else any_gait_from_dict(table, where)
    return _of_robot(gait, found_description(gait.robot.description, path.parent))


def support_gait_from_dict(table: dict[str, Any], where: str) -> SupportGait:
    """The gait of the content of a gait file that has a support_step; ``where`` begins every complaint.

    Raises:
        GaitFileError: as `load_filed_gait`.
    """
    version_of(table, where)
    reader = FieldReader(where)
    reader.no_others("", table, ("format", "version", "robot", SUPPORT_STEP, "specification", "provenance"))
    robot, step = reader.robot(table), reader.table(table, SUPPORT_STEP, _STEP)
    place = f"{SUPPORT_STEP}."
    rising = reader.phase(step, "rising", place)
    if not rising.beta_start < rising.beta_end:
        raise GaitFileError(f"{where}: {place}rising: beta_start must be below beta_end, rising means dbeta > 0")
    width, setting_off, margin = (reader.number(step, SUPPORT_STEP, key) for key in _STEP[1:4])
    orbit = reader.table(step, "orbit", _ORBIT, place)
    speed, *numbers = (reader.number(orbit, f"{place}orbit", key) for key in _ORBIT)
    bounds, provenance = reader.specification(table), reader.provenance(table)
    if bounds.double_support is None:
        raise GaitFileError(f"{where}: specification.double_support is missing; write the range asked for, [0.1, 0.2]")
    try:
        asked = SupportSpecification(bounds, margin)
    except SpecificationError as error:
        raise GaitFileError(f"{where}: {place}{error}") from None
    return SupportGait(robot, rising, width, speed, setting_off, asked, SupportNumbers(*numbers), provenance)


def _of_robot(gait: _G, description: str) -> _G:
    return replace(gait, robot=replace(gait.robot, description=description))
