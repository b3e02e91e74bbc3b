"""Reduce a robot to its frontal plane: lock every joint but four, check HR1 to HR5, project, symmetrise."""

import xml.etree.ElementTree as ElementTree
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import HypothesisError
from frontal_biped.model.chain import FrontalChain
from frontal_biped.model.robot import Robot
from frontal_biped.model.stance_map import StanceMap
from frontal_biped.model.urdf.description import ROLL_JOINTS, RobotDescription
from frontal_biped.model.urdf.frontal_axes import roll_axis_signs, turn_axes_along_x
from frontal_biped.model.urdf.legs import nearest_upright
from frontal_biped.model.urdf.locked_model import lock_other_joints
from frontal_biped.model.urdf.projection import PELVIS, FrontalBodies, RollJoint, planar_inertia
from frontal_biped.model.urdf.symmetry import MOST_AVERAGED, Asymmetry, asymmetry, symmetrised
from frontal_biped.model.urdf.whole_model import ROOT

FLAT_TOLERANCE = 1e-3
"""Largest roll [rad] of a foot at the reference posture; with virtual legs, largest turn about any axis."""


class FrontalReduction(NamedTuple):
    """What the reduction of a robot yields.

    Attributes:
        chain: the planar biped, legs mirrored.
        stance_map: between URDF joint coordinates and stance coordinates.
        model: 3D Pinocchio model, free-flyer root and the four roll joints, the others locked; with virtual legs, the
            axes of the roll joints are turned along X (`frontal_axes`), and so they are in ``stance_map``.
        reference: configuration of ``model`` at the posture, all roll joints at their reference angle.
        measured: the robot in its frontal plane as the URDF has it, before the legs were made equal.
        asymmetry: how much that changed.
    """

    chain: FrontalChain
    stance_map: StanceMap
    model: pin.Model
    reference: FloatArray
    measured: FrontalBodies
    asymmetry: Asymmetry


def reduce_to_frontal_plane(robot: Robot) -> FrontalReduction:
    """Planar biped of a robot: its four roll joints, the others locked at its posture.

    Args:
        robot: the whole robot.

    Returns:
        The planar chain, the stance map and the reduced 3D model.

    Raises:
        HypothesisError: the robot is no open chain of two mirrored legs with four actuated roll joints in the
            frontal plane (HR1 to HR5).
    """
    description = robot.description
    where = str(description.path)
    _check_actuators(robot.urdf_text, description, where)  # HR4
    model, reference = lock_other_joints(robot)
    data = model.createData()
    joint_id = {key: model.getJointId(description.joints[key]) for key in ROLL_JOINTS}
    _check_open_chain(model, joint_id, description, where)  # HR1
    axis_sign = roll_axis_signs(model, reference, robot)  # HR2
    if description.virtual_legs:
        model = turn_axes_along_x(model, reference, robot, axis_sign)
        data = model.createData()
    pin.forwardKinematics(model, data, reference)
    position = {key: data.oMi[joint].translation[1:].copy() for key, joint in joint_id.items()}
    for part in ("hip", "ankle"):
        left, right = position[f"left_{part}"][0], position[f"right_{part}"][0]
        if left <= right:
            raise HypothesisError(
                "HR3",
                f"{where}: the left {part} is at y = {left:.4g} m, right of the right one at {right:.4g} m;"
                " swap the joint names (Y points left), or turn the robot with [base] rpy",
            )
    angle = {key: float(reference[model.joints[joint].idx_q]) for key, joint in joint_id.items()}
    measured = FrontalBodies(
        position=position,
        body={
            PELVIS: planar_inertia(model, data, model.getJointId(ROOT)),
            **{key: planar_inertia(model, data, joint) for key, joint in joint_id.items()},
        },
        joint={key: _roll_joint(model, key, axis_sign[key], description, where) for key in ROLL_JOINTS},  # HR4
    )
    _check_inertias(measured, description, where)  # HR1
    _check_feet(where, position, description)  # HR5
    differences = asymmetry(measured, description.sole)
    bodies = _mirrored(measured, differences, description, where)  # HR3
    if description.virtual_legs:
        _check_level_feet(robot)  # HR5
    else:
        _check_flat_feet(where, angle, axis_sign, description)  # HR5
    stance_map = StanceMap(
        axis_sign=np.array([axis_sign[key] for key in ROLL_JOINTS]),
        reference=np.array([angle[key] for key in ROLL_JOINTS]),
        joint_names=tuple(description.joints[key] for key in ROLL_JOINTS),
    )
    return FrontalReduction(bodies.chain(description.sole), stance_map, model, reference, measured, differences)


def _check_actuators(urdf_text: str, description: RobotDescription, where: str) -> None:
    for joint in ElementTree.fromstring(urdf_text).findall("joint"):
        if joint.get("name") in description.joints.values() and joint.find("mimic") is not None:
            raise HypothesisError(
                "HR4",
                f"{where}: joint {joint.get('name')!r} mimics another; the four roll joints are actuated on their own,"
                " remove its <mimic>",
            )


def _check_open_chain(model: pin.Model, joint_id: Mapping[str, int], description: RobotDescription, where: str) -> None:
    root = model.getJointId(ROOT)
    for side in ("left", "right"):
        hip, ankle = joint_id[f"{side}_hip"], joint_id[f"{side}_ankle"]
        for joint, parent, what in ((hip, root, "the pelvis"), (ankle, hip, f"the {side} hip")):
            if model.parents[joint] != parent:
                raise HypothesisError(
                    "HR1",
                    f"{where}: joint {model.names[joint]!r} does not hang from {what} but from"
                    f" {model.names[model.parents[joint]]!r}; the open chain is foot, leg, pelvis, leg, foot:"
                    f" check [joints] {side}_hip and {side}_ankle",
                )
    for key, joint in joint_id.items():
        if model.inertias[joint].mass <= 0.0:
            raise HypothesisError(
                "HR1",
                f"{where}: the link moved by {description.joints[key]!r} has no mass;"
                " give it an <inertial> with positive mass",
            )
    if model.inertias[root].mass <= 0.0:
        raise HypothesisError("HR1", f"{where}: the pelvis link has no mass; give it an <inertial> with positive mass")


def _check_inertias(bodies: FrontalBodies, description: RobotDescription, where: str) -> None:
    for key, body in bodies.body.items():
        if body.inertia <= 0.0:
            part = "the pelvis" if key == PELVIS else f"the link moved by {description.joints[key]!r}"
            raise HypothesisError(
                "HR1",
                f"{where}: {part} has a moment of inertia of {body.inertia:g} kg m^2 about the roll axis;"
                " give its <inertia> a positive ixx",
            )


def _check_feet(where: str, position: Mapping[str, FloatArray], description: RobotDescription) -> None:
    for side in ("left", "right"):
        if position[f"{side}_hip"][1] <= position[f"{side}_ankle"][1]:
            raise HypothesisError(
                "HR5",
                f"{where}: the {side} ankle is not below the {side} hip at the reference posture;"
                " stand the robot upright there, feet flat",
            )
    apart = position["left_ankle"][0] - position["right_ankle"][0]
    if apart <= 2.0 * description.sole.inner:
        raise HypothesisError(
            "HR5",
            f"{where}: [sole] inner = {description.sole.inner:g} m makes the feet overlap, the ankles are"
            f" {apart:.4g} m apart at the reference posture; give the true sole",
        )


def _check_flat_feet(
    where: str, angle: Mapping[str, float], axis_sign: Mapping[str, float], description: RobotDescription
) -> None:
    """A foot is flat when hip and ankle roll cancel, whatever the pitch joints between them do."""
    for side in ("left", "right"):
        hip, ankle = f"{side}_hip", f"{side}_ankle"
        roll = axis_sign[hip] * angle[hip] + axis_sign[ankle] * angle[ankle]
        if abs(roll) > FLAT_TOLERANCE:
            raise HypothesisError(
                "HR5",
                f"{where}: the {side} foot is rolled by {np.degrees(roll):.3g} degrees at the reference posture; let"
                f" [posture] {description.joints[ankle]} and {description.joints[hip]} cancel",
            )


def _check_level_feet(robot: Robot) -> None:
    """With virtual legs roll angles do not tell whether a foot is flat: it is as it is drawn, all joints at zero."""
    model, description = robot.model, robot.description
    data = model.createData()
    drawn = pin.neutral(model)
    drawn[3:7] = pin.Quaternion(nearest_upright(pin.rpy.rpyToMatrix(*description.base_rpy))).coeffs()
    for side in ("left", "right"):
        name = description.joints[f"{side}_ankle"]
        foot = model.getJointId(name)
        pin.forwardKinematics(model, data, drawn)
        flat = data.oMi[foot].rotation.copy()
        pin.forwardKinematics(model, data, robot.posture)
        turn = pin.log3(data.oMi[foot].rotation @ flat.T)
        if float(np.linalg.norm(turn)) > FLAT_TOLERANCE:
            roll, pitch, yaw = np.degrees(turn)
            raise HypothesisError(
                "HR5",
                f"{description.path}: the {side} foot is turned by {roll:.3g}, {pitch:.3g} and {yaw:.3g} degrees about"
                f" X, Y and Z at the reference posture; let the [posture] of the joints down to {name!r} cancel",
            )


def _mirrored(measured: FrontalBodies, found: Asymmetry, description: RobotDescription, where: str) -> FrontalBodies:
    """The bodies with equal legs; where they are not, only if the description lets them be averaged (HR3)."""
    if not found.differences:
        return symmetrised(measured)  # rounding only
    worst = found.differences[0]
    what = f"{worst.what} is {worst.left:.7g} {worst.unit} on the left and {worst.right:.7g} {worst.unit} on the right"
    if not description.symmetrise:
        raise HypothesisError(
            "HR3",
            f"{where}: the legs are not mirror images, {what}; make them equal in the URDF, or let them be averaged"
            " with symmetrise = true",
        )
    if found.bodies > MOST_AVERAGED:
        raise HypothesisError(
            "HR3",
            f"{where}: the legs differ by {100 * found.bodies:.3g} %, too much to average"
            f" (at most {100 * MOST_AVERAGED:g} %), {what}; make them equal in the URDF",
        )
    bodies = symmetrised(measured)
    for key, joint in bodies.joint.items():
        if not joint.lower < 0.0 < joint.upper:
            raise HypothesisError(
                "HR3",
                f"{where}: left and right {key.split('_')[1]} limits have nothing in common around the reference"
                " posture; mirror their lower and upper in the URDF",
            )
    return bodies


def _roll_joint(model: pin.Model, key: str, axis_sign: float, description: RobotDescription, where: str) -> RollJoint:
    """Limits of one joint about +X from its reference angle."""
    part, name = key.split("_")[1], description.joints[key]
    joint = model.joints[model.getJointId(name)]
    effort = float(model.effortLimit[joint.idx_v])
    if not effort > 0.0:
        raise HypothesisError(
            "HR4",
            f"{where}: joint {name!r} has no effort limit, so it is not actuated;"
            f" set effort in the URDF or [limits] {part}_torque",
        )
    velocity = float(model.velocityLimit[joint.idx_v])
    if not velocity > 0.0:
        raise HypothesisError(
            "HR4", f"{where}: joint {name!r} has no velocity limit, so it cannot move; set velocity in the URDF"
        )
    reference = description.posture.get(name, 0.0)
    ends = axis_sign * (
        np.array([model.lowerPositionLimit[joint.idx_q], model.upperPositionLimit[joint.idx_q]]) - reference
    )
    if not ends.min() < 0.0 < ends.max():
        raise HypothesisError(
            "HR4",
            f"{where}: joint {name!r} cannot move to both sides of its reference angle {reference:g} rad,"
            f" its limits are [{model.lowerPositionLimit[joint.idx_q]:g}, {model.upperPositionLimit[joint.idx_q]:g}];"
            " widen them in the URDF or move the posture",
        )
    armature = float(model.armature[joint.idx_v])
    return RollJoint(float(ends.min()), float(ends.max()), velocity, effort, armature)
