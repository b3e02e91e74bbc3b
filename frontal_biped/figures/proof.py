"""What is proved about the zeros of Z: the function, the pieces that a proof knows it on, and its zeros."""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from frontal_biped.analysis.proof import ProofCertificate
from frontal_biped.figures.style import (
    BLACK,
    BLUE,
    ENERGY_UNIT,
    GREEN,
    ORANGE,
    VERMILION,
    legend_above,
    new_figure,
    styled,
)
from frontal_biped.gait.gait import converged_nodes
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.zero_dynamics.proof.imposed_zeros import Interval
from frontal_biped.zero_dynamics.proof.signs import Kind, Piece
from frontal_biped.zero_dynamics.reversal.problem import ReversalProblem

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_LOOKS = (
    ((Kind.POSITIVE, Kind.NEGATIVE), "#C9CED6", "one sign"),
    ((Kind.INCREASING, Kind.DECREASING), ORANGE, "monotone"),
    ((Kind.UNDECIDED,), BLACK, "undecided"),
)

_POINTS = 161

LINEAR = 2e-3
"""Share of a function's largest value below which the scale is linear."""


@styled
def proved_zeros(biped: FrontalBiped, certificate: ProofCertificate) -> "Figure":
    """The surplus of energy over the reversal, with b fixed and with invariance imposed, and what is proved of it.

    Below each curve are the pieces of the proof: on each the function has one sign, or is monotone.

    Args:
        biped: the robot.
        certificate: what was proved of its gait.

    Returns:
        Two panels over beta minus the planned reversal [mrad]: E [kg^2 m^4/s^2], measured, on a scale that is linear
        near zero.
    """
    gait, proof = certificate.gait, certificate.proof
    phases = gait.rising, gait.falling, gait.step_width
    problem = ReversalProblem.of_phases(biped, *phases, converged_nodes(biped, *phases))
    fixed = problem.at_fixed_parameters()
    figure = new_figure("proved_zeros", 4.6)
    upper, lower = figure.subplots(2, 1)
    regions = (proof.fixed.region,)
    _panel(
        upper,
        problem.planned,
        regions,
        proof.fixed.found.pieces,
        proof.fixed.found.zeros,
        lambda beta: fixed(beta, problem.nodes).surplus,
    )
    upper.set_ylabel(f"E, b fixed\n{ENERGY_UNIT}")
    imposed = proof.imposed
    _panel(
        lower,
        problem.planned,
        imposed.regions,
        [piece for found in imposed.found for piece in found.pieces],
        imposed.places,
        lambda beta: problem.balance(beta).surplus,
    )
    lower.set_ylabel(f"S, b imposed\n{ENERGY_UNIT}")
    lower.set_xlabel(r"reversal $\beta - \beta_r^-$ [mrad]")
    legend_above(upper, 2)
    return figure


def _panel(
    ax: "Axes",
    planned: float,
    regions: Sequence[Interval],
    pieces: Sequence[Piece],
    zeros: Sequence[Interval],
    function: Callable[[float], float],
) -> None:
    """One function."""
    largest = 1.0
    for low, high in regions:
        # half of the points near the plan, where the zeros are close
        near = planned + 0.05 * np.linspace(low - planned, high - planned, _POINTS // 2)
        beta = np.union1d(np.linspace(low, high, _POINTS), near[(near > low) & (near < high)])
        values = np.array([function(float(b)) for b in beta])
        largest = max(largest, float(np.max(np.abs(values))))
        ax.plot(1e3 * (beta - planned), values, color=BLUE, label="_function")
    ax.set_yscale("symlog", linthresh=10.0 ** np.ceil(np.log10(LINEAR * largest)))
    ax.axhline(0.0, color=BLACK, linewidth=0.8)
    for kinds, colour, label in _LOOKS:
        own = [(1e3 * (a - planned), 1e3 * (b - a)) for a, b, kind in pieces if kind in kinds]
        if own:
            strip = ax.get_xaxis_transform()
            looks: Any = {"facecolors": colour, "edgecolors": "white", "linewidth": 0.3}
            ax.broken_barh(own, (0.0, 0.06), transform=strip, label=label, **looks)
    planned_ones = [planned for low, high in zeros if low <= planned <= high]
    others = [0.5 * (low + high) for low, high in zeros if not low <= planned <= high]
    for places, colour, marker, label in (
        (planned_ones, VERMILION, "o", "the gait"),
        (others, GREEN, "s", "another zero"),
    ):
        if places:
            at = [1e3 * (place - planned) for place in places]
            ax.plot(at, [0.0] * len(at), marker, color=colour, markersize=4.5, clip_on=False, label=label)
