"""What a page must know beside the scene: phases, events, pushes, traces, and the samples behind its plots."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.files.array_schema import LARGEST
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.chain import JOINTS
from frontal_biped.simulation.orbit import ORBIT
from frontal_biped.simulation.space.run import SpatialRun
from frontal_biped.simulation.trajectory import Trajectory
from frontal_biped.simulation.world import FEET, Phased, frame_times, phase_spans
from frontal_biped.viewer.channels import frame_rate, packed
from frontal_biped.viewer.markers import COM, CONTACT, TRACE
from frontal_biped.viewer.planar_motion import planar_motion
from frontal_biped.viewer.scene import FIRST, GHOST, SECOND, Actor, frontal_camera
from frontal_biped.virtual_constraints.phase import StepPhase

MOST_SAMPLES = 12_000
"""Of one run in the plots; a longer one is thinned, see `thinned`."""

WINDOWS = 64
"""Parts of a long run of which every curve keeps its highest and its lowest value."""


def panel(key: str, title: str, label: str, lines: Sequence[tuple[str, ...]], **more: Any) -> dict[str, Any]:
    """A plot: lines are (name, channel) or (name, channel, channel of the desired value).

    ``more`` may say ``x`` and ``xlabel`` of a plot over something else than time, ``band=True`` where the limits are
    the ends of what is allowed, and how many ``digits`` are told.
    """
    named = [dict(zip(("name", "y", "wanted"), line, strict=False)) for line in lines]
    return {"key": key, "title": title, "x": "t", "xlabel": "time [s]", "ylabel": label, "lines": named} | more


BETA = "stance ankle angle β [rad]"
"""Label of the axis of the phase variable."""

PANELS: tuple[dict[str, Any], ...] = (
    panel(
        "angles",
        "Joint angles",
        "angle [rad]",
        [(name, f"q{i + 1}", *([f"d{i + 1}"] if i else [])) for i, name in enumerate(JOINTS)],
    ),
    panel("fri", "FRI and sole", "FRI [mm]", [("from the ankle", "fri", "fri_target")], band=True),
    panel("torques", "Torques", "torque [N m]", [(name, f"u{i + 1}") for i, name in enumerate(JOINTS)]),
    panel("portrait", "Phase portrait", "dβ/dt [rad/s]", [("stance ankle", "v1")], x="q1", xlabel=BETA),
    panel("force", "Ground reaction", "force [N]", [("vertical", "fv"), ("horizontal", "fh")]),
    panel("foot", "Swing foot", "height [mm]", [("inner end", "inner"), ("outer end", "outer")]),
    panel("roll", "Pelvis roll", "roll [degrees]", [("pelvis", "roll")]),
    panel(
        "error", "Tracking error", "actual − desired [mrad]", [(name, f"e{i + 2}") for i, name in enumerate(JOINTS[1:])]
    ),
    panel("speeds", "Joint velocities", "velocity [rad/s]", [(name, f"v{i + 1}") for i, name in enumerate(JOINTS)]),
)
"""What a plot of the page can show; the first four are shown first."""


def part(key: str, label: str, nodes: Sequence[Sequence[str]]) -> dict[str, Any]:
    """Something of the scene that can be shown or hidden: its nodes below MeshCat's root."""
    return {"key": key, "label": label, "nodes": [list(node) for node in nodes]}


def page_data(actors: Sequence[Actor], plots: bool = True, theme: str = "auto", fps: float = 30.0) -> dict[str, Any]:
    """Everything `viewer.js` reads.

    Args:
        actors: the robots of the scene, see `cast`.
        plots: with the samples for plots.
        theme: "auto" (what the browser prefers), "light" or "dark".
        fps: frames of the motion a second, fewer for a long walk.
    """
    longest = max(actors, key=lambda actor: actor.duration)
    times = frame_times(longest.trajectory, frame_rate(len(actors) * longest.duration, fps)) - longest.trajectory.t[0]
    runs = [actor for actor in actors if actor.node != GHOST]
    ghosts = [actor for actor in actors if actor.node == GHOST]
    return {
        "duration": longest.duration,
        "camera": frontal_camera(actors),
        "runs": [_run(actor, plots) | {"motion": planar_motion(actor, times)} for actor in runs],
        "moved": [{"node": actor.node, "motion": planar_motion(actor, times)} for actor in ghosts],
        "overlaid": any(actor.node == SECOND and not actor.marked for actor in actors),
        "ghost": any(actor.node == GHOST for actor in actors),
        "parts": _parts(actors),
        "panels": list(PANELS) if plots else [],
        "theme": theme,
    }


def told_source(run: Trajectory | SpatialRun) -> str:
    """What a run is, in one line: the periodic orbit, or who simulated it at which rate; "" where it does not tell."""
    if run.settings.get("source") == ORBIT:
        return "the gait's periodic orbit, in closed form"
    if "period" not in run.settings:
        return ""
    engine = " in MuJoCo" if run.settings.get("engine") == "mujoco" else ""
    period = run.settings["period"]
    rate = f"control at {1.0 / period:.6g} Hz" if isinstance(period, float) and period > 0.0 else "continuous control"
    return f"simulated{engine}, {rate}"


def _parts(actors: Sequence[Actor]) -> list[dict[str, Any]]:
    marked = [actor.node for actor in actors if actor.marked]

    def contacts(name: str) -> list[tuple[str, ...]]:
        return [(node, CONTACT, foot.value, name) for node in marked for foot in FEET]

    others = {actor.node for actor in actors} - {FIRST}
    hidden = {GHOST: "desired posture", SECOND: "second run"}
    return [
        part("force", "ground reaction", contacts("force")),
        part("fri", "FRI", contacts("fri")),
        part("com", "centre of mass", [(node, COM) for node in marked]),
        part("trace", "swing-foot trace", [(node, TRACE) for node in marked]),
        *(part(node, label, [(node,)]) for node, label in hidden.items() if node in others),
    ]


def _run(actor: Actor, plots: bool) -> dict[str, Any]:
    run, biped = actor.trajectory, actor.biped
    return {
        "node": actor.node,
        "robot": biped.name,
        "duration": actor.duration,
        "outcome": run.outcome,
        "steps": run.steps_completed,
        "source": told_source(run),
        "phases": phase_marks(run),
        "events": event_marks(run),
        "pushes": _pushes(run),
        "traces": [
            {"foot": trace.foot.value, "start": trace.start, "end": trace.end, "pieces": len(trace.points) - 1}
            for trace in actor.traces
        ],
        "limits": _limits(biped),
        "samples": samples(biped, run) if plots else None,
    }


def phase_marks(run: Phased) -> list[dict[str, Any]]:
    """Start [s] of every phase of a run, the number of its step, the foot that stands, rising or falling."""
    return [
        {
            "start": span.start - float(run.t[0]),
            "step": span.step + 1,
            "stance": span.stance.value,
            "phase": span.phase.value,
        }
        for span in phase_spans(run)
    ]


def event_marks(run: Trajectory | SpatialRun) -> list[dict[str, Any]]:
    """Reversals and impacts within the run, from its event list and, where that is silent, from its phases."""
    start, end = float(run.t[0]), float(run.t[-1])
    found = {
        (round(float(t) - start, 6), kind.lower())
        for t, kind in zip(run.event_t, run.event_kind, strict=True)
        if kind in ("IMPACT", "REVERSAL") and start <= t <= end
    }
    spans = phase_spans(run)
    for before, after in pairwise(spans):
        kind = "impact" if after.step != before.step else "reversal" if before.phase.sign > after.phase.sign else ""
        time = after.start - start
        if kind and not any(kind == known and abs(time - t) < 2e-2 for t, known in found):
            found.add((round(time, 6), kind))
    return [{"t": t, "kind": kind} for t, kind in sorted(found)]


def _pushes(run: Trajectory) -> list[dict[str, float]]:
    """Pushes as the run's settings tell them; none where they do not."""
    found = []
    disturbances = run.settings.get("disturbances", {})
    for start, push in told_pushes(run, disturbances.get("pushes") if isinstance(disturbances, Mapping) else None):
        try:
            found.append({"start": start, "duration": float(push["duration"]), "impulse": float(push["impulse"])})
        except (KeyError, TypeError, ValueError):
            continue
    return found


_NUMBERS_OF_PUSH = ("start", "duration", "impulse", "point")


def told_pushes(run: Trajectory | SpatialRun, pushes: Any) -> Iterator[tuple[float, Mapping[str, Any]]]:
    """Start from the first sample [s] of each push that began in a run, and the rest of what is told of it.

    Args:
        run: the run.
        pushes: as its settings tell them; anything but a list of tables is passed over.
    """
    for push in pushes if isinstance(pushes, list) else []:
        try:
            start = float(push["start"])
            told = [np.ravel(np.asarray(push.get(key, 0.0), dtype=float)) for key in _NUMBERS_OF_PUSH]
        except (KeyError, TypeError, ValueError, OverflowError, AttributeError):
            continue
        # nan is not below it
        if not np.all(np.abs(np.concatenate(told)) <= LARGEST) or not isinstance(push.get("step"), int | None):
            continue
        origin = _origin(run, push.get("step"), push.get("phase"))
        if origin is not None:
            yield origin + start - float(run.t[0]), push


def _origin(run: Trajectory | SpatialRun, step: int | None, phase: str | None) -> float | None:
    """What the start of a push counts from [s]: the run, or a phase of a step; None where that never began."""
    if step is None:
        return 0.0
    kind, before = ("IMPACT", step - 1) if phase == StepPhase.RISING.value else ("REVERSAL", step)
    begun = [i for i in run.events(kind) if run.event_step[i] == before]
    return float(run.event_t[begun[0]]) if begun else None


def _limits(biped: FrontalBiped) -> dict[str, list[dict[str, Any]]]:
    """Lines across plots: the ends of the sole, the torque limits, the weight, the ground."""
    outer, inner = (1e3 * end for end in biped.sole)
    ankle, hip = (float(limit) for limit in biped.max_torque[:2])
    torque = [{"value": sign * ankle, "name": "ankle limit"} for sign in (1.0, -1.0)]
    if hip != ankle:
        torque += [{"value": sign * hip, "name": "hip limit"} for sign in (1.0, -1.0)]
    return {
        "fri": [{"value": inner, "name": "inner end"}, {"value": outer, "name": "outer end"}],
        "torques": torque if hip != ankle else [{**line, "name": "limit"} for line in torque],
        "force": [{"value": biped.weight, "name": "weight"}],
        "foot": [{"value": 0.0, "name": "ground"}],
        "portrait": [{"value": 0.0, "name": "turns back"}],
    }


def samples(biped: FrontalBiped, trajectory: Trajectory) -> dict[str, Any]:
    """Channels of the plots, in the units of their axes, packed as little-endian float32 in base64.

    Returns:
        "count", "breaks" (index of the first sample of each phase) and "channels".
    """
    names = ("q", "dq", "u", "force", "p_fri", "p_fri_target", "output_error")
    kept, breaks = thinned(trajectory, np.column_stack([getattr(trajectory, name) for name in names]), MOST_SAMPLES)
    run = {name: getattr(trajectory, name)[kept] for name in ("t", "q", "dq", "u", "force", "p_fri", "p_fri_target")}
    wanted = trajectory.q_b_desired[kept]
    inner, outer = 1e3 * biped.swing_sole_heights(run["q"])
    channels: dict[str, FloatArray] = {"t": run["t"] - trajectory.t[0]}
    for i in range(4):
        channels |= {f"q{i + 1}": run["q"][:, i], f"v{i + 1}": run["dq"][:, i], f"u{i + 1}": run["u"][:, i]}
    for i in range(3):
        channels |= {f"d{i + 2}": wanted[:, i], f"e{i + 2}": 1e3 * (run["q"][:, i + 1] - wanted[:, i])}
    channels |= {"fh": run["force"][:, 0], "fv": run["force"][:, 1]}
    channels |= {"fri": 1e3 * run["p_fri"], "fri_target": 1e3 * run["p_fri_target"]}
    channels |= {"inner": inner, "outer": outer}
    channels["roll"] = np.degrees(biped.pelvis_roll(run["q"]))
    return {
        "count": len(kept),
        "breaks": breaks,
        "channels": {name: packed(values) for name, values in channels.items()},
    }


def thinned(run: Phased, values: FloatArray, most: int) -> tuple[np.ndarray[Any, np.dtype[np.intp]], list[int]]:
    """Samples of a run that its plots keep: evenly chosen ones, both ends of every phase, and whatever is extreme.

    Args:
        run: the run.
        values: (T, k) of its curves; of each the highest and the lowest value is kept in every one of `WINDOWS` parts
            of the run, so that no spike is lost and every axis reaches as far as it would have.
        most: how many samples to choose evenly, about.

    Returns:
        Their indices, and among them the index of the first of each phase.
    """
    share = min(1.0, most / len(run.t))
    spans = phase_spans(run)
    chosen: list[np.ndarray[Any, np.dtype[np.intp]]] = []
    for span in spans:
        first, last = span.samples.start, span.samples.stop - 1
        count = max(2, int(np.ceil(share * (last - first + 1))))
        chosen.append(np.linspace(first, last, count).round().astype(np.intp))
    for part in np.array_split(np.arange(len(run.t)), WINDOWS if share < 1.0 else 1):
        chosen += [part[values[part].argmin(axis=0)], part[values[part].argmax(axis=0)]]
    kept = np.unique(np.concatenate(chosen))
    return kept, np.searchsorted(kept, [span.samples.start for span in spans]).tolist()
