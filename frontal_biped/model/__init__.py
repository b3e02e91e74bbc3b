"""The robot: URDF and description in, dynamics in stance coordinates out ([O] Sec. II)."""

from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.catalogue import load_robot, load_whole_robot, models_dir, robot_names
from frontal_biped.model.impact import Landing, impact
from frontal_biped.model.robot import FootSole, JointLimits, Robot, Soles
from frontal_biped.model.stance_map import Stance, StanceMap, relabel
from frontal_biped.model.state import State
from frontal_biped.model.urdf.description import RobotDescription, Sole

__all__ = [
    "FootSole",
    "FrontalBiped",
    "Landing",
    "JointLimits",
    "Robot",
    "RobotDescription",
    "Sole",
    "Soles",
    "Stance",
    "State",
    "StanceMap",
    "impact",
    "load_robot",
    "load_whole_robot",
    "models_dir",
    "relabel",
    "robot_names",
]
