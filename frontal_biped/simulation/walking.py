"""Gait, controller and simulator together: walk a gait in the full model."""

from collections.abc import Callable
from dataclasses import asdict, replace
from typing import Any, cast

from frontal_biped.control.controller import QpController
from frontal_biped.control.interface import Contract, Controller, Tickable
from frontal_biped.control.joint_law import JointLaw, is_joint_law
from frontal_biped.control.settings import ControllerSettings, sampled_frequency
from frontal_biped.control.stabilisers.by_name import make_stabiliser, make_stabilisers
from frontal_biped.control.stabilisers.transitions import Stabiliser
from frontal_biped.control.steps_in_turn import StepsInTurn
from frontal_biped.control.walker.law_walker import LawWalker
from frontal_biped.control.walker.walker import Walker
from frontal_biped.exceptions import ControllerError, SimulationError
from frontal_biped.gait.file import gait_to_dict
from frontal_biped.gait.given import GaitLike, any_gait_of
from frontal_biped.gait.sideways import AnyGait, SidewaysGait, steps_in_turn
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.catalogue import RobotLike, biped_of
from frontal_biped.model.perturbation import ModelErrors
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.state import State
from frontal_biped.simulation.disturbances import Disturbances
from frontal_biped.simulation.event_driven import simulate_walk
from frontal_biped.simulation.mujoco.walk import walk_in_mujoco
from frontal_biped.simulation.sensed import walk_sensed
from frontal_biped.simulation.settings import PERIOD, SimulationSettings
from frontal_biped.simulation.trajectory import Trajectory


def simulate(
    biped: RobotLike,
    gait: GaitLike,
    *,
    steps: int = 20,
    period: float | None = PERIOD,
    speed_error: float = 0.0,
    stance: Stance = Stance.LEFT,
    stabiliser: Stabiliser | str | None = None,
    disturbances: Disturbances | None = None,
    errors: ModelErrors | None = None,
    controller_settings: ControllerSettings | None = None,
    simulation_settings: SimulationSettings | None = None,
    controller: JointLaw | Tickable | Controller | None = None,
    on_step: Callable[[int], None] | None = None,
) -> Trajectory:
    """Walk a gait in the full model under the QP controller, from its periodic orbit.

    By default, with a control period and no stabiliser, it is the `Walker` that walks, from sensor readings, as in
    `walk`: torques that are held leave errors which phases over beta alone, on gaits of small range, do not survive.

    Args:
        biped: the robot, in any of its views, or by name or path.
        gait: the gait, a design's result, or by name or path. One that travels sideways begins with its wide step: on
            the left foot it goes to the right.
        steps: impacts after which to stop.
        period: control period [s], a zero-order hold; None: the controller acts in continuous time.
        speed_error: relative error of the first post-impact speed, all joints alike, so that the start stays on Z.
        stance: first stance foot.
        stabiliser: of a controller that is told the state: a stabiliser, or one of `STABILISERS` by name; default:
            "adaptive" in continuous time and for a control Lyapunov function, with a period otherwise the walker.
        disturbances: noise, pushes and more; they need a period.
        errors: how the robot that walks differs from ``biped``, which the controller believes in.
        controller_settings: gains and limits; default: the limits of the gait's specification, and with a period the
            gains of `sampled_frequency`.
        simulation_settings: tolerances; ``steps`` and ``period`` above take precedence.
        controller: your own in place of the QP's, to which stabiliser and settings belong: a function of (t, q, v)
            that returns torques by joint name, as `joint_law` says, or an object with ``tick`` and ``reset`` as
            `Walker`, both asked every ``period`` (`PERIOD` if None); or with ``begin`` and ``command`` as
            `QpController`.
        on_step: called with the number of completed steps.

    Returns:
        The run; a fall is an outcome, not an error.

    Raises:
        ControllerError: your controller is none of these, fails, or returns no torques; one line.
        RobotError: there is no such robot.
        GaitFileError: there is no such gait.
        DesignFailedError: the design found none.
    """
    biped, gait = biped_of(biped), any_gait_of(gait)
    base = simulation_settings or SimulationSettings()
    settings = replace(base, steps=steps, period=period, disturbances=disturbances or base.disturbances)
    if controller is not None:
        start, told = start_state(gait, speed_error), gait_to_dict(gait)
        return _under(controller, biped, start, settings, errors=errors, stance=stance, on_step=on_step, gait=told)
    linearising = controller_settings is None or controller_settings.outputs == "linearising"
    if stabiliser is None and period is not None and linearising:
        return _walked(biped, gait, "ours", settings, speed_error, stance, None, errors, controller_settings, on_step)
    program, name = _told(biped, gait, stabiliser, controller_settings or sampled_settings(gait, period))
    controllers = program.controllers if isinstance(program, StepsInTurn) else (program,)
    stored = {**asdict(controllers[0].settings), "speed_error": speed_error, "stabiliser": name}
    run = simulate_walk(
        biped,
        program,
        start_state(gait, speed_error),
        settings,
        errors=errors,
        stance=stance,
        on_step=on_step,
        gait=gait_to_dict(gait),
        controller_settings=stored,
    )
    counters = ("ticks", "unsolved", "relaxed", "held", "declined")
    counted = {**stored, **{name: sum(getattr(one, name) for one in controllers) for name in counters}}
    return replace(run, settings={**run.settings, "controller": counted})


def _told(
    biped: FrontalBiped, gait: AnyGait, stabiliser: Stabiliser | str | None, settings: ControllerSettings
) -> tuple[QpController | StepsInTurn, str]:
    """A controller that is told the state, and the name of its stabiliser."""
    if isinstance(gait, SidewaysGait):
        chosen = make_stabilisers(stabiliser or "re-anchored", biped, gait.steps)
        pairs = zip(gait.steps, chosen, strict=True)
        return StepsInTurn([QpController(biped, step, settings, by) for step, by in pairs]), chosen[0].name
    stabiliser = stabiliser or "adaptive"
    by = make_stabiliser(stabiliser, biped, gait) if isinstance(stabiliser, str) else stabiliser
    return QpController(biped, gait, settings, by), by.name


def _under(own: object, biped: FrontalBiped, start: State, settings: SimulationSettings, **options: Any) -> Trajectory:
    """A walk under the user's controller, asked by the contract that it keeps; ``options`` as `simulate_walk`."""
    contract = Contract.of(own)
    if contract is Contract.TOLD:
        return simulate_walk(biped, cast("Controller", own), start, settings, **options)
    sampled = replace(settings, period=settings.period or PERIOD)
    if contract is None and is_joint_law(own):
        own = LawWalker(biped, own, sampled.period or PERIOD)
    elif contract is None:
        raise ControllerError(
            f"controller = {type(own).__name__}: no controller; give a function of (t, q, v) that returns torques by"
            " joint name, or an object with tick and reset as Walker has, or begin and command as QpController has"
        )
    return walk_sensed(biped, cast("Tickable", own), start, sampled, **options)


def start_state(gait: AnyGait, speed_error: float = 0.0) -> State:
    """State on the periodic orbit right after an impact, all speeds off by a relative error."""
    q, dq = gait.state_after_impact()
    return State(q, (1.0 + speed_error) * dq)


def walk(
    biped: FrontalBiped,
    gait: AnyGait,
    *,
    engine: str = "mujoco",
    steps: int = 20,
    period: float = PERIOD,
    speed_error: float = 0.0,
    stance: Stance = Stance.LEFT,
    stabiliser: Stabiliser | str | None = None,
    disturbances: Disturbances | None = None,
    errors: ModelErrors | None = None,
    controller_settings: ControllerSettings | None = None,
    on_step: Callable[[int], None] | None = None,
) -> Trajectory:
    """Walk a gait under a `Walker`, which sees sensor readings only, in MuJoCo or in our own simulator.

    Args:
        biped: the robot as the walker believes it to be.
        gait: the gait.
        engine: "mujoco" (extra ``mujoco``) or "ours".
        steps: landings after which to stop.
        period: control period [s].
        speed_error: relative error of the first post-impact speed.
        stance: first stance foot.
        stabiliser: a stabiliser, or one of `STABILISERS` by name; default: the walker's own.
        disturbances: noise, delay, pushes, ground; the walker knows the delay.
        errors: how the robot that walks differs from ``biped``.
        controller_settings: gains and limits; default: the walker's own.
        on_step: called with the number of completed steps.

    Returns:
        The run; a fall is an outcome, not an error.

    Raises:
        MissingExtraError: MuJoCo is not installed.
        SimulationError: the engine is unknown.
    """
    if engine not in ENGINES:
        raise SimulationError(f"no engine {engine!r}; known: {', '.join(ENGINES)}")
    settings = SimulationSettings(steps=steps, period=period, disturbances=disturbances or Disturbances())
    return _walked(biped, gait, engine, settings, speed_error, stance, stabiliser, errors, controller_settings, on_step)


def _walked(
    biped: FrontalBiped,
    gait: AnyGait,
    engine: str,
    settings: SimulationSettings,
    speed_error: float,
    stance: Stance,
    stabiliser: Stabiliser | str | None,
    errors: ModelErrors | None,
    controller_settings: ControllerSettings | None,
    on_step: Callable[[int], None] | None,
) -> Trajectory:
    """A `Walker` in an engine; it knows the delay."""
    assert settings.period is not None
    period = settings.period
    delay = period * settings.disturbances.delay_ticks(period)
    walker = Walker(biped, gait, period=period, settings=controller_settings, stabiliser=stabiliser, delay=delay)
    return ENGINES[engine](
        biped,
        walker,
        start_state(gait, speed_error),
        settings,
        errors=errors,
        stance=stance,
        on_step=on_step,
        gait=gait_to_dict(gait),
    )


ENGINES: dict[str, Callable[..., Trajectory]] = {"ours": walk_sensed, "mujoco": walk_in_mujoco}


def sampled_settings(gait: AnyGait, period: float | None, **changes: Any) -> ControllerSettings:
    """Limits of the gait's specification, and with a period the gains of `sampled_frequency`.

    Args:
        gait: the gait.
        period: control period [s]; None: continuous control.
        changes: other fields of the settings.
    """
    settings = replace(ControllerSettings.for_gait(steps_in_turn(gait)[0]), **changes)
    return settings if period is None else replace(settings, frequency=sampled_frequency(period))
