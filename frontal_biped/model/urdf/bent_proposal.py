"""Propose a posture to walk from in space: `bent_posture`, in a description."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.model.urdf.bent_posture import BentPosture, find_bent_posture
from frontal_biped.model.urdf.description import RobotDescription, read_description
from frontal_biped.model.urdf.description_text import description_text
from frontal_biped.model.urdf.draft import (
    Proposal,
    described,
    first_draft,
    legs_of,
    measure_left_sole,
    reachable,
    reduce_draft,
    rounded,
    rounded_rpy,
    urdf_key,
)
from frontal_biped.model.urdf.frontal_axes import AXIS_TOLERANCE
from frontal_biped.model.urdf.legs import Legs
from frontal_biped.model.urdf.mirrored_joints import MirroredJoints
from frontal_biped.model.urdf.read import read_urdf
from frontal_biped.model.urdf.whole_model import build_model, posture_configuration, require_joints

STEP_SHARE = 0.3
"""Distance of the feet in x for which knees are bent, where none is asked for, of the length of a leg [-]."""

ASSUMED_ARMATURE = 0.01
"""Reflected rotor inertia of every joint [kg m^2], where a robot that is to walk in space has none described and its
legs are `USUAL_LEG` or longer; smaller motors have it smaller, with the cube of the length."""

USUAL_LEG = 0.6
"""Length of the legs [m] of a robot whose steps take `STEP_DURATIONS`; times grow with the root of the length."""

STEP_DURATIONS = (0.4, 0.8)  # [s]; slow steps sway far, to the ends of the hips' ranges
CLEARANCE = 0.02  # [m] of a swing foot of that robot: in space it is not led as exactly as in the plane
NARROWER = 2.0 / 3.0
"""Widest step over that proposed for the plane: 1.2 distances of the hips. Wider ones cost less, and land harder."""

BETWEEN_FEET = 0.02  # [m] at least
SOLE_MARGIN = 0.2  # of the distance from the ankle to the nearer edge of the sole, that the FRI keeps
LEVEL = 0.05  # [rad] that the swing foot may turn


def propose_bent_posture(
    path: Path, step_length: float | None = None, name: str | None = None, folder: Path | None = None
) -> Proposal:
    """The description with the knees bent far enough for steps forward; virtual legs where the roll axes then leave X.

    Rotor inertia that is not described is assumed (`ASSUMED_ARMATURE`): a URDF without any has feet so light that they
    chatter.

    Args:
        path: the description file; its joints, sole, limits and gait are kept, and the posture of arms and head.
        step_length: distance of the feet in x [m]; None: `STEP_SHARE` of the length of a leg.
        name: of the robot in the new description; None: as it was.
        folder: where the new description is to lie, its URDF below it; None: beside the old one.

    Raises:
        RobotError: description or URDF cannot be read, no legs are found, or they cannot bend; `HypothesisError` names
            the hypothesis.
    """
    description = read_description(path)
    urdf_text = read_urdf(description.urdf)
    full = build_model(description, urdf_text)
    require_joints(full, description, urdf_text)
    legs = legs_of(description, full)
    draft = replace(_without_legs(description, full, legs), name=name or description.name)
    start = posture_configuration(full, draft)
    ends = _sole_ends(draft, full, legs, start, urdf_text)
    bent, found, undecided = _bent(draft, full, legs, ends, step_length)
    comments = {"posture": "found by `frontal-biped robots --bend`"}
    return _proposal(bent, full, urdf_text, [_note(found)], undecided, comments, folder or path.parent)


def propose_walking_description(urdf: Path, folder: Path, name: str | None = None) -> Proposal:
    """A description for a URDF nobody has described, to walk in space: knees bent, level feet, steps of its size.

    Args:
        urdf: the file.
        folder: where the description is to lie, the URDF below it.
        name: of the robot; None: that of the file.

    Raises:
        RobotError: the URDF cannot be read, or its legs cannot walk so; `HypothesisError` names the hypothesis.
    """
    draft, full, legs, urdf_text, notes, doubts = first_draft(urdf)
    draft = replace(draft, name=name or draft.name)
    sole, trouble = measure_left_sole(full, posture_configuration(full, draft), draft, legs, urdf_text)
    ends = None if sole is None else (sole.heel, sole.toe)
    bent, found, undecided = _bent(draft, full, legs, ends, None)
    undecided = doubts + undecided
    comments: dict[str, str] = {}
    sole, trouble = (
        measure_left_sole(full, posture_configuration(full, bent), bent, legs, urdf_text, found.com_x)
        if sole is not None
        else (None, trouble)
    )
    if sole is None:
        undecided.append(f"sole: {trouble}; measure inner, outer, ankle_height, front and back")
    else:
        bent = replace(bent, sole=described(sole))
        comments["sole"] = f"of one foot, m; measured on its {sole.source} shapes, under the centre of mass"
    return _proposal(bent, full, urdf_text, [*notes, _note(found)], undecided, comments, folder)


def _bent(
    draft: RobotDescription, full: pin.Model, legs: Legs, ends: tuple[float, float] | None, step_length: float | None
) -> tuple[RobotDescription, BentPosture, list[str]]:
    """The draft with its knees bent, how they are, and what could not be reached."""
    wanted = STEP_SHARE * leg_length(draft, full) if step_length is None else step_length
    found = find_bent_posture(full, legs, draft.joints, posture_configuration(full, draft), wanted, ends)
    bent = replace(
        draft,
        posture=rounded(full, draft, found.angles),
        base_rpy=rounded_rpy(found.base_rpy),
        virtual_legs=found.axis_error > AXIS_TOLERANCE,
    )
    undecided = []
    if found.step_length < wanted:
        undecided.append(
            f"posture: the legs have room for steps of {found.step_length:.3f} m, not of {wanted:.3f} m; check the"
            " limits of the pitch joints, or walk on the spot"
        )
    return bent, found, undecided


def _proposal(
    bent: RobotDescription,
    full: pin.Model,
    urdf_text: str,
    notes: list[str],
    undecided: list[str],
    comments: dict[str, str],
    folder: Path,
) -> Proposal:
    """With rotors, averaged legs and a gait where there are none."""
    if not (bent.ankle_armature or bent.hip_armature or bent.other_armature):
        rotor = float(f"{ASSUMED_ARMATURE * min(leg_length(bent, full) / USUAL_LEG, 1.0) ** 3:.1g}")
        bent = replace(bent, ankle_armature=rotor, hip_armature=rotor, other_armature=rotor)
        comments["armature"] = "reflected rotor inertia, kg m^2; assumed, the URDF tells none"
    given = bool(bent.gait)
    bent, problems = reduce_draft(bent, full, urdf_text, comments, sole_known=bent.sole.inner > 0.0)
    if bent.gait and not given:
        bent = replace(bent, gait=_walking_gait(bent.gait, bent, leg_length(bent, full)))
        comments["gait"] = "used where no specification is given"
    undecided = [*undecided, *problems]
    head = [*notes, *(f"NOT DECIDED: {line}" for line in undecided)]
    file = description_text(bent, urdf_key(bent.urdf, folder), head, comments)
    return Proposal(file, tuple(undecided), folder, found=tuple(notes))


def _walking_gait(gait: Mapping[str, Any], bent: RobotDescription, length: float) -> dict[str, Any]:
    """The proposed keys for a walk in space: a level foot, an FRI inside the sole, and times of the robot's size."""
    scale = length / USUAL_LEG
    walking = {
        **gait,
        "swing_clearance": round(CLEARANCE * scale, 4),
        "step_duration": [round(duration * scale**0.5, 2) for duration in STEP_DURATIONS],
        "max_foot_rotation": LEVEL,
    }
    sole, (narrow, wide) = bent.sole, gait["step_width"]
    narrow = max(narrow, round(2.0 * sole.inner + BETWEEN_FEET, 4))
    walking["step_width"] = [narrow, max(round(NARROWER * wide, 4), round(1.25 * narrow, 4))]
    if sole.inner > 0.0:
        walking["fri_margin"] = round(SOLE_MARGIN * min(sole.inner, sole.outer), 4)
    return walking


def leg_length(description: RobotDescription, full: pin.Model) -> float:
    """From the origin of the hip roll joint to that of the ankle roll joint, at the posture of a description [m]."""
    data, joints = full.createData(), description.joints
    pin.forwardKinematics(full, data, posture_configuration(full, description))
    hip, ankle = (data.oMi[full.getJointId(joints[f"left_{part}"])].translation for part in ("hip", "ankle"))
    return float(np.linalg.norm(hip - ankle))


def _without_legs(description: RobotDescription, full: pin.Model, legs: Legs) -> RobotDescription:
    """The posture of all but the joints that the search moves: those start at zero, or as near as they come."""
    neutral = pin.neutral(full)
    moved = MirroredJoints(full, legs, description.joints, neutral, all_joints=True).angles(neutral)
    kept = {name: angle for name, angle in description.posture.items() if name not in moved}
    return replace(description, posture={**reachable(full), **kept})


def _sole_ends(
    draft: RobotDescription, full: pin.Model, legs: Legs, start: FloatArray, urdf_text: str
) -> tuple[float, float] | None:
    """X of heel and toe, from the ankle [m]: as described, or as measured; None: neither."""
    described_sole, measured = draft.sole, None
    if described_sole.front is None or described_sole.back is None:
        measured, _ = measure_left_sole(full, start, draft, legs, urdf_text)
    heel = -described_sole.back if described_sole.back is not None else None if measured is None else measured.heel
    toe = described_sole.front if described_sole.front is not None else None if measured is None else measured.toe
    return None if heel is None or toe is None else (heel, toe)


def _note(found: BentPosture) -> str:
    torques: Mapping[str, float] = {name: abs(share) for name, share in found.torques.items()}
    worst = max(torques, key=lambda name: torques[name])
    return (
        f"posture: knees bent by {np.degrees(found.flexion):.1f} degrees, room for steps of {found.step_length:.3f} m,"
        f" centre of mass {found.com_x:+.3f} m ahead of the ankles; standing on one foot {worst} holds"
        f" {100.0 * torques[worst]:.0f} % of its torque"
    )
