"""What a run is measured by, and whether it is as expected."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from frontal_biped.scenarios.preparation import Prepared
from frontal_biped.simulation.trajectory import Trajectory

ROUNDING = 1e-9
"""What a bound leaves for rounding, relative (FRI: in m): a saturated torque is at its limit, not beyond it."""


@dataclass(frozen=True)
class Finding:
    """One expectation and what became of it.

    Attributes:
        key: of the expectation in the scenario.
        held: was it met?
        text: measured value and bound, for people.
        value: measured; nan where there was nothing to measure.
    """

    key: str
    held: bool
    text: str
    value: float


def measures(prepared: Prepared, run: Trajectory) -> dict[str, float]:
    """Numbers of a run, by the keys of `Expectations`; nan where there was nothing to measure.

    Whole steps only count for times and speeds; every recorded sample counts for errors and forces.
    """
    biped, orbit = prepared.biped, prepared.gait.orbit
    outer, inner = biped.sole
    impacts = run.event_t[run.events("IMPACT")]
    durations = np.diff(impacts)
    speed = run.post_impact_speeds / orbit.beta_dot_after_impact - 1.0
    limits = np.where(np.isfinite(biped.max_torque), biped.max_torque, np.inf)
    loaded = run.force[:, 1] > 0.0
    reported = run.settings.get("controller", {})
    measured = run.settings.get("measured", {})
    return {
        "steps": float(run.steps_completed),
        "output_error": _largest(np.abs(run.output_error)),
        "torque": _largest(np.abs(run.u) / limits),
        "friction": _largest(np.abs(run.force[loaded, 0]) / run.force[loaded, 1]),
        "fri_margin": -_largest(-np.minimum(run.p_fri[loaded] - outer, inner - run.p_fri[loaded])),
        "return_within": float(steps_to_return(prepared, run)),
        "shortest_step": float(durations.min()) if len(durations) else float("nan"),
        "longest_step": float(durations.max()) if len(durations) else float("nan"),
        "step_time_error": float(durations.mean()) / prepared.step_duration - 1.0 if len(durations) else float("nan"),
        "speed_error": float(speed[-1]) if len(durations) else float("nan"),
        "unsolved": float(reported.get("unsolved", 0)),
        "foot_slip": _of(measured, "slip"),
        "foot_rotation": _of(measured, "rotation"),
    }


def steps_to_return(prepared: Prepared, run: Trajectory) -> float:
    """Steps after the one in which the last push began (or from the start) until the speed stays near the orbit's.

    inf where it does not within the run, or the robot fell.
    """
    if run.fell:
        return float("inf")
    speed = run.post_impact_speeds / prepared.gait.orbit.beta_dot_after_impact - 1.0
    away = np.flatnonzero(np.abs(speed) > prepared.scenario.expect.return_tolerance)
    if len(away) and away[-1] == len(speed) - 1:
        return float("inf")
    impacts = run.event_t[run.events("IMPACT")]
    pushed = 0
    for push in prepared.scenario.pushes:
        moment = push.moment
        if moment.time is None:
            pushed = max(pushed, moment.step - 1)
        else:
            time = moment.time if isinstance(moment.time, float | int) else moment.time.high
            pushed = max(pushed, int(np.searchsorted(impacts, time, side="right")) - 1)
    return float(max(0, int(away[-1]) + 1 - pushed)) if len(away) else 0.0


def judge(prepared: Prepared, run: Trajectory, measured: Mapping[str, float]) -> tuple[Finding, ...]:
    """Every expectation of the scenario against a run."""
    expect, asked = prepared.scenario.expect, prepared.scenario.expect.steps or prepared.scenario.steps
    walked = run.steps_completed
    fate = "" if not run.fell else f", then it fell: {run.outcome}"
    findings = [Finding("steps", walked >= asked, f"walked {walked} of {asked} steps{fate}", float(walked))]
    at_most: dict[str, tuple[str, str]] = {
        "output_error": ("largest output error", "rad"),
        "torque": ("largest torque, of the limit", ""),
        "friction": ("largest |F_h| / F_v", ""),
        "unsolved": ("unsolved ticks", ""),
        "return_within": ("steps to return to the orbit", ""),
        "foot_slip": ("largest slip of a foot", "m"),
        "foot_rotation": ("largest rotation of a foot", "rad"),
        "step_time_error": ("error of the step time", ""),
        "speed_error": ("error of the last speed", ""),
    }
    for key, (label, unit) in at_most.items():
        bound = getattr(expect, key)
        if bound is None:
            continue
        value = measured[key]
        text = f"{label} {_figure(value)} (at most {bound:g}{' ' + unit if unit else ''})"
        findings.append(Finding(key, abs(value) <= bound * (1.0 + ROUNDING), text, value))
    if expect.fri_margin is not None:
        value = measured["fri_margin"]
        text = f"FRI {_figure(value)} m inside the ends of the sole (at least {expect.fri_margin:g} m)"
        findings.append(Finding("fri_margin", value >= expect.fri_margin - ROUNDING, text, value))
    if expect.step_duration is not None:
        low, high = expect.step_duration
        shortest, longest = measured["shortest_step"], measured["longest_step"]
        text = f"steps last {_figure(shortest)} to {_figure(longest)} s (from {low:g} to {high:g} s)"
        held = low <= shortest and longest <= high
        findings.append(Finding("step_duration", held, text, longest if longest > high else shortest))
    return tuple(findings)


def _largest(values: Any) -> float:
    """Largest of the values; inf where one is not a number, nan where there is none."""
    array = np.asarray(values, dtype=float)
    if array.size == 0:
        return float("nan")
    return float("inf") if np.isnan(array).any() else float(array.max())


def _of(measured: Mapping[str, Any], key: str) -> float:
    part = measured.get(key)
    return float(part["largest"]) if isinstance(part, Mapping) else float("nan")


def _figure(value: float) -> str:
    return f"{value:.3g}"
