"""Pushes in the full model at 1 kHz: the largest one survived at an instant of the step, by bisection.

The ground holds what it can and no more: a stance foot slips at the gait's own coefficient of friction, and rolls over
its edge where the FRI leaves the sole. Either is a fall, as in the closed form, which keeps every contact constraint.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.gait.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.simulation.disturbances import Disturbances
from frontal_biped.simulation.pushes import Push
from frontal_biped.simulation.settings import SimulationSettings
from frontal_biped.simulation.trajectory import Trajectory
from frontal_biped.simulation.walking import simulate
from frontal_biped.zero_dynamics.poincare import StepOrbit

PERIOD = 1e-3  # [s]
PUSH_DURATION = 0.05  # [s]

INSTANTS = (("just after the impact", 0.02), ("half-way up", 0.5), ("at the reversal", 1.0), ("half-way down", 1.5))
"""Name and place in the step: 0 impact, 1 reversal, 2 next impact, by time within each phase."""

DIRECTIONS = ("outwards", "inwards")
"""Away from the first swing foot, and towards it."""

STEPS_TO_DECIDE = (3, 6)
"""Steps walked after a push; the larger number only where the speed is not back after the smaller."""

RECOVERED = 0.05
"""Relative error of the post-impact speed that counts as recovered; 1 kHz control alone costs 0.003."""

FIRST_PUSH, LARGEST_PUSH = 8.0, 64.0
"""First and largest push tried [N s]."""

PUSH_RESOLUTION = 1.0  # [N s], or a tenth of the push

RECORDING = SimulationSettings(record_rate=20.0)
"""Only the events are read."""

HELD = 0.01
"""Friction that torques held between two ticks may use beyond what the controller keeps to at its ticks, relative."""


@dataclass(frozen=True)
class PushOutcome:
    """The largest push survived at one instant in one direction.

    Attributes:
        instant: of the first step.
        direction: "outwards", away from the swing foot, or "inwards".
        impulse: largest survived [N s].
        steps_to_recover: steps after it until the speed is within `RECOVERED` of the gait's.
        limited_by: what became of the next larger one.
    """

    instant: str
    direction: str
    impulse: float
    steps_to_recover: int
    limited_by: str


def largest_push(
    biped: FrontalBiped,
    gait: Gait,
    stabiliser: str,
    instant: str,
    place: float,
    direction: str,
    resolution: float = PUSH_RESOLUTION,
) -> PushOutcome:
    """The largest push survived at an instant of the first step, by bisection on its impulse.

    Args:
        biped: the robot.
        gait: the gait.
        stabiliser: by name.
        instant: what the place is called.
        place: 0 impact, 1 reversal, 2 next impact.
        direction: "outwards" or "inwards", of the first stance foot.
        resolution: of the impulse [N s]; a tenth of it is enough in any case.
    """
    start = time_in_step(gait.step(biped), place)
    # the left foot stands first: outwards is to the left
    sign = 1.0 if direction == "outwards" else -1.0
    good, bad, steps, why = 0.0, np.inf, 0, "nothing up to the end of the search"
    while bad - good > max(resolution, 0.1 * good) and good < LARGEST_PUSH:
        size = 0.5 * (good + bad) if np.isfinite(bad) else max(2.0 * good, FIRST_PUSH)
        fell, count = _fate(biped, gait, stabiliser, Push(start, PUSH_DURATION, sign * size))
        if fell:
            bad, why = size, fell
        else:
            good, steps = size, count
    return PushOutcome(instant, direction, good, steps, why)


def held_walk(
    biped: FrontalBiped,
    gait: Gait,
    stabiliser: str,
    *pushes: Push,
    **options: Any,
) -> Trajectory:
    """A walk at `PERIOD` on ground that holds what it can: the gait's friction, and a FRI within the sole.

    Args:
        biped: the robot.
        gait: the gait.
        stabiliser: by name.
        pushes: on the way.
        options: of `simulate`.

    Returns:
        The run; to slip and to roll over an edge are falls.
    """
    ground = Disturbances(pushes=pushes, friction=(1.0 + HELD) * gait.specification.friction, rolls=True)
    return simulate(biped, gait, period=PERIOD, stabiliser=stabiliser, disturbances=ground, **options)


def time_in_step(step: StepOrbit, place: float) -> float:
    """When a place of the step is reached, from the impact that begins it [s]; see `INSTANTS`."""
    up, down = step.rising.duration, step.falling.duration
    return place * up if place <= 1.0 else up + (place - 1.0) * down


def _fate(biped: FrontalBiped, gait: Gait, stabiliser: str, push: Push) -> tuple[str, int]:
    """What is in the way of recovery, empty where nothing is; and the steps that recovery takes."""
    for steps in STEPS_TO_DECIDE:
        run = held_walk(biped, gait, stabiliser, push, steps=steps, simulation_settings=RECORDING)
        if run.fell:
            return run.outcome, 0
        late = np.flatnonzero(speed_errors(run, gait) > RECOVERED)
        taken = int(late[-1]) if len(late) else 0
        if taken <= steps - 2:  # the last two steps were the gait's
            return "", taken
    return f"not back within {STEPS_TO_DECIDE[-1]} steps", 0


def speed_errors(run: Trajectory, gait: Gait) -> FloatArray:
    """(k,) relative errors of the post-impact speeds of a run, unsigned [-]."""
    return np.abs(run.post_impact_speeds / gait.orbit.beta_dot_after_impact - 1.0)
