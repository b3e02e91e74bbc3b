"""Figures of robustness: what an error of the reversal costs, and the return map with the speeds that return."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from scipy.interpolate import PchipInterpolator

from frontal_biped.analysis.robustness import RobustnessCard
from frontal_biped.analysis.sensitivity import LossOfInvariance
from frontal_biped.arrays import FloatArray
from frontal_biped.figures.style import BLACK, BLUE, GREEN, PURPLE, VERMILION, legend_above, new_figure, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ROBUSTNESS_FIGURES: dict[str, str] = {
    "sensitivity": "Loss of invariance over the error of the reversal point: full model, one step.",
    "return_map": "Return map of the post-impact speed, closed form at the markers, smooth between; bar: what returns.",
}
"""Names and captions, in the order of a report."""

_LOOKS = ((VERMILION, "o", "-"), (BLUE, "s", "--"), (GREEN, "^", "-."), (PURPLE, "D", ":"))

_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@styled
def sensitivity(runs: Sequence[LossOfInvariance]) -> "Figure":
    """Largest output error over the error of the reversal, early and late apart.

    Args:
        runs: of `reversal_sensitivity`.

    Returns:
        Two panels with logarithmic axes, [rad] over [rad].
    """
    from matplotlib.ticker import NullLocator

    figure = new_figure("sensitivity", 3.4)
    early, late = figure.subplots(1, 2, sharey=True)
    names = list(dict.fromkeys(run.stabiliser for run in runs))
    for ax, sign, title in ((early, -1.0, "reversal too early"), (late, 1.0, "reversal too late")):
        for name, (colour, marker, line) in zip(names, _LOOKS, strict=False):
            own = [run for run in runs if run.stabiliser == name and sign * run.shift > 0.0 and np.isfinite(run.actual)]
            own.sort(key=lambda run: abs(run.actual))
            ax.loglog(
                [abs(run.actual) for run in own],
                [run.worst_output_error for run in own],
                color=colour,
                marker=marker,
                linestyle=line,
                markersize=4.5,
                label=f"{name} transitions",
            )
        ax.set_title(title, loc="left")
        ax.set_xlabel("|error| [rad]")
        ax.axhline(1e-6, color=BLACK, linewidth=0.8, linestyle=(0, (2, 2)))
        ax.margins(0.06)
        for axis in (ax.xaxis, ax.yaxis):
            axis.set_major_formatter(_power_of_ten)
            axis.set_minor_locator(NullLocator())  # of the axis across ten decades there are none either
    early.set_ylabel(r"largest $|q_b - h_d|$ [rad]")
    # half-way along, where the first error is too large and the second too small for a marker near the line
    early.text(0.5, 1.25e-6, "1e-6", transform=early.get_yaxis_transform(), fontsize=8.0, va="bottom", ha="center")
    figure.legend(*early.get_legend_handles_labels(), loc="outside upper left", ncols=2, columnspacing=1.0)
    return figure


def _power_of_ten(value: float, _: object = None) -> str:
    """Of a tick, in plain letters: formulas of the ticks take a fifth of the time to draw the figure."""
    return "10" + f"{np.log10(value):.0f}".translate(_RAISED)


def smooth(x: FloatArray, y: FloatArray, points: int = 20) -> tuple[FloatArray, FloatArray]:
    """A curve through points without corners, that goes up and down where they do and nowhere else (PCHIP).

    Args:
        x: (n,) increasing.
        y: (n,); nan: the curve has a gap there.
        points: of the curve between two of the points.

    Returns:
        x and y of the curve.
    """
    xs, ys = [np.zeros(0)], [np.zeros(0)]
    known = np.isfinite(y)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], known, [False]]).astype(int)))
    for start, end in edges.reshape(-1, 2).tolist():
        if end - start < 2:
            continue
        own = slice(start, end)
        fine = np.interp(np.linspace(start, end - 1, points * (end - start - 1) + 1), np.arange(start, end), x[own])
        xs += [fine, np.array([np.nan])]
        ys += [PchipInterpolator(x[own], y[own])(fine), np.array([np.nan])]
    return np.concatenate(xs), np.concatenate(ys)


@styled
def return_map(card: RobustnessCard, gait: str = "gait") -> "Figure":
    """Post-impact speed of the next step over that of this one, both relative to the gait's.

    Args:
        card: of the gait; the stabilisers whose map was sampled are drawn.
        gait: what the legend calls it.

    Returns:
        One panel; the bars at its foot span the speeds that return. Markers are what was computed.
    """
    figure = new_figure("return_map", 4.2)
    ax = figure.add_subplot()
    widest = np.array([pair[0] for pairs in card.sampled_maps.values() for pair in pairs])
    ends = [widest.min(initial=1.0), widest.max(initial=1.0)]
    ax.plot(ends, ends, color=BLACK, linewidth=0.8, label="unchanged")
    for k, ((name, pairs), (colour, marker, line)) in enumerate(zip(card.sampled_maps.items(), _LOOKS, strict=False)):
        speeds, values = np.array(pairs).T
        ax.plot(*smooth(speeds, values), color=colour, linestyle=line)
        ax.plot(speeds, values, color=colour, linestyle="none", marker=marker, markersize=3.0)
        ax.plot([], [], color=colour, linestyle=line, marker=marker, markersize=3.0, label=name)
        basin, height = card.basins[name], -0.12 * (k + 1)
        ax.plot([basin.low, basin.high], [height, height], color=colour, linewidth=5.0, alpha=0.7)
    ax.plot([1.0], [1.0], "o", color=BLACK, markersize=6, linestyle="none", label=gait)
    ax.set_xlabel("post-impact speed, relative to the gait's [-]")
    ax.set_ylabel("after the next impact [-]")
    legend_above(ax, 3)
    ax.margins(0.04)
    return figure
