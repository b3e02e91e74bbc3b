"""The same robot in a text that urdfdom, Pinocchio and MuJoCo read as it is meant.

Those readers are touchier than the format is: they drop what they cannot read, with words on the C-level standard error
only, or refuse the whole file. What can be said without doubt in words that they understand is said so here. A text
that needs nothing of this stays as it is, byte for byte: the fingerprints of gaits are made of it.

    blanks around numbers              dropped, tabs and line breaks between them too
    a link that bears a joint's name   ..._link (names of links and of joints are apart in a URDF, not in Pinocchio)
    a link called "world"              world_link (MuJoCo has a body of that name, Pinocchio a frame called "universe"
                                       and a joint called "root_joint"; fixed joints of these names get a _)
    a root link without mass from which the robot hangs by a floating joint
                                       the joint is fixed: the robot floats anyway
    a continuous joint with limits of effort and speed
                                       a revolute one of half a turn either way: no leg turns further
    a material without a name          named, for one hides all shapes of its link; beside the links, dropped
    a material defined twice           the first holds
    a capsule                          a cylinder and two spheres
    a shape without a geometry, or whose geometry lacks a size
                                       dropped, for it hides all shapes of its link
    what else a <geometry> holds       dropped, for its first element is read
    a name with line breaks or control characters
                                       these become _, so that it can be printed and written into other files
    processing instructions            dropped
"""

import copy
import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterable

import numpy as np
import pinocchio as pin

from frontal_biped.model.urdf.numbers_of_text import number_texts, plain_spelling

GEOMETRIES = {"box": ("size",), "cylinder": ("radius", "length"), "sphere": ("radius",), "mesh": ("filename",)}
"""What a ``<geometry>`` may hold for all readers, and the attributes that it must have."""

_OF_PINOCCHIO = ("universe", "root_joint")
"""Names that Pinocchio gives itself, the second because we ask for it."""

_COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)

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
        "<?" in _COMMENT.sub("", text).lstrip("\ufeff").removeprefix("<?"),
        _names_printable(root),
        _blanks_dropped(root),
        _floating_root_fixed(root),
        _turns_bounded(root),
        _fixed_joints_renamed(root),
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


def _names_printable(root: ElementTree.Element) -> bool:
    changed = False
    for kind in ("link", "joint"):
        taken = _names(root, kind)
        renamed = {
            name: _free("".join(letter if letter.isprintable() else "_" for letter in name), taken)
            for name in sorted(name for name in taken if not name.isprintable())
        }
        _rename(root, kind, renamed)
        changed = changed or bool(renamed)
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


def _fixed_joints_renamed(root: ElementTree.Element) -> bool:
    fixed = {joint.get("name", "") for joint in root.findall("joint") if joint.get("type") == "fixed"}
    taken = _names(root, "joint")
    renamed = {name: _free(f"{name}_", taken) for name in _OF_PINOCCHIO if name in fixed}
    _rename(root, "joint", renamed)
    return bool(renamed)


def _links_renamed(root: ElementTree.Element) -> bool:
    joints, links = _names(root, "joint"), _names(root, "link")
    taken = joints | links
    renamed = {name: _free(f"{name}_link", taken) for name in sorted((joints | {"world", *_OF_PINOCCHIO}) & links)}
    _rename(root, "link", renamed)
    return bool(renamed)


_REFERENCES = {"link": {"parent": "link", "child": "link"}, "joint": {"mimic": "joint"}}
"""Where joints name links, and one another: element and attribute."""


def _names(root: ElementTree.Element, kind: str) -> set[str]:
    return {part.get("name", "") for part in root.findall(kind)}


def _free(name: str, taken: set[str]) -> str:
    """The name, with as many _ as nobody has it; it is taken then."""
    while name in taken:
        name += "_"
    taken.add(name)
    return name


def _rename(root: ElementTree.Element, kind: str, renamed: dict[str, str]) -> None:
    """Give links or joints other names, wherever they are named."""
    if not renamed:
        return
    places = [(part, "name") for part in root.findall(kind)]
    for joint in root.findall("joint"):
        places += [(element, key) for tag, key in _REFERENCES[kind].items() for element in joint.findall(tag)]
    for element, key in places:
        if (new := renamed.get(element.get(key, ""))) is not None:
            element.set(key, new)


def _ends(joint: ElementTree.Element, ends: Iterable[str]) -> list[ElementTree.Element]:
    return [element for end in ends for element in joint.findall(end)]


def _materials_named(root: ElementTree.Element) -> bool:
    names: set[str] = set()
    kept = []
    for element in root:
        name = element.get("name")
        if element.tag != "material" or (name is not None and name not in names):
            kept.append(element)
        if element.tag == "material" and name is not None:
            names.add(name)
    changed = len(kept) < len(root)
    root[:] = kept
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
        kept = []
        for part in link:
            geometry = _geometry(part) if part.tag in _SHAPES else part
            if geometry is not None:
                kept.append(part)
            if part.tag in _SHAPES and geometry is not None and len(part.findall("geometry")) + len(geometry) > 2:
                part[:] = [child for child in part if child.tag != "geometry"] + [geometry]
                geometry[:] = [child for child in geometry if child.tag in GEOMETRIES][:1]
                changed = True
        if len(kept) < len(link):
            link[:] = kept
            changed = True
    return changed


def _geometry(shape: ElementTree.Element) -> ElementTree.Element | None:
    """The first one of which all readers can make something."""
    for geometry in shape.findall("geometry"):
        solid = next((child for child in geometry if child.tag in GEOMETRIES), None)
        if solid is not None and set(GEOMETRIES[solid.tag]) <= set(solid.attrib):
            return geometry
    return None


_SHAPES = ("visual", "collision")


def _shapes(link: ElementTree.Element) -> list[ElementTree.Element]:
    return [shape for kind in _SHAPES for shape in link.findall(kind)]
