"""Gait design: specification, problem, optimiser, report."""

from frontal_biped.design.optimise import DesignResult, design_gait
from frontal_biped.design.report import ConstraintCheck, ConstraintReport, check_constraints
from frontal_biped.design.shipped import load_specification, specification_names
from frontal_biped.design.specification import GaitSpecification, read_specification

__all__ = [
    "ConstraintCheck",
    "ConstraintReport",
    "DesignResult",
    "GaitSpecification",
    "check_constraints",
    "design_gait",
    "load_specification",
    "read_specification",
    "specification_names",
]
