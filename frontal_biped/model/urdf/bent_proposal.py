"""Propose a posture to walk from in space, for a robot whose knees are straight: `bent_posture`, in a description."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.model.urdf.bent_posture import BentPosture, find_bent_posture
from frontal_biped.model.urdf.description import RobotDescription, read_description
from frontal_biped.model.urdf.description_text import description_text
from frontal_biped.model.urdf.draft import (
    Proposal,
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
from frontal_biped.model.urdf.whole_model import build_model, posture_configuration

STEP_SHARE = 0.3
"""Distance of the feet in x for which knees are bent, where none is asked for, of the length of a leg [-]."""

ASSUMED_ARMATURE = 0.01
"""Reflected rotor inertia of every joint [kg m^2], where a robot that is to walk in space has none described."""


def propose_bent_posture(path: Path, step_length: float | None = None, name: str | None = None) -> Proposal:
    """The description with the knees bent far enough for steps forward; virtual legs where the roll axes then leave X.

    Rotor inertia that is not described is assumed to be `ASSUMED_ARMATURE`: a URDF without any has feet so light that
    they chatter.

    Args:
        path: the description file; its joints, sole, limits and gait are kept, and the posture of arms and head.
        step_length: distance of the feet in x [m]; None: `STEP_SHARE` of the length of a leg.
        name: of the robot in the new description; None: as it was.

    Raises:
        RobotError: description or URDF cannot be read, no legs are found, or they cannot bend; `HypothesisError` names
            the hypothesis.
    """
    description = read_description(path)
    urdf_text = read_urdf(description.urdf)
    full = build_model(description, urdf_text)
    legs = legs_of(description, full)
    draft = _without_legs(description, full, legs)
    wanted = STEP_SHARE * _leg_length(draft, full) if step_length is None else step_length
    start = posture_configuration(full, draft)
    ends = _sole_ends(draft, full, legs, start, urdf_text)
    found = find_bent_posture(full, legs, draft.joints, start, wanted, ends)
    bent = replace(
        draft,
        name=name or description.name,
        posture=rounded(full, draft, found.angles),
        base_rpy=rounded_rpy(found.base_rpy),
        virtual_legs=found.axis_error > AXIS_TOLERANCE,
    )
    comments = {"posture": "found by `frontal-biped robots --bend`"}
    if not (description.ankle_armature or description.hip_armature or description.other_armature):
        rotor = ASSUMED_ARMATURE
        bent = replace(bent, ankle_armature=rotor, hip_armature=rotor, other_armature=rotor)
        comments["armature"] = "reflected rotor inertia, kg m^2; assumed"
    undecided = []
    if found.step_length < wanted:
        undecided.append(
            f"posture: the legs have room for steps of {found.step_length:.3f} m, not of {wanted:.3f} m; check the"
            " limits of the pitch joints, or walk on the spot"
        )
    bent, problems = reduce_draft(bent, full, urdf_text, comments, sole_known=True)
    undecided += problems
    head = [_note(found), *(f"NOT DECIDED: {line}" for line in undecided)]
    folder = path.parent
    return Proposal(description_text(bent, urdf_key(bent.urdf, folder), head, comments), tuple(undecided), folder)


def _without_legs(description: RobotDescription, full: pin.Model, legs: Legs) -> RobotDescription:
    """The posture of all but the joints that the search moves: those start at zero, or as near as they come."""
    neutral = pin.neutral(full)
    moved = MirroredJoints(full, legs, description.joints, neutral, all_joints=True).angles(neutral)
    kept = {name: angle for name, angle in description.posture.items() if name not in moved}
    return replace(description, posture={**reachable(full), **kept})


def _leg_length(draft: RobotDescription, full: pin.Model) -> float:
    data = full.createData()
    pin.forwardKinematics(full, data, posture_configuration(full, draft))
    hip, ankle = (data.oMi[full.getJointId(draft.joints[f"left_{part}"])].translation for part in ("hip", "ankle"))
    return float(np.linalg.norm(hip - ankle))


def _sole_ends(
    draft: RobotDescription, full: pin.Model, legs: Legs, start: FloatArray, urdf_text: str
) -> tuple[float, float] | None:
    """X of heel and toe, from the ankle [m]: as described, or as measured; None: neither."""
    described, measured = draft.sole, None
    if described.front is None or described.back is None:
        measured, _ = measure_left_sole(full, start, draft, legs, urdf_text)
    heel = -described.back if described.back is not None else None if measured is None else measured.heel
    toe = described.front if described.front is not None else None if measured is None else measured.toe
    return None if heel is None or toe is None else (heel, toe)


def _note(found: BentPosture) -> str:
    torques: Mapping[str, float] = {name: abs(share) for name, share in found.torques.items()}
    worst = max(torques, key=lambda name: torques[name])
    return (
        f"posture: knees bent by {np.degrees(found.flexion):.1f} degrees, room for steps of {found.step_length:.3f} m,"
        f" centre of mass {found.com_x:+.3f} m ahead of the ankles; standing on one foot {worst} holds"
        f" {100.0 * torques[worst]:.0f} % of its torque"
    )
