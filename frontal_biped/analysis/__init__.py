"""What a gait is worth: closed form, return map, robustness, pushes, sensitivity, two engines."""

from frontal_biped.analysis.closed_form import GaitAnalysis, analyze

__all__ = [
    "GaitAnalysis",
    "analyze",
]
