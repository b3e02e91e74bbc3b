"""Figures over the state: snapshots, phase portrait, energy of the zero dynamics."""

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.figures.style import (
    BETA_LABEL,
    BLACK,
    BLUE,
    COLUMN,
    GREEN,
    VERMILION,
    ZETA_LABEL,
    legend_above,
    new_figure,
    own_or_new,
    panels,
    styled,
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
        for k in range(count):
            _stick_figure(ax, biped, poses, k, k * pitch, 0.35 + 0.65 * k / max(count - 1, 1))
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
    beta, dbeta = trajectory.q[:, 0], trajectory.dq[:, 0]
    named: set[StepPhase] = set()  # a robot that stands turns to and fro within a step
    for span in spans:
        label = None if span.phase in named else span.phase.value
        named.add(span.phase)
        colour, style = _LOOKS[span.phase]
        ax.plot(beta[span.samples], dbeta[span.samples], color=colour, linestyle=style, label=label)
    jumps = [
        (before.samples.stop - 1, after.samples.start) for before, after in pairwise(spans) if after.step != before.step
    ]
    for k, (i, j) in enumerate(jumps):
        ax.annotate("", xy=(beta[j], dbeta[j]), xytext=(beta[i], dbeta[i]), arrowprops=IMPACT_ARROW)
        name = "impact" if k == 0 else None
        ax.plot(beta[[i, j]], dbeta[[i, j]], "s", color=BLACK, markersize=4.5, linestyle="none", label=name)
    turns = [span.samples.start for span in spans if span.phase is StepPhase.FALLING]
    if turns:
        ax.plot(beta[turns], dbeta[turns], "o", color=GREEN, markersize=6, linestyle="none", label="reversal")
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
    lower.set_ylabel(r"$V_Z$ of the phase" + "\n" + r"[kg$^2$ m$^4$/s$^2$]")
    lower.set_xlabel(BETA_LABEL)
    legend_above(upper, 2)
    figure.align_ylabels([upper, lower])
    return figure


def _ground(ax: "Axes", count: int, pitch: float) -> None:
    ax.plot([-0.6 * pitch, (count - 0.4) * pitch], [0.0, 0.0], color=BLACK, linewidth=1.0, zorder=0)


def _stick_figure(ax: "Axes", biped: FrontalBiped, poses: Trajectory, k: int, shift: float, darkness: float) -> None:
    q, side, y = poses.q[k], float(poses.stance[k]), float(poses.stance_y[k])

    def draw(points: FloatArray, colour: str, style: str, width: float) -> None:
        yz = plane_to_world(points, side, y)
        ax.plot(
            yz[:, 0] + shift,
            yz[:, 1],
            color=colour,
            linestyle=style,
            linewidth=width,
            alpha=darkness,
            solid_capstyle="round",
        )

    joints = biped.joint_positions(q)
    left, right = (BLUE, "-"), (VERMILION, (0, (3, 1.2)))
    stance_leg, swing_leg = (left, right) if Stance.of_sign(side) is Stance.LEFT else (right, left)
    draw(joints[[0, 1]], stance_leg[0], stance_leg[1], 2.4)  # type: ignore[arg-type]
    draw(joints[[3, 2]], swing_leg[0], swing_leg[1], 2.4)  # type: ignore[arg-type]
    draw(joints[[1, 2]], BLACK, "-", 3.0)
    middle, roll = joints[1:3].mean(axis=0), float(biped.pelvis_roll(q))
    up = np.array([-np.sin(roll), np.cos(roll)])
    torso = 0.5 * biped.leg_length
    draw(np.array([middle, middle + torso * up]), BLACK, "-", 3.0)
    head = plane_to_world(middle + 1.18 * torso * up, side, y)
    ax.plot(head[0] + shift, head[1], "o", color=BLACK, alpha=darkness, markersize=6, markeredgewidth=0.0)
    soles = sole_ends(biped, world_configurations(biped, _one(poses, k)))[0, :, :, 1:]
    for foot, colour in zip(soles, (BLUE, VERMILION), strict=True):
        ax.plot(foot[:, 0] + shift, foot[:, 1], color=colour, alpha=darkness, linewidth=3.2, solid_capstyle="butt")


def _one(poses: Trajectory, k: int) -> Trajectory:
    return resample(poses, poses.t[k : k + 1])
