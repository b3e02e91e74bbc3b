"""From URDF to MuJoCo: what the models of the plane and of space share.

Masses, inertias, joints and their axes are MuJoCo's own reading of the URDF. Meshes are left out, and so is what is no
part of our models, damping and dry friction of the joints. The description adds what a URDF cannot tell: soles (boxes),
rotor inertia, and a floor for each foot, so that the ground may be uneven.
"""

import xml.etree.ElementTree as ElementTree
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import SimulationError
from frontal_biped.files.extras import missing_extra
from frontal_biped.model.chain import GRAVITY
from frontal_biped.model.stance_map import Stance

if TYPE_CHECKING:
    from mujoco import MjSpec

TIMESTEP = 5e-4
"""Default physics step [s]."""

CONTACT_TIME = 0.004
"""Time constant of the contact, critically damped [s]: a few physics steps, near to rigid."""

SOLE_THICKNESS = 0.02
"""Of the box feet [m], upwards from the sole."""

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


def substeps(period: float, timestep: float) -> int:
    """Physics steps in a control period.

    Raises:
        SimulationError: the step does not divide the period.
    """
    steps = round(period / timestep)
    if steps < 1 or abs(steps * timestep - period) > 1e-9:
        raise SimulationError(
            f"a physics step of {timestep:g} s does not divide the period of {period:g} s;"
            f" give {fitting_timestep(period):g} s"
        )
    return steps


def contact_for(period: float, contact: ContactSettings | None, friction: float | None) -> ContactSettings:
    """Contact of a walk: what is given, else a physics step that divides the control period; its friction if told."""
    used = contact or ContactSettings(timestep=fitting_timestep(period))
    return used if friction is None else used._replace(friction=friction)


def fitting_timestep(period: float) -> float:
    """The physics step nearest to `TIMESTEP` that divides a control period [s]."""
    return period / max(1, round(period / TIMESTEP))


def import_mujoco() -> Any:
    """The ``mujoco`` package.

    Raises:
        MissingExtraError: it is not installed.
    """
    try:
        import mujoco
    except ImportError:
        raise missing_extra("the second engine is MuJoCo", "mujoco") from None
    return mujoco


def read_spec(urdf_text: str) -> "MjSpec":
    """The mechanics of a URDF, its root not yet given any joints.

    Raises:
        MissingExtraError: MuJoCo is not installed.
    """
    mujoco = import_mujoco()
    spec = mujoco.MjSpec.from_string(_without_shapes(urdf_text))
    spec.compiler.fusestatic = True
    spec.compiler.discardvisual = False
    for equality in list(spec.equalities):  # mimicked joints are joints like any other
        spec.delete(equality)
    return spec


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


def release(joint: Any, armature: float) -> None:
    """Leave nothing of a joint but its axis, its range and its rotor inertia [kg m^2]."""
    joint.damping[:] = 0.0
    joint.frictionloss = 0.0
    joint.armature = armature


def lock(spec: "MjSpec", joint: Any, angle: float) -> None:
    """Turn or move the joint's body to an angle [rad] or length [m], and take the joint away."""
    mujoco, body = import_mujoco(), joint.parent
    if joint.type == mujoco.mjtJoint.mjJNT_HINGE:
        turned = to_rotation(body.quat) @ pin.exp3(angle * np.asarray(joint.axis, dtype=float))
        body.quat = to_quaternion(turned)
    elif joint.type == mujoco.mjtJoint.mjJNT_SLIDE:
        body.pos = np.asarray(body.pos) + to_rotation(body.quat) @ (angle * np.asarray(joint.axis, dtype=float))
    spec.delete(joint)


def inertia_of(body: Any) -> FloatArray | None:
    """(3, 3) inertia of a body about its centre of mass, in the axes of its inertial frame; None where none is told."""
    full = np.asarray(body.fullinertia, dtype=float)
    if not (body.explicitinertial and np.all(np.isfinite(full))):
        return None
    xx, yy, zz, xy, xz, yz = full
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def add_sole(body: Any, side: Stance, size: FloatArray, placement: pin.SE3, contact: ContactSettings) -> None:
    """Give a foot a box to stand on.

    Args:
        body: the foot.
        side: which one.
        size: (3,) length, width and thickness [m].
        placement: of the middle of the box in the frame of the body.
        contact: friction and softness.
    """
    geom = body.add_geom(
        name=sole_of(side),
        type=import_mujoco().mjtGeom.mjGEOM_BOX,
        size=0.5 * size,
        pos=placement.translation,
        quat=to_quaternion(placement.rotation),
        mass=0.0,
    )
    _contact(geom, contact, contype=1 if side is Stance.LEFT else 2, conaffinity=0)


def add_ground(spec: "MjSpec", contact: ContactSettings) -> None:
    """Add gravity, a floor for each foot, and how MuJoCo integrates."""
    mujoco = import_mujoco()
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
    # one robot is one island: looking for others costs a tenth of a step, and finds none
    option.disableflags |= mujoco.mjtDisableBit.mjDSBL_ISLAND


def _contact(geom: Any, contact: ContactSettings, contype: int, conaffinity: int) -> None:
    geom.contype, geom.conaffinity = contype, conaffinity
    geom.condim = 3
    geom.friction = [contact.friction, 0.005, 0.0001]
    geom.solref = [contact.time_constant, 1.0]
    geom.solmix = 1.0


def sole_of(stance: Stance) -> str:
    """Name of a foot's sole."""
    return _FEET[0] if stance is Stance.LEFT else _FEET[1]


def floor_of(stance: Stance) -> str:
    """Name of the floor a foot stands on."""
    return _FLOORS[0] if stance is Stance.LEFT else _FLOORS[1]


def to_rotation(quaternion: FloatArray) -> FloatArray:
    """(3, 3) rotation of MuJoCo's quaternion (4,), scalar first."""
    matrix = np.zeros(9)
    import_mujoco().mju_quat2Mat(matrix, np.asarray(quaternion, dtype=float))
    return matrix.reshape(3, 3)


def to_quaternion(rotation: FloatArray) -> FloatArray:
    """MuJoCo's quaternion (4,), scalar first, of a rotation (3, 3)."""
    x, y, z, w = pin.Quaternion(rotation).coeffs()
    return np.array([w, x, y, z])
