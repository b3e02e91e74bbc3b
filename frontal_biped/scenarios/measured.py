"""What runs in the plane and in space are measured by alike."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from frontal_biped.scenarios.preparation import Prepared
from frontal_biped.simulation.space.run import SpatialRun
from frontal_biped.simulation.trajectory import Trajectory

AnyRun = Trajectory | SpatialRun


def of_every_run(prepared: Prepared, run: AnyRun) -> dict[str, float]:
    """Step times and frontal speeds after the impacts, against the orbit; ticks that were not solved."""
    durations = np.diff(run.event_t[run.events("IMPACT")])
    speed, nothing = _speed_errors(prepared, run), float("nan")
    walked = len(durations) > 0
    return {
        "return_within": float(steps_to_return(prepared, run)),
        "shortest_step": float(durations.min()) if walked else nothing,
        "longest_step": float(durations.max()) if walked else nothing,
        "step_time_error": float(durations.mean()) / prepared.step_duration - 1.0 if walked else nothing,
        "speed_error": float(speed[-1]) if walked else nothing,
        "unsolved": float(run.settings.get("controller", {}).get("unsolved", 0)),
    }


def steps_to_return(prepared: Prepared, run: AnyRun) -> float:
    """Steps after the one in which the last push began (or from the start) until the speed stays near the orbit's.

    inf where it does not within the run, or the robot fell.
    """
    if run.fell:
        return float("inf")
    speed = _speed_errors(prepared, run)
    away = np.flatnonzero(np.abs(speed) > prepared.scenario.expect.return_tolerance)
    if len(away) and away[-1] == len(speed) - 1:
        return float("inf")
    impacts = run.event_t[run.events("IMPACT")]
    pushed = 0
    for moment in prepared.scenario.push_moments:
        if moment.time is None:
            pushed = max(pushed, moment.step - 1)
        else:
            time = moment.time if isinstance(moment.time, float | int) else moment.time.high
            pushed = max(pushed, int(np.searchsorted(impacts, time, side="right")) - 1)
    return float(max(0, int(away[-1]) + 1 - pushed)) if len(away) else 0.0


def _speed_errors(prepared: Prepared, run: AnyRun) -> Any:
    return run.post_impact_speeds / prepared.gait.orbit.beta_dot_after_impact - 1.0


def largest(values: Any) -> float:
    """Largest of the values; inf where one is not a number, nan where there is none."""
    array = np.asarray(values, dtype=float)
    if array.size == 0:
        return float("nan")
    return float("inf") if np.isnan(array).any() else float(array.max())


def of_steps(measured: Mapping[str, Any], key: str) -> float:
    """Largest over the steps of what `Measured` lists; nan where it was not measured."""
    part = measured.get(key)
    return float(part["largest"]) if isinstance(part, Mapping) else float("nan")
