"""Figures over the state: snapshots, phase portrait, energy of the zero dynamics."""

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.figures.style import (
    BETA_LABEL,
    BLACK,
    BLUE,
    COLUMN,
    ENERGY_UNIT,
    GREEN,
    VERMILION,
    ZETA_LABEL,
    legend_above,
    new_figure,
    own_or_new,
    panels,
    styled,
    with_gaps,
)
from frontal_biped.gait.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.trajectory import Trajectory
from frontal_biped.simulation.world import phase_spans, plane_to_world, resample, sole_ends, world_configurations
from frontal_biped.virtual_constraints.phase import StepPhase
from frontal_biped.zero_dynamics.orbit import resample as resample_orbit

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_TAU = np.linspace(0.0, 1.0, 121)

_LOOKS = {StepPhase.RISING: (BLUE, "-"), StepPhase.FALLING: (VERMILION, "--")}


# a dotted shaft would dot the head as well
IMPACT_ARROW = {
    "arrowstyle": "-|>",
    "mutation_scale": 12,
    "color": BLACK,
    "linewidth": 0.8,
    "shrinkA": 4,
    "shrinkB": 4,
}
"""How the jump at impact is drawn."""

SAME_PLACE = 1e-3
"""Distance between two places in a figure that nobody sees, over the extent of what is drawn."""


@styled
def snapshots(biped: FrontalBiped, trajectory: Trajectory, count: int = 7) -> "Figure":
    """Stick figures of the first two steps, seen from the front (the robot's left is on the right).

    The poses of a step stand side by side in the order of time, evenly spaced in it, and grow darker.

    Args:
        biped: the robot.
        trajectory: the run.
        count: poses of a step.

    Returns:
        Two panels, y and z [m]; the left leg is blue and solid, the right one orange and dashed.
    """
    run = trajectory.first_steps(2)
    steps = [int(s) for s in np.unique(run.step)]
    reach = 2.0 * max(abs(float(run.stance_y.max())), abs(float(run.stance_y.min())))
    pitch = reach + 0.55 * biped.leg_length
    bottom, top = -0.22 * biped.leg_length, 1.75 * biped.leg_length
    # equal scales: the width of the page and the poses in a row settle the height
    panel = 0.84 * COLUMN * (top - bottom) / (count * pitch)
    figure = new_figure("snapshots", len(steps) * (panel + 0.32) + 0.45)
    axes = figure.subplots(len(steps), 1, sharex=True, sharey=True, squeeze=False)[:, 0]
    for ax, step in zip(axes, steps, strict=True):
        spans = [span for span in phase_spans(run) if span.step == step]
        start, end = spans[0].start, spans[-1].end
        # a hair inside the step: at its ends two samples share one time
        inside = np.linspace(start, end, count)
        inside[[0, -1]] += np.array([1.0, -1.0]) * 1e-9
        poses = resample(run, inside)
        _ground(ax, count, pitch)
        _stick_figures(ax, biped, poses, pitch)
        for k in range(count):
            time = f"{poses.t[k] - run.t[0]:.2f}"
            ax.text(k * pitch, -0.07 * biped.leg_length, time, ha="center", va="top", fontsize=8.0)
        foot = spans[0].stance.value
        reversal = f", reversal at {spans[0].end - run.t[0]:.2f} s" if len(spans) > 1 else ""
        ax.set_title(f"step {step + 1}: {foot} foot{reversal}; times in s", loc="left")
        ax.set_aspect("equal")
        ax.set_ylabel("height z [m]")
        ax.set_xlim(-0.6 * pitch, (count - 0.4) * pitch)
        ax.set_ylim(bottom, top)
        ax.grid(False)
        ax.spines["bottom"].set_visible(False)
        ax.tick_params(bottom=False, labelbottom=False)
    axes[-1].set_xlabel(f"lateral position y [m], poses {pitch:.2f} m apart\nleft leg blue, right leg orange, dashed")
    return figure


@styled
def phase_portrait(trajectory: Trajectory, ax: "Axes | None" = None) -> "Figure":
    """The zero dynamics' own coordinates, (beta, dbeta), of every step.

    Args:
        trajectory: the run.
        ax: where to draw; None: a figure of its own.

    Returns:
        dbeta [rad/s] over beta [rad].
    """
    figure, ax = own_or_new(ax, "phase_portrait", 3.0)
    spans = phase_spans(trajectory)
    states = np.stack([trajectory.q[:, 0], trajectory.dq[:, 0]], axis=1)
    for phase, (colour, style) in _LOOKS.items():
        pieces = [span.samples for span in spans if span.phase is phase]
        if pieces:
            ax.plot(*with_gaps(states, pieces).T, color=colour, linestyle=style, label=phase.value)
    jumps = [
        (before.samples.stop - 1, after.samples.start) for before, after in pairwise(spans) if after.step != before.step
    ]
    if jumps:
        # of arrows that would lie upon each other, as those of a periodic walk, one
        places = np.round(states[jumps] / (SAME_PLACE * np.maximum(np.ptp(states, axis=0), 1e-12)))
        _, first = np.unique(places.reshape(len(jumps), -1), axis=0, return_index=True)
        for before, after in states[jumps][first]:
            ax.annotate("", xy=after, xytext=before, arrowprops=IMPACT_ARROW)
        ends = states[jumps].reshape(-1, 2).T
        ax.plot(*ends, "s", color=BLACK, markersize=4.5, linestyle="none", label="impact")
    turns = [span.samples.start for span in spans if span.phase is StepPhase.FALLING]
    if turns:
        ax.plot(*states[turns].T, "o", color=GREEN, markersize=6, linestyle="none", label="reversal")
    ax.axhline(0.0, color=BLACK, linewidth=0.8)
    ax.set_xlabel(BETA_LABEL)
    ax.set_ylabel(r"$\dot\beta$ [rad/s]")
    ax.margins(0.06)
    legend_above(ax, 2)
    return figure


@styled
def energy(biped: FrontalBiped, gait: Gait) -> "Figure":
    """The energy of the zero dynamics over beta: zeta, and the potential V_Z it climbs and descends.

    Args:
        biped: the robot.
        gait: the gait.

    Returns:
        Two panels, zeta and V_Z [kg^2 m^4/s^2] over beta [rad].
    """
    step = gait.step(biped)
    phases = (
        (StepPhase.RISING, resample_orbit(biped, gait.rising, step.rising, _TAU)),
        (StepPhase.FALLING, resample_orbit(biped, gait.falling, step.falling, _TAU)),
    )
    figure, (upper, lower) = panels("energy", 2, 4.4)
    for phase, orbit in phases:
        colour, style = _LOOKS[phase]
        for ax, values in ((upper, orbit.zeta), (lower, orbit.V_Z)):
            ax.plot(orbit.beta, values, color=colour, linestyle=style, label=phase.value)
            ax.plot(orbit.beta[-1], values[-1], "s", color=BLACK, markersize=5)
            ax.plot(orbit.beta[0], values[0], "o", color=GREEN, markersize=6)
    (_, rising), (_, falling) = phases
    upper.annotate(
        "", xy=(rising.beta[-1], rising.zeta[-1]), xytext=(falling.beta[-1], falling.zeta[-1]), arrowprops=IMPACT_ARROW
    )
    upper.plot([], [], "s", color=BLACK, markersize=5, linestyle="none", label="impact")
    upper.plot([], [], "o", color=GREEN, markersize=6, linestyle="none", label="reversal")
    lower.axhline(0.0, color=BLACK, linewidth=0.8)
    upper.set_ylabel(ZETA_LABEL)
    lower.set_ylabel(r"$V_Z$ of the phase" + "\n" + ENERGY_UNIT)
    lower.set_xlabel(BETA_LABEL)
    legend_above(upper, 2)
    figure.align_ylabels([upper, lower])
    return figure


def _ground(ax: "Axes", count: int, pitch: float) -> None:
    ax.plot([-0.6 * pitch, (count - 0.4) * pitch], [0.0, 0.0], color=BLACK, linewidth=1.0, zorder=0)


def _stick_figures(ax: "Axes", biped: FrontalBiped, poses: Trajectory, pitch: float) -> None:
    """The robot in K poses side by side, the later the darker."""
    from matplotlib.collections import LineCollection
    from matplotlib.colors import to_rgba_array

    shifts = pitch * np.arange(len(poses.t))
    darkness = np.linspace(0.35, 1.0, len(poses.t))
    side, y = poses.stance[:, None], poses.stance_y[:, None]
    joints = np.array([biped.joint_positions(q) for q in poses.q])
    middle, roll = joints[:, 1:3].mean(axis=1), biped.pelvis_roll(poses.q)
    torso = 0.5 * biped.leg_length * np.stack([-np.sin(roll), np.cos(roll)], axis=1)

    def placed(*points: FloatArray) -> FloatArray:
        """(K, n, 2) y and z of n points (K, 2) of every pose, each pose in its place."""
        yz = plane_to_world(np.stack(points, axis=1), side, y)
        yz[..., 0] += shifts[:, None]
        return yz

    def draw(lines: FloatArray, colour: str, style: Any, width: float, cap: str = "round") -> None:
        colours = to_rgba_array([colour] * len(lines), darkness)
        looks: dict[str, Any] = {"colors": colours, "linestyles": [style], "linewidths": width, "capstyle": cap}
        ax.add_collection(LineCollection(list(lines), **looks))

    left, right = (BLUE, "-"), (VERMILION, (0, (3, 1.2)))
    left_stands = Stance.of_sign(float(poses.stance[0])) is Stance.LEFT  # as throughout a step
    stance_leg, swing_leg = (left, right) if left_stands else (right, left)
    for (colour, style), ends in ((stance_leg, (0, 1)), (swing_leg, (3, 2))):
        draw(placed(*(joints[:, end] for end in ends)), colour, style, 2.4)
    draw(placed(joints[:, 1], joints[:, 2]), BLACK, "-", 3.0)
    draw(placed(middle, middle + torso), BLACK, "-", 3.0)
    y_head, z_head = placed(middle + 1.18 * torso)[:, 0].T
    ax.scatter(y_head, z_head, 36.0, to_rgba_array([BLACK] * len(darkness), darkness), linewidths=0.0, zorder=2)
    soles = sole_ends(biped, world_configurations(biped, poses))[..., 1:]
    soles[..., 0] += shifts[:, None, None]
    for foot, (colour, _) in enumerate((left, right)):
        draw(soles[:, foot], colour, "-", 3.2, "butt")
