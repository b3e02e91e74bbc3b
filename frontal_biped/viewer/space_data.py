"""What a page of a walk in space must know beside scene and motion: footsteps, events, the samples of its plots."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.model.chain import JOINTS
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.simulation.space.run import SpatialRun
from frontal_biped.simulation.space.shares import JointShares, joint_shares
from frontal_biped.simulation.space.soles import (
    footsteps,
    friction_used,
    yaw_moments,
)
from frontal_biped.simulation.space.steps import step_table
from frontal_biped.simulation.trajectory import Trajectory
from frontal_biped.simulation.world import FEET, phase_spans
from frontal_biped.viewer.channels import packed
from frontal_biped.viewer.markers import COM, CONTACT
from frontal_biped.viewer.page_data import BETA, event_marks, panel, part, phase_marks, thinned, told_source
from frontal_biped.viewer.scene import FIRST
from frontal_biped.viewer.space_motion import motion, spatial_pushes
from frontal_biped.viewer.space_scene import (
    FOOTHOLD,
    FOOTSTEPS,
    PUSH,
    TRIANGLES,
    space_camera,
)

MOST_SAMPLES = 8000
"""In the plots; of 200 steps some forty each, of a longer walk fewer, see `thinned`."""

LEGS = ("left leg", "right leg", "other joints")

SPACE_PANELS: tuple[dict[str, Any], ...] = (
    panel(
        "speed",
        "Forward speed",
        "speed [m/s]",
        [("centre of mass", "vx"), ("step's mean", "vstep", "vtarget")],
        digits=3,
    ),
    panel("cop", "CoP, fore-aft", "CoP [mm]", [("from the ankle", "cop_x", "cop_target_x")], band=True),
    panel("fri", "FRI and sole", "FRI [mm]", [("from the ankle", "fri", "fri_target")], band=True),
    panel("torques", "Torques", "share of limit [%]", [(name, f"u_{i}") for i, name in enumerate(LEGS)]),
    panel("portrait", "Frontal phase portrait", "dβ/dt [rad/s]", [("stance leg", "v1")], x="q1", xlabel=BETA),
    panel("speeds", "Joint speeds", "share of limit [%]", [(name, f"w_{i}") for i, name in enumerate(LEGS)]),
    panel("ranges", "Joint ranges", "share of range [%]", [(name, f"r_{i}") for i, name in enumerate(LEGS)]),
    panel(
        "angles",
        "Frontal angles",
        "angle [rad]",
        [(name, f"q{i + 1}", *([f"d{i + 1}"] if i else [])) for i, name in enumerate(JOINTS)],
    ),
    panel(
        "error", "Tracking error", "actual − desired [mrad]", [(name, f"e{i + 2}") for i, name in enumerate(JOINTS[1:])]
    ),
    panel("load", "Vertical force", "force [N]", [("left foot", "fz_left"), ("right foot", "fz_right")]),
    panel("friction", "Friction used", "horizontal/vertical [-]", [("stance foot", "friction")], digits=3),
    panel("moment", "Yaw moment of the sole", "moment [N m]", [("stance foot", "moment")]),
    panel("foot", "Feet", "height of the sole [mm]", [("left foot", "z_left"), ("right foot", "z_right")]),
    panel("tilt", "Pelvis", "angle [degrees]", [("roll", "roll"), ("pitch", "pitch"), ("yaw", "yaw")], digits=2),
)
"""What a plot of the page can show; the first four are shown first."""


def space_page_data(
    robot: FreeRobot,
    run: SpatialRun,
    orbit: Trajectory | None = None,
    *,
    fps: float = 30.0,
    plots: bool = True,
    theme: str = "auto",
) -> dict[str, Any]:
    """Everything `viewer.js` reads.

    Args:
        robot: the robot.
        run: its walk, see `drawable_part`.
        orbit: one step of the periodic orbit in closed form, drawn into the phase portrait.
        fps: frames of the motion a second; the page interpolates between them.
        plots: with plots below the robot; the phase portrait is there without.
        theme: "auto" (what the browser prefers), "light" or "dark".
    """
    duration = float(run.t[-1] - run.t[0])
    pushes = spatial_pushes(robot, run)
    told = {
        "node": FIRST,
        "robot": robot.name,
        "duration": duration,
        "outcome": run.outcome,
        "steps": run.steps_completed,
        "source": told_source(run),
        "phases": phase_marks(run),
        "events": event_marks(run),
        "pushes": [{"start": push.start, "duration": push.duration, "text": push.text} for push in pushes],
        "traces": [],
        "footsteps": _landed(run),
        "limits": _limits(robot, run),
        "samples": space_samples(robot, run),
        "motion": motion(robot, run, pushes, fps),
        "reference": {} if orbit is None else {"portrait": _closed_form(orbit)},
        "readout": [{"name": "forwards at", "y": "vstep", "unit": "m/s", "digits": 2}],
    }
    contacts = {name: [(FIRST, CONTACT, foot.value, name) for foot in FEET] for name in ("force", "cop", "moment")}
    return {
        "duration": duration,
        "camera": space_camera(robot),
        "runs": [told],
        "overlaid": False,
        "ghost": False,
        "panels": list(SPACE_PANELS),
        "rows": 4 if plots else 0,
        "inset": "portrait",
        "follow": True,
        "parts": [
            part("force", "ground reactions", contacts["force"]),
            part("fri", "CoP", contacts["cop"]),
            part("moment", "yaw moment", contacts["moment"]),
            part("com", "centre of mass", [(FIRST, COM)]),
            part("footsteps", "footsteps", [(FIRST, FOOTSTEPS)]),
            part("foothold", "planned foothold", [(FIRST, FOOTHOLD)]),
            *([part("push", "pushes", [(FIRST, PUSH)])] if pushes else []),
        ],
        "theme": theme,
    }


# ---------------------------------------------------------------------- plots
def space_samples(robot: FreeRobot, run: SpatialRun) -> dict[str, Any]:
    """Channels of the plots, in the units of their axes, packed as little-endian float32 in base64.

    Returns:
        "count", "breaks" (index of the first sample of each phase) and "channels".
    """
    channels: dict[str, FloatArray] = {"t": run.t - run.t[0]}
    channels |= {f"q{i + 1}": run.frontal_q[:, i] for i in range(4)}
    channels["v1"] = run.frontal_dq[:, 0]
    channels |= {f"d{i + 2}": run.frontal_q[:, i + 1] - run.frontal_y[:, i] for i in range(3)}
    channels |= {f"e{i + 2}": 1e3 * run.frontal_y[:, i] for i in range(3)}
    channels |= {"vx": _forward_speed(run), "vstep": _mean_speed(run), "vtarget": run.speed_target}
    channels |= {"cop_x": 1e3 * run.cop_x, "cop_target_x": 1e3 * run.cop_target_x}
    channels |= {"fri": 1e3 * run.p_fri, "fri_target": 1e3 * run.p_fri_target}
    shares = joint_shares(robot, run)
    for name, values in zip("uwr", JointShares(*shares), strict=True):
        channels |= {f"{name}_{i}": 100.0 * worst for i, worst in enumerate(_worst_of_legs(robot, values))}
    for i, foot in enumerate(FEET):
        channels |= {f"fz_{foot.value}": run.wrench[:, i, 2], f"z_{foot.value}": 1e3 * run.sole_position[:, i, 2]}
    standing = np.where(run.stance > 0.0, 0, 1)
    rows = np.arange(len(run.t))
    channels["friction"] = np.nan_to_num(friction_used(run))[rows, standing]
    channels["moment"] = np.nan_to_num(yaw_moments(run))[rows, standing]
    channels |= dict(zip(("roll", "pitch", "yaw"), np.degrees(_tilt(robot, run)).T, strict=True))
    kept, breaks = thinned(run, np.column_stack(list(channels.values())), MOST_SAMPLES)
    return {
        "count": len(kept),
        "breaks": breaks,
        "channels": {name: packed(values[kept]) for name, values in channels.items()},
    }


def _forward_speed(run: SpatialRun) -> FloatArray:
    return run.com_velocity[:, 0] * np.cos(run.yaw) + run.com_velocity[:, 1] * np.sin(run.yaw)


def _mean_speed(run: SpatialRun) -> FloatArray:
    """(T,) mean speed forwards of the step that each sample belongs to; of one that did not end, so far [m/s]."""
    table = step_table(run)
    of_step = dict(zip(table.step.tolist(), table.speed.tolist(), strict=True))
    forwards = _forward_speed(run)
    rest = {step: float(np.mean(forwards[run.step == step])) for step in set(run.step.tolist()) - set(of_step)}
    return np.array([(of_step | rest)[step] for step in run.step.tolist()])


def _worst_of_legs(robot: FreeRobot, shares: FloatArray) -> list[FloatArray]:
    legs = [list(robot.leg(foot)) for foot in FEET]
    others = [i for i in range(shares.shape[1]) if i not in {*legs[0], *legs[1]}]
    return [np.max(shares[:, own], axis=1, initial=0.0) for own in (*legs, others)]


def _tilt(robot: FreeRobot, run: SpatialRun) -> FloatArray:
    """(T, 3) roll, pitch and yaw of the root link from the posture [rad]."""
    upright = pin.Quaternion(robot.posture[3:7]).matrix()
    angles = [pin.rpy.matrixToRpy(pin.Quaternion(q).normalized().matrix() @ upright.T) for q in run.q[:, 3:7]]
    return np.unwrap(np.array(angles), axis=0)


def _limits(robot: FreeRobot, run: SpatialRun) -> dict[str, list[dict[str, Any]]]:
    """Lines across plots: ends of the sole, limits, weight, friction of the ground."""
    sole = robot.soles.left
    full = [{"value": 100.0, "name": "limit"}]
    limits: dict[str, list[dict[str, Any]]] = {
        "cop": [{"value": 1e3 * sole.front, "name": "toe"}, {"value": -1e3 * sole.back, "name": "heel"}],
        "fri": [
            {"value": 1e3 * sole.inner, "name": "inner edge"},
            {"value": -1e3 * sole.outer, "name": "outer edge"},
        ],
        "torques": full,
        "speeds": full,
        "ranges": full,
        "load": [{"value": robot.weight, "name": "weight"}],
        "foot": [{"value": 0.0, "name": "ground"}],
        "portrait": [{"value": 0.0, "name": "turns back"}],
    }
    return limits


def _closed_form(orbit: Trajectory) -> dict[str, list[float | None]]:
    """Beta and dbeta of the first step of an orbit; a gap between its phases."""
    found: dict[str, list[float | None]] = {"x": [], "y": []}
    for span in phase_spans(orbit.first_steps(1)):
        few = np.unique(np.linspace(span.samples.start, span.samples.stop - 1, 120).round().astype(int))
        found["x"] += [*orbit.q[few, 0].tolist(), None]
        found["y"] += [*orbit.dq[few, 0].tolist(), None]
    return found


def _landed(run: SpatialRun) -> dict[str, Any]:
    """When the footsteps of either foot were left, and how many triangles of their meshes each has."""
    start = float(run.t[0])
    landed: Mapping[str, list[float]] = {foot.value: [] for foot in FEET}
    for step in footsteps(run):
        landed[step.side.value].append(step.time - start)
    return {"times": landed, "triangles": {"inside": 2, "edge": TRIANGLES - 2}}
