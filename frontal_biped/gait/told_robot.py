"""The robot that a gait or a run tells of."""

from collections.abc import Mapping
from typing import Any

from frontal_biped.gait.robot_path import description_file
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.catalogue import load_robot


def told_robot(gait: Mapping[str, Any], name: str) -> FrontalBiped:
    """The robot whose description a gait names, read anew; where it names none that is there, the robot of that name.

    Args:
        gait: content of a gait file, as a run has it, or {}.
        name: of the robot.

    Raises:
        RobotError: there is neither, or its files cannot be used.
    """
    reference = gait.get("robot")
    if isinstance(reference, Mapping):
        named = reference.get("description")
        if isinstance(named, str) and named and (file := description_file(named)).is_file():
            return load_robot(file)
    return load_robot(name)
