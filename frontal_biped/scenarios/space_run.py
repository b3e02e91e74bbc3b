"""One trial of a walk of the whole robot in space: what it is up against, who controls it, and the walk."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np

from frontal_biped.control.joint_law import is_joint_law
from frontal_biped.control.spatial_walker.interface import SpatialTickable
from frontal_biped.control.spatial_walker.law_walker import SpatialLawWalker
from frontal_biped.control.spatial_walker.path_walker import PathWalker
from frontal_biped.control.spatial_walker.walker import SpatialWalker
from frontal_biped.control.whole_body.settings import WholeBodySettings
from frontal_biped.exceptions import FrontalBipedError, ScenarioError
from frontal_biped.gait.file import gait_to_dict
from frontal_biped.model.space.errors import SpatialErrors
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.model.stance_map import Stance
from frontal_biped.scenarios.controllers import Factory, made_by, named_factory
from frontal_biped.scenarios.preparation import Draws, Picker, Prepared, start_of_push
from frontal_biped.scenarios.scenario import CommandPlan, SpacePlan, SpatialPushPlan
from frontal_biped.scenarios.user_code import guarded
from frontal_biped.simulation.disturbances import Disturbances
from frontal_biped.simulation.space.pushes import SpatialPush
from frontal_biped.simulation.space.run import SpatialRun
from frontal_biped.simulation.space.settings import SpatialSettings, SpeedChange
from frontal_biped.simulation.space.start import standing_in_space, start_in_space
from frontal_biped.simulation.space.walk_path import path_walker, with_path
from frontal_biped.simulation.space.walking import walk_in_space
from frontal_biped.simulation.walking import start_state


@dataclass(frozen=True, eq=False)
class SpatialConditions:
    """What one trial in space is up against.

    Attributes:
        speed_error: relative error of the first frontal speed [-].
        errors: of the robot; None: none.
        settings: of the walk.
        drawn: the numbers drawn from ranges, for the report.
    """

    speed_error: float
    errors: SpatialErrors | None
    settings: SpatialSettings
    drawn: Mapping[str, float]


def spatial_conditions(prepared: Prepared, seed: np.random.SeedSequence) -> SpatialConditions:
    """Draw what one trial in space is up against; a function of scenario and seed alone."""
    scenario, free, plan = prepared.scenario, *in_space(prepared)
    draws = Draws(seed)
    speed_error = float(draws.pick("speed_error", scenario.speed_error))
    values = {key: draws.pick(key, scenario.disturbances[key]) for key in sorted(scenario.disturbances)}
    settings = SpatialSettings(
        steps=scenario.steps,
        period=scenario.controller.period,
        disturbances=Disturbances(**values, seed=draws.noise_seed),
        velocity_noise=draws.pick("velocity_noise", plan.velocity_noise),
        pushes=tuple(
            _push(prepared, push, draws.named("push", i, len(plan.pushes))) for i, push in enumerate(plan.pushes)
        ),
        commands=tuple(
            _command(command, draws.named("command", i, len(plan.commands))) for i, command in enumerate(plan.commands)
        ),
    )
    errors = None
    if plan.factors or any(plan.within.values()):
        errors = SpatialErrors.draw(draws.for_model, 1 + len(free.joint_names), **plan.within)
        errors = replace(errors, **{key: factor * getattr(errors, key) for key, factor in plan.factors.items()})
    return SpatialConditions(speed_error, errors, settings, draws.drawn)


def _push(prepared: Prepared, plan: SpatialPushPlan, pick: Picker) -> SpatialPush:
    duration = float(pick("duration", plan.duration))
    sizes = [float(pick(name, value)) for name, value in zip(_names(plan), plan.impulse, strict=True)]
    if plan.direction is None:
        forwards, left, up = sizes
    else:
        angle = np.radians(float(pick("direction", plan.direction)))
        forwards, left, up = sizes[0] * np.cos(angle), sizes[0] * np.sin(angle), 0.0
    begins = start_of_push(prepared, plan.moment, pick)
    x, y, z = plan.point
    return SpatialPush(
        begins.start,
        duration,
        (float(forwards), float(left), up),
        plan.link,
        (x, y, z),
        plan.profile,
        begins.step,
        begins.phase,
    )


def _names(plan: SpatialPushPlan) -> tuple[str, ...]:
    return ("impulse",) if plan.direction is not None else ("forwards", "left", "up")


def _command(plan: CommandPlan, pick: Picker) -> SpeedChange:
    speeds = {key: pick(key, getattr(plan, key)) for key in ("speed", "lateral", "turn")}
    return SpeedChange(**speeds, step=plan.step, time=plan.time)


def spatial_walker(
    prepared: Prepared, drawn: SpatialConditions, own: Factory | object | None = None
) -> SpatialTickable:
    """The controller of one trial in space.

    Args:
        prepared: scenario, robot and gait.
        drawn: what the trial is up against; the walker knows the delay.
        own: a controller, or a factory of one, that takes the place of the scenario's; called as (free, biped, gait,
            period=...).

    Raises:
        ScenarioError: the user's module or factory cannot be used; one line with the reason.
    """
    scenario, (free, plan) = prepared.scenario, in_space(prepared)
    choice = scenario.controller
    period = choice.period
    if own is None and choice.kind == "walker":
        delay = drawn.settings.disturbances.delay if choice.delay is None else choice.delay
        settings = WholeBodySettings(**dict(choice.settings)) if choice.settings else None
        delay = period * round(delay / period)
        if plan.path:
            biped, gait = prepared.biped, prepared.gait
            return path_walker(free, biped, gait, plan.path, period=period, delay=delay, settings=settings)
        return SpatialWalker(free, prepared.biped, prepared.gait, period=period, delay=delay, settings=settings)
    where = f"{scenario.path}: controller = {choice.kind!r}" if own is None else "the controller given"
    made: Any = named_factory(scenario) if own is None else own
    if isinstance(made, type) or not (_is_walker(made) or is_joint_law(made)):
        if not callable(made):
            raise ScenarioError(f"{where}: {type(made).__name__} is no factory; name a function of (free, biped, gait)")
        given = (free, prepared.biped, prepared.gait)
        made = made_by(made, where, given, scenario, "(free, biped, gait, period=...)")
    if not _is_walker(made) and is_joint_law(made):
        made = SpatialLawWalker(free, made, period)
    if not _is_walker(made):
        raise ScenarioError(
            f"{where}: {type(made).__name__} is no controller of a walk in space; give it reset, tick and command as"
            " SpatialWalker has, or make it a function of (t, q, v)"
        )
    return cast(SpatialTickable, guarded(made, where))


def _is_walker(thing: object) -> bool:
    return all(hasattr(thing, name) for name in ("reset", "tick", "command"))


def walk_trial(
    prepared: Prepared,
    drawn: SpatialConditions,
    walker: SpatialTickable,
    on_step: Callable[[int], None] | None,
) -> SpatialRun:
    """Walk one trial.

    Raises:
        ScenarioError: the legs do not reach the start of the gait.
    """
    scenario, (free, plan), gait = prepared.scenario, in_space(prepared), prepared.gait
    try:
        if plan.path:
            start = standing_in_space(free, prepared.biped, gait)
        else:
            start = start_in_space(free, prepared.biped, start_state(gait, drawn.speed_error), scenario.stance)
    except FrontalBipedError as error:
        raise ScenarioError(f"{scenario.path}: robot = {scenario.robot!r}: {error}") from None
    run = walk_in_space(
        free,
        walker,
        start,
        drawn.settings,
        stance=Stance.LEFT if plan.path else scenario.stance,
        errors=drawn.errors,
        on_step=on_step,
        gait=gait_to_dict(gait),
    )
    return with_path(run, walker, plan.path) if plan.path and isinstance(walker, PathWalker) else run


def in_space(prepared: Prepared) -> tuple[FreeRobot, SpacePlan]:
    """The whole robot and the plan of a scenario in space."""
    assert prepared.free is not None
    assert prepared.scenario.space is not None
    return prepared.free, prepared.scenario.space
