"""Write a robot description: the text of the TOML file that `read_description` reads."""

import json
from collections.abc import Iterable, Mapping
from dataclasses import asdict
from typing import Any

from frontal_biped.model.urdf.description import ROLL_JOINTS, RobotDescription, Sole


def description_text(
    description: RobotDescription, urdf: str, notes: Iterable[str] = (), comments: Mapping[str, str] | None = None
) -> str:
    """Text of a description file.

    Args:
        description: what to write; a sole with extents of zero is unknown and written as a comment to fill in.
        urdf: what the key ``urdf`` says.
        notes: comment lines at the top.
        comments: by section, a comment beside its header.
    """
    beside = comments or {}

    def head(section: str) -> str:
        return f"[{section}]  # {beside[section]}" if section in beside else f"[{section}]"

    lines = [f"# {' '.join(note.split())}" for note in notes]  # a joint's name may hold a line break, a comment not
    lines += [f"name = {_value(description.name)}", f"urdf = {_value(urdf)}"]
    if description.symmetrise:
        lines.append("symmetrise = true" + (f"  # {beside['symmetrise']}" if "symmetrise" in beside else ""))
    if description.virtual_legs:
        lines.append("virtual_legs = true" + (f"  # {beside['virtual_legs']}" if "virtual_legs" in beside else ""))
    lines += ["", head("joints"), *(f"{key} = {_value(description.joints[key])}" for key in ROLL_JOINTS)]
    if any(description.base_rpy):
        lines += ["", head("base"), f"rpy = {_value(list(description.base_rpy))}"]
    if description.posture:
        lines += ["", head("posture"), *(f"{_key(k)} = {_value(v)}" for k, v in description.posture.items())]
    lines += ["", head("sole"), *_sole_lines(description.sole)]
    limits = {"ankle_torque": description.ankle_torque, "hip_torque": description.hip_torque}
    if any(value is not None for value in limits.values()):
        lines += ["", head("limits"), *(f"{key} = {_value(v)}" for key, v in limits.items() if v is not None)]
    armature = {"ankle": description.ankle_armature, "hip": description.hip_armature}
    if description.other_armature:
        armature["other"] = description.other_armature
    if any(armature.values()):
        lines += ["", head("armature"), *(f"{key} = {_value(value)}" for key, value in armature.items())]
    if description.gait:
        lines += ["", head("gait"), *(f"{_key(key)} = {_value(value)}" for key, value in description.gait.items())]
    return "\n".join(lines) + "\n"


def _sole_lines(sole: Sole) -> list[str]:
    extents = asdict(sole)
    if not (sole.inner > 0.0 and sole.outer > 0.0):
        return [f"# {key} = ?" for key in extents]
    return [f"{key} = {_value(value)}" for key, value in extents.items() if value is not None]


def _value(value: Any) -> str:
    # JSON's strings, numbers and lists are TOML's, but for characters beyond U+FFFF, of which JSON escapes halves
    text = json.dumps(list(value) if isinstance(value, tuple) else value, ensure_ascii=False)
    return "".join(letter if " " <= letter <= "~" else _escaped(letter) for letter in text)


def _escaped(letter: str) -> str:
    return f"\\u{ord(letter):04x}" if ord(letter) <= 0xFFFF else f"\\U{ord(letter):08x}"


def _key(key: str) -> str:
    return key if key.replace("_", "").replace("-", "").isalnum() and key.isascii() else _value(key)
