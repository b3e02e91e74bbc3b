"""Figure of the load of a foot that lands, with an impact and without."""

from typing import TYPE_CHECKING

from frontal_biped.analysis.landing_load import LandingLoad
from frontal_biped.figures.style import BLUE, VERMILION, legend_above, new_figure, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@styled
def landing_load_figure(without: LandingLoad, with_impact: LandingLoad) -> "Figure":
    """Load over time, both landings in one picture.

    Args:
        without: of a gait with a finite double support.
        with_impact: of a gait with impacts.
    """
    figure = new_figure("landing_load", 2.6)
    ax = figure.add_subplot()
    ax.plot(1e3 * with_impact.t, with_impact.load, color=VERMILION, linestyle="--", linewidth=1.0, label="impact")
    ax.plot(1e3 * without.t, without.load, color=BLUE, label="at rest")
    ax.set_xlabel("time since the landing [ms]")
    ax.set_ylabel(r"load / $m g$ [-]")
    legend_above(ax, 2)
    return figure
