"""Robot description: the TOML file beside a URDF that says which joints roll and how large the soles are.

    name = "my_biped"
    urdf = "my_biped.urdf"  # or "example-robot-data:talos_data/robots/talos_full_v2.urdf"

    [joints]                # the four roll joints, by URDF name
    left_ankle = "left_ankle"
    left_hip = "left_hip"
    right_hip = "right_hip"
    right_ankle = "right_ankle"

    [sole]                  # of one foot, m; the other is its mirror image
    inner = 0.05            # from the ankle towards the other foot
    outer = 0.05
    ankle_height = 0.0      # of the ankle joint above the sole

That is all that must be there; ankle_height is 0 where it is left out. It may say more:

    symmetrise = true       # average legs that differ by at most 10 %, and take of their joint limits what both can do;
                            # `frontal-biped robots --json` lists what was averaged. Left out: refused (HR3)
    virtual_legs = true     # a leg, seen from the front, turns about lines along X through the origins of its hip and
                            # ankle roll joints, whatever the directions of their axes: robots whose hip roll joint
                            # hangs below the hip pitch joint can bend their knees. Such a robot walks in space, where
                            # the leg's six joints make those turns; in the plane its motors are those of the roll
                            # joints, approximately. Left out: the axes must be along X (HR2)
    [base]
    rpy = [0.0, 0.0, 0.0]   # turns the root link so that X is forward, Y left, Z up, rad; left out: 0
    [posture]               # where every other joint is locked, rad, by URDF name; left out: 0
    left_knee = 0.3
    [limits]                # left out: the URDF's efforts, N m
    ankle_torque = 150.0
    hip_torque = 150.0
    [armature]              # reflected rotor inertia, kg m^2, which a URDF cannot tell; left out: 0
    ankle = 0.0
    hip = 0.0
    other = 0.0             # of every other joint; the plane does not see it, walking in space does
    [gait]                  # keys of a gait specification, used where none is given; left out: the reference one
    friction = 0.6

``front`` and ``back`` of ``[sole]`` are its ends ahead of and behind the ankle, m; left out, they are measured on the
foot's shapes.
"""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from frontal_biped.exceptions import HypothesisError, RobotError
from frontal_biped.files.quoted import quoted
from frontal_biped.files.toml import as_finite, finite_number, load_toml, reject_unknown_keys, respelt_keys
from frontal_biped.model.urdf.packages import resolve_urdf

ROLL_JOINTS = ("left_ankle", "left_hip", "right_hip", "right_ankle")
"""The four roll joints in the order in which the paper's open chain passes them from left to right."""


LONGEST_TEXT = 1000
"""Characters of a text of a description: of a name or a path."""

LARGEST = {
    "sole": 10.0,  # [m]
    "limits": 1e9,  # [N m]
    "armature": 1e6,  # [kg m^2]
    "posture": 1e4,  # [rad], or [m] of a sliding joint
    "base": 1e4,  # [rad]
}
"""By section, the size from which on a number is none of a robot."""

KEYS = ("name", "urdf", "symmetrise", "virtual_legs", "joints", "base", "posture", "sole", "limits", "armature", "gait")
"""Keys and sections of a description file."""


@dataclass(frozen=True)
class Sole:
    """Sole of one foot; the other is its mirror image.

    Attributes:
        inner: extent from the ankle towards the other foot [m].
        outer: extent from the ankle away from the other foot [m].
        ankle_height: height of the ankle joint above the sole [m].
        front: extent from the ankle forwards [m]; None: measured on the foot's shapes.
        back: extent from the ankle backwards, positive [m]; None: measured likewise.
    """

    inner: float
    outer: float
    ankle_height: float = 0.0
    front: float | None = None
    back: float | None = None


@dataclass(frozen=True)
class RobotDescription:
    """What a description file says.

    Attributes:
        name: what `robots` lists.
        urdf: the URDF file.
        joints: URDF joint name of each of the four roll joints, keyed by `ROLL_JOINTS`.
        posture: angle [rad] of joints that are not zero at the reference posture.
        sole: sole of one foot.
        ankle_torque: ankle torque limit [N m]; None: the URDF's effort limit.
        hip_torque: hip torque limit [N m]; None: the URDF's effort limit.
        base_rpy: roll, pitch, yaw [rad] of the root link at the reference posture, X forward, Y left, Z up.
        symmetrise: average legs that differ; otherwise they are refused.
        ankle_armature: reflected rotor inertia of the ankles [kg m^2], which a URDF cannot tell.
        hip_armature: of the hips [kg m^2].
        other_armature: of every other joint [kg m^2].
        virtual_legs: a leg turns about lines along X through the origins of its roll joints, whatever their axes.
        gait: keys of a gait specification that suit the robot, for `default_specification`.
        path: where the description was read.
    """

    name: str
    urdf: Path
    joints: Mapping[str, str]
    posture: Mapping[str, float]
    sole: Sole
    ankle_torque: float | None
    hip_torque: float | None
    path: Path
    base_rpy: tuple[float, float, float] = (0.0, 0.0, 0.0)
    symmetrise: bool = False
    ankle_armature: float = 0.0
    hip_armature: float = 0.0
    other_armature: float = 0.0
    virtual_legs: bool = False
    gait: Mapping[str, Any] = field(default_factory=dict)

    def fingerprint(self, urdf_text: str) -> str:
        """SHA-256 of the URDF text and of everything in the description that shapes the planar model.

        The length of the soles does not, nor does the rotor inertia of joints that are locked in the plane.
        """
        shape: dict[str, Any] = {
            "joints": dict(self.joints),
            "posture": dict(self.posture),
            "sole": {key: getattr(self.sole, key) for key in ("inner", "outer", "ankle_height")},
            "limits": [self.ankle_torque, self.hip_torque],
        }
        # keys that came later enter only where they are used: fingerprints of gaits already designed stay valid
        if self.symmetrise:
            shape["symmetrise"] = True
        if any(self.base_rpy):
            shape["base"] = list(self.base_rpy)
        if self.ankle_armature or self.hip_armature:
            shape["armature"] = [self.ankle_armature, self.hip_armature]
        if self.virtual_legs:
            shape["virtual_legs"] = True
        content = json.dumps(shape, sort_keys=True)
        return hashlib.sha256((content + urdf_text).encode()).hexdigest()

    def actuator(self, roll_joint: str) -> tuple[float | None, float]:
        """Torque limit [N m], None for the URDF's, and reflected rotor inertia [kg m^2] of one of `ROLL_JOINTS`."""
        if roll_joint.endswith("ankle"):
            return self.ankle_torque, self.ankle_armature
        return self.hip_torque, self.hip_armature


def read_description(path: Path) -> RobotDescription:
    """Read and check a robot description file.

    Args:
        path: the ``.toml`` file.

    Returns:
        The description; the URDF path is resolved but not opened.

    Raises:
        RobotError: the file is missing or malformed, or a key is unknown, absent or of the wrong type.
    """
    table = respelt_keys(load_toml(path, RobotError), KEYS)
    reject_unknown_keys(str(path), table, KEYS, RobotError)
    joints = _section(path, table, "joints", ROLL_JOINTS)
    sole = _section(path, table, "sole", ("inner", "outer", "ankle_height", "front", "back"))
    limits = _section(path, table, "limits", ("ankle_torque", "hip_torque"))
    posture = _section(path, table, "posture", None)
    base = _section(path, table, "base", ("rpy",))
    armature = _section(path, table, "armature", ("ankle", "hip", "other"))
    names = {key: _text(path, joints, "joints", key) for key in ROLL_JOINTS}
    if len(set(names.values())) != len(ROLL_JOINTS):
        raise RobotError(f"{path}: [joints] names one joint twice; the four roll joints are different joints")
    urdf = _text(path, table, "", "urdf")
    return RobotDescription(
        name=_text(path, table, "", "name"),
        urdf=resolve_urdf(f"{path}: urdf", urdf, path.parent),
        joints=names,
        posture={key: _number(path, posture, "posture", key) for key in posture},
        sole=Sole(
            inner=_positive(path, sole, "sole", "inner"),
            outer=_positive(path, sole, "sole", "outer"),
            ankle_height=_not_negative(path, sole, "sole", "ankle_height"),
            front=_positive_or_none(path, sole, "sole", "front"),
            back=_positive_or_none(path, sole, "sole", "back"),
        ),
        ankle_torque=_positive_or_none(path, limits, "limits", "ankle_torque"),
        hip_torque=_positive_or_none(path, limits, "limits", "hip_torque"),
        path=path,
        base_rpy=_rpy(path, base),
        symmetrise=_truth(path, table, "symmetrise"),
        ankle_armature=_not_negative(path, armature, "armature", "ankle"),
        hip_armature=_not_negative(path, armature, "armature", "hip"),
        other_armature=_not_negative(path, armature, "armature", "other"),
        virtual_legs=_truth(path, table, "virtual_legs"),
        gait=_gait(path, table),
    )


def _number(path: Path, table: dict[str, Any], section: str, key: str) -> float:
    shown = key if key.isprintable() and len(key) <= LONGEST_TEXT else quoted(key)
    where = f"{path}: [{section}] {shown}"
    value = finite_number(where, table[key], RobotError)
    if abs(value) > LARGEST[section]:
        raise RobotError(f"{where} = {value:g} is beyond {LARGEST[section]:g}; give its true value, in SI units")
    return value


def _gait(path: Path, table: dict[str, Any]) -> dict[str, Any]:
    """Keys of a gait specification, which says what it thinks of them; here, whether it can be asked at all."""
    section = _section(path, table, "gait", None)
    for key, value in section.items():
        for part in value if isinstance(value, list) else [value]:
            if not isinstance(part, str | bool) and as_finite(part) is None:
                shown = quoted(value)
                raise RobotError(f"{path}: [gait] {quoted(key)} = {shown} is no finite number, nor a list of them")
    return section


def _section(path: Path, table: dict[str, Any], name: str, known: tuple[str, ...] | None) -> dict[str, Any]:
    section = table.get(name, {})
    if not isinstance(section, dict):
        raise RobotError(f"{path}: {name} = {quoted(section)} is not a table; write [{name}] and its keys below it")
    if known is not None:
        reject_unknown_keys(f"{path}: [{name}]", section, known, RobotError)
    return section


def _truth(path: Path, table: dict[str, Any], key: str) -> bool:
    value = table.get(key, False)
    if not isinstance(value, bool):
        raise RobotError(f"{path}: {key} = {quoted(value)} is neither true nor false; write {key} = true")
    return value


def _text(path: Path, table: dict[str, Any], section: str, key: str) -> str:
    where = f"{path}: [{section}] {key}" if section else f"{path}: {key}"
    if key not in table:
        raise RobotError(f'{where} is missing; add {key} = "..."')
    value = table[key]
    if not isinstance(value, str) or not value or not value.isprintable() or len(value) > LONGEST_TEXT:
        raise RobotError(f'{where} = {quoted(value)} is not text; write {key} = "..."')
    return value


def _positive(path: Path, table: dict[str, Any], section: str, key: str) -> float:
    where = f"{path}: [{section}] {key}"
    if key not in table:
        # a foot of nonzero length is part of the robot, so there is no default
        raise HypothesisError("HR5", f"{where} is missing; give the extent of the sole in metres")
    value = _number(path, table, section, key)
    if value <= 0.0:
        message = f"{where} = {value:g} must be positive; give its true value"
        raise HypothesisError("HR5", message) if section == "sole" else RobotError(message)
    return value


def _positive_or_none(path: Path, table: dict[str, Any], section: str, key: str) -> float | None:
    return _positive(path, table, section, key) if key in table else None


def _not_negative(path: Path, table: dict[str, Any], section: str, key: str) -> float:
    where = f"{path}: [{section}] {key}"
    value = _number(path, table, section, key) if key in table else 0.0
    if value < 0.0:
        if section == "sole":
            raise HypothesisError("HR5", f"{where} = {value:g} must not be negative; measure it upwards from the sole")
        raise RobotError(f"{where} = {value:g} must not be negative; give its true value")
    return value


def _rpy(path: Path, base: dict[str, Any]) -> tuple[float, float, float]:
    value = base.get("rpy", [0.0, 0.0, 0.0])
    where = f"{path}: [base] rpy"
    if not isinstance(value, list) or len(value) != 3:
        raise RobotError(f"{where} = {quoted(value)} is not a list of three angles; write rpy = [0.0, 0.0, 0.0]")
    roll, pitch, yaw = (_number(path, {"rpy": angle}, "base", "rpy") for angle in value)
    return roll, pitch, yaw
