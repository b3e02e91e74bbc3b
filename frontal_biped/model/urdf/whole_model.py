"""The 3D model of a URDF with every joint, told what the description adds: limits, rotor inertia, the posture."""

import difflib
import xml.etree.ElementTree as ElementTree
from collections import Counter

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import RobotError
from frontal_biped.files.quoted import listed
from frontal_biped.model.urdf.description import RobotDescription
from frontal_biped.model.urdf.inertia_check import check_inertias
from frontal_biped.model.urdf.quiet import kept_from_terminal

ROOT = "root_joint"


def build_model(description: RobotDescription, urdf_text: str) -> pin.Model:
    """3D model of a URDF with a free-flyer root and the URDF's limits.

    Raises:
        RobotError: Pinocchio cannot read the URDF, or reads other inertias than it gives, or a joint has a name that
            Pinocchio gives to its own.
    """
    failed = ""
    with kept_from_terminal() as kept:
        try:
            full = pin.buildModelFromXML(urdf_text, pin.JointModelFreeFlyer())
        except (ValueError, RuntimeError) as error:
            failed = " ".join(str(error).split())
    if failed:
        reason = kept.text or failed
        raise RobotError(f"{description.urdf}: Pinocchio cannot read it, {reason}; check it with check_urdf")
    twice = [name for name, count in Counter(full.names).items() if count > 1]
    if twice:
        raise RobotError(f"{description.urdf}: a joint is called {twice[0]!r}, as one of Pinocchio's own; rename it")
    full.name = description.name
    check_inertias(str(description.urdf), full, urdf_text)
    return full


def build_described_model(description: RobotDescription, urdf_text: str) -> pin.Model:
    """The model of `build_model` with the torque limits and rotor inertias that the description gives.

    Raises:
        RobotError: Pinocchio cannot read the URDF, or a joint that the description names does not exist.
    """
    full = build_model(description, urdf_text)
    require_joints(full, description, urdf_text)
    behind_root = full.joints[full.getJointId(ROOT)].nv
    full.armature[behind_root:] = description.other_armature
    for key, name in description.joints.items():
        torque, armature = description.actuator(key)
        joint = full.joints[full.getJointId(name)]
        rows = slice(joint.idx_v, joint.idx_v + joint.nv)
        if torque is not None:
            full.lowerEffortLimit[rows], full.upperEffortLimit[rows] = -torque, torque
        full.armature[rows] = armature
    return full


def posture_configuration(full: pin.Model, description: RobotDescription) -> FloatArray:
    """Configuration (nq,) of the whole robot at the posture of the description, root turned by ``[base] rpy``.

    Raises:
        RobotError: an angle is outside its joint's limits, given or not.
    """
    where = str(description.path)
    posture = pin.neutral(full)
    posture[3:7] = pin.Quaternion(pin.rpy.rpyToMatrix(*description.base_rpy)).coeffs()
    outside = []
    for name in full.names[2:]:
        joint = full.joints[full.getJointId(name)]
        angle = description.posture.get(name, 0.0)
        if joint.nq == 2 and joint.nv == 1:  # continuous: cosine and sine
            posture[joint.idx_q : joint.idx_q + 2] = np.cos(angle), np.sin(angle)
            continue
        if joint.nq != 1:
            if name in description.posture:
                raise RobotError(
                    f"{where}: [posture] {name!r} is not a one-number joint; leave it out, it is locked at 0"
                )
            continue
        low, high = full.lowerPositionLimit[joint.idx_q], full.upperPositionLimit[joint.idx_q]
        if not low <= angle <= high:
            if name in description.posture:
                raise RobotError(
                    f"{where}: [posture] {name} = {angle:g} rad is outside its limits [{low:g}, {high:g}];"
                    " give an angle the joint can reach"
                )
            outside.append(f"{name} = {np.clip(angle, low, high):.9g}")
        posture[joint.idx_q] = angle
    if outside:
        raise RobotError(f"{where}: [posture] cannot leave out joints that cannot be at 0; add {listed(outside)}")
    return posture


def require_joints(full: pin.Model, description: RobotDescription, urdf_text: str) -> None:
    """Raise RobotError where a joint that the description names is none, or fixed."""
    names = [name for name in full.names[1:] if name != ROOT]
    fixed = {
        joint.get("name")
        for joint in ElementTree.fromstring(urdf_text).findall("joint")
        if joint.get("type") == "fixed"
    }
    for section, asked in (("joints", list(description.joints.values())), ("posture", list(description.posture))):
        for name in asked:
            if full.existJointName(name) and name != ROOT:
                continue
            where = f"{description.path}: [{section}]"
            if name in fixed:
                remedy = "name a movable joint" if section == "posture" else 'make it type="revolute" with limits'
                raise RobotError(f"{where} joint {name!r} is fixed; {remedy}")
            close = difflib.get_close_matches(name, names, n=1)
            remedy = f"did you mean {close[0]!r}?" if close else f"movable joints: {listed(names)}"
            raise RobotError(f"{where} the URDF has no movable joint {name!r}; {remedy}")
