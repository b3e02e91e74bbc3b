"""The axes of the roll joints: along X (HR2), or turned along X where the description asks for virtual legs.

Seen from the front, a leg with six joints turns about a line along X through the origin of its hip roll joint, and its
foot about one through the origin of its ankle roll joint: all six joints make those turns, whichever directions their
axes have. The planar biped of such a robot has its roll joints turned along X in place. Exact in it are the posture,
the masses and inertias, and where the turns take place: in space, a robot whose legs are told to make them has the
same (y, z). Approximate are its motors. Range, speed, torque and rotor inertia of the URDF's roll joint are taken over
as if they were about X, while in space other joints of the leg take part in the turn: by a share of the order of the
sine of the angle between axis and X.
"""

from collections.abc import Mapping

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import HypothesisError
from frontal_biped.model.robot import Robot
from frontal_biped.model.urdf.description import ROLL_JOINTS

AXIS_TOLERANCE = 1e-3
"""Largest angle [rad] between a roll axis and world X; beyond it the motion leaves the plane measurably."""

VIRTUAL_AXIS_TOLERANCE = np.radians(60.0)
"""The same with virtual legs: beyond it, the joint rolls less than it does something else."""

VIRTUAL_LEG_JOINTS = 6
"""Joints that a leg needs to make two turns while the foot keeps its other freedoms."""


def roll_axis_signs(model: pin.Model, reference: FloatArray, robot: Robot) -> dict[str, float]:
    """+1 where a roll joint's axis points forward, -1 where it points backward, by `ROLL_JOINTS`.

    Args:
        model: the four roll joints on a free-flyer.
        reference: (nq,) its posture.
        robot: of which it is the model.

    Raises:
        HypothesisError: an axis is not along X (HR2); with virtual legs, too far from it, or a leg has too few joints.
    """
    description = robot.description
    data = model.createData()
    pin.computeJointJacobians(model, data, reference)
    sign = {}
    for key in ROLL_JOINTS:
        name = description.joints[key]
        axis = _axis(model, data, model.getJointId(name))
        off = float(np.arctan2(np.linalg.norm(axis[1:]), abs(axis[0])))
        if off > (VIRTUAL_AXIS_TOLERANCE if description.virtual_legs else AXIS_TOLERANCE):
            remedy = "give the [posture] at which its axis is along X"
            if not description.virtual_legs and off <= VIRTUAL_AXIS_TOLERANCE:
                remedy += ", or let a leg of six joints make its turns with virtual_legs = true"
            raise HypothesisError(
                "HR2",
                f"{description.path}: the axis of {name!r} is {np.degrees(off):.3g} degrees off world X;"
                f" name the roll joint, or {remedy}",
            )
        sign[key] = float(np.sign(axis[0]))
    if description.virtual_legs:
        _check_leg_joints(robot)
    return sign


def turn_axes_along_x(model: pin.Model, reference: FloatArray, robot: Robot, sign: Mapping[str, float]) -> pin.Model:
    """The model with the frames of its roll joints turned, by the least turn, so that the axes are along +X or -X.

    Nothing moves at the reference, and bodies, joints' origins and limits stay.

    Args:
        model: the four roll joints on a free-flyer.
        reference: (nq,) its posture.
        robot: of which it is the model.
        sign: which way each axis points, from `roll_axis_signs`.
    """
    turned, data = model.copy(), model.createData()
    pin.computeJointJacobians(model, data, reference)
    old = {joint: data.oMi[joint].copy() for joint in range(1, model.njoints)}
    new = dict(old)
    for key, name in robot.description.joints.items():
        joint = model.getJointId(name)
        turn = pin.Quaternion.FromTwoVectors(_axis(model, data, joint), np.array([sign[key], 0.0, 0.0])).matrix()
        new[joint] = pin.SE3(turn @ old[joint].rotation, old[joint].translation)
    for joint in range(2, model.njoints):
        # at the reference angle; the joint's own turn is taken off its placement
        own = data.liMi[joint].inverse() * model.jointPlacements[joint]
        turned.jointPlacements[joint] = new[model.parents[joint]].inverse() * new[joint] * own
    for joint in range(1, model.njoints):
        to_new = new[joint].inverse() * old[joint]
        turned.inertias[joint] = to_new.act(model.inertias[joint])
        for i, frame in enumerate(model.frames):
            if frame.parentJoint == joint and frame.type != pin.FrameType.JOINT:
                turned.frames[i].placement = to_new * frame.placement
    return turned


def _check_leg_joints(robot: Robot) -> None:
    model, joints = robot.model, robot.description.joints
    left, right = (set(model.supports[model.getJointId(joints[f"{side}_ankle"])]) for side in ("left", "right"))
    for side, leg in (("left", left - right), ("right", right - left)):
        count = sum(model.joints[joint].nv for joint in leg)
        if count < VIRTUAL_LEG_JOINTS:
            raise HypothesisError(
                "HR2",
                f"{robot.description.path}: virtual_legs = true, but down to {joints[f'{side}_ankle']!r} the {side} leg"
                f" has {count} joints of at least {VIRTUAL_LEG_JOINTS}; leave virtual_legs out, and give the [posture]"
                " at which the roll axes are along X",
            )


def _axis(model: pin.Model, data: pin.Data, joint: int) -> FloatArray:
    """World axis of a joint, from its Jacobian."""
    jacobian = pin.getJointJacobian(model, data, joint, pin.LOCAL_WORLD_ALIGNED)
    return np.array(jacobian[3:, model.joints[joint].idx_v])
