"""The same robot in a text that urdfdom, Pinocchio and MuJoCo read as it is meant.

Those readers are touchier than the format is: they drop what they cannot read, with words on the C-level standard error
only, or refuse the whole file. What can be said without doubt in words that they understand is said so here. A text
that needs nothing of this stays as it is, byte for byte: the fingerprints of gaits are made of it.

    blanks around numbers              dropped, tabs and line breaks between them too
    a link that bears a joint's name   ..._link (names of links and of joints are apart in a URDF, not in Pinocchio)
    a link called "world"              world_link (MuJoCo has a body of that name)
    a root link without mass from which the robot hangs by a floating joint
                                       the joint is fixed: the robot floats anyway
    a continuous joint with limits of effort and speed
                                       a revolute one of half a turn either way: no leg turns further
    a material without a name          named, for one hides all shapes of its link; beside the links, dropped
    a material defined twice           the first holds
    a capsule                          a cylinder and two spheres
    a shape without a geometry         dropped, for it hides all shapes of its link
"""

import copy
import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterable

import numpy as np
import pinocchio as pin

from frontal_biped.model.urdf.numbers_of_text import number_texts, plain_spelling

GEOMETRIES = ("box", "cylinder", "sphere", "mesh")
"""What a ``<geometry>`` may hold for all readers."""

_BROKEN_ATTRIBUTE = re.compile(r"""=\s*("[^"<]*[\t\r\n][^"<]*"|'[^'<]*[\t\r\n][^'<]*')""")
"""An attribute with a tab or a line break; an XML reader should make blanks of them, urdfdom's does not."""

_NO_BLANK = re.compile(r"[^\S ]")
"""White space that is no blank."""


def normal_form(text: str, root: ElementTree.Element) -> str:
    """The text in normal form.

    Args:
        text: of a URDF whose numbers are sound.
        root: its ``<robot>``; changed where it is not in normal form.
    """
    changes = [
        bool(_BROKEN_ATTRIBUTE.search(text)),
        _blanks_dropped(root),
        _floating_root_fixed(root),
        _turns_bounded(root),
        _links_renamed(root),
        _materials_named(root),
        _capsules_parted(root),
        _empty_shapes_dropped(root),
    ]
    return ElementTree.tostring(root, encoding="unicode") if any(changes) else text


def _blanks_dropped(root: ElementTree.Element) -> bool:
    changed = False
    for _, element, key, count in number_texts("", root):
        text = element.attrib[key]
        plain = plain_spelling(text)
        # between the numbers of a vector, several blanks do no harm
        if text.split() != plain.split() or _NO_BLANK.search(text) or (count == 1 and text != plain):
            element.set(key, plain)
            changed = True
    return changed


def _floating_root_fixed(root: ElementTree.Element) -> bool:
    children = {end.get("link") for joint in root.findall("joint") for end in joint.findall("child")}
    top = next(link for link in root.findall("link") if link.get("name") not in children)
    hanging = [joint for joint in root.findall("joint") if _ends(joint, ("parent",))[0].get("link") == top.get("name")]
    if top.find("inertial") is not None or len(hanging) != 1 or hanging[0].get("type") != "floating":
        return False
    hanging[0].set("type", "fixed")
    return True


def _turns_bounded(root: ElementTree.Element) -> bool:
    changed = False
    for joint in root.findall("joint"):
        limit = joint.find("limit")
        if joint.get("type") == "continuous" and limit is not None and {"effort", "velocity"} <= set(limit.attrib):
            joint.set("type", "revolute")
            limit.set("lower", repr(-np.pi))
            limit.set("upper", repr(np.pi))
            changed = True
    return changed


def _links_renamed(root: ElementTree.Element) -> bool:
    joints = {joint.get("name", "") for joint in root.findall("joint")}
    links = {link.get("name", "") for link in root.findall("link")}
    renamed = {}
    for name in sorted((joints | {"world"}) & links):
        new = f"{name}_link"
        while new in links | joints:
            new += "_"
        links.add(new)
        renamed[name] = new
    for link in root.findall("link"):
        link.set("name", renamed.get(link.get("name", ""), link.get("name", "")))
    for joint in root.findall("joint"):
        for end in _ends(joint, ("parent", "child")):
            end.set("link", renamed.get(end.get("link", ""), end.get("link", "")))
    return bool(renamed)


def _ends(joint: ElementTree.Element, ends: Iterable[str]) -> list[ElementTree.Element]:
    return [element for end in ends for element in joint.findall(end)]


def _materials_named(root: ElementTree.Element) -> bool:
    changed = False
    names: set[str] = set()
    for material in root.findall("material"):
        name = material.get("name")
        if name is None or name in names:
            root.remove(material)
            changed = True
        else:
            names.add(name)
    shapes = [shape for link in root.findall("link") for shape in _shapes(link)]
    names.update(material.get("name", "") for shape in shapes for material in shape.findall("material"))
    for shape in shapes:
        for material in shape.findall("material"):
            if material.get("name") is None:
                number = len(names)
                while f"material_{number}" in names:
                    number += 1
                material.set("name", f"material_{number}")
                names.add(f"material_{number}")
                changed = True
    return changed


def _capsules_parted(root: ElementTree.Element) -> bool:
    changed = False
    for link in root.findall("link"):
        for shape in _shapes(link):
            geometry, capsule = shape.find("geometry"), shape.find("geometry/capsule")
            if geometry is None or capsule is None or not {"radius", "length"} <= set(capsule.attrib):
                continue
            for sense in (1.0, -1.0):
                link.append(_end_of_capsule(shape, 0.5 * sense * float(capsule.attrib["length"])))
            capsule.tag = "cylinder"
            changed = True
    return changed


def _end_of_capsule(shape: ElementTree.Element, height: float) -> ElementTree.Element:
    """The sphere on the axis of a capsule at a height above its middle [m]."""
    end = copy.deepcopy(shape)
    end.attrib.pop("name", None)
    sphere = end.find("geometry/capsule")
    origin = end.find("origin")
    assert sphere is not None
    sphere.tag = "sphere"
    del sphere.attrib["length"]
    if origin is None:
        origin = ElementTree.SubElement(end, "origin")
    xyz, rpy = (np.array([float(word) for word in origin.get(key, "0 0 0").split()]) for key in ("xyz", "rpy"))
    place = xyz + height * pin.rpy.rpyToMatrix(*rpy)[:, 2]
    origin.set("xyz", " ".join(repr(float(part)) for part in place))
    return end


def _empty_shapes_dropped(root: ElementTree.Element) -> bool:
    changed = False
    for link in root.findall("link"):
        for shape in _shapes(link):
            if not any(shape.find(f"geometry/{kind}") is not None for kind in GEOMETRIES):
                link.remove(shape)
                changed = True
    return changed


def _shapes(link: ElementTree.Element) -> list[ElementTree.Element]:
    return [*link.findall("visual"), *link.findall("collision")]
