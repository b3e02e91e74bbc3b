r"""The planar chain from the decimal numbers of URDF and description, in ball arithmetic.

What `model.urdf.reduction` does in floating point: the links at the posture, each lumped to the body that moves it
(the pelvis, or the last of the four roll joints before it), projected, and the legs made mirror images,

.. math:: m = \sum m_i, \qquad m c = \sum m_i c_i, \qquad
          I = \sum I_i + m_i (c_i - c)^2, \qquad I_i = e_x^T R_i \bar I_i R_i^T e_x,

with c in (y, z). Every number is the decimal one of the text: a ball whose radius is the rounding to `FINE` bits, not
a double. Of the description, which is kept as doubles, it is the shortest decimal number that reads as that double: the
one in the file, unless somebody wrote more than fifteen digits.
"""

import xml.etree.ElementTree as ElementTree
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.chain import FrontalChain, PlanarBody
from frontal_biped.model.robot import Robot
from frontal_biped.model.urdf.projection import PELVIS, FrontalBodies, RollJoint
from frontal_biped.model.urdf.symmetry import symmetrised
from frontal_biped.zero_dynamics.proof.balls import Ball, arb, arb_mat, working_precision
from frontal_biped.zero_dynamics.proof.chain import BallChain

FINE = 200
"""Bits of this arithmetic: beside the rest of a proof its radii vanish."""


class _Link(NamedTuple):
    """A link at the posture.

    Attributes:
        rotation: (3, 3), to the world.
        origin: (3, 1) [m].
        moved_by: key of the roll joint that moves it, or `PELVIS`.
    """

    rotation: arb_mat
    origin: arb_mat
    moved_by: str


def decimal_chain(biped: FrontalBiped) -> BallChain:
    """The chain of a robot.

    Args:
        biped: the robot. One with errors of its own (`FrontalBiped.perturbed`) has no decimal numbers: the doubles
            of its chain are taken, as exact.
    """
    if biped.fingerprint != biped.robot.fingerprint:
        return BallChain.of(biped.chain)
    with working_precision(FINE):
        bodies = symmetrised(_bodies(biped.robot, biped.measured))
        sole = replace(biped.description.sole, ankle_height=_decimal(biped.description.sole.ankle_height))
        chain: FrontalChain = bodies.chain(sole)
        return BallChain.of(chain)


def _bodies(robot: Robot, measured: FrontalBodies) -> FrontalBodies:
    """The robot in its frontal plane, arrays of balls; limits of joints as measured, for no dynamics depend on them."""
    tree = ElementTree.fromstring(robot.urdf_text)
    links = _links(tree, robot)
    position: dict[str, Any] = {}
    for joint in tree.findall("joint"):
        for key, name in robot.description.joints.items():
            if joint.get("name") == name:
                position[key] = _plane(links[_named(joint, "child")].origin)
    shares: dict[str, list[PlanarBody]] = {key: [] for key in measured.body}
    for element in tree.findall("link"):
        inertial, link = element.find("inertial"), links[element.get("name", "")]
        if inertial is not None:
            shares[link.moved_by].append(_planar(inertial, link))
    joints = {key: _with_rotor(joint, robot.description.actuator(key)[1]) for key, joint in measured.joint.items()}
    return FrontalBodies(position, {key: _lumped(parts) for key, parts in shares.items()}, joints)


def _with_rotor(joint: RollJoint, armature: float) -> RollJoint:
    return joint._replace(armature=_decimal(armature))


def _links(tree: ElementTree.Element, robot: Robot) -> dict[str, _Link]:
    """Every link, from the root outwards."""
    description = robot.description
    leaving: dict[str, list[ElementTree.Element]] = {}
    for joint in tree.findall("joint"):
        leaving.setdefault(_named(joint, "parent"), []).append(joint)
    children = {_named(joint, "child") for joint in tree.findall("joint")}
    root = next(name for link in tree.findall("link") if (name := link.get("name", "")) not in children)
    key_of = {name: key for key, name in description.joints.items()}
    base = _rpy([_decimal(angle) for angle in description.base_rpy])
    links = {root: _Link(base, _column([arb(0)] * 3), PELVIS)}
    todo = [root]
    while todo:
        parent = links[at := todo.pop()]
        for joint in leaving.get(at, []):
            name, child = joint.get("name", ""), _named(joint, "child")
            xyz, rotation = _placement(joint.find("origin"))
            origin = parent.origin + parent.rotation * _column(xyz)
            turn, slide = _motion(joint, _decimal(description.posture.get(name, 0.0)))
            rotation = parent.rotation * rotation
            links[child] = _Link(rotation * turn, origin + rotation * slide, key_of.get(name, parent.moved_by))
            todo.append(child)
    return links


def _motion(joint: ElementTree.Element, at: Ball) -> tuple[arb_mat, arb_mat]:
    """Rotation and translation of a joint; of more than one freedom it is at rest."""
    axis = _numbers(joint.find("axis"), "xyz", "1 0 0")
    nowhere = _column([arb(0)] * 3)
    kind = joint.get("type")
    if kind not in ("revolute", "continuous", "prismatic") or at == 0:
        return _identity(), nowhere
    length = sum((x * x for x in axis), arb(0)).sqrt()
    x, y, z = (component / length for component in axis)
    if kind == "prismatic":
        return _identity(), _column([x * at, y * at, z * at])
    sin, cos = at.sin_cos()
    across = arb_mat([[arb(0), -z, y], [z, arb(0), -x], [-y, x, arb(0)]])
    return _identity() + across * sin + across * across * (1 - cos), nowhere  # Rodrigues' formula


def _planar(inertial: ElementTree.Element, link: _Link) -> PlanarBody:
    mass = _numbers(inertial.find("mass"), "value", "0")[0]
    xyz, own = _placement(inertial.find("origin"))
    inertia = {
        key: _numbers(inertial.find("inertia"), key, "0")[0] for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    }
    about = arb_mat([[inertia["i" + "".join(sorted(a + b))] for b in "xyz"] for a in "xyz"])
    to_world = link.rotation * own
    turned: Any = to_world * about * to_world.transpose()
    return PlanarBody(mass, _plane(link.origin + link.rotation * _column(xyz)), turned[0, 0])


def _lumped(parts: Sequence[PlanarBody]) -> PlanarBody:
    """One body of some in rigid connection."""
    nothing: Any = arb(0)
    mass = sum((part.mass for part in parts), nothing)
    com = sum((part.com * part.mass for part in parts), nothing) / mass
    inertia = sum((part.inertia + part.mass * ((part.com - com) ** 2).sum() for part in parts), nothing)
    return PlanarBody(mass, com, inertia)


def _placement(origin: ElementTree.Element | None) -> tuple[list[Ball], arb_mat]:
    return _numbers(origin, "xyz", "0 0 0"), _rpy(_numbers(origin, "rpy", "0 0 0"))


def _rpy(angles: Sequence[Ball]) -> arb_mat:
    """Turned about fixed axes by roll, pitch and yaw, in this order [rad]."""
    (sr, cr), (sp, cp), (sy, cy) = (angle.sin_cos() for angle in angles)
    return arb_mat(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def _named(joint: ElementTree.Element, end: str) -> str:
    element = joint.find(end)
    return "" if element is None else element.get("link", "")


def _numbers(element: ElementTree.Element | None, key: str, default: str) -> list[Ball]:
    text = default if element is None else element.get(key, default)
    return [arb(word) for word in text.split()]


def _decimal(number: float) -> Ball:
    return arb(repr(float(number)))


def _column(values: Sequence[Ball]) -> arb_mat:
    return arb_mat([[value] for value in values])


def _identity() -> arb_mat:
    return arb_mat([[arb(int(i == j)) for j in range(3)] for i in range(3)])


def _plane(point: arb_mat) -> Any:
    """(y, z)."""
    return np.array([point[1, 0], point[2, 0]])
