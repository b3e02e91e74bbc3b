"""MuJoCo's model of the whole robot in space, built by `MjSpec` from the same URDF and description as `FreeRobot`.

The root gets a free joint, light joints are locked at the posture, every other joint keeps its axis and its range,
which MuJoCo's own joint limits enforce. Soles are boxes of the length and width of `FreeRobot.soles`; a box that lies
flat touches the ground at its four corners, whose friction together resists yaw. The feet touch only their own floor,
nothing else collides: what of the robot runs into itself is told by `frontal_biped.simulation.space.self_collision`.
`frontal_biped.simulation.mujoco.spec` says what MuJoCo takes from the URDF.

Inertias that no body can have, which MuJoCo refuses, are replaced by the nearest that a body can have. Bodies without
mass or inertia get `SMALLEST` of each, where MuJoCo asks for something above zero.
"""

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.model.robot import FootSole
from frontal_biped.model.space.free_robot import FreeRobot
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
)

if TYPE_CHECKING:
    from mujoco import MjModel, MjSpec

IndexArray = npt.NDArray[np.int64]

SMALLEST = 1e-12
"""Mass [kg] and inertia [kg m^2] of a body that has none: far below anything that is felt."""

ROUNDING = 1e-12
"""Relative margin by which a principal moment stays below the sum of the others: MuJoCo computes them anew."""


def mujoco_space_model(free: FreeRobot, contact: ContactSettings | None = None) -> "MjModel":
    """Compile MuJoCo's model of a free robot.

    Args:
        free: the robot; its URDF, posture, soles and rotor inertias are read, not its Pinocchio model.
        contact: contact and physics step.

    Raises:
        MissingExtraError: MuJoCo is not installed.
    """
    return mujoco_space_spec(free, contact or ContactSettings()).compile()


def mujoco_space_spec(free: FreeRobot, contact: ContactSettings) -> "MjSpec":
    """The specification that `mujoco_space_model` compiles."""
    spec = read_spec(free.robot.urdf_text)
    armature = dict(zip(free.joint_names, free.armature, strict=True))
    soles = {sole.joint: sole for sole in free.soles}
    for joint in list(spec.joints):
        if joint.name not in armature:
            lock(spec, joint, free.robot.description.posture.get(joint.name, 0.0))
            continue
        release(joint, float(armature[joint.name]))
        # as stiff as the ground; the default gives way by degrees under a hip's torque
        joint.solref_limit = [contact.time_constant, 1.0]
        if joint.name in soles:
            _add_sole_box(joint.parent, soles[joint.name], contact)
    root = spec.worldbody.first_body()
    _mend_inertias(root)
    spec.compiler.boundmass = spec.compiler.boundinertia = SMALLEST
    root.add_freejoint()
    add_ground(spec, contact)
    # a state that is no longer finite is a fall, not a new beginning
    spec.option.disableflags |= import_mujoco().mjtDisableBit.mjDSBL_AUTORESET
    return spec


def _add_sole_box(foot: Any, sole: FootSole, contact: ContactSettings) -> None:
    """The box whose lower face is the sole."""
    middle = 0.5 * (sole.corners.min(axis=0) + sole.corners.max(axis=0))
    middle[2] = 0.5 * SOLE_THICKNESS
    size = np.array([sole.length, sole.width, SOLE_THICKNESS])
    add_sole(foot, sole.side, size, sole.placement * pin.SE3(np.eye(3), middle), contact)


def _mend_inertias(body: Any) -> None:
    inertia = inertia_of(body)
    if inertia is not None:
        mended = nearest_possible_inertia(inertia)
        if mended is not inertia:
            body.fullinertia = [*np.diag(mended), mended[0, 1], mended[0, 2], mended[1, 2]]
    for child in body.bodies:
        _mend_inertias(child)


def nearest_possible_inertia(inertia: FloatArray) -> FloatArray:
    """The nearest inertia (3, 3), by sum of squared differences, that a body can have [kg m^2]; itself if it is one.

    Principal moments are positive, and none is larger than the sum of the others. Romeo's right upper arm, where one is
    five times the sum of the others, and iCub's right leg, where rounding has left less than nothing, are such links.
    """
    moments, axes = np.linalg.eigh(inertia)
    excess = (1.0 + ROUNDING) * moments[2] - moments[0] - moments[1]
    if excess <= 0.0 and moments[0] >= SMALLEST:
        return inertia
    if excess > 0.0:
        moments = moments + excess / 3.0 * np.array([1.0, 1.0, -1.0])
    moments = np.maximum(moments, SMALLEST)
    mended: FloatArray = axes @ np.diag(moments) @ axes.T
    return mended


def joint_addresses(free: FreeRobot, model: "MjModel") -> tuple[IndexArray, IndexArray]:
    """Where MuJoCo keeps positions and velocities of `FreeRobot.joint_names`, (n,) indices each."""
    joints = [model.joint(name) for name in free.joint_names]
    return (
        np.array([joint.qposadr[0] for joint in joints]),
        np.array([joint.dofadr[0] for joint in joints]),
    )


def moved_bodies(free: FreeRobot, model: "MjModel") -> IndexArray:
    """(1 + n,) MuJoCo's bodies in Pinocchio's order: the root's, then those that `FreeRobot.joint_names` move."""
    root = int(model.jnt_bodyid[0])
    return np.array([root, *(model.jnt_bodyid[model.joint(name).id] for name in free.joint_names)])
