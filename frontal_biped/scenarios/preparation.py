"""From a scenario to what can be run: robot, gait, and for every trial the disturbances that are drawn for it."""

import json
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from frontal_biped.design.optimise import optimise_gait
from frontal_biped.exceptions import DesignFailedError, FrontalBipedError, ScenarioError
from frontal_biped.files.counted import counted
from frontal_biped.files.table import Range, draw
from frontal_biped.gait.file import load_gait
from frontal_biped.gait.gait import Gait
from frontal_biped.gait.shipped import load_specification
from frontal_biped.gait.specification import GaitSpecification, default_specification
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.catalogue import load_robot, models_dir
from frontal_biped.model.perturbation import ModelErrors
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.scenarios.scenario import Moment, PushPlan, Scenario, SpacePlan
from frontal_biped.simulation.disturbances import Disturbances
from frontal_biped.simulation.pushes import Push
from frontal_biped.simulation.space.pushes import link_place

Picker = Callable[[str, Any], Any]
"""Called with a name and a value that may be a range; see `Draws.pick`."""


@dataclass(frozen=True, eq=False)
class Prepared:
    """A scenario with everything in place that all its trials share.

    Attributes:
        scenario: what is asked.
        biped: the robot as the controller knows it.
        gait: what it walks.
        phase_durations: planned duration of the rising and of the falling phase [s].
        free: the whole robot, where it walks in space; None in the plane.
    """

    scenario: Scenario
    biped: FrontalBiped
    gait: Gait
    phase_durations: Mapping[str, float]
    free: FreeRobot | None = None

    @property
    def step_duration(self) -> float:
        """Planned duration of a step [s]."""
        return sum(self.phase_durations.values())


@dataclass(frozen=True, eq=False)
class Conditions:
    """What one trial is up against.

    Attributes:
        speed_error: relative error of the first post-impact speed [-].
        errors: of the robot; None: none.
        disturbances: noise, pushes and ground.
        drawn: the numbers drawn from ranges, for the report.
    """

    speed_error: float
    errors: ModelErrors | None
    disturbances: Disturbances
    drawn: Mapping[str, float]


def prepare(scenario: Scenario) -> Prepared:
    """Load the robot; load or design the gait.

    Raises:
        ScenarioError: the robot or the gait cannot be had, or a push comes after the end; one line with file, field,
            value and remedy.
    """
    where = scenario.path
    try:
        biped = _robot(scenario.robot, threading.get_ident())
        free = None if scenario.space is None else _free_robot(scenario.robot, threading.get_ident())
    except FrontalBipedError as error:
        raise ScenarioError(f"{where}: robot = {scenario.robot!r}: {error}") from None
    try:
        gait = _gait(scenario, biped)
    except ScenarioError:
        raise
    except FrontalBipedError as error:
        given = json.dumps(dict(scenario.gait)) if isinstance(scenario.gait, Mapping) else str(scenario.gait)
        raise ScenarioError(f"{where}: gait = {given}: {error}") from None
    if scenario.space is not None and free is not None:
        _check_links(where, scenario.space, free)
    step = gait.step(biped)
    durations = {"rising": float(step.rising.duration), "falling": float(step.falling.duration)}
    longest = scenario.steps * sum(durations.values())
    for i, moment in enumerate(scenario.push_moments):
        time = moment.time
        if time is not None and (time.high if isinstance(time, Range) else time) > longest:
            latest = time if isinstance(time, Range) else f"{time:g}"
            raise ScenarioError(
                f"{where}: [[push]] {i + 1}: time = {latest} s: the run of {counted(scenario.steps, 'step')} ends at"
                f" {longest:.3g} s; push earlier or raise steps"
            )
    return Prepared(scenario, biped, gait, durations, free)


def _check_links(where: Path, plan: SpacePlan, free: FreeRobot) -> None:
    for i, push in enumerate(plan.pushes):
        try:
            link_place(free, push.link)
        except FrontalBipedError as error:
            raise ScenarioError(f"{where}: [[push]] {i + 1}: {error}") from None


def trial_seed(seed: int, number: int) -> np.random.SeedSequence:
    """Seed of a trial: the ``number``-th child that ``SeedSequence(seed).spawn`` gives."""
    return np.random.SeedSequence(seed, spawn_key=(number,))


class Draws:
    """What one trial draws, a function of its seed alone.

    Args:
        seed: of the trial.

    Attributes:
        drawn: numbers drawn from ranges, by name.
        for_model: random numbers of model errors.
        noise_seed: of noise and ground; one whole number, which a run file keeps.
    """

    def __init__(self, seed: np.random.SeedSequence) -> None:
        for_draws, for_model, for_noise = (
            np.random.SeedSequence(seed.entropy, spawn_key=(*seed.spawn_key, i)) for i in range(3)
        )
        self._generator = np.random.default_rng(for_draws)
        self.for_model = np.random.default_rng(for_model)
        self.noise_seed = int(for_noise.generate_state(1, np.uint64)[0] >> 1)
        self.drawn: dict[str, float] = {}

    def pick(self, name: str, value: Any) -> Any:
        """The value, or a number drawn from it if it is a range."""
        if not isinstance(value, Range):
            return value
        self.drawn[name] = draw(value, self._generator)
        return self.drawn[name]

    def named(self, what: str, index: int, count: int) -> Picker:
        """`pick` for the parts of one of several things."""
        name = f"{what} {index + 1} " if count > 1 else f"{what} "
        return lambda key, value: self.pick(name + key, value)


def conditions(prepared: Prepared, seed: np.random.SeedSequence) -> Conditions:
    """Draw what one trial is up against; a function of scenario and seed alone."""
    scenario = prepared.scenario
    draws = Draws(seed)
    pick = draws.pick
    speed_error = float(pick("speed_error", scenario.speed_error))
    values = {key: pick(key, scenario.disturbances[key]) for key in sorted(scenario.disturbances)}
    pushes = []
    for i, plan in enumerate(scenario.pushes):
        pushes.append(_push(prepared, plan, draws.named("push", i, len(scenario.pushes))))
    errors = None
    if scenario.model.any:
        errors = scenario.model.fixed.times(ModelErrors.draw(draws.for_model, **scenario.model.within))
    disturbances = Disturbances(**values, pushes=tuple(pushes), seed=draws.noise_seed)
    return Conditions(speed_error, errors, disturbances, draws.drawn)


def _push(prepared: Prepared, plan: PushPlan, pick: Picker) -> Push:
    shape = (float(pick("duration", plan.duration)), float(pick("impulse", plan.impulse)), plan.profile, plan.height)
    begins = start_of_push(prepared, plan.moment, pick)
    return Push(begins.start, *shape, step=begins.step, phase=begins.phase)


class PushStart(NamedTuple):
    """When a push begins, as `Push` has it.

    Attributes:
        start: after the start of the run, or of a phase [s].
        step: index of the step, from 0; None: of the run.
        phase: of that step.
    """

    start: float
    step: int | None = None
    phase: str | None = None


def start_of_push(prepared: Prepared, moment: Moment, pick: Picker) -> PushStart:
    """When a push begins; a time may be drawn."""
    if moment.time is not None:
        return PushStart(float(pick("time", moment.time)))
    return PushStart(moment.fraction * prepared.phase_durations[moment.phase], moment.step - 1, moment.phase)


@lru_cache(maxsize=32)
def _free_robot(name: str, thread: int) -> FreeRobot:
    return FreeRobot(_robot(name, thread).robot)


@lru_cache(maxsize=32)
def _robot(name: str, thread: int) -> FrontalBiped:
    """A robot of one thread: its work data cannot be shared."""
    return load_robot(name)


def _gait(scenario: Scenario, biped: FrontalBiped) -> Gait:
    given = scenario.gait
    if isinstance(given, Mapping):
        specification = GaitSpecification.from_dict(dict(given), "[gait]")
        return _designed(scenario.robot, json.dumps(specification.as_dict()))
    if given is None:
        shipped = models_dir() / f"{biped.name}.gait.json"
        if shipped.is_file():
            return _fitting(load_gait(shipped), biped, scenario)
        return _designed(scenario.robot, json.dumps(default_specification(biped).as_dict()))
    if Path(given).suffix == ".json":
        return _fitting(load_gait(Path(given)), biped, scenario)
    return _designed(scenario.robot, json.dumps(load_specification(given).as_dict()))


def _fitting(gait: Gait, biped: FrontalBiped, scenario: Scenario) -> Gait:
    if gait.robot.fingerprint != biped.fingerprint:
        raise ScenarioError(
            f"{scenario.path}: gait = {scenario.gait}: was designed for {gait.robot.name!r} with another URDF or"
            f" description than {biped.name!r}; design it again with `frontal-biped design --robot {scenario.robot}`"
        )
    return gait


@lru_cache(maxsize=32)
def _designed(robot: str, specification: str) -> Gait:
    result = optimise_gait(load_robot(robot), GaitSpecification.from_dict(json.loads(specification), "[gait]"))
    if result.gait is None or not result.success:
        raise DesignFailedError(f"no gait is found for {robot!r}, {result.message}")
    return result.gait
