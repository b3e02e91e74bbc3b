"""Pushes in the full model at 1 kHz: the largest one survived at an instant of the step.

The ground holds what it can and no more: a stance foot slips at the gait's own coefficient of friction, and rolls over
its edge where the FRI leaves the sole. Either is a fall, as in the closed form, which keeps every contact constraint.

The largest push is found between two walks of neighbouring pushes, one that recovers and one that falls. Where to look
for them is read off the first moments of other walks: most robots that a push fells fall during it, and of those that
are about to tip over their stance foot the closed form says so (`tipping`).
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from frontal_biped.analysis.tipping import comes_over_the_barrier
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
from frontal_biped.simulation.sampled_walk import SampledWalk
from frontal_biped.simulation.settings import SimulationSettings
from frontal_biped.simulation.trajectory import COMPLETED, Trajectory
from frontal_biped.simulation.walking import sampled_settings, start_state
from frontal_biped.virtual_constraints.phase import StepPhase
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

PUSHES = (0.0, 8.0, 16.0, 32.0, 64.0)
"""None, and ends of the ranges that are refined to the resolution; beyond the last nobody looks [N s]."""

SETTLED = 0.15
"""How long after the beginning of a push the outputs are back, so that the closed form can be asked [s]."""

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
    sizes = push_sizes(resolution)
    return tuple(_largest(walks, sizes, instant, direction) for direction in DIRECTIONS)


def _largest(walks: "PushedWalks", sizes: list[float], instant: str, direction: str) -> PushOutcome:
    """In one direction, of pushes in order; where one is survived those below it are taken to be."""
    # the left foot stands first: outwards is to the left
    sign = 1.0 if direction == "outwards" else -1.0
    steps, why = 0, "nothing up to the end of the search"

    def survives(place: int) -> bool:
        nonlocal steps, why
        obstacle, count = walks.fate(sign * sizes[place])
        if obstacle:
            why = obstacle
        else:
            steps = count
        return not obstacle

    good, bad = 0, len(sizes)
    place = last_true(lambda place: walks.promises(sign * sizes[place]), good, bad)
    for _ in range(2):  # two neighbours settle it, where the promise is kept or all but kept
        if good < place < bad:
            good, bad, place = (place, bad, place + 1) if survives(place) else (good, place, place - 1)
    return PushOutcome(instant, direction, sizes[last_true(survives, good, bad)], steps, why)


def last_true(holds: Callable[[int], bool], good: int, bad: int) -> int:
    """The last number below ``bad`` for which something holds that holds from ``good`` up to there; by bisection."""
    while bad - good > 1:
        middle = (good + bad + 1) // 2
        good, bad = (middle, bad) if holds(middle) else (good, middle)
    return good


def push_sizes(resolution: float) -> list[float]:
    """Pushes among which the largest is looked for [N s], in order, from none up."""
    return [PUSHES[0], *(size for ends in pairwise(PUSHES) for size in push_cells(*ends, resolution)[1:])]


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
        self._biped, self._gait, self._start = biped, gait, start
        self._controller = _controller(biped, gait, make_stabiliser(stabiliser, biped, gait))
        settings = _on_its_ground(gait, STEPS_TO_DECIDE, RECORDING)
        self._unpushed = begin_walk(biped, self._controller, start_state(gait), settings, self._recovered)
        self._unpushed.walk_until(start)
        self._begun: dict[float, tuple[SampledWalk, QpController]] = {}

    def promises(self, impulse: float) -> bool:
        """Is the robot on its feet a moment after a push [N s], and does nothing say that it will tip over?"""
        walk, controller = self._walk(impulse)
        walk.walk_until(self._start + SETTLED)
        engine = walk.told.engine
        if walk.outcome is not None or engine.phase is not StepPhase.RISING:
            return walk.outcome in (None, COMPLETED)
        return not comes_over_the_barrier(self._biped, controller.rising, engine.state)

    def fate(self, impulse: float) -> tuple[str, int]:
        """What is in the way of recovery from a push [N s], empty where nothing is; and the steps that it takes."""
        walk, _ = self._walk(impulse)
        outcome, speeds = walk.walk(), np.array(walk.told.speeds)
        if outcome != COMPLETED:
            return outcome, 0
        if not self._recovered(speeds):
            return f"not back within {STEPS_TO_DECIDE} steps", 0
        late = np.flatnonzero(_errors(speeds, self._gait) > RECOVERED)
        return "", int(late[-1]) if len(late) else 0

    def _walk(self, impulse: float) -> tuple[SampledWalk, QpController]:
        """The walk with a push, as far as it has come, and its controller."""
        if impulse not in self._begun:
            push, controller = Push(self._start, PUSH_DURATION, impulse), self._controller.copy()
            self._begun[impulse] = self._unpushed.copy(controller, [push]), controller
        return self._begun[impulse]

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
