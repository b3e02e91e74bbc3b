"""From a scenario to what can be run: robot, gait, and for every trial the disturbances that are drawn for it."""

import json
import threading
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from frontal_biped.design.optimise import design_gait
from frontal_biped.exceptions import DesignFailedError, FrontalBipedError, ScenarioError
from frontal_biped.files.table import Range, draw
from frontal_biped.gait.file import load_gait
from frontal_biped.gait.gait import Gait
from frontal_biped.gait.shipped import load_specification
from frontal_biped.gait.specification import GaitSpecification, default_specification
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.catalogue import load_robot, models_dir
from frontal_biped.model.perturbation import ModelErrors
from frontal_biped.scenarios.scenario import PushPlan, Scenario
from frontal_biped.simulation.disturbances import Disturbances
from frontal_biped.simulation.pushes import Push


@dataclass(frozen=True, eq=False)
class Prepared:
    """A scenario with everything in place that all its trials share.

    Attributes:
        scenario: what is asked.
        biped: the robot as the controller knows it.
        gait: what it walks.
        phase_durations: planned duration of the rising and of the falling phase [s].
    """

    scenario: Scenario
    biped: FrontalBiped
    gait: Gait
    phase_durations: Mapping[str, float]

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
    except FrontalBipedError as error:
        raise ScenarioError(f"{where}: robot = {scenario.robot!r}: {error}") from None
    try:
        gait = _gait(scenario, biped)
    except ScenarioError:
        raise
    except FrontalBipedError as error:
        given = json.dumps(dict(scenario.gait)) if isinstance(scenario.gait, Mapping) else str(scenario.gait)
        raise ScenarioError(f"{where}: gait = {given}: {error}") from None
    step = gait.step(biped)
    durations = {"rising": float(step.rising.duration), "falling": float(step.falling.duration)}
    longest = scenario.steps * sum(durations.values())
    for i, push in enumerate(scenario.pushes):
        time = push.moment.time
        if time is not None and (time.high if isinstance(time, Range) else time) > longest:
            latest = time if isinstance(time, Range) else f"{time:g}"
            raise ScenarioError(
                f"{where}: [[push]] {i + 1}: time = {latest} s: the run of {scenario.steps} steps ends at"
                f" {longest:.3g} s; push earlier or raise steps"
            )
    return Prepared(scenario, biped, gait, durations)


def trial_seed(seed: int, number: int) -> np.random.SeedSequence:
    """Seed of a trial: the ``number``-th child that ``SeedSequence(seed).spawn`` gives."""
    return np.random.SeedSequence(seed, spawn_key=(number,))


def conditions(prepared: Prepared, seed: np.random.SeedSequence) -> Conditions:
    """Draw what one trial is up against; a function of scenario and seed alone."""
    scenario = prepared.scenario
    for_draws, for_model, for_noise = (
        np.random.SeedSequence(seed.entropy, spawn_key=(*seed.spawn_key, i)) for i in range(3)
    )
    generator = np.random.default_rng(for_draws)
    drawn: dict[str, float] = {}

    def pick(name: str, value: Any) -> Any:
        if not isinstance(value, Range):
            return value
        drawn[name] = draw(value, generator)
        return drawn[name]

    speed_error = float(pick("speed_error", scenario.speed_error))
    values = {key: pick(key, scenario.disturbances[key]) for key in sorted(scenario.disturbances)}
    pushes = []
    for i, plan in enumerate(scenario.pushes):
        name = f"push {i + 1} " if len(scenario.pushes) > 1 else "push "
        pushes.append(_push(prepared, plan, lambda key, value, name=name: pick(name + key, value)))
    errors = None
    if scenario.model.any:
        errors = scenario.model.fixed.times(ModelErrors.draw(np.random.default_rng(for_model), **scenario.model.within))
    # one whole number, which a run file keeps
    noise_seed = int(for_noise.generate_state(1, np.uint64)[0] >> 1)
    return Conditions(speed_error, errors, Disturbances(**values, pushes=tuple(pushes), seed=noise_seed), drawn)


def _push(prepared: Prepared, plan: PushPlan, pick: Any) -> Push:
    moment = plan.moment
    shape = (float(pick("duration", plan.duration)), float(pick("impulse", plan.impulse)), plan.profile, plan.height)
    if moment.time is not None:
        return Push(float(pick("time", moment.time)), *shape)
    start = moment.fraction * prepared.phase_durations[moment.phase]
    return Push(start, *shape, step=moment.step - 1, phase=moment.phase)


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
    result = design_gait(load_robot(robot), GaitSpecification.from_dict(json.loads(specification), "[gait]"))
    if result.gait is None or not result.success:
        raise DesignFailedError(f"no gait is found for {robot!r}, {result.message}")
    return result.gait
