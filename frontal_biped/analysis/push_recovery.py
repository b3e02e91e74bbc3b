"""Pushes in the full model at 1 kHz: the largest one survived at an instant of the step.

The ground holds what it can and no more: a stance foot slips at the gait's own coefficient of friction, and rolls over
its edge where the FRI leaves the sole. Either is a fall, as in the closed form, which keeps every contact constraint.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.controller import QpController
from frontal_biped.control.stabilisers.by_name import make_stabiliser
from frontal_biped.control.stabilisers.transitions import Stabiliser
from frontal_biped.gait.file import gait_to_dict
from frontal_biped.gait.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.simulation.disturbances import Disturbances
from frontal_biped.simulation.event_driven import begin_walk, simulate_walk
from frontal_biped.simulation.pushes import Push
from frontal_biped.simulation.settings import SimulationSettings
from frontal_biped.simulation.trajectory import COMPLETED, Trajectory
from frontal_biped.simulation.walking import sampled_settings, start_state
from frontal_biped.zero_dynamics.poincare import StepOrbit

PERIOD = 1e-3  # [s]
PUSH_DURATION = 0.05  # [s]

INSTANTS = (("just after the impact", 0.02), ("half-way up", 0.5), ("at the reversal", 1.0), ("half-way down", 1.5))
"""Name and place in the step: 0 impact, 1 reversal, 2 next impact, by time within each phase."""

DIRECTIONS = ("outwards", "inwards")
"""Away from the first swing foot, and towards it."""

STEPS_TO_DECIDE = 6
"""Steps walked at most to see whether the speed is back."""

AT_THE_GAIT = 2
"""Landings on end at the gait's speed after which a pushed walk is the gait's."""

RECOVERED = 0.05
"""Relative error of the post-impact speed that counts as recovered; 1 kHz control alone costs 0.003."""

PUSHES = (64.0, 32.0, 16.0, 8.0)
"""Tried first, until one is survived; the largest is between that and the one before [N s]."""

FROM_BELOW = 0.7
"""Where in what is left of a search the next push is tried: one that fells takes a fifth of the walking of another."""

PUSH_RESOLUTION = 1.0  # [N s], or a tenth of the push

RECORDING = SimulationSettings(record_rate=1.0)
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


def largest_pushes(
    biped: FrontalBiped,
    gait: Gait,
    stabiliser: str,
    instant: str,
    place: float,
    resolution: float = PUSH_RESOLUTION,
) -> tuple[PushOutcome, ...]:
    """The largest push survived at an instant of the first step, in each of `DIRECTIONS`.

    Args:
        biped: the robot.
        gait: the gait.
        stabiliser: by name.
        instant: what the place is called.
        place: 0 impact, 1 reversal, 2 next impact.
        resolution: of the impulse [N s]; a tenth of it is enough in any case.
    """
    walks = PushedWalks(biped, gait, stabiliser, time_in_step(gait.step(biped), place))
    return tuple(_largest(walks, instant, direction, resolution) for direction in DIRECTIONS)


def _largest(walks: "PushedWalks", instant: str, direction: str, resolution: float) -> PushOutcome:
    """In one direction; where a push is survived those below it are taken to be."""
    # the left foot stands first: outwards is to the left
    sign = 1.0 if direction == "outwards" else -1.0
    good, bad, steps, why = 0.0, np.inf, 0, "nothing up to the end of the search"

    def survives(size: float) -> bool:
        nonlocal good, bad, steps, why
        obstacle, count = walks.fate(sign * size)
        if obstacle:
            bad, why = size, obstacle
        else:
            good, steps = size, count
        return not obstacle

    # from the largest down: a robot that a push fells falls soon, and one that recovers is walked for steps
    for size in PUSHES:
        if survives(size):
            break
    between = push_cells(good, bad, resolution)[1:-1] if np.isfinite(bad) else []
    while between:
        place = int(FROM_BELOW * len(between))
        between = between[place + 1 :] if survives(between[place]) else between[:place]
    return PushOutcome(instant, direction, good, steps, why)


def push_cells(good: float, bad: float, resolution: float) -> list[float]:
    """Ends of the cells in which a bisection between two pushes could end [N s], in order."""
    if bad - good <= max(resolution, 0.1 * good):
        return [good, bad]
    middle = 0.5 * (good + bad)
    return [*push_cells(good, middle, resolution), *push_cells(middle, bad, resolution)[1:]]


class PushedWalks:
    """Walks of the gait that differ by a push at one instant of the first step: up to it they are one walk.

    Args:
        biped: the robot.
        gait: the gait.
        stabiliser: by name.
        start: of the pushes [s].
    """

    def __init__(self, biped: FrontalBiped, gait: Gait, stabiliser: str, start: float) -> None:
        self._gait, self._start = gait, start
        self._controller = _controller(biped, gait, make_stabiliser(stabiliser, biped, gait))
        settings = _on_its_ground(gait, STEPS_TO_DECIDE, RECORDING)
        self._unpushed = begin_walk(biped, self._controller, start_state(gait), settings, self._recovered)
        self._unpushed.walk_until(start)

    def fate(self, impulse: float) -> tuple[str, int]:
        """What is in the way of recovery from a push [N s], empty where nothing is; and the steps that it takes."""
        push = Push(self._start, PUSH_DURATION, impulse)
        walk = self._unpushed.copy(self._controller.copy(), [push])
        outcome, speeds = walk.walk(), np.array(walk.told.speeds)
        if outcome != COMPLETED:
            return outcome, 0
        if not self._recovered(speeds):
            return f"not back within {STEPS_TO_DECIDE} steps", 0
        late = np.flatnonzero(_errors(speeds, self._gait) > RECOVERED)
        return "", int(late[-1]) if len(late) else 0

    def _recovered(self, speeds: FloatArray) -> bool:
        landings = _errors(speeds, self._gait)[1:]
        return len(landings) >= AT_THE_GAIT and not np.any(landings[-AT_THE_GAIT:] > RECOVERED)


def held_walk(
    biped: FrontalBiped,
    gait: Gait,
    stabiliser: Stabiliser | str,
    *pushes: Push,
    steps: int,
    speed_error: float = 0.0,
    simulation_settings: SimulationSettings | None = None,
    **options: Any,
) -> Trajectory:
    """A walk at `PERIOD` on ground that holds what it can: the gait's friction, and a FRI within the sole.

    Args:
        biped: the robot.
        gait: the gait.
        stabiliser: itself or by name.
        pushes: on the way.
        steps: impacts after which to stop.
        speed_error: relative error of the first post-impact speed [-].
        simulation_settings: how to record.
        options: of `simulate_walk`.

    Returns:
        The run; to slip and to roll over an edge are falls.
    """
    settings = _on_its_ground(gait, steps, simulation_settings or SimulationSettings(), pushes)
    by = make_stabiliser(stabiliser, biped, gait) if isinstance(stabiliser, str) else stabiliser
    start, told = start_state(gait, speed_error), gait_to_dict(gait)
    return simulate_walk(biped, _controller(biped, gait, by), start, settings, gait=told, **options)


def _on_its_ground(
    gait: Gait, steps: int, recording: SimulationSettings, pushes: tuple[Push, ...] = ()
) -> SimulationSettings:
    """Settings of a walk on ground that holds what it can."""
    ground = Disturbances(pushes=pushes, friction=(1.0 + HELD) * gait.specification.friction, rolls=True)
    return replace(recording, steps=steps, period=PERIOD, disturbances=ground)


def _controller(biped: FrontalBiped, gait: Gait, stabiliser: Stabiliser) -> QpController:
    return QpController(biped, gait, sampled_settings(gait, PERIOD), stabiliser)


def time_in_step(step: StepOrbit, place: float) -> float:
    """When a place of the step is reached, from the impact that begins it [s]; see `INSTANTS`."""
    up, down = step.rising.duration, step.falling.duration
    return place * up if place <= 1.0 else up + (place - 1.0) * down


def speed_errors(run: Trajectory, gait: Gait) -> FloatArray:
    """(k,) relative errors of the post-impact speeds of a run, unsigned [-]."""
    return _errors(run.post_impact_speeds, gait)


def _errors(speeds: FloatArray, gait: Gait) -> FloatArray:
    errors: FloatArray = np.abs(speeds / gait.orbit.beta_dot_after_impact - 1.0)
    return errors
