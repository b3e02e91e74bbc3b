"""Figures of a run, a gait and a design. Importing this does not load Matplotlib.

They have the width of a column, 3.5 in, with letters of 8 pt, and tell lines apart in greyscale; SVG, PDF or PNG.
*Will it tip over?* is answered by `barrier`: the hill V_Z/delta^2 that a rising robot climbs, its top, and where
perturbed steps turn back. `design` draws what a bound costs: on the Table I robot from 210 to 406 N^2 m s for a pelvis
within 5 degrees and 1059 within 2, and 409 for steps of 0.4 s instead of 0.8 s.

Of a walk in space `write_space_figures` draws footsteps from above, pressure in both soles, the frontal state against
its closed form, the speed against the command, and what every joint used of its limits.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from frontal_biped.figures.style import figure_svg
from frontal_biped.figures.write import write_figures

if TYPE_CHECKING:
    from frontal_biped.figures.space import write_space_figures

__all__ = [
    "figure_svg",
    "write_figures",
    "write_space_figures",
]


def __getattr__(name: str) -> Any:
    if name != "write_space_figures":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    # brings the simulation of walks in space, which no other figure needs
    value = import_module(f"{__name__}.space").write_space_figures
    globals()[name] = value  # asked for once; and pdoc looks into the module's dictionary
    return value
