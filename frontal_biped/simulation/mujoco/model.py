"""MuJoCo's model of a robot in its frontal plane, built by `MjSpec` from the same URDF and description as ours.

Every joint but the four roll joints is locked at the description's posture, and the root gets three joints: along Y,
along Z, about X. The feet touch only their own floor, nothing else collides. Legs that our model averages stay as they
are. `frontal_biped.simulation.mujoco.spec` says what MuJoCo takes from the URDF.
"""

from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import RobotError
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.catalogue import models_dir
from frontal_biped.model.perturbation import LINKS
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.urdf.read import ROUNDING_INERTIA
from frontal_biped.simulation.mujoco.spec import (
    SOLE_THICKNESS,
    ContactSettings,
    add_ground,
    add_sole,
    import_mujoco,
    inertia_of,
    lock,
    read_spec,
    release,
    to_quaternion,
    to_rotation,
)

if TYPE_CHECKING:
    from mujoco import MjModel, MjSpec

SOLE_LENGTH = 0.2
"""Of the box feet along X [m]; nothing in the plane depends on it."""

BASE_JOINTS = ("frontal_base_y", "frontal_base_z", "frontal_base_roll")


def mujoco_model(biped: FrontalBiped, contact: ContactSettings | None = None) -> "MjModel":
    """Compile MuJoCo's model of a robot: 7 degrees of freedom, y and z [m], roll [rad], then the roll joints.

    At the zero configuration the robot stands at its reference posture on the ground, feet on either side of y = 0.

    Args:
        biped: the robot; its URDF and description are read, not its reduced model.
        contact: contact and physics step.

    Raises:
        MissingExtraError: MuJoCo is not installed.
        RobotError: the robot has virtual legs.
    """
    return mujoco_spec(biped, contact or ContactSettings()).compile()


def mujoco_spec(biped: FrontalBiped, contact: ContactSettings) -> "MjSpec":
    """The specification that `mujoco_model` compiles."""
    mujoco = import_mujoco()
    description = biped.description
    if description.virtual_legs:
        raise RobotError(
            f"{biped.path}: virtual_legs = true: its roll joints alone leave the plane, MuJoCo takes their axes as they"
            f" are; walk it in space: frontal-biped walk {_asked_by(biped)}"
        )
    spec = read_spec(biped.robot.urdf_text)
    names = biped.stance_map.joint_names
    feet = {names[0]: Stance.LEFT, names[3]: Stance.RIGHT}
    foot_placement = _foot_frames(biped)

    for joint in list(spec.joints):
        if joint.name in names:
            release(joint, float(biped.chain.armature[min(names.index(joint.name), 3 - names.index(joint.name))]))
            if joint.name in feet:
                _add_planar_sole(joint.parent, feet[joint.name], biped, foot_placement[joint.name], contact)
            continue
        lock(spec, joint, description.posture.get(joint.name, 0.0))

    root = spec.worldbody.first_body()
    rotation = pin.rpy.rpyToMatrix(*description.base_rpy)
    _mend_inertias(root, rotation)
    root.quat = to_quaternion(rotation)
    root.pos = _root_position(biped)
    slide, hinge = mujoco.mjtJoint.mjJNT_SLIDE, mujoco.mjtJoint.mjJNT_HINGE
    for name, kind, axis in zip(BASE_JOINTS, (slide, slide, hinge), np.eye(3)[[1, 2, 0]], strict=True):
        root.add_joint(name=name, type=kind, axis=rotation.T @ axis)
    add_ground(spec, contact)
    return spec


def _asked_by(biped: FrontalBiped) -> str:
    """What a command is told to get this robot."""
    return biped.name if biped.path.parent == models_dir() else str(biped.path)


def _mend_inertias(body: Any, orientation: FloatArray) -> None:
    """Give impossible inertias, which MuJoCo refuses, their moment about world X in all directions.

    Only that moment enters a motion in the plane, so nothing changes there. Romeo's right upper arm is such a link.
    """
    inertia = inertia_of(body)
    if inertia is not None:
        principal = np.linalg.eigvalsh(inertia)
        if principal[0] < ROUNDING_INERTIA or principal[0] + principal[1] < principal[2]:
            along_x = (orientation @ to_rotation(body.iquat)).T[:, 0]
            moment = max(float(along_x @ inertia @ along_x), ROUNDING_INERTIA)
            body.fullinertia = [*np.full(3, moment), 0.0, 0.0, 0.0]
    for child in body.bodies:
        _mend_inertias(child, orientation @ to_rotation(child.quat))


def _foot_frames(biped: FrontalBiped) -> dict[str, pin.SE3]:
    """World placement of each foot's joint frame at the reference posture, the root at the origin."""
    model, reference = biped.spatial_model, biped.spatial_reference
    data = model.createData()
    pin.forwardKinematics(model, data, reference)
    names = biped.stance_map.joint_names
    return {name: data.oMi[model.getJointId(name)].copy() for name in (names[0], names[3])}


def _root_position(biped: FrontalBiped) -> FloatArray:
    """(3,) where the root stands at the reference posture [m]."""
    left, right = _foot_frames(biped).values()
    middle = 0.5 * (left.translation + right.translation)
    return np.array([0.0, -middle[1], biped.ankle_height - middle[2]]) + biped.spatial_reference[:3]


def _add_planar_sole(body: Any, side: Stance, biped: FrontalBiped, frame: pin.SE3, contact: ContactSettings) -> None:
    chain = biped.chain
    # inner lies towards the other foot: -Y of the left one
    middle = 0.5 * side.sign * (chain.sole_outer - chain.sole_inner)
    center = np.array([0.0, middle, 0.5 * SOLE_THICKNESS - biped.ankle_height])
    to_local = frame.rotation.T
    size = np.array([SOLE_LENGTH, chain.sole_inner + chain.sole_outer, SOLE_THICKNESS])
    add_sole(body, side, size, pin.SE3(to_local, to_local @ center), contact)


def link_bodies(biped: FrontalBiped, model: "MjModel") -> dict[str, int]:
    """MuJoCo's body of each of `LINKS`."""
    names = biped.stance_map.joint_names
    bodies = [int(model.jnt_bodyid[model.joint(name).id]) for name in names]
    pelvis = int(model.jnt_bodyid[model.joint(BASE_JOINTS[0]).id])
    return dict(zip(LINKS, (bodies[0], bodies[1], pelvis, bodies[2], bodies[3]), strict=True))
