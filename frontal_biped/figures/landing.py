"""Figure of the landing with every joint free: how much rotor inertia it takes to make it the planar impact."""

from typing import TYPE_CHECKING

import numpy as np

from frontal_biped.figures.style import BLACK, BLUE, VERMILION, legend_above, panels, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from frontal_biped.analysis.free_landing import FreeLandingReport

_PANELS = (
    ("vertical_impulse", "vertical\nimpulse [N s]"),
    ("energy_lost", "kinetic energy\nlost [J]"),
    ("dbeta_after", r"$\dot\beta$ after" + "\n[rad/s]"),
)


@styled
def free_landing_figure(report: "FreeLandingReport", other_rotors: float) -> "Figure":
    """Impulse, energy and speed of a landing over the rotor inertia of the joints that the plane holds.

    Args:
        report: of `free_landing`.
        other_rotors: what the description says of those joints, where its own landing is marked [kg m^2]; 0: at the
            left end, where rotors no longer matter.

    Returns:
        Three panels with one logarithmic axis [kg m^2].
    """
    figure, axes = panels("free_landing", len(_PANELS), 4.4)
    rotors = np.array([landed.rotors for landed in report.swept], dtype=float)
    marked = max(other_rotors, float(rotors[0]))
    for ax, (key, label) in zip(axes, _PANELS, strict=True):
        swept = [getattr(landed, key) for landed in report.swept]
        planar, described = getattr(report.planar, key), getattr(report.described, key)
        ax.semilogx(rotors, swept, color=BLUE, label="every joint free")
        ax.axhline(planar, color=VERMILION, linestyle="--", label="planar impact")
        ax.plot([marked], [described], "o", color=BLACK, markersize=5.0, label="as described", clip_on=False, zorder=3)
        ax.set_ylabel(label)
        ax.set_ylim(min(0.0, 1.15 * min(swept)), 1.15 * max(*swept, planar))
    axes[0].set_xlim(rotors[0], rotors[-1])
    axes[-1].set_xlabel(r"rotor inertia of each held joint [kg m$^2$]")
    legend_above(axes[0], 2)
    figure.align_ylabels(axes)
    return figure
