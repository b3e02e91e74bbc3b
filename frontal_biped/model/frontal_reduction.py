"""Reduce a URDF to its frontal plane: lock every joint but four, check HR1 to HR4, project the inertias.

Only mass, (y, z) of the centre of mass and the moment of inertia about X of each body enter a motion in the
frontal plane; the projection below is therefore exact, not an approximation, once the four axes are along X.
"""

import difflib
import xml.etree.ElementTree as ElementTree
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import HypothesisError, RobotError
from frontal_biped.model.description import ROLL_JOINTS, RobotDescription
from frontal_biped.model.frontal_chain import UPRIGHT, FrontalChain, PlanarBody
from frontal_biped.model.stance_map import StanceMap

AXIS_TOLERANCE = 1e-3
"""Largest angle [rad] between a roll axis and world X; beyond it the motion leaves the plane measurably."""

SYMMETRY_TOLERANCE = 1e-6
"""Largest relative difference between the mirrored legs (HR3); a URDF prints at least seven digits."""

ROOT = "root_joint"


class FrontalReduction(NamedTuple):
    """What the reduction of a URDF yields.

    Attributes:
        chain: the planar biped.
        stance_map: between URDF joint coordinates and stance coordinates.
        model: 3D Pinocchio model, free-flyer root and the four roll joints, the others locked.
        reference: configuration of ``model`` at the posture, all roll joints at their reference angle.
    """

    chain: FrontalChain
    stance_map: StanceMap
    model: pin.Model
    reference: FloatArray


def reduce_to_frontal_plane(description: RobotDescription, urdf_text: str) -> FrontalReduction:
    """Planar biped of a robot.

    Args:
        description: which joints roll, the posture, the soles, the limits.
        urdf_text: the robot's URDF, already checked by `read_urdf`.

    Returns:
        The planar chain, the stance map and the reduced 3D model.

    Raises:
        RobotError: a named joint does not exist, or the posture is out of a joint's reach.
        HypothesisError: the robot is no open chain of two mirrored legs with four actuated roll joints in the
            frontal plane (HR1 to HR4).
    """
    where = str(description.path)
    try:
        full = pin.buildModelFromXML(urdf_text, pin.JointModelFreeFlyer())
    except (ValueError, RuntimeError) as error:
        reason = " ".join(str(error).split())
        raise RobotError(f"{description.urdf}: Pinocchio cannot read it, {reason}; check it with check_urdf") from None
    _check_actuators(urdf_text, description, where)  # HR4
    full.name = description.name
    model, reference = _lock_other_joints(full, description, where)
    data = model.createData()
    pin.forwardKinematics(model, data, reference)
    pin.computeJointJacobians(model, data, reference)

    joint_id = {key: model.getJointId(description.joints[key]) for key in ROLL_JOINTS}
    _check_open_chain(model, joint_id, description, where)  # HR1
    axis_sign = _check_planarity(model, data, joint_id, description, where)  # HR2
    position = {key: data.oMi[joint].translation[1:].copy() for key, joint in joint_id.items()}
    for part in ("hip", "ankle"):
        left, right = position[f"left_{part}"][0], position[f"right_{part}"][0]
        if left <= right:
            raise HypothesisError(
                "HR3",
                f"{where}: the left {part} is at y = {left:.4g} m, right of the right one at {right:.4g} m;"
                " swap the joint names (Y points left)",
            )
    body = {
        "pelvis": _planar_inertia(model, data, model.getJointId(ROOT)),
        **{key: _planar_inertia(model, data, joint) for key, joint in joint_id.items()},
    }
    _check_feet(where, position, description)
    _check_mirrored_legs(where, position, body)  # HR3
    limits = _chain_limits(model, joint_id, axis_sign, description, where)  # HR4

    # (h, v) with the left foot as stance foot: h = y_left_ankle - y, v = z - z_sole
    left_ankle = position["left_ankle"]
    ground = left_ankle[1] - description.sole.ankle_height

    def to_plane(yz: FloatArray) -> FloatArray:
        return np.array([left_ankle[0] - yz[0], yz[1] - ground])

    bodies = [body["left_ankle"], body["left_hip"], body["pelvis"], body["right_hip"], body["right_ankle"]]
    chain = FrontalChain(
        joints=np.array([to_plane(position[key]) for key in ROLL_JOINTS]),
        bodies=tuple(b._replace(com=to_plane(b.com)) for b in bodies),  # type: ignore[arg-type]
        sole_inner=description.sole.inner,
        sole_outer=description.sole.outer,
        **limits,
    )
    stance_map = StanceMap(
        axis_sign=np.array([axis_sign[key] for key in ROLL_JOINTS]),
        reference=np.array([reference[model.joints[joint_id[key]].idx_q] for key in ROLL_JOINTS]),
        joint_names=tuple(description.joints[key] for key in ROLL_JOINTS),
    )
    return FrontalReduction(chain, stance_map, model, reference)


def _check_actuators(urdf_text: str, description: RobotDescription, where: str) -> None:
    for joint in ElementTree.fromstring(urdf_text).findall("joint"):
        if joint.get("name") in description.joints.values() and joint.find("mimic") is not None:
            raise HypothesisError(
                "HR4",
                f"{where}: joint {joint.get('name')!r} mimics another; the four roll joints are actuated on their own,"
                " remove its <mimic>",
            )


def _lock_other_joints(full: pin.Model, description: RobotDescription, where: str) -> tuple[pin.Model, FloatArray]:
    names = [name for name in full.names[1:] if name != ROOT]
    for section, asked in (("joints", list(description.joints.values())), ("posture", list(description.posture))):
        for name in asked:
            if not full.existJointName(name) or name == ROOT:
                close = difflib.get_close_matches(name, names, n=1)
                remedy = f"did you mean {close[0]!r}?" if close else f"movable joints: {', '.join(names)}"
                raise RobotError(f"{where}: [{section}] the URDF has no movable joint {name!r}; {remedy}")
    posture = pin.neutral(full)
    for name, angle in description.posture.items():
        joint = full.joints[full.getJointId(name)]
        if joint.nq != 1:
            raise RobotError(f"{where}: [posture] {name!r} is not a one-number joint; leave it out, it is locked at 0")
        low, high = full.lowerPositionLimit[joint.idx_q], full.upperPositionLimit[joint.idx_q]
        if not low <= angle <= high:
            raise RobotError(f"{where}: [posture] {name} = {angle:g} rad is outside its limits [{low:g}, {high:g}]")
        posture[joint.idx_q] = angle
    for name in description.joints.values():
        joint = full.joints[full.getJointId(name)]
        if joint.nq != 1 or joint.nv != 1 or not joint.shortname().startswith("JointModelR"):
            raise HypothesisError(
                "HR1", f'{where}: joint {name!r} is not an ideal revolute joint; make it type="revolute" with limits'
            )
    kept = {ROOT, *description.joints.values()}
    model = pin.buildReducedModel(full, [full.getJointId(n) for n in full.names[1:] if n not in kept], posture)
    reference = pin.neutral(model)
    for name in description.joints.values():
        source, target = full.joints[full.getJointId(name)], model.joints[model.getJointId(name)]
        reference[target.idx_q] = posture[source.idx_q]
    return model, reference


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


def _check_planarity(
    model: pin.Model, data: pin.Data, joint_id: Mapping[str, int], description: RobotDescription, where: str
) -> dict[str, float]:
    sign = {}
    for key, joint in joint_id.items():
        jacobian = pin.getJointJacobian(model, data, joint, pin.LOCAL_WORLD_ALIGNED)
        axis = jacobian[3:, model.joints[joint].idx_v]
        off = float(np.arctan2(np.linalg.norm(axis[1:]), abs(axis[0])))
        if off > AXIS_TOLERANCE:
            raise HypothesisError(
                "HR2",
                f"{where}: the axis of {description.joints[key]!r} is {np.degrees(off):.3g} degrees off world X;"
                " name the roll joint, or give the [posture] at which its axis is along X",
            )
        sign[key] = float(np.sign(axis[0]))
    return sign


def _planar_inertia(model: pin.Model, data: pin.Data, joint: int) -> PlanarBody:
    inertia = data.oMi[joint].act(model.inertias[joint])
    return PlanarBody(float(inertia.mass), inertia.lever[1:].copy(), float(inertia.inertia[0, 0]))


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


def _check_mirrored_legs(where: str, position: Mapping[str, FloatArray], body: Mapping[str, PlanarBody]) -> None:
    """Raise where left and right differ (HR3)."""
    middle = 0.5 * (position["left_hip"][0] + position["right_hip"][0])
    length = max(abs(position["left_hip"][1] - position["left_ankle"][1]), 1e-3)

    def differ(what: str, left: float, right: float, scale: float, unit: str) -> None:
        if abs(left - right) > SYMMETRY_TOLERANCE * scale:
            raise HypothesisError(
                "HR3",
                f"{where}: the legs are not mirror images, {what} is {left:.7g} {unit} on the left and"
                f" {right:.7g} {unit} on the right; make them equal in the URDF",
            )

    for part in ("hip", "ankle"):
        left, right = position[f"left_{part}"], position[f"right_{part}"]
        differ(f"the distance of the {part} from the middle", left[0] - middle, middle - right[0], length, "m")
        differ(f"the height of the {part}", left[1], right[1], length, "m")
    for joint, link in (("hip", "leg"), ("ankle", "foot")):
        a, b = body[f"left_{joint}"], body[f"right_{joint}"]
        differ(f"the mass of the {link}", a.mass, b.mass, a.mass, "kg")
        differ(f"the inertia of the {link}", a.inertia, b.inertia, a.inertia + a.mass * length**2, "kg m^2")
        differ(f"y of the {link}'s centre of mass", a.com[0] - middle, middle - b.com[0], length, "m")
        differ(f"z of the {link}'s centre of mass", a.com[1], b.com[1], length, "m")
    pelvis = body["pelvis"].com[0] - middle
    differ("the distance of the torso's centre of mass", pelvis, -pelvis, length, "m")


def _chain_limits(
    model: pin.Model,
    joint_id: Mapping[str, int],
    axis_sign: Mapping[str, float],
    description: RobotDescription,
    where: str,
) -> dict[str, FloatArray]:
    override = {"ankle": description.ankle_torque, "hip": description.hip_torque}
    torque, velocity, armature = np.zeros(4), np.zeros(4), np.zeros(4)
    lower, upper = np.zeros(4), np.zeros(4)
    for i, key in enumerate(ROLL_JOINTS):
        joint = model.joints[joint_id[key]]
        limit = override[key.split("_")[1]]
        torque[i] = model.effortLimit[joint.idx_v] if limit is None else limit
        if not torque[i] > 0.0:
            raise HypothesisError(
                "HR4",
                f"{where}: joint {description.joints[key]!r} has no effort limit, so it is not actuated;"
                f" set effort in the URDF or [limits] {key.split('_')[1]}_torque",
            )
        velocity[i] = model.velocityLimit[joint.idx_v]
        armature[i] = model.armature[joint.idx_v]
        # stance = left: q = pi/2-shifted URDF angle, sign as in StanceMap
        sign = axis_sign[key] * (1.0 if key.startswith("left") else -1.0)
        ends = sign * np.array([model.lowerPositionLimit[joint.idx_q], model.upperPositionLimit[joint.idx_q]])
        lower[i], upper[i] = UPRIGHT + ends.min(), UPRIGHT + ends.max()
    mirrored = {"max_torque": torque, "max_velocity": velocity, "armature": armature, "lower": lower, "upper": upper}
    for what, values in mirrored.items():
        if not np.allclose(values, values[::-1], rtol=SYMMETRY_TOLERANCE, atol=SYMMETRY_TOLERANCE):
            raise HypothesisError(
                "HR3",
                f"{where}: {what.replace('_', ' ')} differs between left and right ({values.tolist()});"
                " make the joint limits of the two legs mirror images",
            )
    return mirrored
