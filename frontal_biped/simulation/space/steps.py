"""A walk in space step by step: how long, how fast forwards, how fast from the front half-way down."""

from typing import NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.simulation.space.run import SpatialRun
from frontal_biped.simulation.world import phase_spans
from frontal_biped.virtual_constraints.phase import StepPhase


class StepTable(NamedTuple):
    """One row for each whole step of a walk.

    Attributes:
        step: (k,) index.
        start: (k,) when it began [s].
        duration: (k,) [s].
        speed: (k,) mean speed of the centre of mass in the direction of the pelvis [m/s].
        target: (k,) commanded one, at the step's end [m/s].
        mid_fall_speed: (k,) dbeta half-way down [rad/s]; nan where the step never gets there.
    """

    step: FloatArray
    start: FloatArray
    duration: FloatArray
    speed: FloatArray
    target: FloatArray
    mid_fall_speed: FloatArray


def step_table(run: SpatialRun, mid_fall: float | None = None) -> StepTable:
    """The steps that ended in a landing.

    Args:
        run: the walk.
        mid_fall: beta half-way down the falling phase of the gait [rad]; None: there is no gait, and nan is returned.
    """
    rows = []
    spans = phase_spans(run)
    for step in dict.fromkeys(span.step for span in spans):
        if step >= run.steps_completed:
            break
        own = [span for span in spans if span.step == step]
        inside = slice(own[0].samples.start, own[-1].samples.stop)
        start, end = own[0].start, own[-1].end
        if end <= start:
            continue
        falling = next((span.samples for span in own if span.phase is StepPhase.FALLING), None)
        down = np.nan
        if mid_fall is not None and falling is not None:
            down = _speed_at(run.frontal_q[falling, 0], run.frontal_dq[falling, 0], mid_fall)
        went = np.diff(run.com[inside][[0, -1], :2], axis=0)[0]
        heading = float(np.mean(np.unwrap(run.yaw[inside])))
        forwards = float(went @ [np.cos(heading), np.sin(heading)]) / (end - start)
        rows.append((step, start, end - start, forwards, float(run.speed_target[inside][-1]), down))
    return StepTable(*np.array(rows, dtype=float).reshape(-1, 6).T)


def _speed_at(beta: FloatArray, dbeta: FloatArray, place: float) -> float:
    """Speed where beta first falls below a place."""
    below = np.flatnonzero(beta < place)
    if not len(below) or below[0] == 0:
        return np.nan
    i, j = below[0] - 1, below[0]
    weight = (beta[i] - place) / (beta[i] - beta[j])
    return float((1.0 - weight) * dbeta[i] + weight * dbeta[j])
