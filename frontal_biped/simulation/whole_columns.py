"""A motion of the whole robot as columns of a table: base and every joint under its URDF name."""

from frontal_biped.model.space.whole_motion import FOOT_NAMES, WholeMotion
from frontal_biped.simulation.whole_names import BASE_POSE, BASE_VELOCITY, units


def base_columns(motion: WholeMotion) -> dict[str, list[float]]:
    """Pose and velocity of the root link."""
    table = {name: motion.base_pose[:, i].tolist() for i, name in enumerate(BASE_POSE)}
    return table | {name: motion.base_velocity[:, i].tolist() for i, name in enumerate(BASE_VELOCITY)}


def joint_columns(motion: WholeMotion, held_torques: bool) -> dict[str, list[float]]:
    """Position, velocity and torque of every joint that moves, then the position of those that are held.

    Args:
        motion: of the whole robot.
        held_torques: also what it takes to hold those that are held.
    """
    model = motion.robot.model
    table: dict[str, list[float]] = {}
    for name in motion.joint_names:
        if name not in motion.held:
            length, effort = units(model, name)
            table[f"{name} position [{length}]"] = motion.positions[name].tolist()
            table[f"{name} velocity [{length}/s]"] = motion.velocities[name].tolist()
            table[f"{name} torque [{effort}]"] = motion.torques[name].tolist()
    for name in motion.held:
        length, effort = units(model, name)
        table[f"{name} position, held [{length}]"] = motion.positions[name].tolist()
        if held_torques:
            table[f"{name} torque, held [{effort}]"] = motion.torques[name].tolist()
    return table


def contact_columns(motion: WholeMotion) -> dict[str, list[int]]:
    """Which foot stands on the ground."""
    return {
        f"{foot} sole contact [0/1]": motion.contact[:, i].astype(int).tolist() for i, foot in enumerate(FOOT_NAMES)
    }
