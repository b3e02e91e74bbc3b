"""Read a URDF file with care: everything that can be told from its text is checked before Pinocchio sees it.

Pinocchio reports a missing file and broken XML with the same words and writes the true reason to the C-level
standard error, so both are found here.
"""

import math
import xml.etree.ElementTree as ElementTree
from collections import Counter
from collections.abc import Iterator
from pathlib import Path, PurePosixPath
from typing import Any, cast

from frontal_biped.exceptions import RobotError
from frontal_biped.files.names import require_utf8_name
from frontal_biped.files.quoted import listed, quoted
from frontal_biped.files.reading import read_bytes
from frontal_biped.model.urdf.normal_form import normal_form
from frontal_biped.model.urdf.numbers_of_text import number_texts, numbers

MAX_URDF_BYTES = 20_000_000  # the largest humanoid URDF seen is 0.3 MB
MAX_LINKS = 1000  # the largest humanoid URDF seen has 150; Pinocchio takes seconds for some thousands
MAX_SHAPES = 1000  # visual and collision shapes; the most seen are 105
LONGEST_NAME = 200  # characters of a link or joint; the longest seen has 60
MAX_DEPTH = 40  # of nested elements; a URDF needs 6, and parsers that recurse must not be led deeper
LEAST_MASS = 1e-3  # [kg] of the whole robot
ALONG_NOTHING = 1e-9  # length of an axis that has no direction
ROUNDING_INERTIA = 1e-12  # [kg m^2]; CAD exports print -5e-20 for zero
JOINT_TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")


def read_urdf(path: Path) -> str:
    """Text of a URDF file whose XML, numbers and link tree are sound.

    Args:
        path: the URDF file.

    Returns:
        The text, ready for Pinocchio: in the form of `normal_form`.

    Raises:
        RobotError: the file is missing, too large, not XML, still a xacro file, declares XML entities, or its links,
            joints, masses or numbers are inconsistent; or the name of the file is not UTF-8.
    """
    require_utf8_name(path, RobotError)
    if path.is_file() and path.stat().st_size > MAX_URDF_BYTES:
        raise RobotError(f"{path}: larger than {MAX_URDF_BYTES} bytes; a URDF keeps its meshes in other files")
    try:
        text = read_bytes(path, MAX_URDF_BYTES, RobotError, ".urdf file").decode("utf-8")
    except FileNotFoundError:
        raise RobotError(f"{path}: no such URDF file; check the path, or see `frontal-biped robots`") from None
    except UnicodeDecodeError as error:
        raise RobotError(f"{path}: not UTF-8 text at byte {error.start}; save the URDF as UTF-8") from None
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise RobotError(f"{path}: declares an XML DOCTYPE or entity; remove it, a URDF needs none")
    try:
        root = _parse(path, text)
    except ElementTree.ParseError as error:
        if "xacro:" in text and "unbound prefix" in str(error):
            raise _is_xacro(path) from None
        raise RobotError(f"{path}: not well-formed XML, {str(error)[:100]}; mend the file there") from None
    if root.tag != "robot":
        raise RobotError(f"{path}: the root element is <{root.tag[:100]}>, not <robot>; is this a URDF file?")
    if _has_xacro(root):
        raise _is_xacro(path)
    if not root.get("name"):
        raise RobotError(f'{path}: the <robot> has no name; write <robot name="...">')
    _check_sizes(path, root)
    for where, element, key, count in number_texts(str(path), root):
        numbers(where, element, key, count)
    _check_links(path, root)
    _check_joints(path, root)
    _check_mesh_paths(path, root)
    return normal_form(text, root)


def _parse(path: Path, text: str) -> ElementTree.Element:
    """The root element; the depth is watched while reading, before any parser that recurses sees the text."""
    parser: ElementTree.XMLPullParser[Any] = ElementTree.XMLPullParser(("start", "end"))
    root: ElementTree.Element | None = None
    depth = 0
    for begin in range(0, max(len(text), 1), 1 << 16):
        parser.feed(text[begin : begin + (1 << 16)])
        for event, element in cast("Iterator[tuple[str, ElementTree.Element]]", parser.read_events()):
            root = element if root is None else root
            depth += 1 if event == "start" else -1
            if depth > MAX_DEPTH:
                raise RobotError(f"{path}: elements are nested more than {MAX_DEPTH} deep; is this a URDF file?")
    parser.close()
    list(parser.read_events())  # raises what the end of the text revealed
    assert root is not None
    return root


def _has_xacro(root: ElementTree.Element) -> bool:
    """Are there macros left to expand? That the prefix is declared says nothing: expanded files declare it too."""
    if any(isinstance(element.tag, str) and "xacro}" in element.tag for element in root.iter()):
        return True
    parts = [*root.findall("link"), *root.findall("joint")]
    values = [value for part in parts for element in part.iter() for value in element.attrib.values()]
    return any("${" in value or "$(" in value for value in values)


def _is_xacro(path: Path) -> RobotError:
    return RobotError(f"{path}: this is a xacro file; run `xacro {path.name} > robot.urdf` first, and give robot.urdf")


def _check_sizes(path: Path, root: ElementTree.Element) -> None:
    """How many links, joints and shapes, and how long their names, before anything is done for each of them."""
    for kind in ("link", "joint"):
        parts = root.findall(kind)
        if len(parts) > MAX_LINKS:
            raise RobotError(
                f"{path}: {len(parts)} {kind}s; at most {MAX_LINKS} are read, remove what is not the robot"
            )
        for part in parts:
            name = part.get("name", "")
            if len(name) > LONGEST_NAME:
                raise RobotError(f"{path}: the {kind} {quoted(name)} has a name of {len(name)} characters; shorten it")

    shapes = sum(len(link.findall("visual")) + len(link.findall("collision")) for link in root.findall("link"))
    if shapes > MAX_SHAPES:
        raise RobotError(f"{path}: {shapes} shapes; at most {MAX_SHAPES} are read, put them together in meshes")


def _check_links(path: Path, root: ElementTree.Element) -> None:
    names = [link.get("name", "") for link in root.findall("link")]
    duplicates = sorted(name for name, count in Counter(names).items() if count > 1)
    if not names or "" in names or duplicates:
        what = f"link {duplicates[0]!r} is defined twice" if duplicates else "a link without a name, or no link"
        raise RobotError(f"{path}: {what}; give every link a name of its own")
    total = 0.0
    for link in root.findall("link"):
        where = f"{path}: link {link.get('name')!r}"
        inertial = link.find("inertial")
        if inertial is None:
            continue
        numbers(where, inertial.find("origin"), "xyz", 3)
        numbers(where, inertial.find("origin"), "rpy", 3)
        mass = numbers(where, inertial.find("mass"), "value", 1)
        if mass and mass[0] < 0.0:
            raise RobotError(f"{where}: mass {mass[0]:g} kg is negative; give a positive mass")
        if not mass:
            raise RobotError(f"{where}: its <inertial> has no <mass value=...>; give one, or drop the <inertial>")
        total += mass[0]
        inertia = inertial.find("inertia")
        for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz"):
            moment = numbers(where, inertia, key, 1)
            if not moment:  # the parser would drop the whole inertia and say so on the C-level standard error only
                raise RobotError(f"{where}: its <inertia> has no {key}; give all six, 0 where there is none")
            if key[1] == key[2] and moment[0] < -ROUNDING_INERTIA:
                raise RobotError(f"{where}: {key} = {moment[0]:g} kg m^2 is negative; give a positive inertia")
    if total < LEAST_MASS:
        raise RobotError(f"{path}: the robot weighs {total:g} kg; give its links an <inertial> with their masses")


def _check_joints(path: Path, root: ElementTree.Element) -> None:
    links = {link.get("name", "") for link in root.findall("link")}
    parent_of: dict[str, str] = {}
    names: set[str] = set()
    for joint in root.findall("joint"):
        name = joint.get("name", "")
        where = f"{path}: joint {name!r}"
        if not name or name in names:
            raise RobotError(f"{where}: empty or used twice; give every joint a name of its own")
        names.add(name)
        if joint.get("type") not in JOINT_TYPES:
            known = ", ".join(JOINT_TYPES)
            raise RobotError(f"{where}: unknown type {quoted(joint.get('type'))}; use one of {known}")
        ends: list[str] = []
        for end in ("parent", "child"):
            element = joint.find(end)
            link = "" if element is None else element.get("link", "")
            if link not in links:
                raise RobotError(
                    f"{where}: its {end} link {quoted(link)} is not defined; add the link or mend the name"
                )
            ends.append(link)
        if ends[1] in parent_of:
            raise RobotError(f"{where}: link {ends[1]!r} already has a parent; a URDF is a tree, remove one joint")
        parent_of[ends[1]] = ends[0]
        numbers(where, joint.find("origin"), "xyz", 3)
        numbers(where, joint.find("origin"), "rpy", 3)
        axis = numbers(where, joint.find("axis"), "xyz", 3)
        if axis and joint.get("type") not in ("fixed", "floating") and math.hypot(*axis) < ALONG_NOTHING:
            raise RobotError(f"{where}: its axis is zero; give a direction, for a roll joint '1 0 0'")
        mimic = joint.find("mimic")
        if mimic is not None and not mimic.get("joint"):
            raise RobotError(f"{where}: its <mimic> names no joint; write joint=..., or remove it")
        limit = joint.find("limit")
        limits = {key: numbers(where, limit, key, 1) for key in ("lower", "upper", "effort", "velocity")}
        if joint.get("type") in ("revolute", "prismatic"):
            for key in ("effort", "velocity"):
                if not limits[key]:
                    raise RobotError(f"{where}: its <limit> has no {key}; a {joint.get('type')} joint needs one")
            low, high = limits["lower"] or [0.0], limits["upper"] or [0.0]
            if low[0] > high[0]:
                raise RobotError(f"{where}: lower = {low[0]:g} is above upper = {high[0]:g}; exchange them")
    for link in parent_of:
        seen, at = {link}, parent_of.get(link)
        while at is not None:
            if at in seen:
                raise RobotError(f"{path}: link {link!r} is its own ancestor; break the loop of joints")
            seen.add(at)
            at = parent_of.get(at)
    roots = sorted(links - set(parent_of))
    if len(roots) != 1:
        raise RobotError(f"{path}: {len(roots)} links have no parent ({listed(roots)}); join them into one tree")


def _check_mesh_paths(path: Path, root: ElementTree.Element) -> None:
    """Meshes lie in the robot's own package: beside the URDF's folder at the farthest."""
    for mesh in root.iter("mesh"):
        name = mesh.get("filename", "")
        _, colon, inside = name.partition("://")
        parts = PurePosixPath(inside if colon else name).parts
        depth = lowest = 0
        for part in parts:
            depth += -1 if part == ".." else 1
            lowest = min(lowest, depth)
        if lowest < (0 if colon else -1):
            raise RobotError(
                f"{path}: mesh {quoted(name)} leaves the robot's package; keep meshes beside the URDF's folder and name"
                " them package://package/meshes/..."
            )
