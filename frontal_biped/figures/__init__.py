"""Figures of a run, a gait and a design. Importing this does not load Matplotlib.

They have the width of a column, 3.5 in, with letters of 8 pt, and tell lines apart in greyscale; SVG, PDF or PNG.
*Will it tip over?* is answered by `barrier`: the hill V_Z/delta^2 that a rising robot climbs, its top, and where
perturbed steps turn back. `design` draws what a bound costs: on the Table I robot from 210 to 406 N^2 m s for a pelvis
within 5 degrees and 1059 within 2, and 409 for steps of 0.4 s instead of 0.8 s.
"""

from frontal_biped.figures.style import figure_svg
from frontal_biped.figures.write import write_figures

__all__ = [
    "figure_svg",
    "write_figures",
]
