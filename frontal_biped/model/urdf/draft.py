"""What proposals of descriptions are made of: reach, soles, reduction, numbers as a file has them."""

import contextlib
import xml.etree.ElementTree as ElementTree
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin

from frontal_biped.exceptions import HypothesisError, RobotError
from frontal_biped.files.quoted import quoted
from frontal_biped.model.robot import Robot
from frontal_biped.model.urdf.description import RobotDescription, Sole
from frontal_biped.model.urdf.legs import Legs, find_legs, look_like_arms, named_legs
from frontal_biped.model.urdf.packages import EXAMPLE_ROBOT_DATA, example_robot_data_dir
from frontal_biped.model.urdf.read import read_urdf
from frontal_biped.model.urdf.reduction import FrontalReduction, reduce_to_frontal_plane
from frontal_biped.model.urdf.soles import MeasuredSole, measure_sole
from frontal_biped.model.urdf.whole_model import build_model

SMALLEST_LEG, LARGEST_LEG = 0.01, 5.0
"""Lengths of legs [m], and distances of hips, of robots that are taken for robots."""

CENTIMETRE_LEG = 150.0
"""Longest leg [m] of a file that is in centimetres; longer ones are in millimetres."""

ANKLES_APART = 2e-3
"""Distance [m] along x of the ankle roll joints' origins that soles measured from either may have."""

CHANGED = 1e-3
"""Difference [rad] from which on an angle is called another one than was given."""

ZERO_ANGLE = 5e-5
"""Angles [rad] this small are left out of a proposed posture where the joint can be at zero."""


@dataclass(frozen=True)
class Proposal:
    """A description, proposed.

    Attributes:
        text: the file, with what was found and what not as comments at its head.
        undecided: what the user must settle before the robot can walk.
        folder: where the file belongs: its ``urdf`` is relative to it.
        changed: what is no longer as the user had it.
        found: what was found, one line each.
    """

    text: str
    undecided: tuple[str, ...]
    folder: Path
    changed: tuple[str, ...] = ()
    found: tuple[str, ...] = ()


class FirstDraft(NamedTuple):
    """What can be told of a URDF before its posture is looked for.

    Attributes:
        description: with the four roll joints, every other joint at zero or as near as it comes.
        full: 3D model with a free-flyer root.
        legs: its legs.
        urdf_text: the URDF.
        notes: comment lines for the file.
        undecided: what the user must settle.
    """

    description: RobotDescription
    full: pin.Model
    legs: Legs
    urdf_text: str
    notes: list[str]
    undecided: list[str]


def first_draft(urdf: Path) -> FirstDraft:
    """The legs of a URDF and its roll joints.

    Raises:
        RobotError: the URDF cannot be read, or it is no biped; `HypothesisError` names the hypothesis.
    """
    text = read_urdf(urdf)
    if not urdf.name.isprintable():
        raise RobotError(f"{quoted(urdf.name)}: a description cannot write this name of a file; rename it")
    draft = RobotDescription(urdf.stem, urdf, {}, {}, Sole(0.0, 0.0), None, None, urdf)
    full = build_model(draft, text)
    legs = find_legs(full, str(urdf), _mimics(text))
    joints = {
        "left_ankle": legs.left[legs.roll[-1]],
        "left_hip": legs.left[legs.roll[0]],
        "right_hip": legs.right[legs.roll[0]],
        "right_ankle": legs.right[legs.roll[-1]],
    }
    notes = [f"legs: {', '.join(legs.left)}", f"and {', '.join(legs.right)}"]
    if not legs.sides_named:
        notes.append("which side is left follows from the root link's X pointing forward; joint names do not tell")
    if len(legs.roll) > 2:
        spare = ", ".join(legs.left[i] for i in legs.roll[1:-1])
        notes.append(f"of the leg's roll joints the first and the last are taken; {spare} is locked")
    undecided = []
    if look_like_arms(full, legs):
        undecided.append(
            f"legs: {', '.join(legs.left)} hangs above the centre of mass of the rest, as an arm does; if these are no"
            " legs, this is no biped"
        )
    apart = _ankles_apart(full, legs, joints)
    if abs(apart) > ANKLES_APART:
        undecided.append(
            f"legs: the origin of {joints['right_ankle']} is {apart:+.3f} m ahead of that of {joints['left_ankle']},"
            " and soles are measured from there; move it along its axis, and what hangs from it back"
        )
    return FirstDraft(replace(draft, joints=joints, posture=reachable(full)), full, legs, text, notes, undecided)


def _ankles_apart(full: pin.Model, legs: Legs, joints: Mapping[str, str]) -> float:
    """How far the right ankle roll joint has its origin ahead of the left one's, all joints at zero [m]."""
    data, q = full.createData(), pin.neutral(full)
    q[3:7] = pin.Quaternion(legs.upright).coeffs()
    pin.forwardKinematics(full, data, q)
    left, right = (data.oMi[full.getJointId(joints[f"{side}_ankle"])].translation[0] for side in ("left", "right"))
    return float(right - left)


def _mimics(urdf_text: str) -> set[str]:
    joints = ElementTree.fromstring(urdf_text).findall("joint")
    return {joint.get("name", "") for joint in joints if joint.find("mimic") is not None}


def legs_of(description: RobotDescription, full: pin.Model) -> Legs:
    """The legs that the robot's described joints name.

    Raises:
        HypothesisError: a described joint is of no leg, or of the wrong one, or the legs are no mirror images.
    """
    return named_legs(full, description.joints, str(description.path))


def reachable(full: pin.Model) -> dict[str, float]:
    """Joints that cannot be at zero, at their nearest limit."""
    angles = {}
    for name in full.names[2:]:
        joint = full.joints[full.getJointId(name)]
        if joint.nq == 1:
            low, high = full.lowerPositionLimit[joint.idx_q], full.upperPositionLimit[joint.idx_q]
            if not low <= 0.0 <= high:
                angles[name] = float(np.clip(0.0, low, high))
    return angles


def changed_angles(given: Mapping[str, float], found: Mapping[str, float]) -> list[str]:
    """Lines that say which angles of a posture are not those that were given [rad]."""
    differ = {name: (old, found.get(name, 0.0)) for name, old in given.items()}
    shown = [f"{name} from {old:g} to {new:g}" for name, (old, new) in differ.items() if abs(old - new) > CHANGED]
    return [f"posture: {', '.join(shown)} rad"] if shown else []


def rounded(full: pin.Model, draft: RobotDescription, found: Mapping[str, float]) -> dict[str, float]:
    """The draft's posture with the angles that were found [rad]."""
    angles = {name: angle for name, angle in draft.posture.items() if name not in found}
    for name, angle in found.items():
        joint = full.joints[full.getJointId(name)]
        reach = full.lowerPositionLimit[joint.idx_q] <= 0.0 <= full.upperPositionLimit[joint.idx_q]
        if abs(angle) > ZERO_ANGLE or not reach:
            angles[name] = round(angle, 9)
    return angles


def rounded_rpy(found: tuple[float, float, float]) -> tuple[float, float, float]:
    """Roll, pitch, yaw [rad]."""
    roll, pitch, yaw = (0.0 if abs(angle) <= ZERO_ANGLE else round(angle, 12) for angle in found)
    return roll, pitch, yaw


def measure_left_sole(
    full: pin.Model,
    q: Any,
    draft: RobotDescription,
    legs: Legs,
    text: str,
    x: float | None = None,
) -> tuple[MeasuredSole | None, str]:
    """The left foot's sole, with the foot flat; or why there is none."""
    flat = pin.neutral(full)
    flat[3:7] = pin.Quaternion(legs.upright).coeffs() if x is None else q[3:7]
    try:
        sole = measure_sole(full, flat if x is None else q, draft.joints["left_ankle"], draft.urdf, text, x)
    except RobotError as error:
        return None, str(error)
    return sole, "the foot has neither collision nor visual shapes"


def described(sole: MeasuredSole) -> Sole:
    """What the description says of the left foot's sole, rather smaller than larger."""
    length = {}
    if sole.spans_ankle:  # otherwise it is left for the user to find out
        length = {"front": _tenth_of_millimetre(sole.toe), "back": _tenth_of_millimetre(-sole.heel)}
    return Sole(
        inner=_tenth_of_millimetre(sole.right),  # the left foot's inner side is its right
        outer=_tenth_of_millimetre(sole.left),
        ankle_height=round(sole.ankle_height, 4),
        **length,
    )


def reduce_draft(
    draft: RobotDescription, full: pin.Model, text: str, comments: dict[str, str], sole_known: bool
) -> tuple[RobotDescription, list[str]]:
    """Reduce the draft; average its legs if need be, and give it a gait."""
    trial = draft if sole_known else replace(draft, sole=Sole(1e-3, 1e-3))
    problems = []
    for part, key in (("ankle", "left_ankle"), ("hip", "left_hip")):
        joint = full.joints[full.getJointId(draft.joints[key])]
        limit, _ = draft.actuator(key)
        if limit is None and not full.effortLimit[joint.idx_v] > 0.0:
            problems.append(f"limits: {draft.joints[key]} has no effort limit; give [limits] {part}_torque")
            trial = replace(trial, ankle_torque=1.0) if part == "ankle" else replace(trial, hip_torque=1.0)
    reduction: FrontalReduction | None = None
    try:
        reduction = reduce_to_frontal_plane(Robot(trial, text))
    except HypothesisError as error:
        if error.hypothesis != "HR3" or trial.symmetrise:
            problems.append(str(error))
    if reduction is None and not trial.symmetrise:
        try:
            reduction = reduce_to_frontal_plane(Robot(replace(trial, symmetrise=True), text))
        except HypothesisError as error:
            if str(error) not in problems:
                problems.append(str(error))
        else:
            draft = replace(draft, symmetrise=True)
            share = 100.0 * reduction.asymmetry.mass_matrix
            comments["symmetrise"] = f"the legs differ by {share:.2g} % of the mass matrix"
    if reduction is not None:
        problems += _implausible(reduction)
    if reduction is not None and not draft.gait:
        hips = float(np.linalg.norm(reduction.chain.joints[2] - reduction.chain.joints[1]))
        draft = replace(draft, gait=_gait(hips))
        comments["gait"] = "used where no specification is given; step_width: 0.8 to 1.8 hip widths"
    return draft, problems


def _implausible(reduction: FrontalReduction) -> list[str]:
    """Sizes of no robot, in words; a URDF is in metres whatever the CAD program was in."""
    ankle, hip, other = (reduction.chain.joints[i] for i in range(3))
    leg, hips = float(np.linalg.norm(hip - ankle)), float(np.linalg.norm(other - hip))
    if SMALLEST_LEG <= leg <= LARGEST_LEG and hips <= LARGEST_LEG:
        return []
    unit = "kilometres" if leg < SMALLEST_LEG else "centimetres" if leg <= CENTIMETRE_LEG else "millimetres"
    return [
        f"sizes: hips {hips:.3g} m apart, legs {leg:.3g} m long; is the file in {unit}? A URDF is in metres: scale its"
        " <origin xyz>, shapes and inertias"
    ]


def _gait(hip_width: float) -> dict[str, Any]:
    return {
        "degree": 8,
        "fri_degree": 4,
        "swing_clearance": 0.008,
        "step_duration": [0.3, 0.8],
        "step_width": [round(0.8 * hip_width, 4), round(1.8 * hip_width, 4)],
        "max_pelvis_roll": 0.1745,
    }


def urdf_key(urdf: Path, folder: Path) -> str:
    """What a description in a folder says of its URDF.

    Raises:
        RobotError: the URDF is not below the folder.
    """
    found = urdf.resolve()
    with contextlib.suppress(ValueError, RobotError):
        return f"{EXAMPLE_ROBOT_DATA}:{found.relative_to(example_robot_data_dir().resolve()).as_posix()}"
    try:
        return found.relative_to(folder.resolve()).as_posix()
    except ValueError:
        raise RobotError(f"{urdf}: not below {folder}, where its description is to lie; put that beside it") from None


def _tenth_of_millimetre(length: float) -> float:
    return float(np.floor(1e4 * length + 1e-2)) / 1e4
