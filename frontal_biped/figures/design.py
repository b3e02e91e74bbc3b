"""Figures over many designs: what a bound costs, and what higher degrees buy."""

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from frontal_biped.design.sideways_studies import TravelPoint
from frontal_biped.design.studies import StudyPoint
from frontal_biped.figures.style import BLACK, BLUE, GREEN, PURPLE, VERMILION, legend_above, new_figure, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_MARKS = ((BLUE, "o", "-"), (VERMILION, "s", "--"), (GREEN, "^", "-."), (PURPLE, "D", ":"), (BLACK, "v", "-"))
COST_LABEL = "cost J [N² m s]"


@styled
def pareto_figure(points: Sequence[StudyPoint], measure: str, label: str, title: str) -> "Figure":
    """Cost of the cheapest gait against what the bound on a measure secures.

    Args:
        points: of `pareto_front`; those without a gait are left out.
        measure: which of the measures is on the horizontal axis.
        label: of that axis, with its unit.
        title: of the figure.
    """
    figure = new_figure("pareto", 2.8)
    axes = figure.add_subplot()
    found = sorted((point.measures[measure], point.measures["cost"]) for point in points if point.measures)
    x, cost = zip(*found, strict=True)
    axes.plot(x, cost, color=BLUE, marker="o", markersize=4.5)
    axes.set(xlabel=label, ylabel=COST_LABEL, title=title)
    axes.set_ylim(0.0, 1.08 * max(cost))  # room for the highest marker
    return figure


@styled
def cost_figure(rolls: Mapping[str, Sequence[StudyPoint]], durations: Mapping[str, Sequence[StudyPoint]]) -> "Figure":
    """Cost against the bound on the pelvis' roll, and against the duration of the step.

    Args:
        rolls: series of `cost_over` with ``max_pelvis_roll``, by name, at most five.
        durations: series of `cost_over` with ``step_duration``, by name.

    Returns:
        Two panels, J [N^2 m s] over the bound [degrees] and over the duration [s]. Crosses at the top: no gait.
    """
    figure = new_figure("cost", 4.6)
    upper, lower = figure.subplots(2, 1)
    for ax, series, scale in ((upper, rolls, math.degrees(1.0)), (lower, durations, 1.0)):
        for (name, points), (colour, mark, line) in zip(series.items(), _MARKS, strict=False):
            found = sorted((scale * point.value, point.measures["cost"]) for point in points if point.measures)
            if found:
                x, cost = zip(*found, strict=True)
                ax.plot(x, cost, color=colour, marker=mark, linestyle=line, markersize=4.0, label=name)
            missing = [scale * point.value for point in points if not point.measures]
            ax.plot(missing, [0.97] * len(missing), "x", color=colour, markersize=5, transform=ax.get_xaxis_transform())
        ax.set_ylim(bottom=0.0)
        ax.set_ylabel(COST_LABEL)
        if len(series) > 1:
            legend_above(ax, 2)
    upper.set_xlabel("largest pelvis roll allowed [degrees]")
    lower.set_xlabel("step duration [s]")
    figure.align_ylabels([upper, lower])
    return figure


@styled
def travel_figure(series: Mapping[str, Sequence[TravelPoint]]) -> "Figure":
    """What travelling sideways costs: int u'u dt for each metre on the way over the speed, and J of the same gaits.

    Args:
        series: of `cost_of_travel`, by name, at most five; points without a gait, and without travel, are left out.
    """
    figure = new_figure("travel", 4.6)
    upper, lower = figure.subplots(2, 1, sharex=True)
    for (name, points), (colour, mark, line) in zip(series.items(), _MARKS, strict=False):
        gaits = [point.gait for point in points if point.gait is not None and point.gait.travel > 0.0]
        speeds = [gait.speed for gait in gaits]
        for ax, costs in ((upper, [gait.cost_of_travel for gait in gaits]), (lower, [gait.cost for gait in gaits])):
            ax.plot(speeds, costs, color=colour, marker=mark, linestyle=line, markersize=4.0, label=name)
    upper.set_ylabel("cost for each metre [N² m s]")
    lower.set_ylabel(COST_LABEL)
    lower.set_xlabel("speed sideways [m/s]")
    for ax in (upper, lower):
        ax.set_ylim(bottom=0.0)
    if len(series) > 1:
        legend_above(upper, 2)
    figure.align_ylabels([upper, lower])
    return figure


@styled
def degree_figure(series: Mapping[int, Sequence[StudyPoint]]) -> "Figure":
    """Cost over the degree of the joints, one line for each degree of the FRI target.

    Args:
        series: of `degree_study`.
    """
    figure = new_figure("degrees", 2.8)
    axes = figure.add_subplot()
    for (fri_degree, points), (colour, mark, line) in zip(sorted(series.items()), _MARKS, strict=False):
        found = [(point.value, point.measures["cost"]) for point in points if point.measures]
        degree, cost = zip(*found, strict=True)
        label = f"FRI degree {fri_degree}"
        axes.plot(degree, cost, color=colour, marker=mark, linestyle=line, markersize=4.5, label=label)
    axes.set(xlabel="degree of the joint polynomials", ylabel=COST_LABEL, title="What higher degrees buy")
    axes.set_xticks(sorted({point.value for points in series.values() for point in points}))
    axes.legend()
    return figure
