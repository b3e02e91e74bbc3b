"""Figures of a run, a gait and a design. Importing this does not load Matplotlib."""

from frontal_biped.figures.style import figure_svg
from frontal_biped.figures.write import write_figures

__all__ = [
    "figure_svg",
    "write_figures",
]
