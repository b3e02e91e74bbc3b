"""Virtual constraints: Bezier polynomials over beta, the two phases of a step, hybrid invariance."""

from frontal_biped.virtual_constraints.bezier import bernstein, bernstein_derivative
from frontal_biped.virtual_constraints.invariance import (
    FreeParameters,
    complete,
    double_support_pose,
    invariance_residuals,
)
from frontal_biped.virtual_constraints.phase import ConstrainedMotion, Phase, StepPhase, phase_basis

__all__ = [
    "ConstrainedMotion",
    "FreeParameters",
    "Phase",
    "StepPhase",
    "bernstein",
    "bernstein_derivative",
    "complete",
    "double_support_pose",
    "invariance_residuals",
    "phase_basis",
]
