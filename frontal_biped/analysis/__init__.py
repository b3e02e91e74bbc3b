"""What a gait is worth: closed form, return map, robustness, pushes, sensitivity, two engines."""

from frontal_biped.analysis.closed_form import GaitAnalysis, analyze
from frontal_biped.analysis.sideways import SidewaysAnalysis, analyze_sideways

__all__ = [
    "GaitAnalysis",
    "SidewaysAnalysis",
    "analyze",
    "analyze_sideways",
]
