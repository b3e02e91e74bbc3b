"""Figures that only the paper has: its angle conventions, its bracket of the reversal, its zoom at a reversal."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.figures.style import (
    BLACK,
    BLUE,
    GREEN,
    VERMILION,
    by_phase,
    legend_above,
    new_figure,
    styled,
)
from frontal_biped.gait.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.chain import JOINTS
from frontal_biped.simulation.trajectory import Trajectory
from frontal_biped.zero_dynamics.reversal.bracket import beta_maximum

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_WINDOW = 0.06  # [s] on either side of the reversal


@styled
def conventions(biped: FrontalBiped, q: FloatArray) -> "Figure":
    """The angles q1 to q4 on a pose; h points from the stance foot to the swing foot ([O], its first figure).

    Args:
        biped: the robot.
        q: (4,) the pose [rad].
    """
    figure = new_figure("conventions", 4.2, width=4.4)
    ax = figure.add_subplot()
    _pose(ax, biped, q, BLUE, 1.0)
    size = 0.17 * biped.leg_length
    joints = biped.joint_positions(q)
    # each angle from the direction of the link before it, the ground for the first, to that of the own link's axis
    before = 0.0
    for i, (point, angle) in enumerate(zip(joints, q, strict=True)):
        turn = np.linspace(before, before + angle, 60)
        arc = point + size * np.stack([np.cos(turn), np.sin(turn)], axis=1)
        ax.plot(*arc.T, color=VERMILION, linewidth=1.2)
        ax.annotate(
            "", xy=arc[-1], xytext=arc[-4], arrowprops={"arrowstyle": "->", "color": VERMILION, "linewidth": 1.2}
        )
        for direction in (before, before + angle):
            end = point + 1.25 * size * np.array([np.cos(direction), np.sin(direction)])
            ax.plot(*np.stack([point, end]).T, color=BLACK, linewidth=0.7, linestyle=(0, (3, 2)))
        middle = point + 1.45 * size * np.array([np.cos(turn[30]), np.sin(turn[30])])
        ax.text(middle[0], middle[1], f"$q_{i + 1}$", color=VERMILION, ha="center", va="center", fontsize=11.0)
        before += angle
    com = biped.com(q)
    ax.plot(*com, "o", color=BLACK, markersize=6)
    ax.text(com[0] + 0.03, com[1], "centre of mass", va="center", fontsize=8.5)
    _plane(ax)
    ax.margins(0.12)
    return figure


@styled
def reversal_bracket(biped: FrontalBiped, gait: Gait) -> "Figure":
    """The pose of the reversal with its joints frozen, at beta_r+, beta_r- and beta_r^max ([O], figure of beta max).

    Args:
        biped: the robot.
        gait: the gait.
    """
    figure = new_figure("reversal_bracket", 3.6)
    ax = figure.add_subplot()
    q = gait.rising.motion(np.array([gait.rising.beta_end])).q[0]
    looks = (
        (gait.rising.beta_start, GREEN, r"$\beta_r^+$, just after the impact"),
        (gait.beta_reversal, BLUE, r"$\beta_r^-$, the reversal"),
        (beta_maximum(biped, gait.rising), VERMILION, r"$\beta_r^{max}$, centre of mass over the FRI"),
    )
    for k, (beta, colour, label) in enumerate(looks):
        pose = q.copy()
        pose[0] = beta
        _pose(ax, biped, pose, colour, 0.9, label)
        com = biped.com(pose)
        ax.plot(*com, "os^"[k], color=colour, markersize=7)
        ax.plot([com[0], com[0]], [0.0, com[1]], color=colour, linewidth=0.9, linestyle=(0, (3, 2)))
    fri = float(gait.rising.fri_bezier[-1])
    ax.plot([fri], [0.0], "v", color=BLACK, markersize=8, clip_on=False)
    ax.text(fri - 0.03, 0.05, "FRI", ha="right", fontsize=8.5)
    _plane(ax)
    ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


@styled
def reversal_zoom(runs: Mapping[float, Trajectory]) -> "Figure":
    """Desired and simulated swing hip around the first reversal, and what is lost there ([O], its zoomed figure).

    Args:
        runs: one step with fixed transitions, by the error of the reversal [rad]; the last one is drawn on the left.

    Returns:
        Two panels: the angle with the largest error, and the largest output error of every run, over time.
    """
    figure = new_figure("reversal_zoom", 3.2)
    angle, loss = figure.subplots(1, 2)
    last = list(runs.values())[-1]
    joint = int(np.argmax(np.max(np.abs(last.output_error), axis=0)))
    at = float(last.event_t[last.events("REVERSAL")[0]])
    t, q = by_phase(last, last.q)
    _, desired = by_phase(last, last.q_b_desired)
    angle.plot(1e3 * (t - at), desired[:, joint], color=BLUE, linewidth=2.4, alpha=0.75, label="desired")
    angle.plot(1e3 * (t - at), q[:, 1 + joint], color=VERMILION, linestyle=(0, (4, 2)), label="simulated")
    near = np.abs(t - at) < _WINDOW
    low, high = np.nanmin(q[near, 1 + joint]), np.nanmax(q[near, 1 + joint])
    angle.set_ylim(low - 0.1 * (high - low), high + 0.1 * (high - low))
    angle.set(ylabel=f"{JOINTS[1 + joint]} [rad]")
    legend_above(angle, 2)
    for (error, run), (colour, line) in zip(
        runs.items(), ((GREEN, "-."), (BLUE, "--"), (VERMILION, "-")), strict=False
    ):
        own = float(run.event_t[run.events("REVERSAL")[0]])
        t, y = by_phase(run, run.output_error)
        worst = np.maximum(np.max(np.abs(y), axis=1), 1e-12)
        loss.semilogy(1e3 * (t - own), worst, color=colour, linestyle=line, label=f"{abs(error):.0e}")
    loss.set(ylabel=r"largest $|q_b - h_d|$ [rad]", ylim=(1e-10, 1.0))
    loss.legend(title="off by [rad]", loc="center left", title_fontsize=8.5)
    for ax in (angle, loss):
        ax.set_xlim(-1e3 * _WINDOW, 1e3 * _WINDOW)
        ax.set_xlabel("time from the reversal [ms]")
        ax.axvline(0.0, color=BLACK, linewidth=0.8)
    return figure


def _plane(ax: "Axes") -> None:
    """The frontal plane in (h, v) with its ground, equal scales."""
    ax.axhline(0.0, color=BLACK, linewidth=0.8)
    ax.set(xlabel="h [m], towards the swing foot", ylabel="v [m]")
    ax.set_aspect("equal")


def _pose(ax: "Axes", biped: FrontalBiped, q: FloatArray, colour: str, opacity: float, label: str = "") -> None:
    """A stick figure in (h, v): legs, hip line, a stub of a torso, both soles."""
    joints = biped.joint_positions(q)
    ax.plot(*joints.T, color=colour, linewidth=3.0, alpha=opacity, marker="o", markersize=4, label=label)
    across = joints[2] - joints[1]
    middle = 0.5 * (joints[1] + joints[2])
    up = np.array([-across[1], across[0]]) / np.linalg.norm(across)
    torso = np.stack([middle, middle + 0.5 * biped.leg_length * up])
    ax.plot(*torso.T, color=colour, linewidth=3.0, alpha=opacity)
    outer, inner = biped.sole
    ax.plot([outer, inner], [0.0, 0.0], color=colour, linewidth=4.0, alpha=opacity)
    ax.plot(*biped.swing_sole(q).T, color=colour, linewidth=4.0, alpha=opacity)
