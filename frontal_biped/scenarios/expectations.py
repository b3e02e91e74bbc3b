"""What a run is measured by, and whether it is as expected."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from frontal_biped.files.counted import counted
from frontal_biped.scenarios.measured import AnyRun, largest, of_every_run, of_steps
from frontal_biped.scenarios.preparation import Prepared
from frontal_biped.simulation.trajectory import Trajectory

ROUNDING = 1e-9
"""What a bound leaves for rounding, relative (FRI: in m): a saturated torque is at its limit, not beyond it."""

AT_MOST: Mapping[str, tuple[str, str]] = {
    "output_error": ("largest output error", "rad"),
    "torque": ("largest torque, of the limit", ""),
    "friction": ("largest |F_h| / F_v", ""),
    "unsolved": ("unsolved ticks", ""),
    "return_within": ("steps to return to the orbit", ""),
    "foot_slip": ("largest slip of a foot", "m"),
    "foot_rotation": ("largest rotation of a foot", "rad"),
    "step_time_error": ("error of the step time", ""),
    "speed_error": ("error of the last speed", ""),
    "yaw_drift": ("change of the heading", "rad"),
    "joint_speed": ("largest joint speed, of the limit", ""),
    "self_collisions": ("instants at which links touch", ""),
    "path_distance": ("distance from the end of the path", "m"),
    "path_angle": ("angle from the end of the path", "rad"),
}
"""Upper bounds by the keys of `Expectations`: what is measured, in words, and its unit."""


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
    """Numbers of a run in the plane, by the keys of `Expectations`; nan where there was nothing to measure.

    Whole steps only count for times and speeds; every recorded sample counts for errors and forces.
    """
    biped = prepared.biped
    outer, inner = biped.sole
    limits = np.where(np.isfinite(biped.max_torque), biped.max_torque, np.inf)
    loaded = run.force[:, 1] > 0.0
    measured = run.settings.get("measured", {})
    return {
        "steps": float(run.steps_completed),
        "output_error": largest(np.abs(run.output_error)),
        "torque": largest(np.abs(run.u) / limits),
        "friction": largest(np.abs(run.force[loaded, 0]) / run.force[loaded, 1]),
        "fri_margin": -largest(-np.minimum(run.p_fri[loaded] - outer, inner - run.p_fri[loaded])),
        "foot_slip": of_steps(measured, "slip"),
        "foot_rotation": of_steps(measured, "rotation"),
        **of_every_run(prepared, run),
    }


def judge(prepared: Prepared, run: AnyRun, measured: Mapping[str, float]) -> tuple[Finding, ...]:
    """Every expectation of the scenario against a run."""
    expect, asked = prepared.scenario.expect, prepared.scenario.expect.steps or prepared.scenario.steps
    walked = run.steps_completed
    fate = "" if not run.fell else f", then it fell: {run.outcome}"
    told, path = f"walked {walked} of {counted(asked, 'step')}{fate}", run.settings.get("path")
    held = walked >= asked
    if path is not None:
        held = bool(path["arrived"])
        told = f"{'arrived' if held else 'did not arrive'} after {counted(walked, 'step')}{fate}"
    findings = [Finding("steps", held, told, float(walked))]
    for key, (label, unit) in AT_MOST.items():
        bound = getattr(expect, key)
        if bound is None:
            continue
        value = measured[key]
        text = f"{label} {_figure(value)} (at most {bound:g}{' ' + unit if unit else ''})"
        findings.append(Finding(key, abs(value) <= bound * (1.0 + ROUNDING), text, value))
    for key, what in (("fri_margin", "FRI"), ("cop_margin", "centre of pressure, fore and aft,")):
        bound = getattr(expect, key)
        if bound is not None:
            value = measured[key]
            text = f"{what} {_figure(value)} m inside the ends of the sole (at least {bound:g} m)"
            findings.append(Finding(key, value >= bound - ROUNDING, text, value))
    if expect.walking_speed is not None:
        low, high = expect.walking_speed
        value = measured["walking_speed"]
        text = f"walks {_figure(value)} m/s (from {low:g} to {high:g} m/s)"
        findings.append(Finding("walking_speed", low <= value <= high, text, value))
    if expect.step_duration is not None:
        low, high = expect.step_duration
        shortest, longest = measured["shortest_step"], measured["longest_step"]
        text = f"steps last {_figure(shortest)} to {_figure(longest)} s (from {low:g} to {high:g} s)"
        held = low <= shortest and longest <= high
        findings.append(Finding("step_duration", held, text, longest if longest > high else shortest))
    return tuple(findings)


def _figure(value: float) -> str:
    return f"{value:.3g}"
