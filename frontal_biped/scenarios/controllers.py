"""The controller of a trial: one of the package's, or the user's own by "module:factory"."""

import contextlib
import importlib
import sys
from collections.abc import Callable
from dataclasses import replace
from types import ModuleType
from typing import Any

from frontal_biped.control.controller import QpController
from frontal_biped.control.interface import Contract
from frontal_biped.control.joint_law import is_joint_law
from frontal_biped.control.settings import ControllerSettings, sampled_frequency
from frontal_biped.control.stabilisers.by_name import make_stabiliser
from frontal_biped.control.walker.law_walker import LawWalker
from frontal_biped.control.walker.walker import Walker
from frontal_biped.exceptions import FrontalBipedError, ScenarioError
from frontal_biped.scenarios.preparation import Conditions, Prepared
from frontal_biped.scenarios.scenario import Scenario
from frontal_biped.scenarios.user_code import guarded, users_own

QP_STABILISER = "ankle+step"
"""Of the controller that is told state and events, where the scenario names none."""

Factory = Callable[..., Any]
"""Called with robot, gait and ``period``, and the arguments of the scenario; returns a controller.

A controller has ``tick(reading)`` and ``reset(stance, q, dq)`` as `Walker`, or ``begin(phase, q, dq)`` and
``command(phase, q, dq)`` as `QpController`, or is a function of (t, q, v) as `joint_law` says; the latter needs no
factory.
"""


def make_controller(
    prepared: Prepared, conditions: Conditions, own: Factory | object | None = None
) -> tuple[Any, Contract]:
    """The controller of one trial, and how it is asked.

    Args:
        prepared: scenario, robot and gait.
        conditions: of the trial; the walker knows the delay.
        own: a controller, or a factory of one, that takes the place of the scenario's.

    Raises:
        ScenarioError: the user's module or factory cannot be used; one line with the reason.
    """
    scenario = prepared.scenario
    choice = scenario.controller
    if own is None and choice.kind == "qp":
        stabiliser = make_stabiliser(choice.stabiliser or QP_STABILISER, prepared.biped, prepared.gait)
        return QpController(prepared.biped, prepared.gait, _settings(prepared), stabiliser), Contract.TOLD
    if own is None and choice.kind == "walker":
        delay = conditions.disturbances.delay if choice.delay is None else choice.delay
        # what the scenario leaves open is the walker's own choice
        named: dict[str, Any] = {} if choice.stabiliser is None else {"stabiliser": choice.stabiliser}
        if choice.settings:
            named["settings"] = _settings(prepared)
        delay = choice.period * round(delay / choice.period)
        walker = Walker(prepared.biped, prepared.gait, period=choice.period, delay=delay, **named)
        return walker, Contract.SENSED
    where = f"{scenario.path}: controller = {choice.kind!r}" if own is None else "the controller given"
    factory = named_factory(scenario) if own is None else own
    if Contract.of(factory) is None and not is_joint_law(factory):
        if not callable(factory):
            raise ScenarioError(f"{where}: {type(factory).__name__} is no factory; name a function of (robot, gait)")
        factory = made_by(factory, where, (prepared.biped, prepared.gait), scenario, "(robot, gait, period=...)")
    if Contract.of(factory) is None and is_joint_law(factory):
        factory = LawWalker(prepared.biped, factory, choice.period)
    contract = Contract.of(factory)
    if contract is None:
        raise ScenarioError(
            f"{where}: {type(factory).__name__} is no controller; give it tick and reset as Walker has,"
            " or begin and command as QpController has, or make it a function of (t, q, v)"
        )
    if scenario.simulator == "mujoco" and contract is Contract.TOLD:
        raise ScenarioError(
            f"{where}: begin and command are told state and events, which only our simulator can;"
            ' give it tick and reset as Walker has, or write simulator = "ours"'
        )
    return guarded(factory, where), contract


def made_by(factory: Factory, where: str, given: tuple[Any, ...], scenario: Scenario, called_as: str) -> Any:
    """The controller that a user's factory makes.

    Args:
        factory: to call.
        where: begins every complaint.
        given: its first arguments.
        scenario: with the others.
        called_as: for the complaint.

    Raises:
        ScenarioError: it raised something; one line.
    """
    remedy = f"it is called as {called_as}"
    try:
        with users_own(where, "the factory", remedy):
            return factory(*given, period=scenario.controller.period, **dict(scenario.controller.arguments))
    except ScenarioError as error:
        if isinstance(error.__cause__, TypeError):  # called with other arguments, most likely
            raise ScenarioError(f"{where}: the factory refused, {error.__cause__}; {remedy}") from error.__cause__
        raise
    except FrontalBipedError as error:
        raise ScenarioError(f"{where}: the factory refused, {error}; {remedy}") from None


def _settings(prepared: Prepared) -> ControllerSettings:
    choice = prepared.scenario.controller
    base = replace(ControllerSettings.for_gait(prepared.gait), frequency=sampled_frequency(choice.period))
    try:
        return replace(base, **dict(choice.settings))
    except FrontalBipedError as error:
        raise ScenarioError(f"{prepared.scenario.path}: [controller] {error}") from None


def named_factory(scenario: Scenario) -> Factory:
    """The factory named by a scenario; a module beside the scenario file is found there.

    Raises:
        ScenarioError: the module or the factory in it cannot be had; one line.
    """
    where = f"{scenario.path}: controller = {scenario.controller.kind!r}"
    module_name, _, name = scenario.controller.kind.partition(":")
    folder = str(scenario.path.resolve().parent)
    sys.path.insert(0, folder)
    try:
        with users_own(where, "importing it", "mend the module"):
            module = _imported(where, module_name)
    finally:
        with contextlib.suppress(ValueError):  # the module may have done it
            sys.path.remove(folder)
    if not hasattr(module, name):
        raise ScenarioError(f"{where}: module {module_name!r} has no {name!r}; name one of its functions")
    factory: Factory = getattr(module, name)
    return factory


def _imported(where: str, name: str) -> ModuleType:
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise ScenarioError(f"{where}: {error}; put {name}.py beside the scenario or install it") from None
