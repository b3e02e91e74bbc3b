"""The 3D robot with every joint locked but the four roll joints."""

import difflib
import xml.etree.ElementTree as ElementTree

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import HypothesisError, RobotError
from frontal_biped.model.urdf.description import RobotDescription

ROOT = "root_joint"


def build_model(description: RobotDescription, urdf_text: str) -> pin.Model:
    """3D model of a URDF with a free-flyer root, its limits set.

    Raises:
        RobotError: Pinocchio cannot read the URDF.
    """
    try:
        full = pin.buildModelFromXML(urdf_text, pin.JointModelFreeFlyer())
    except (ValueError, RuntimeError) as error:
        reason = " ".join(str(error).split())
        raise RobotError(f"{description.urdf}: Pinocchio cannot read it, {reason}; check it with check_urdf") from None
    full.name = description.name
    return full


def lock_other_joints(
    full: pin.Model, description: RobotDescription, urdf_text: str, where: str
) -> tuple[pin.Model, FloatArray]:
    """The model of the four roll joints, and its configuration at the posture of the description.

    Raises:
        RobotError: a named joint does not exist, or an angle of the posture is out of its joint's reach.
        HypothesisError: a roll joint is no ideal revolute joint (HR1).
    """
    _check_names(full, description, urdf_text, where)
    for name in description.joints.values():
        joint = full.joints[full.getJointId(name)]
        if joint.nq != 1 or joint.nv != 1 or not joint.shortname().startswith("JointModelR"):
            raise HypothesisError(
                "HR1", f'{where}: joint {name!r} is not an ideal revolute joint; make it type="revolute" with limits'
            )
    posture = posture_configuration(full, description, where)
    kept = {ROOT, *description.joints.values()}
    model = pin.buildReducedModel(full, [full.getJointId(n) for n in full.names[1:] if n not in kept], posture)
    reference = pin.neutral(model)
    reference[:7] = posture[:7]
    for name in description.joints.values():
        source, target = full.joints[full.getJointId(name)], model.joints[model.getJointId(name)]
        reference[target.idx_q] = posture[source.idx_q]
    return model, reference


def posture_configuration(full: pin.Model, description: RobotDescription, where: str) -> FloatArray:
    """Configuration (nq,) of the whole robot at the posture of the description, root turned by ``[base] rpy``.

    Raises:
        RobotError: an angle is outside its joint's limits, given or not.
    """
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
        raise RobotError(f"{where}: [posture] cannot leave out joints that cannot be at 0; add {', '.join(outside)}")
    return posture


def _check_names(full: pin.Model, description: RobotDescription, urdf_text: str, where: str) -> None:
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
            if name in fixed:
                remedy = "name a movable joint" if section == "posture" else 'make it type="revolute" with limits'
                raise RobotError(f"{where}: [{section}] joint {name!r} is fixed; {remedy}")
            close = difflib.get_close_matches(name, names, n=1)
            remedy = f"did you mean {close[0]!r}?" if close else f"movable joints: {', '.join(names)}"
            raise RobotError(f"{where}: [{section}] the URDF has no movable joint {name!r}; {remedy}")
