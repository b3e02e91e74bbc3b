"""The robot that a gait or a run tells of."""

from collections.abc import Mapping
from typing import Any

from frontal_biped.exceptions import RobotError
from frontal_biped.gait.robot_path import description_file
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.catalogue import load_robot


def told_robot(gait: Mapping[str, Any], name: str, *, unchanged: bool = True) -> FrontalBiped:
    """The robot whose description a gait names, read anew; where it names none that is there, the robot of that name.

    Args:
        gait: content of a gait file, as a run has it, or {}.
        name: of the robot.
        unchanged: refuse a robot that is not the one that the gait was designed for, as after `with_mass`.

    Raises:
        RobotError: there is neither, its files cannot be used, or it has changed since.
    """
    reference = gait.get("robot")
    if isinstance(reference, Mapping):
        named = reference.get("description")
        if isinstance(named, str) and named and (file := description_file(named)).is_file():
            biped = load_robot(file)
            if unchanged and biped.fingerprint != reference.get("fingerprint"):
                raise RobotError(
                    f"the gait was designed for {name!r} with another URDF or description than {file.name}; give its"
                    " robot: view(gait, robot), run.plot(name, robot)"
                )
            return biped
    return load_robot(name)
