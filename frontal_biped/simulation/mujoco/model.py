"""MuJoCo's model of a robot in its frontal plane, built by `MjSpec` from the same URDF and description as ours.

Masses, inertias, joints and their axes are MuJoCo's own reading of the URDF. Meshes are left out, every joint but the
four roll joints is locked at the description's posture, and the root gets three joints: along Y, along Z, about X. The
description adds what a URDF cannot tell: soles (boxes), rotor inertia, and a floor for each foot, so that the ground
may be uneven. The feet touch only their own floor, nothing else collides. What is no part of our model, damping and dry
friction of the joints, is left out. Legs that our model averages stay as they are.
"""

import xml.etree.ElementTree as ElementTree
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import MissingExtraError, RobotError
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.catalogue import models_dir
from frontal_biped.model.chain import GRAVITY
from frontal_biped.model.perturbation import LINKS
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.urdf.read import ROUNDING_INERTIA

if TYPE_CHECKING:
    from mujoco import MjModel, MjSpec

TIMESTEP = 5e-4
"""Default physics step [s]."""

CONTACT_TIME = 0.004
"""Time constant of the contact, critically damped [s]: a few physics steps, near to rigid."""

SOLE_LENGTH = 0.2
"""Of the box feet along X [m]; nothing in the plane depends on it."""

SOLE_THICKNESS = 0.02
"""Of the box feet [m], upwards from the sole."""

BASE_JOINTS = ("frontal_base_y", "frontal_base_z", "frontal_base_roll")

_FEET = ("left_sole", "right_sole")
_FLOORS = ("left_floor", "right_floor")


class ContactSettings(NamedTuple):
    """What MuJoCo is told about contact and time.

    Attributes:
        friction: coefficient of sliding friction [-].
        time_constant: of the contact's spring and damper, critically damped [s].
        timestep: physics step [s].
    """

    friction: float = 0.8
    time_constant: float = CONTACT_TIME
    timestep: float = TIMESTEP


def import_mujoco() -> Any:
    """The ``mujoco`` package.

    Raises:
        MissingExtraError: it is not installed.
    """
    try:
        import mujoco
    except ImportError:
        raise MissingExtraError("the second engine is MuJoCo: pip install 'frontal-biped[mujoco]'") from None
    return mujoco


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
    spec = mujoco.MjSpec.from_string(_without_shapes(biped.robot.urdf_text))
    spec.compiler.fusestatic = True
    spec.compiler.discardvisual = False
    for equality in list(spec.equalities):  # mimicked joints are locked below
        spec.delete(equality)
    names = biped.stance_map.joint_names
    soles = dict(zip((names[0], names[3]), _FEET, strict=True))
    foot_placement = _foot_frames(biped)

    for joint in list(spec.joints):
        if joint.name in names:
            joint.damping[:] = 0.0
            joint.frictionloss = 0.0
            joint.armature = float(biped.chain.armature[min(names.index(joint.name), 3 - names.index(joint.name))])
            if joint.name in soles:
                _add_sole(mujoco, joint.parent, soles[joint.name], biped, foot_placement[joint.name], contact)
            continue
        _lock(mujoco, spec, joint, description.posture.get(joint.name, 0.0))

    root = spec.worldbody.first_body()
    _mend_inertias(mujoco, root, pin.rpy.rpyToMatrix(*description.base_rpy))
    rotation = pin.rpy.rpyToMatrix(*description.base_rpy)
    root.quat = _quaternion(rotation)
    root.pos = _root_position(biped)
    slide, hinge = mujoco.mjtJoint.mjJNT_SLIDE, mujoco.mjtJoint.mjJNT_HINGE
    for name, kind, axis in zip(BASE_JOINTS, (slide, slide, hinge), np.eye(3)[[1, 2, 0]], strict=True):
        root.add_joint(name=name, type=kind, axis=rotation.T @ axis)

    for index, name in enumerate(_FLOORS):
        # a mocap body: geoms of the world itself stay where they were compiled
        floor = spec.worldbody.add_body(name=name, mocap=True).add_geom(
            name=name, type=mujoco.mjtGeom.mjGEOM_PLANE, size=[10.0, 10.0, 0.1]
        )
        _contact(floor, contact, contype=0, conaffinity=1 << index)
    option = spec.option
    option.timestep = contact.timestep
    option.gravity = [0.0, 0.0, -GRAVITY]
    option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    option.impratio = 10.0  # friction as stiff as MuJoCo's manual advises against creeping
    return spec


def _asked_by(biped: FrontalBiped) -> str:
    """What a command is told to get this robot."""
    return biped.name if biped.path.parent == models_dir() else str(biped.path)


def _without_shapes(text: str) -> str:
    """The URDF without meshes, materials and what else is no mechanics."""
    root = ElementTree.fromstring(text)
    for tag in ("material", "transmission", "gazebo", "mujoco"):
        for element in root.findall(tag):
            root.remove(element)
    for link in root.findall("link"):
        for tag in ("visual", "collision"):
            for element in link.findall(tag):
                link.remove(element)
    for joint in root.findall("joint"):
        for element in joint.findall("mimic"):
            joint.remove(element)
    return ElementTree.tostring(root, encoding="unicode")


def _lock(mujoco: Any, spec: "MjSpec", joint: Any, angle: float) -> None:
    """Turn or move the joint's body to an angle [rad] or length [m], and take the joint away."""
    body = joint.parent
    if joint.type == mujoco.mjtJoint.mjJNT_HINGE:
        turned = _rotation(mujoco, body.quat) @ pin.exp3(angle * np.asarray(joint.axis, dtype=float))
        body.quat = _quaternion(turned)
    elif joint.type == mujoco.mjtJoint.mjJNT_SLIDE:
        body.pos = np.asarray(body.pos) + _rotation(mujoco, body.quat) @ (angle * np.asarray(joint.axis, dtype=float))
    spec.delete(joint)


def _mend_inertias(mujoco: Any, body: Any, orientation: FloatArray) -> None:
    """Give impossible inertias, which MuJoCo refuses, their moment about world X in all directions.

    Only that moment enters a motion in the plane, so nothing changes there. Romeo's right upper arm is such a link.
    """
    full = np.asarray(body.fullinertia, dtype=float)
    if body.explicitinertial and np.all(np.isfinite(full)):
        xx, yy, zz, xy, xz, yz = full
        inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        principal = np.linalg.eigvalsh(inertia)
        if principal[0] < ROUNDING_INERTIA or principal[0] + principal[1] < principal[2]:
            along_x = (orientation @ _rotation(mujoco, body.iquat)).T[:, 0]
            moment = max(float(along_x @ inertia @ along_x), ROUNDING_INERTIA)
            body.fullinertia = [*np.full(3, moment), 0.0, 0.0, 0.0]
    for child in body.bodies:
        _mend_inertias(mujoco, child, orientation @ _rotation(mujoco, child.quat))


def _rotation(mujoco: Any, quaternion: FloatArray) -> FloatArray:
    matrix = np.zeros(9)
    mujoco.mju_quat2Mat(matrix, np.asarray(quaternion, dtype=float))
    return matrix.reshape(3, 3)


def _quaternion(rotation: FloatArray) -> FloatArray:
    x, y, z, w = pin.Quaternion(rotation).coeffs()
    return np.array([w, x, y, z])


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


def _add_sole(mujoco: Any, body: Any, name: str, biped: FrontalBiped, frame: pin.SE3, contact: ContactSettings) -> None:
    chain = biped.chain
    left = name == _FEET[0]
    # inner lies towards the other foot: -Y of the left one
    low, high = (-chain.sole_inner, chain.sole_outer) if left else (-chain.sole_outer, chain.sole_inner)
    center = np.array([0.0, 0.5 * (low + high), 0.5 * SOLE_THICKNESS - biped.ankle_height])
    to_local = frame.rotation.T
    geom = body.add_geom(
        name=name,
        type=mujoco.mjtGeom.mjGEOM_BOX,
        size=[0.5 * SOLE_LENGTH, 0.5 * (high - low), 0.5 * SOLE_THICKNESS],
        pos=to_local @ center,
        quat=_quaternion(to_local),
        mass=0.0,
    )
    _contact(geom, contact, contype=1 if left else 2, conaffinity=0)


def _contact(geom: Any, contact: ContactSettings, contype: int, conaffinity: int) -> None:
    geom.contype, geom.conaffinity = contype, conaffinity
    geom.condim = 3
    geom.friction = [contact.friction, 0.005, 0.0001]
    geom.solref = [contact.time_constant, 1.0]
    geom.solmix = 1.0


def link_bodies(biped: FrontalBiped, model: "MjModel") -> dict[str, int]:
    """MuJoCo's body of each of `LINKS`."""
    names = biped.stance_map.joint_names
    bodies = [int(model.jnt_bodyid[model.joint(name).id]) for name in names]
    pelvis = int(model.jnt_bodyid[model.joint(BASE_JOINTS[0]).id])
    return dict(zip(LINKS, (bodies[0], bodies[1], pelvis, bodies[2], bodies[3]), strict=True))


def sole_of(stance: Stance) -> str:
    """Name of a foot's sole."""
    return _FEET[0] if stance is Stance.LEFT else _FEET[1]


def floor_of(stance: Stance) -> str:
    """Name of the floor a foot stands on."""
    return _FLOORS[0] if stance is Stance.LEFT else _FLOORS[1]
