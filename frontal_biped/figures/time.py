"""Figures over time: joint angles, torques, ground reaction and FRI, swing foot height."""

from typing import TYPE_CHECKING

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.figures.style import (
    BLACK,
    BLUE,
    GREEN,
    JOINT_STYLES,
    ORANGE,
    PALE,
    PHASE_LABELS,
    VERMILION,
    by_phase,
    legend_above,
    own_or_new,
    panels,
    shade_phases,
    styled,
)
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.chain import JOINTS
from frontal_biped.simulation.orbit import ORBIT
from frontal_biped.simulation.trajectory import Trajectory
from frontal_biped.simulation.world import phase_spans
from frontal_biped.virtual_constraints.phase import StepPhase

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


@styled
def joint_angles(trajectory: Trajectory, steps: int = 2) -> "Figure":
    """Desired and simulated joint angles over the first steps ([O], its figure of the joints).

    Args:
        trajectory: the run.
        steps: how many of its steps.

    Returns:
        Four panels, q1 (no desired value: it is the phase variable) to q4 [rad] over time [s].
    """
    run = trajectory.first_steps(steps)
    figure, axes = panels("joint_angles", 4, 6.2)
    t, q = by_phase(run, run.q)
    _, desired = by_phase(run, run.q_b_desired)
    done = "on the orbit" if trajectory.settings.get("source") == ORBIT else "simulated"
    for i, ax in enumerate(axes):
        if i > 0:
            ax.plot(t, desired[:, i - 1], color=PALE, linewidth=3.0, label="desired")
        ax.plot(t, q[:, i], color=BLACK, linestyle=(0, (4, 2)), linewidth=1.2, label=done)
        ax.set_ylabel(JOINTS[i] + (r" $\beta$" if i == 0 else "") + "\n[rad]")
    shade_phases(axes, run)
    handles, labels = axes[1].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper right", ncols=2)
    figure.align_ylabels(axes)
    return figure


@styled
def torques(biped: FrontalBiped, trajectory: Trajectory, steps: int = 2, ax: "Axes | None" = None) -> "Figure":
    """Joint torques over the first steps, with the limits.

    Args:
        biped: the robot, for its limits.
        trajectory: the run.
        steps: how many of its steps.
        ax: where to draw; None: a figure of its own.

    Returns:
        u_1 to u_4 [N m] over time [s].
    """
    run = trajectory.first_steps(steps)
    figure, ax = own_or_new(ax, "torques", 3.2)
    t, u = by_phase(run, run.u)
    for i, (colour, style) in enumerate(JOINT_STYLES):
        ax.plot(t, u[:, i], color=colour, linestyle=style, label=JOINTS[i])
    limits, peak = biped.max_torque, float(np.abs(run.u).max())
    shade_phases([ax], run)
    for i, limit in enumerate(limits[:2]):  # the two legs have the same (HR3)
        if limit < 1.5 * peak:
            for sign in (-1.0, 1.0):
                ax.axhline(sign * limit, color=BLACK, linestyle=("--", ":")[i], linewidth=1.0)
    ankle, hip = np.abs(run.u[:, [0, 3]]).max(), np.abs(run.u[:, [1, 2]]).max()
    reached = f"largest: ankle {ankle:.0f} of {limits[0]:.0f}, hip {hip:.0f} of {limits[1]:.0f} N m"
    ax.set_xlabel(f"{ax.get_xlabel()}\n{reached}")
    ax.set_ylabel("torque [N m]")
    legend_above(ax, 2, lift=PHASE_LABELS)
    return figure


@styled
def ground_reaction(
    biped: FrontalBiped, trajectory: Trajectory, friction: float | None = None, steps: int = 2
) -> "Figure":
    """Ground reaction inside the friction cone, and the FRI inside the sole.

    Args:
        biped: the robot.
        trajectory: the run.
        friction: coefficient of the cone; None: the one the gait was designed for.
        steps: how many of its steps.

    Returns:
        Three panels over time [s]: F_v [N], F_h [N] and p_FRI [mm].
    """
    run = trajectory.first_steps(steps)
    mu = (_asked(run) or GaitSpecification()).friction if friction is None else friction
    figure, axes = panels("ground_reaction", 3, 6.0)
    vertical, horizontal, fri = axes
    t, force = by_phase(run, run.force)
    _, p = by_phase(run, np.stack([run.p_fri, run.p_fri_target], axis=1))

    vertical.plot(t, force[:, 1], color=BLUE, label="$F_v$")
    vertical.axhline(biped.weight, color=BLACK, linestyle="--", linewidth=1.0, label=f"weight, {biped.weight:.0f} N")
    vertical.set_ylim(bottom=0.0)
    _headroom(vertical, 0.1)
    vertical.set_ylabel("vertical force\n$F_v$ [N]")

    cone = mu * force[:, 1]
    horizontal.fill_between(t, -cone, cone, color=GREEN, alpha=0.15, linewidth=0.0, label=rf"$|F_h| \leq {mu:g}\,F_v$")
    for edge in (-cone, cone):
        horizontal.plot(t, edge, color=GREEN, linestyle="--", linewidth=1.0)
    horizontal.plot(t, force[:, 0], color=BLUE, label="$F_h$")
    horizontal.set_ylabel("horizontal force\n$F_h$ [N]")

    outer, inner = (1e3 * end for end in biped.sole)
    fri.axhspan(outer, inner, color=GREEN, alpha=0.15, linewidth=0.0, label="sole")
    for edge_mm in (outer, inner):
        fri.axhline(edge_mm, color=GREEN, linestyle="--", linewidth=1.0)
    fri.plot(t, 1e3 * p[:, 1], color=PALE, linewidth=3.0, label="target")
    fri.plot(t, 1e3 * p[:, 0], color=BLACK, linestyle=(0, (4, 2)), linewidth=1.2, label=r"$p_{\mathrm{FRI}}$")
    fri.set_ylim(*_around(np.append(1e3 * run.p_fri, [outer, inner])))
    fri.set_ylabel("FRI from the ankle\n" + r"$p_{\mathrm{FRI}}$ [mm]")
    shade_phases(axes, run)
    legend_above(vertical, 2, lift=PHASE_LABELS)
    legend_above(horizontal, 2)
    legend_above(fri, 3)
    figure.align_ylabels(axes)
    return figure


@styled
def swing_foot_height(
    biped: FrontalBiped,
    trajectory: Trajectory,
    clearance: float | None = None,
    steps: int = 2,
    ax: "Axes | None" = None,
) -> "Figure":
    """Height of both ends of the swing sole above the ground, and the clearance asked for.

    Args:
        biped: the robot.
        trajectory: the run.
        clearance: swing_clearance of the specification [m]; None: the gait's own, nothing where the run has no gait.
        steps: how many of its steps.
        ax: where to draw; None: a figure of its own.

    Returns:
        Heights [mm] over time [s].
    """
    run = trajectory.first_steps(steps)
    specification = _asked(run)
    asked = specification.swing_clearance if clearance is None and specification else clearance
    figure, ax = own_or_new(ax, "swing_foot_height", 3.0)
    height = 1e3 * biped.swing_sole_heights(run.q).T
    t, ends = by_phase(run, height)
    ax.plot(t, ends[:, 0], color=BLUE, label="inner end")
    ax.plot(t, ends[:, 1], color=VERMILION, linestyle="--", label="outer end")
    if asked is not None:
        _, least = by_phase(run, 1e3 * asked * clearance_profile(run))
        ax.fill_between(t, 0.0, least, color=ORANGE, alpha=0.35, linewidth=0.0, label="asked for")
    ax.axhline(0.0, color=BLACK, linewidth=0.8)
    shade_phases([ax], run)
    ax.set_ylabel("height of the sole [mm]")
    legend_above(ax, 2, lift=PHASE_LABELS)
    return figure


def clearance_profile(trajectory: Trajectory) -> FloatArray:
    """(T,) 1 - t2 of the clearance constraint C05: 1 at the reversal, 0 where the phase touches an impact.

    t2 = (beta_r- - beta) / (beta_r- - beta_impact) with both ends as they occurred in the run.
    """
    profile = np.empty_like(trajectory.t)
    for span in phase_spans(trajectory):
        beta = trajectory.q[span.samples, 0]
        impact, reversal = (beta[0], beta[-1]) if span.phase is StepPhase.RISING else (beta[-1], beta[0])
        reach = reversal - impact
        profile[span.samples] = (beta - impact) / reach if reach != 0.0 else 0.0
    return np.clip(profile, 0.0, 1.0)


def _asked(run: Trajectory) -> GaitSpecification | None:
    """What the gait of a run was designed for; None where the run has no gait."""
    table = run.gait.get("specification")
    return None if table is None else GaitSpecification.from_dict(table, "the gait of the run: specification")


def _headroom(ax: "Axes", share: float) -> None:
    low, high = ax.get_ylim()
    ax.set_ylim(low, high + share * (high - low))


def _around(values: FloatArray) -> tuple[float, float]:
    known = values[np.isfinite(values)]
    low, high = float(np.min(known)), float(np.max(known))
    margin = 0.08 * (high - low)
    return low - margin, high + margin
