"""Names, with their units, of the numbers of a motion of the whole robot, for tables and archives."""

import numpy as np
import pinocchio as pin

from frontal_biped.model.robot import Robot
from frontal_biped.model.space.joint_arrays import mujoco_joint_names

AXES = "xyz"
_PLACE = [f"root {axis} [m]" for axis in AXES]
_SPIN = [f"root angular velocity {axis}, own axes [rad/s]" for axis in AXES]

BASE_POSE = (*_PLACE, *(f"root quaternion {part} [-]" for part in "xyzw"))
"""Of `WholeMotion.base_pose`."""

BASE_VELOCITY = (*(f"root velocity {axis}, own axes [m/s]" for axis in AXES), *_SPIN)
"""Of `WholeMotion.base_velocity`."""

WRENCH = (*(f"force {axis} [N]" for axis in AXES), *(f"moment {axis} [N m]" for axis in AXES))
"""Of a foot's wrench."""


def turns(model: pin.Model, name: str) -> bool:
    """Does a joint turn, rather than slide?"""
    return bool(np.any(model.joints[model.getJointId(name)].createData().S[3:]))


def units(model: pin.Model, name: str) -> tuple[str, str]:
    """Units of a joint's position and of its torque."""
    return ("rad", "N m") if turns(model, name) else ("m", "N")


def pinocchio_names(robot: Robot) -> dict[str, list[str]]:
    """Names of the columns of Pinocchio's q, v and tau."""
    model = robot.model
    q = list(BASE_POSE)
    for name in robot.joint_names:
        both = model.joints[model.getJointId(name)].nq == 2
        q += [f"{name} cosine [-]", f"{name} sine [-]"] if both else [f"{name} position [{units(model, name)[0]}]"]
    return {
        "q": q,
        "v": [*BASE_VELOCITY, *_velocities(model, robot.joint_names)],
        "tau": _torques(model, robot.joint_names),
    }


def mujoco_names(robot: Robot) -> dict[str, list[str]]:
    """Names of the columns of MuJoCo's qpos, qvel and the torques in its order."""
    model, names = robot.model, mujoco_joint_names(robot.urdf_text)
    pose = [*_PLACE, *(f"root quaternion {part} [-]" for part in "wxyz")]
    speed = [*(f"root velocity {axis}, world axes [m/s]" for axis in AXES), *_SPIN]
    return {
        "qpos": [*pose, *(f"{name} position [{units(model, name)[0]}]" for name in names)],
        "qvel": [*speed, *_velocities(model, names)],
        "tau": _torques(model, names),
    }


def _velocities(model: pin.Model, names: tuple[str, ...]) -> list[str]:
    return [f"{name} velocity [{units(model, name)[0]}/s]" for name in names]


def _torques(model: pin.Model, names: tuple[str, ...]) -> list[str]:
    return [f"{name} torque [{units(model, name)[1]}]" for name in names]
