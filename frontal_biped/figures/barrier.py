"""Will it tip over? The energy barrier of a gait, and what perturbed steps do before it."""

from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.stabilisers.transitions import ReanchoringTransitions
from frontal_biped.exceptions import ReversalError
from frontal_biped.figures.style import (
    BETA_LABEL,
    BLACK,
    BLUE,
    ENERGY_UNIT,
    GREEN,
    PURPLE,
    VERMILION,
    ZETA_LABEL,
    legend_above,
    panels,
    styled,
)
from frontal_biped.gait.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.simulation.trajectory import Trajectory
from frontal_biped.simulation.world import phase_spans
from frontal_biped.virtual_constraints.contract import RisingConstraints
from frontal_biped.virtual_constraints.phase import StepPhase
from frontal_biped.zero_dynamics.energy import PhaseEnergy
from frontal_biped.zero_dynamics.half_steps import falling_energy, rising_energy

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SPEED_ERRORS = (-0.1, 0.0, 0.15)
"""Of the post-impact speed, relative; the picture adds one that tips over."""

TIPPING = 1.15
"""Energy of that one, over the barrier's."""

_LOOKS = ((BLUE, "-."), (BLACK, "-"), (GREEN, "--"), (BLUE, (0, (5, 1, 1, 1, 1, 1))))
_POINTS = 161


@styled
def energy_barrier(
    biped: FrontalBiped,
    gait: Gait,
    trajectory: Trajectory | None = None,
    speed_errors: Sequence[float] = SPEED_ERRORS,
) -> "Figure":
    r"""The hill that a rising robot climbs, and the orbits of perturbed steps.

    With delta^2 = e^Gamma, zeta = delta^2 zeta+ - V_Z ([O] eq. soledo): a robot that leaves the impact with the energy
    zeta+ reverses where the hill V_Z / delta^2 is that high, and tips over if no place is. The rising phase is
    continued past its end as `ReanchoringTransitions` does, up to the top: there the centre of mass is over the FRI.
    A stabiliser that moves the FRI raises the hill; this is the one without.

    Args:
        biped: the robot.
        gait: the gait.
        trajectory: a run; each of its steps is a mark at its energy and its reversal.
        speed_errors: of the post-impact speed, relative [-], at most four.

    Returns:
        Two panels over beta [rad]: the hill with the levels zeta+, and zeta of the orbits [kg^2 m^4/s^2].
    """
    transitions = ReanchoringTransitions(biped, gait)
    phase = transitions.planned_rising
    energy = rising_energy(biped, phase)
    beta = np.linspace(phase.beta_start, energy.end, _POINTS)
    growth, hill = np.array([energy.at(b) for b in beta]).T
    top = energy.highest

    figure, (upper, lower) = panels("barrier", 2, 4.9)
    upper.fill_between(beta, 0.0, hill, color="#C9CED6", linewidth=0.0, label=r"hill $V_Z/\delta^2$")
    upper.plot(beta, hill, color="#6B7480", linewidth=1.8, label="_hill")
    _mark_top(upper, beta[-1], top, energy.reaches_barrier)

    own = 0.5 * (energy.start_inertia * gait.orbit.beta_dot_after_impact) ** 2
    for error, (colour, style) in zip(speed_errors, _LOOKS, strict=False):
        name = "gait" if error == 0.0 else f"{100.0 * error:+.0f} % speed".replace("-", "−")
        zeta = own * (1.0 + error) ** 2
        if zeta >= top and not energy.reaches_barrier:
            continue  # what lies beyond is not known
        if zeta >= top:
            _tipping(upper, lower, beta, growth, hill, zeta, name)
            continue
        reversal = float(np.interp(zeta, np.maximum.accumulate(hill), beta))
        upper.plot([beta[0], reversal], [zeta, zeta], color=colour, linestyle=style, label=name)
        upper.plot(reversal, zeta, "o", color=colour, markersize=4)
        rising = beta[beta < reversal]
        climbed = np.exp(growth) * np.maximum(zeta - hill, 0.0)
        lower.plot([*rising, reversal], [*climbed[: len(rising)], 0.0], color=colour, linestyle=style)
        lower.plot(reversal, 0.0, "o", color=colour, markersize=4, zorder=4)
        fallen = _fall(biped, transitions, phase, reversal)
        if fallen is not None:
            lower.plot(*fallen, color=colour, linestyle=style, linewidth=0.9)
            lower.plot(fallen[0][-1], fallen[1][-1], "s", color=colour, markersize=3.5)
    if energy.reaches_barrier and all(own * (1.0 + error) ** 2 < top for error in speed_errors):
        tipping = TIPPING * top
        name = f"{100.0 * (np.sqrt(tipping / own) - 1.0):+.0f} % speed"
        _tipping(upper, lower, beta, growth, hill, tipping, name)
    if trajectory is not None:
        places, levels = run_levels(biped, trajectory)
        upper.plot(
            places, levels, "x", color=PURPLE, markersize=6, markeredgewidth=1.6, zorder=6, label="steps of the run"
        )
    upper.set_ylim(0.0, 1.12 * max(upper.get_ylim()[1], top))
    if energy.reaches_barrier:
        speed = 100.0 * (np.sqrt(top / own) - 1.0)
        upper.set_xlabel(f"tips over from {speed:+.0f} % speed (energy {100.0 * (top / own - 1.0):+.0f} %)")
    upper.set_ylabel("energy after impact " + r"$\zeta^+$" + "\n" + ENERGY_UNIT)
    lower.set_ylabel(ZETA_LABEL)
    lower.set_xlabel(f"{BETA_LABEL}; rising to the right")
    lower.axhline(0.0, color=BLACK, linewidth=0.8)
    legend_above(upper, 2)
    figure.align_ylabels([upper, lower])
    return figure


def run_levels(biped: FrontalBiped, trajectory: Trajectory) -> tuple[FloatArray, FloatArray]:
    """Where each rising phase of a run ended [rad] and the energy zeta+ it began with [kg^2 m^4/s^2].

    Phases that did not end in a reversal (a fall, the end of the run) are left out.
    """
    spans = phase_spans(trajectory)
    places, levels = [], []
    for span, after in pairwise(spans):
        if not (span.phase is StepPhase.RISING and after.phase is StepPhase.FALLING and after.step == span.step):
            continue
        first, last = span.samples.start, span.samples.stop - 1
        sigma = biped.sigma(trajectory.q[first], trajectory.dq[first], float(trajectory.p_fri[first]))
        places.append(float(trajectory.q[last, 0]))
        levels.append(0.5 * sigma**2)
    return np.array(places), np.array(levels)


def _mark_top(ax: "Axes", place: float, top: float, barrier: bool) -> None:
    ax.plot(place, top, "^", color=VERMILION, markersize=7, zorder=5)
    text = "barrier" if barrier else "followed to here"
    ax.annotate(text, (place, top), xytext=(-4, -16), textcoords="offset points", ha="right", va="top", fontsize=8.0)


def _tipping(
    upper: "Axes", lower: "Axes", beta: FloatArray, growth: FloatArray, hill: FloatArray, zeta: float, name: str
) -> None:
    """An orbit that clears the hill: an arrow over its top."""
    arrow = {"arrowstyle": "-|>", "color": VERMILION, "linewidth": 1.4, "mutation_scale": 10}
    upper.plot(beta, np.full_like(beta, zeta), color=VERMILION, linestyle=":", label=name)
    middle = 0.5 * (beta[0] + beta[-1])
    upper.annotate("tips over", (middle, zeta), (0, 3), textcoords="offset points", ha="center", fontsize=8.0)
    past = beta[-1] + 0.07 * (beta[-1] - beta[0])
    upper.annotate("", xy=(past, zeta), xytext=(beta[-1], zeta), arrowprops=arrow)
    climbed = np.exp(growth) * (zeta - hill)
    lower.plot(beta, climbed, color=VERMILION, linestyle=":")
    lower.annotate("", xy=(past, climbed[-1]), xytext=(beta[-1], climbed[-1]), arrowprops=arrow)
    upper.set_xlim(right=past)


def _fall(
    biped: FrontalBiped, transitions: ReanchoringTransitions, rising: RisingConstraints, reversal: float
) -> tuple[FloatArray, FloatArray] | None:
    """Beta and zeta of the falling phase from a reversal; None where it does not reach its end."""
    try:
        falling: PhaseEnergy = falling_energy(biped, transitions.falling(rising, reversal), reversal)
    except ReversalError:
        return None
    if not falling.complete:
        return None
    beta = np.linspace(reversal, falling.end, _POINTS)
    growth, spent = np.array([falling.at(b) for b in beta]).T
    return beta, np.exp(growth) * np.maximum(-spent, 0.0)  # at rest where it begins
