"""Gait design: specification, problem, optimiser, report, continuation, transitions, studies."""

from frontal_biped.design.continuation import Branch, follow_branch
from frontal_biped.design.explanation import Conflict, Remedy
from frontal_biped.design.optimise import DesignResult, design_gait
from frontal_biped.design.report import ConstraintCheck, ConstraintReport, check_constraints
from frontal_biped.design.shipped import load_specification, specification_names
from frontal_biped.design.specification import GaitSpecification, default_specification, read_specification
from frontal_biped.design.studies import StudyPoint, cost_over, degree_study, pareto_front
from frontal_biped.design.transition import Transition, design_transition
from frontal_biped.design.verification import Verification, verify

__all__ = [
    "Branch",
    "Conflict",
    "ConstraintCheck",
    "ConstraintReport",
    "DesignResult",
    "GaitSpecification",
    "Remedy",
    "StudyPoint",
    "Transition",
    "Verification",
    "check_constraints",
    "cost_over",
    "default_specification",
    "degree_study",
    "design_gait",
    "design_transition",
    "follow_branch",
    "load_specification",
    "pareto_front",
    "read_specification",
    "specification_names",
    "verify",
]
