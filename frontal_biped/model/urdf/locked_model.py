"""The 3D robot with every joint locked but the four roll joints."""

import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import HypothesisError
from frontal_biped.model.robot import Robot
from frontal_biped.model.urdf.whole_model import ROOT


def lock_other_joints(robot: Robot) -> tuple[pin.Model, FloatArray]:
    """The model of the four roll joints, and its configuration at the robot's posture.

    Raises:
        HypothesisError: a roll joint is no ideal revolute joint (HR1).
    """
    full, posture, roll_joints = robot.model, robot.posture, robot.description.joints.values()
    for name in roll_joints:
        joint = full.joints[full.getJointId(name)]
        if joint.nq != 1 or joint.nv != 1 or not joint.shortname().startswith("JointModelR"):
            raise HypothesisError(
                "HR1",
                f"{robot.description.path}: joint {name!r} is not an ideal revolute joint;"
                ' make it type="revolute" with limits',
            )
    kept = (ROOT, *roll_joints)
    model = pin.buildReducedModel(full, [full.getJointId(n) for n in full.names[1:] if n not in kept], posture)
    reference = pin.neutral(model)
    for name in kept:
        source, target = full.joints[full.getJointId(name)], model.joints[model.getJointId(name)]
        reference[target.idx_q : target.idx_q + target.nq] = posture[source.idx_q : source.idx_q + source.nq]
    return model, reference
