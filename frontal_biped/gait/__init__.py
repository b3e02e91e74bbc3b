"""A gait and what it must satisfy: file, specification, constraints C01 to C09, check, margins ([O] Sec. IV-A)."""

from frontal_biped.gait.check import ConstraintCheck, ConstraintReport, check_constraints
from frontal_biped.gait.file import gait_from_dict, gait_to_dict, load_any_gait, load_gait, save_gait
from frontal_biped.gait.gait import Gait
from frontal_biped.gait.shipped import gait_names, gait_path, load_specification, specification_names
from frontal_biped.gait.sideways import SidewaysGait
from frontal_biped.gait.specification import GaitSpecification, default_specification, read_specification

__all__ = [
    "ConstraintCheck",
    "ConstraintReport",
    "Gait",
    "GaitSpecification",
    "SidewaysGait",
    "check_constraints",
    "default_specification",
    "gait_from_dict",
    "gait_names",
    "gait_path",
    "gait_to_dict",
    "load_any_gait",
    "load_gait",
    "load_specification",
    "read_specification",
    "save_gait",
    "specification_names",
]
