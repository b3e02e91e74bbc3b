"""Gait design: problem, optimiser, explanation, continuation, transitions, studies."""

from frontal_biped.design.continuation import Branch, follow_branch
from frontal_biped.design.explanation import Conflict, Remedy
from frontal_biped.design.optimise import DesignResult, design_gait
from frontal_biped.design.studies import StudyPoint, cost_over, degree_study, pareto_front
from frontal_biped.design.transition import Transition, design_transition
from frontal_biped.design.verification import Verification, verify

__all__ = [
    "Branch",
    "Conflict",
    "DesignResult",
    "Remedy",
    "StudyPoint",
    "Transition",
    "Verification",
    "cost_over",
    "degree_study",
    "design_gait",
    "design_transition",
    "follow_branch",
    "pareto_front",
    "verify",
]
