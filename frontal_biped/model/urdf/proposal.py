"""Propose a description for an unknown URDF, or a posture for a description, and say what could not be decided."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pinocchio as pin

from frontal_biped.exceptions import RobotError
from frontal_biped.model.urdf.description import RobotDescription, Sole, read_description
from frontal_biped.model.urdf.description_text import description_text
from frontal_biped.model.urdf.draft import (
    Proposal,
    changed_angles,
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
from frontal_biped.model.urdf.legs import Legs
from frontal_biped.model.urdf.posture import Posture, find_posture
from frontal_biped.model.urdf.read import read_urdf
from frontal_biped.model.urdf.whole_model import build_model, posture_configuration, require_joints


def propose_description(urdf: Path) -> Proposal:
    """A description for a URDF nobody has described: joints by axis, side and order, posture, soles, gait.

    Args:
        urdf: the file.

    Raises:
        RobotError: the URDF cannot be read, or it is no biped that can walk in its frontal plane; `HypothesisError`
            names the hypothesis.
    """
    draft, full, legs, text, notes, undecided = first_draft(urdf)
    notes.append(
        "armature: a URDF does not tell the rotors' reflected inertia; add [armature] ankle, hip (kg m^2) if known"
    )
    return _complete(draft, full, legs, text, notes, undecided)


def propose_posture(path: Path) -> Proposal:
    """The description with another posture: roll axes parallel to X, feet flat, centre of mass over the soles.

    Args:
        path: the description file; its joints, sole, limits and gait are kept, and the angles of its posture where feet
            can be flat and the robot in balance with them.

    Raises:
        RobotError: description or URDF cannot be read, or no legs are found; `HypothesisError` names the hypothesis.
    """
    description = read_description(path)
    text = read_urdf(description.urdf)
    full = build_model(description, text)
    require_joints(full, description, text)
    legs = legs_of(description, full)
    start = {**reachable(full), **description.posture}
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
    sole, trouble = measure_left_sole(full, start, draft, legs, text)
    given = {} if keep is None else keep.posture
    ends = None if sole is None else (sole.heel, sole.toe)
    posture = find_posture(full, legs, draft.joints, start, ends, tuple(given))
    if not np.isfinite([*posture.base_rpy, *posture.angles.values(), posture.com_x, posture.axis_error]).all():
        raise RobotError(f"{draft.urdf}: no posture can be computed; look at its masses, lengths and limits")
    draft = replace(draft, posture=rounded(full, draft, posture.angles), base_rpy=rounded_rpy(posture.base_rpy))
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
        sole, trouble = measure_left_sole(full, q, draft, legs, text, posture.com_x)
        if sole is None:
            undecided.append(f"sole: {trouble}; measure inner, outer, ankle_height, front and back")
            draft = replace(draft, sole=Sole(0.0, 0.0))
        else:
            draft = replace(draft, sole=described(sole))
            comments["sole"] = f"of one foot, m; measured on its {sole.source} shapes, under the centre of mass"
    draft, problems = reduce_draft(draft, full, text, comments, sole_known=keep is not None or sole is not None)
    undecided += problems
    changed = changed_angles(given, draft.posture)
    head = [*notes, *(f"CHANGED: {line}" for line in changed), *(f"NOT DECIDED: {line}" for line in undecided)]
    folder = draft.urdf.parent if keep is None else keep.path.parent
    file = description_text(draft, urdf_key(draft.urdf, folder), head, comments)
    return Proposal(file, tuple(undecided), folder, tuple(changed), tuple(notes))


def _posture_note(posture: Posture) -> str:
    soles = "" if posture.heel is None else f", soles {posture.heel:+.3f}..{posture.toe:+.3f} m"
    return (
        f"posture: roll axes within {np.degrees(posture.axis_error):.1e} degrees of X, feet flat within"
        f" {np.degrees(posture.foot_error):.1e}, centre of mass {posture.com_x:+.3f} m ahead of the ankles{soles}"
    )
