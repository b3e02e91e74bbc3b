"""Gait design: specification, problem, optimiser, report."""

from frontal_biped.design.optimise import DesignResult, design_gait
from frontal_biped.design.report import ConstraintCheck, ConstraintReport, check_constraints
from frontal_biped.design.specification import GaitSpecification, default_specification, read_specification

__all__ = [
    "ConstraintCheck",
    "ConstraintReport",
    "DesignResult",
    "GaitSpecification",
    "check_constraints",
    "default_specification",
    "design_gait",
    "read_specification",
]
