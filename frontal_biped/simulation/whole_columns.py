"""A motion of the whole robot as columns of a table: base and every joint under its URDF name."""

from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.model.space.whole_motion import FOOT_NAMES, WholeMotion
from frontal_biped.simulation.whole_names import BASE_POSE, BASE_VELOCITY, units


def base_columns(motion: WholeMotion) -> dict[str, FloatArray]:
    """Pose and velocity of the root link."""
    table = {name: motion.base_pose[:, i] for i, name in enumerate(BASE_POSE)}
    return table | {name: motion.base_velocity[:, i] for i, name in enumerate(BASE_VELOCITY)}


def joint_columns(motion: WholeMotion, held_torques: bool) -> dict[str, FloatArray]:
    """Position, velocity and torque of every joint that moves, then the position of those that are held.

    Args:
        motion: of the whole robot.
        held_torques: also what it takes to hold those that are held.
    """
    model = motion.robot.model
    table: dict[str, FloatArray] = {}
    for name in motion.joint_names:
        if name not in motion.held:
            length, effort = units(model, name)
            table[f"{name} position [{length}]"] = motion.positions[name]
            table[f"{name} velocity [{length}/s]"] = motion.velocities[name]
            table[f"{name} torque [{effort}]"] = motion.torques[name]
    for name in motion.held:
        length, effort = units(model, name)
        table[f"{name} position, held [{length}]"] = motion.positions[name]
        if held_torques:
            table[f"{name} torque, held [{effort}]"] = motion.torques[name]
    return table


def contact_columns(motion: WholeMotion) -> dict[str, "np.ndarray[Any, np.dtype[np.int64]]"]:
    """Which foot stands on the ground."""
    return {f"{foot} sole contact [0/1]": motion.contact[:, i].astype(np.int64) for i, foot in enumerate(FOOT_NAMES)}
