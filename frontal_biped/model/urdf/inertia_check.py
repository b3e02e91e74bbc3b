"""Is the model that Pinocchio made as heavy as the URDF says, body by body?

The text is read a second time here, by another reader: one that drops what it cannot read is found out.
"""

import xml.etree.ElementTree as ElementTree

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import RobotError

SAME = 1e-6
"""Relative difference of inertias that two readers of one text may have by rounding [-]."""


def check_inertias(where: str, full: pin.Model, urdf_text: str) -> None:
    """Compare mass, centre of mass and moments of inertia of every body of a model with those of its links.

    Args:
        where: the URDF, for the message.
        full: 3D model with every joint, made from the text.
        urdf_text: of the URDF, its numbers sound.

    Raises:
        RobotError: a body differs.
    """
    given = np.zeros((full.njoints, 4, 4))
    links: list[list[str]] = [[] for _ in range(full.njoints)]
    for link in ElementTree.fromstring(urdf_text).findall("link"):
        name, inertial = link.get("name", ""), link.find("inertial")
        if inertial is not None and full.existBodyName(name):
            frame = full.frames[full.getFrameId(name, pin.FrameType.BODY)]
            place = frame.placement.homogeneous
            given[frame.parentJoint] += place @ _mass_matrix(inertial) @ place.T
            links[frame.parentJoint].append(name)
    total, mass = pin.computeTotalMass(full), float(given[:, 3, 3].sum())
    wrong = "other inertias than the file gives"
    if not np.isclose(total, mass, rtol=SAME, atol=SAME):
        wrong = f"{total:.6g} kg of {mass:.6g} kg"
    for inertia, text, names in zip(full.inertias, given, links, strict=True):
        read = _second_moments(inertia.mass, inertia.lever, inertia.inertia)
        if not np.allclose(read, text, rtol=SAME, atol=SAME * max(float(np.abs(text).max()), 1e-6)):
            raise RobotError(
                f"{where}: Pinocchio reads {wrong}; look at the <inertial> of {', '.join(map(repr, names))}"
            )


def _mass_matrix(inertial: ElementTree.Element) -> FloatArray:
    """Of one link, in its own frame: see `_second_moments`."""

    def vector(tag: str, key: str, count: int) -> FloatArray:
        element = inertial.find(tag)
        text = None if element is None else element.get(key)
        return np.zeros(count) if text is None else np.array([float(word) for word in text.split()])

    xx, yy, zz, xy, xz, yz = (vector("inertia", key, 1)[0] for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz"))
    turn = pin.rpy.rpyToMatrix(*vector("origin", "rpy", 3))
    moments = turn @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ turn.T
    return _second_moments(float(vector("mass", "value", 1)[0]), vector("origin", "xyz", 3), moments)


def _second_moments(mass: float, com: FloatArray, inertia: FloatArray) -> FloatArray:
    """(4, 4) integral of (x, y, z, 1)' (x, y, z, 1) dm; unlike `pin.Inertia`, of impossible inertias too.

    Args:
        mass: of a body [kg].
        com: (3,) its centre of mass [m].
        inertia: (3, 3) about it [kg m^2].
    """
    place = np.append(com, 1.0)
    moments = mass * np.outer(place, place)
    moments[:3, :3] += 0.5 * np.trace(inertia) * np.eye(3) - inertia
    return moments
