"""Numbers in the text of a URDF, spelled so that every reader takes them for the same.

Python reads "5.0 ", "5_0" and digits of any script; urdfdom, which Pinocchio uses, reads none of them and drops the
whole element instead: a mass, a limit, all shapes of a link.
"""

import math
import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from typing import NamedTuple

from frontal_biped.exceptions import RobotError
from frontal_biped.files.quoted import quoted

_PLAIN = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")
"""What all readers call a number."""

_SMALLEST = 1e-300
"""Smaller numbers are written as 0: urdfdom refuses what underflows."""

LARGEST = {
    **dict.fromkeys(("xyz", "size", "radius", "length"), 1e6),  # [m]; a file in millimetres is still told as one
    "rpy": 1e4,  # [rad]
    "value": 1e6,  # [kg]
    **dict.fromkeys(("ixx", "iyy", "izz", "ixy", "ixz", "iyz"), 1e12),  # [kg m^2], of millimetres
    "scale": 1e6,
}
"""Size from which on a number is none of a robot, and its products would overflow. Limits may be of any size."""

OF_LINK = {
    "origin": {"xyz": 3, "rpy": 3},
    "mass": {"value": 1},
    "inertia": {"ixx": 1, "iyy": 1, "izz": 1, "ixy": 1, "ixz": 1, "iyz": 1},
    "box": {"size": 3},
    "cylinder": {"radius": 1, "length": 1},
    "sphere": {"radius": 1},
    "capsule": {"radius": 1, "length": 1},
    "mesh": {"scale": 3},
}
"""Numbers that an attribute of an element of a link holds."""

OF_JOINT = {
    "origin": {"xyz": 3, "rpy": 3},
    "axis": {"xyz": 3},
    "limit": {"lower": 1, "upper": 1, "effort": 1, "velocity": 1},
    "dynamics": {"damping": 1, "friction": 1},
    "mimic": {"multiplier": 1, "offset": 1},
    "safety_controller": {"soft_lower_limit": 1, "soft_upper_limit": 1, "k_position": 1, "k_velocity": 1},
    "calibration": {"rising": 1, "falling": 1},
}
"""Likewise, of a joint."""


class NumberText(NamedTuple):
    """An attribute that holds numbers.

    Attributes:
        where: link or joint, for messages.
        element: that has the attribute.
        key: of the attribute.
        size: how many numbers it holds.
    """

    where: str
    element: ElementTree.Element
    key: str
    size: int


def number_texts(where: str, root: ElementTree.Element) -> Iterator[NumberText]:
    """Every attribute of links and joints that holds numbers.

    Args:
        where: the file, for messages.
        root: the ``<robot>``.
    """
    for kind, known in (("link", OF_LINK), ("joint", OF_JOINT)):
        for owner in root.findall(kind):
            whose = f"{where}: {kind} {owner.get('name')!r}"
            for element in owner.iter():
                for key, size in known.get(element.tag, {}).items():
                    if element.get(key) is not None:
                        yield NumberText(whose, element, key, size)


def numbers(where: str, element: ElementTree.Element | None, key: str, count: int) -> list[float]:
    """Finite numbers of an attribute, [] where it is absent.

    Raises:
        RobotError: there are more or fewer, they are not spelled as every reader reads them, or too large (`LARGEST`).
    """
    text = None if element is None else element.get(key)
    if text is None:
        return []
    words = text.split()
    values = [float(word) for word in words if _PLAIN.fullmatch(word)]
    if len(values) != len(words) or len(values) != count or not all(math.isfinite(value) for value in values):
        wanted = "a finite number" if count == 1 else f"{count} finite numbers"
        example = " ".join(("0.5", "-1e-3", "2")[:count])
        raise RobotError(f'{where}: {key}={quoted(text)} is not {wanted}; write {key}="{example}" with the true value')
    most = LARGEST.get(key, math.inf)
    if max(map(abs, values)) > most:
        raise RobotError(
            f"{where}: {key}={quoted(text)} is beyond {most:g}; a URDF is in metres, kilograms and radians"
        )
    return values


def plain_spelling(text: str) -> str:
    """Numbers that `numbers` accepts, with single blanks between them and none around."""
    return " ".join(word if abs(float(word)) >= _SMALLEST or _is_zero(word) else "0" for word in text.split())


def _is_zero(word: str) -> bool:
    return not re.search("[1-9]", re.split("[eE]", word)[0])
