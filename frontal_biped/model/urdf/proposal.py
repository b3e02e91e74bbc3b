"""Propose a description for an unknown URDF, or a posture for a description, and say what could not be decided."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

from frontal_biped.exceptions import HypothesisError, RobotError
from frontal_biped.model.robot import Robot
from frontal_biped.model.urdf.description import RobotDescription, Sole, read_description
from frontal_biped.model.urdf.description_text import description_text
from frontal_biped.model.urdf.legs import Legs, find_legs
from frontal_biped.model.urdf.packages import EXAMPLE_ROBOT_DATA, example_robot_data_dir
from frontal_biped.model.urdf.posture import Posture, find_posture
from frontal_biped.model.urdf.read import read_urdf
from frontal_biped.model.urdf.reduction import FrontalReduction, reduce_to_frontal_plane
from frontal_biped.model.urdf.soles import MeasuredSole, measure_sole
from frontal_biped.model.urdf.whole_model import build_model, posture_configuration

ZERO_ANGLE = 5e-5
"""Angles [rad] this small are left out of a proposed posture where the joint can be at zero."""


@dataclass(frozen=True)
class Proposal:
    """A description, proposed.

    Attributes:
        text: the file, with what was found and what not as comments at its head.
        undecided: what the user must settle before the robot can walk.
        folder: where the file belongs: its ``urdf`` is relative to it.
    """

    text: str
    undecided: tuple[str, ...]
    folder: Path


def propose_description(urdf: Path) -> Proposal:
    """A description for a URDF nobody has described: joints by axis, side and order, posture, soles, gait.

    Args:
        urdf: the file.

    Raises:
        RobotError: the URDF cannot be read, or it is no biped that can walk in its frontal plane; `HypothesisError`
            names the hypothesis.
    """
    text = read_urdf(urdf)
    name = urdf.stem
    draft = RobotDescription(name, urdf, {}, {}, Sole(0.0, 0.0), None, None, urdf)
    full = build_model(draft, text)
    legs = find_legs(full, str(urdf))
    joints = {
        "left_ankle": legs.left[legs.roll[-1]],
        "left_hip": legs.left[legs.roll[0]],
        "right_hip": legs.right[legs.roll[0]],
        "right_ankle": legs.right[legs.roll[-1]],
    }
    notes = [f"legs: {', '.join(legs.left)}", f"and {', '.join(legs.right)}"]
    undecided: list[str] = []
    if not legs.sides_named:
        notes.append("which side is left follows from the root link's X pointing forward; joint names do not tell")
    if len(legs.roll) > 2:
        spare = ", ".join(legs.left[i] for i in legs.roll[1:-1])
        notes.append(f"of the leg's roll joints the first and the last are taken; {spare} is locked")
    notes.append(
        "armature: a URDF does not tell the rotors' reflected inertia; add [armature] ankle, hip (kg m^2) if known"
    )
    draft = replace(draft, joints=joints, posture=_reachable(full))
    return _complete(draft, full, legs, text, notes, undecided)


def propose_posture(path: Path) -> Proposal:
    """The description with another posture: roll axes parallel to X, feet flat, centre of mass over the soles.

    Args:
        path: the description file; its joints, sole, limits and gait are kept, its posture is where the search starts.

    Raises:
        RobotError: description or URDF cannot be read, or no legs are found; `HypothesisError` names the hypothesis.
    """
    description = read_description(path)
    text = read_urdf(description.urdf)
    full = build_model(description, text)
    legs = find_legs(full, str(description.urdf))
    for side, names in (("left", legs.left), ("right", legs.right)):
        for part in ("hip", "ankle"):
            joint = description.joints[f"{side}_{part}"]
            if joint not in names:
                raise RobotError(
                    f"{path}: [joints] {side}_{part} = {joint!r} is not of the {side} leg: {', '.join(names)}"
                )
    start = {**_reachable(full), **description.posture}
    return _complete(replace(description, posture=start), full, legs, text, [], [], keep=description)


def _complete(
    draft: RobotDescription,
    full: pin.Model,
    legs: Legs,
    text: str,
    notes: list[str],
    undecided: list[str],
    keep: RobotDescription | None = None,
) -> Proposal:
    """Posture, soles and what follows; ``keep`` is a description that has all but the posture."""
    start = posture_configuration(full, draft)
    sole, trouble = _measure(full, start, draft, legs, text)
    posture = find_posture(full, legs, draft.joints, start, None if sole is None else (sole.heel, sole.toe))
    draft = replace(draft, posture=_rounded(full, draft, posture), base_rpy=_rounded_rpy(posture))
    notes.append(_posture_note(posture))
    if not posture.aligned:
        undecided.append(
            f"posture: the roll axes stay {np.degrees(posture.axis_error):.3g} degrees off X and the feet"
            f" {np.degrees(posture.foot_error):.3g} degrees off flat; the frontal plane wants both at 0"
        )
    if not posture.balanced:
        undecided.append(
            f"posture: the centre of mass is {posture.com_x:+.3f} m from the ankles, outside the soles"
            f" {posture.heel:+.3f}..{posture.toe:+.3f} m; lean the torso"
        )
    comments: dict[str, str] = {}
    if keep is None:
        q = posture_configuration(full, draft)
        sole, trouble = _measure(full, q, draft, legs, text, posture.com_x)
        if sole is None:
            undecided.append(f"sole: {trouble}; measure inner, outer, ankle_height, front and back")
            draft = replace(draft, sole=Sole(0.0, 0.0))
        else:
            draft = replace(draft, sole=_described(sole))
            comments["sole"] = f"of one foot, m; measured on its {sole.source} shapes, under the centre of mass"
    draft, problems = _try(draft, full, text, comments, sole_known=keep is not None or sole is not None)
    undecided += problems
    head = [*notes, *(f"NOT DECIDED: {line}" for line in undecided)]
    folder = draft.urdf.parent if keep is None else keep.path.parent
    return Proposal(description_text(draft, _urdf_key(draft.urdf, folder), head, comments), tuple(undecided), folder)


def _described(sole: MeasuredSole) -> Sole:
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


def _try(
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
    if reduction is not None and not draft.gait:
        hips = float(np.linalg.norm(reduction.chain.joints[2] - reduction.chain.joints[1]))
        draft = replace(draft, gait=_gait(hips))
        comments["gait"] = "used where no specification is given; step_width: 0.8 to 1.8 hip widths"
    return draft, problems


def _gait(hip_width: float) -> dict[str, Any]:
    return {
        "degree": 8,
        "fri_degree": 4,
        "swing_clearance": 0.008,
        "step_duration": [0.3, 0.8],
        "step_width": [round(0.8 * hip_width, 4), round(1.8 * hip_width, 4)],
        "max_pelvis_roll": 0.1745,
    }


def _reachable(full: pin.Model) -> dict[str, float]:
    """Joints that cannot be at zero, at their nearest limit."""
    angles = {}
    for name in full.names[2:]:
        joint = full.joints[full.getJointId(name)]
        if joint.nq == 1:
            low, high = full.lowerPositionLimit[joint.idx_q], full.upperPositionLimit[joint.idx_q]
            if not low <= 0.0 <= high:
                angles[name] = float(np.clip(0.0, low, high))
    return angles


def _rounded(full: pin.Model, draft: RobotDescription, posture: Posture) -> dict[str, float]:
    angles = {name: angle for name, angle in draft.posture.items() if name not in posture.angles}
    for name, angle in posture.angles.items():
        joint = full.joints[full.getJointId(name)]
        reach = full.lowerPositionLimit[joint.idx_q] <= 0.0 <= full.upperPositionLimit[joint.idx_q]
        if abs(angle) > ZERO_ANGLE or not reach:
            angles[name] = round(angle, 9)
    return angles


def _rounded_rpy(posture: Posture) -> tuple[float, float, float]:
    roll, pitch, yaw = (0.0 if abs(angle) <= ZERO_ANGLE else round(angle, 12) for angle in posture.base_rpy)
    return roll, pitch, yaw


def _measure(
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


def _posture_note(posture: Posture) -> str:
    soles = "" if posture.heel is None else f", soles {posture.heel:+.3f}..{posture.toe:+.3f} m"
    return (
        f"posture: roll axes within {np.degrees(posture.axis_error):.1e} degrees of X, feet flat within"
        f" {np.degrees(posture.foot_error):.1e}, centre of mass {posture.com_x:+.3f} m ahead of the ankles{soles}"
    )


def _tenth_of_millimetre(length: float) -> float:
    return float(np.floor(1e4 * length + 1e-2)) / 1e4


def _urdf_key(urdf: Path, folder: Path) -> str:
    try:
        inside = urdf.resolve().relative_to(example_robot_data_dir().resolve())
    except (ValueError, RobotError):
        return urdf.relative_to(folder).as_posix()
    return f"{EXAMPLE_ROBOT_DATA}:{inside.as_posix()}"
