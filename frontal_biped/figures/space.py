"""Figures of a walk in space: footsteps, pressure in the soles, the frontal state, limits of every joint, speed."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.figures.style import (
    BETA_LABEL,
    BLACK,
    BLUE,
    COLUMN,
    GREEN,
    PALE,
    PURPLE,
    TICKS,
    VERMILION,
    legend_above,
    new_figure,
    styled,
)
from frontal_biped.figures.write import write_figure
from frontal_biped.gait.gait import Gait
from frontal_biped.model.robot import FootSole
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.space.asked_path import asked_corners
from frontal_biped.simulation.space.resampling import drawable_part
from frontal_biped.simulation.space.run import SpatialRun
from frontal_biped.simulation.space.shares import joint_shares
from frontal_biped.simulation.space.soles import Footstep, bearing, footprint, footsteps, pressure_in_sole
from frontal_biped.simulation.space.steps import step_table
from frontal_biped.simulation.trajectory import Trajectory
from frontal_biped.simulation.world import FEET, phase_spans
from frontal_biped.virtual_constraints.phase import StepPhase

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SPACE_FIGURES: dict[str, str] = {
    "footsteps": "Footsteps from above, and the way of the centre of mass.",
    "pressure": "Centre of pressure inside both soles.",
    "frontal_state": "Frontal state against the periodic orbit in closed form.",
    "speed": "Forward speed against the command.",
    "joint_limits": "Torque, speed and range of every joint as shares of their limits.",
}
"""Names and captions, in the order of a report."""

FOOT_LOOKS = {Stance.LEFT: (BLUE, "-"), Stance.RIGHT: (VERMILION, "--")}

LONG_WAY = 12
"""Of more than twice as many steps the first and the last of these are drawn: all would be too small to be seen."""

NARROW = 0.05
"""Of the closed form's speed, shown at least on either side of it."""

FEW_POINTS = 6000
"""Of the centre of pressure in one sole."""


@styled
def footsteps_figure(robot: FreeRobot, run: SpatialRun) -> "Figure":
    """The soles on the ground and the way of the centre of mass, from above; and the path, if there was one.

    Args:
        robot: the robot.
        run: its walk.

    Returns:
        Y over x [m], at equal scales; of a long walk its first and its last steps in two panels, of a path all of it.
    """
    steps, corners = footsteps(run), asked_corners(run)
    whole = len(corners) or len(steps) <= 2 * LONG_WAY + 1
    parts = [steps] if whole else [steps[: LONG_WAY + 1], steps[-LONG_WAY - 1 :]]
    views = [_view(robot, part) for part in parts]
    width = 0.8 * COLUMN
    heights = [min(3.4, width * (high[1] - low[1]) / (high[0] - low[0])) for low, high in views]
    figure = new_figure("footsteps", sum(heights) + 0.55 * len(parts) + 0.45)
    axes = figure.subplots(len(parts), 1, squeeze=False, gridspec_kw={"height_ratios": heights})[:, 0]
    for ax, part, (low, high) in zip(axes, parts, views, strict=True):
        for step in part:
            _draw_sole(ax, robot, step)
        inside = (run.com[:, 0] >= low[0]) & (run.com[:, 0] <= high[0]) & _during(run, part)
        ax.plot(run.com[inside, 0], run.com[inside, 1], color=BLACK, linewidth=1.0, label="CoM")
        if len(corners):
            ax.plot(*corners.T, color=PURPLE, linewidth=1.5, linestyle=":", label="asked for")
        ax.set_aspect("equal")
        ax.set_xlim(low[0], high[0])
        ax.set_ylim(low[1], high[1])
        ax.set_ylabel("y, to the left [m]")
        if len(parts) > 1:
            first, last = max(part[0].step, 0) + 1, part[-1].step + 1
            ax.set_title(f"steps {first} to {last} of {steps[-1].step + 1}", loc="right")
    for foot, (colour, style) in FOOT_LOOKS.items():
        axes[0].plot([], [], color=colour, linestyle=style, linewidth=2.0, label=f"{foot.value} foot")
    axes[-1].set_xlabel("x, forward [m]")
    legend_above(axes[0], 2 if len(corners) else 3, lift=0.16 if len(parts) > 1 else 0.0)
    return figure


@styled
def pressure_figure(robot: FreeRobot, run: SpatialRun) -> "Figure":
    """Where the centre of pressure was in both soles, seen from above, toes up; darker under more load.

    Args:
        robot: the robot.
        run: its walk.

    Returns:
        Two panels, x over y [mm] in the axes of each sole.
    """
    figure = new_figure("pressure", 3.1)
    figure.set_layout_engine("compressed")  # axes at equal scales, side by side
    axes = figure.subplots(1, 2)
    pressure, loaded = 1e3 * pressure_in_sole(run), bearing(run)
    for i, (ax, foot, sole) in enumerate(zip(axes, FEET, robot.soles, strict=True)):
        own = np.flatnonzero(loaded[:, i])
        few = own[:: max(1, len(own) // FEW_POINTS)]
        load = np.clip(run.wrench[few, i, 2] / robot.weight, 0.0, 1.0)
        outline = 1e3 * footprint(sole, 0.0, 0.0, 0.0)
        ax.fill(outline[:, 1], outline[:, 0], facecolor=GREEN, alpha=0.12, linewidth=0.0)
        ax.plot(*_closed(outline).T[::-1], color=GREEN, linewidth=1.2, label="sole")
        x, y = pressure[few, i].T
        # one picture of all points: thousands of vector marks make a heavy file
        ax.scatter(y, x, s=5.0, c=BLUE, alpha=0.08 + 0.5 * load, linewidths=0.0, rasterized=True)
        ax.plot([], [], ".", color=BLUE, label="CoP")
        ax.plot(0.0, 0.0, "+", color=BLACK, markersize=7, markeredgewidth=1.2, linestyle="none", label="ankle")
        ax.set_aspect("equal")
        margin = 0.15 * 1e3 * sole.length
        ax.set_ylim(outline[:, 0].min() - margin, outline[:, 0].max() + margin)
        ax.set_xlim(outline[:, 1].max() + margin, outline[:, 1].min() - margin)  # left is on the left
        edge = _distance_to_edge(sole, pressure[own, i], run.wrench[own, i, 2] / robot.weight)
        ax.set_xlabel(f"y, to the left [mm]\n{edge}")
        ax.set_title(f"{foot.value} foot")
        ax.locator_params(axis="x", nbins=4)
    axes[0].set_ylabel("x, ahead of the ankle [mm]")
    axes[1].tick_params(labelleft=False)
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=3)
    return figure


@styled
def frontal_state_figure(run: SpatialRun, gait: Gait | None = None, orbit: Trajectory | None = None) -> "Figure":
    """The frontal zero dynamics' coordinates of every step, and its speed half-way down, against the closed form.

    Args:
        run: the walk.
        gait: of the closed form; None: there is none.
        orbit: one step of it (`orbit_trajectory`).

    Returns:
        Two panels, dbeta [rad/s] over beta [rad] and over the step.
    """
    figure = new_figure("frontal_state", 5.2)
    upper, lower = figure.subplots(2, 1, gridspec_kw={"height_ratios": (1.5, 1.0)})
    mid_fall = None if gait is None else 0.5 * (gait.falling.beta_start + gait.falling.beta_end)
    if orbit is not None:
        for span in phase_spans(orbit.first_steps(1)):
            own = span.samples
            name = "closed form" if span.phase is StepPhase.RISING else None
            upper.plot(orbit.q[own, 0], orbit.dq[own, 0], color=PALE, linewidth=4.0, label=name, zorder=1)
    told = set()
    for span in phase_spans(run):
        colour, style = (BLUE, "-") if span.phase is StepPhase.RISING else (VERMILION, "--")
        name = None if span.phase in told else span.phase.value
        told.add(span.phase)
        beta, dbeta = run.frontal_q[span.samples, 0], run.frontal_dq[span.samples, 0]
        upper.plot(beta, dbeta, color=colour, linestyle=style, linewidth=0.8, label=name)
    upper.axhline(0.0, color=BLACK, linewidth=0.8)
    if orbit is not None:
        _stay_near(upper, orbit.q[:, 0], orbit.dq[:, 0])
    upper.set_xlabel(BETA_LABEL)
    upper.set_ylabel(r"$\dot\beta$ [rad/s]")
    legend_above(upper, 2)

    table = step_table(run, mid_fall)
    lower.plot(table.step + 1, table.mid_fall_speed, "o", color=BLUE, markersize=3.0, linestyle="none", label="steps")
    lower.margins(y=0.25)
    compared = ""
    if orbit is not None and mid_fall is not None:
        falling = (orbit.phase < 0.0) & (orbit.step == 0)
        speed = float(np.interp(-mid_fall, -orbit.q[falling, 0], orbit.dq[falling, 0]))
        lower.axhline(speed, color=PALE, linewidth=3.0, label="closed form", zorder=1)
        found = table.mid_fall_speed[np.isfinite(table.mid_fall_speed)]
        if len(found):
            off = 100.0 * (float(np.mean(found)) / speed - 1.0)
            compared = f"\non the mean {off:+.1f} % off the closed form".replace("+-", "-").replace("-", "−")
        # what is far below a per cent is not worth the height of the panel
        low, high = lower.get_ylim()
        lower.set_ylim(min(low, speed - NARROW * abs(speed)), max(high, speed + NARROW * abs(speed)))
    lower.set_xlabel(f"step [-]{compared}")
    lower.set_ylabel(r"$\dot\beta$ half-way" + "\ndown [rad/s]")
    lower.locator_params(axis="x", integer=True)
    upper.locator_params(axis="x", nbins=TICKS)
    figure.align_ylabels([upper, lower])
    return figure


@styled
def speed_figure(run: SpatialRun) -> "Figure":
    """Mean forward speed of each step and the command, of a walk of few steps that of the centre of mass as well.

    Args:
        run: the walk.

    Returns:
        Speeds [m/s] over time [s].
    """
    figure = new_figure("speed", 2.7)
    ax = figure.add_subplot()
    t, table = run.t - run.t[0], step_table(run)
    forwards = run.com_velocity[:, 0] * np.cos(run.yaw) + run.com_velocity[:, 1] * np.sin(run.yaw)
    if len(table.step) <= 2 * LONG_WAY:  # of more it would be a band
        ax.plot(t, forwards, color=PALE, linewidth=0.9, label="centre of mass")
    ax.plot(t, run.speed_target, color=BLACK, linestyle="--", linewidth=1.2, label="command")
    if len(table.step):
        edges = np.append(table.start, table.start[-1] + table.duration[-1]) - run.t[0]
        ax.stairs(table.speed, edges, color=BLUE, linewidth=1.8, label="mean of the step", baseline=None)
    ax.set_xlim(0.0, max(float(t[-1]), 1e-6))
    ax.set_xlabel("time [s]")
    ax.set_ylabel("forward speed [m/s]")
    legend_above(ax, 2)
    return figure


@styled
def joint_limits_figure(robot: FreeRobot, run: SpatialRun) -> "Figure":
    """The largest share of its torque, speed and range that each joint used.

    Args:
        robot: the robot.
        run: its walk.

    Returns:
        Joints, by their URDF names, over shares [%]; 100 % is the limit.
    """
    names = robot.joint_names
    figure = new_figure("joint_limits", 0.155 * len(names) + 0.95)
    ax = figure.add_subplot()
    place = np.arange(len(names))[::-1]
    worst = [100.0 * np.max(share, axis=0, initial=0.0) for share in joint_shares(robot, run)]
    looks = (("torque", "o", BLUE), ("speed", "s", VERMILION), ("range", "^", PURPLE))
    for values, (name, mark, colour) in zip(worst, looks, strict=True):
        ax.plot(values, place, mark, color=colour, markersize=4.2, markeredgewidth=0.0, linestyle="none", label=name)
    ax.axvline(100.0, color=BLACK, linestyle="--", linewidth=1.0)
    ax.set_yticks(place, names)
    ax.set_ylim(-0.7, len(names) - 0.3)
    ax.set_xlim(left=-2.0, right=1.05 * max(100.0, *(float(values.max(initial=0.0)) for values in worst)))
    ax.set_xlabel("largest share of the limit [%]")
    ax.set_ylabel("joint [-]")
    handles, labels = ax.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper right", ncols=3)  # names leave no room above the axes
    return figure


def all_space_figures(
    robot: FreeRobot, run: SpatialRun, gait: Gait | None = None, orbit: Trajectory | None = None
) -> list[tuple[str, "Figure"]]:
    """Every figure of a walk in space, with its name, in the order of `SPACE_FIGURES`.

    Args:
        robot: the robot.
        run: its walk.
        gait: the gait; None: there is no closed form to compare with.
        orbit: one step of its periodic orbit (`orbit_trajectory`).

    Raises:
        MissingExtraError: Matplotlib is not installed.
    """
    makers = space_figure_makers(robot, run, gait, orbit)
    return [(name, makers[name]()) for name in SPACE_FIGURES]


def space_figure_makers(
    robot: FreeRobot, run: SpatialRun, gait: Gait | None = None, orbit: Trajectory | None = None
) -> "dict[str, Callable[[], Figure]]":
    """What makes each of `SPACE_FIGURES`, by name; arguments as `all_space_figures`."""
    seen = drawable_part(run)
    return {
        "footsteps": lambda: footsteps_figure(robot, seen),
        "pressure": lambda: pressure_figure(robot, seen),
        "frontal_state": lambda: frontal_state_figure(seen, gait, orbit),
        "speed": lambda: speed_figure(seen),
        "joint_limits": lambda: joint_limits_figure(robot, seen),
    }


def write_space_figures(
    directory: Path | str,
    robot: FreeRobot,
    run: SpatialRun,
    gait: Gait | None = None,
    orbit: Trajectory | None = None,
    formats: Sequence[str] = ("svg", "png"),
) -> list[Path]:
    """Write every figure of a walk in space; each file appears whole or not at all.

    Args:
        directory: made if absent; files of the same names are replaced.
        robot: the robot.
        run: its walk.
        gait: the gait; None: there is no closed form to compare with.
        orbit: one step of its periodic orbit.
        formats: of `FORMATS`.

    Returns:
        The files written.
    """
    written = []
    for name, figure in all_space_figures(robot, run, gait, orbit):
        written += write_figure(directory, name, figure, formats)
    return written


def _stay_near(ax: "Axes", x: FloatArray, y: FloatArray) -> None:
    """Show of a robot that falls what is near the closed form: elsewhere there is nothing to compare with."""
    for values, limits, limit in ((x, ax.get_xlim(), ax.set_xlim), (y, ax.get_ylim(), ax.set_ylim)):
        low, high, span = float(values.min()), float(values.max()), float(np.ptp(values))
        limit(max(limits[0], low - span), min(limits[1], high + span))


def _view(robot: FreeRobot, steps: list[Footstep]) -> tuple[FloatArray, FloatArray]:
    """Lower left and upper right corner that show some footsteps [m]."""
    corners = np.concatenate([_corners(robot, step) for step in steps])
    margin = 0.25 * robot.soles.left.length
    return corners.min(axis=0) - margin, corners.max(axis=0) + margin


def _during(run: SpatialRun, steps: list[Footstep]) -> "np.ndarray[tuple[int, ...], np.dtype[np.bool_]]":
    return (run.step >= steps[0].step) & (run.step <= steps[-1].step)


def _corners(robot: FreeRobot, step: Footstep) -> FloatArray:
    sole = robot.soles.left if step.side is Stance.LEFT else robot.soles.right
    return footprint(sole, step.x, step.y, step.yaw)


def _draw_sole(ax: "Axes", robot: FreeRobot, step: Footstep) -> None:
    colour, style = FOOT_LOOKS[step.side]
    corners = _corners(robot, step)
    ax.fill(*corners.T, facecolor=colour, alpha=0.18, linewidth=0.0, label="_sole")
    ax.plot(*_closed(corners).T, color=colour, linestyle=style, linewidth=0.9, label="_sole")
    # where it points: from the ankle to the middle of the toes
    toes = corners[:2].mean(axis=0)
    ax.plot([step.x, toes[0]], [step.y, toes[1]], color=colour, linewidth=0.7, label="_sole")


def _closed(corners: FloatArray) -> FloatArray:
    return np.concatenate([corners, corners[:1]])


def _distance_to_edge(sole: FootSole, pressure: FloatArray, load: FloatArray) -> str:
    """How far inside the sole the CoP is while the foot carries at least half the weight, in words."""
    full = load >= 0.5
    if not full.any():
        return ""
    x, y = pressure[full].T
    low, high = (1e3 * end for end in (sole.corners.min(axis=0), sole.corners.max(axis=0)))
    inside = np.min([x - low[0], high[0] - x, y - low[1], high[1] - y], axis=0)
    most = round(float(np.quantile(inside, 0.01)))
    return f"99 %: {abs(most)} mm {'in' if most >= 0 else 'out'}side"
