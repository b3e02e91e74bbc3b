"""Other masses in the text of a URDF: the same bodies of another density.

A link keeps its shape and its centre of mass; its inertia is scaled with its mass.
"""

import xml.etree.ElementTree as ElementTree
from collections.abc import Mapping

from frontal_biped.exceptions import RobotError
from frontal_biped.files.toml import finite_number
from frontal_biped.numerics.by_name import suggestion


def with_total_mass(urdf_text: str, mass: float, where: str) -> str:
    """The text with every mass and inertia scaled alike.

    Args:
        urdf_text: of a checked URDF (`read_urdf`).
        mass: of all links together [kg].
        where: begins every complaint.

    Raises:
        RobotError: the mass is no positive number, or the robot has none to scale.
    """
    root = ElementTree.fromstring(urdf_text)
    masses = {name: _mass(inertial) for name, inertial in _inertials(root).items()}
    total = sum(masses.values())
    if total <= 0.0:
        raise RobotError(f"{where}: no link has a mass to scale; give the links an <inertial>")
    factor = _positive(f"{where}: total mass", mass) / total
    for inertial in _inertials(root).values():
        _scale(inertial, factor)
    return ElementTree.tostring(root, encoding="unicode")


def with_link_masses(urdf_text: str, masses: Mapping[str, float], where: str) -> str:
    """The text with the masses of some links changed, and their inertias scaled along.

    Args:
        urdf_text: of a checked URDF (`read_urdf`).
        masses: by the URDF name of the link [kg].
        where: begins every complaint.

    Raises:
        RobotError: there is no such link, it has no mass to scale, or a mass is no positive number.
    """
    root = ElementTree.fromstring(urdf_text)
    links = [link.get("name", "") for link in root.findall("link")]
    inertials = _inertials(root)
    for name, mass in masses.items():
        if name not in links:
            raise RobotError(f"{where}: the URDF has no link {name!r}; {suggestion(name, links)}")
        if name not in inertials or _mass(inertials[name]) <= 0.0:
            raise RobotError(f"{where}: link {name!r} has no mass to scale; give it an <inertial> in the URDF")
        inertial = inertials[name]
        _scale(inertial, _positive(f"{where}: mass of link {name!r}", mass) / _mass(inertial))
    return ElementTree.tostring(root, encoding="unicode")


def _positive(where: str, mass: object) -> float:
    number = finite_number(where, mass, RobotError)
    if number <= 0.0:
        raise RobotError(f"{where} = {number:g} kg must be positive")
    return number


def _inertials(root: ElementTree.Element) -> dict[str, ElementTree.Element]:
    """Of the links that have one, by their names."""
    found = {link.get("name", ""): link.find("inertial") for link in root.findall("link")}
    return {name: inertial for name, inertial in found.items() if inertial is not None}


def _mass(inertial: ElementTree.Element) -> float:
    element = inertial.find("mass")
    return 0.0 if element is None else float(element.attrib["value"])


def _scale(inertial: ElementTree.Element, factor: float) -> None:
    for element in (inertial.find("mass"), inertial.find("inertia")):
        if element is not None:
            element.attrib.update({key: repr(float(value) * factor) for key, value in element.attrib.items()})
