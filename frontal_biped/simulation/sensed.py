"""A walker in a run: it sees sensor readings only, and phases and stance foot are those that it takes them for.

q, dq, forces and FRI of the recording are the engine's.
"""

from collections.abc import Callable, Mapping
from dataclasses import asdict, is_dataclass
from typing import Any, TypedDict, Unpack

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.answers import check_answer
from frontal_biped.control.interface import PhaseEvent, Tickable, WalkerCommand
from frontal_biped.exceptions import ControllerError
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.perturbation import ModelErrors
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.state import State
from frontal_biped.simulation.engine import Engine, Move
from frontal_biped.simulation.hybrid_system import EventKind
from frontal_biped.simulation.loop import Decision, Steps, run_sampled
from frontal_biped.simulation.measured import Airborne, StepMeter
from frontal_biped.simulation.motors import Motors
from frontal_biped.simulation.pushes import PushForces
from frontal_biped.simulation.recorder import Recorder
from frontal_biped.simulation.rigid import RigidEngine
from frontal_biped.simulation.sensors import Sensors
from frontal_biped.simulation.settings import PERIOD, SimulationSettings
from frontal_biped.simulation.trajectory import Trajectory

RINGING = 0.01
"""Time after a landing when the state after the impact is taken [s]: a soft contact has done its work by then."""

EVENTS = {PhaseEvent.REVERSAL: EventKind.REVERSAL, PhaseEvent.TURNED_OUTWARDS: EventKind.TURNED_OUTWARDS}
"""What a run calls what a walker has noticed."""


class Sensed:
    """The pilot of a walker.

    Args:
        engine: moves the robot.
        biped: the robot of the files.
        walker: answers readings.
        settings: period, recording and disturbances.
        steps: counts and tells.
        recorder: of samples and events.
    """

    def __init__(
        self,
        engine: Engine,
        biped: FrontalBiped,
        walker: Tickable,
        settings: SimulationSettings,
        steps: Steps,
        recorder: Recorder,
    ) -> None:
        self._engine, self._biped, self._walker = engine, biped, walker
        self._steps, self._recorder = steps, recorder
        self._sensors = Sensors(settings.disturbances)
        self._period = settings.period or PERIOD
        self._every = max(1, round(1.0 / (settings.record_rate * self._period)))
        self._ticks = 0
        self._airborne, self._meter = Airborne(self._period), StepMeter(self._period)
        self._impact: tuple[float, int, Stance] | None = None  # whose state is still to be taken

    @property
    def since(self) -> float:
        """When the present step began, as the walker believes [s]: one that rocks on the spot is not walking either."""
        return self._meter.began

    def decide(self, t: float) -> Decision | None:
        """Show the walker what the sensors tell; None after the last landing that it noticed."""
        true = self._engine.read(t)
        command = self._walker.tick(self._sensors.read(true))
        try:
            check_answer(command, "joint_torques", len(true.joint_positions), "tick", t)
        except ControllerError:
            if np.isfinite(true.joint_positions).all():  # of a state that has diverged no controller makes torques
                raise
        if self._impact is not None:
            self.take_impact(t)
        if command.event is not None and self._complete(command.event, command.stance, t):
            return None
        self._airborne.watch(true.contact)
        self._command, self._touching, self._rates = command, true.contact, true.joint_velocities
        return Decision(command.joint_torques)

    def _complete(self, event: PhaseEvent, stance: Stance, t: float) -> bool:
        """Count what the walker has noticed; was that the last landing?"""
        steps = self._steps
        if event is PhaseEvent.LANDING and self._airborne.lands(stance):
            self._meter.end_step()
            self._meter.begin_step(t)
            self._impact = (t, steps.count, stance)
            steps.land(t, stance)
            steps.announce()
            return steps.complete
        if event in EVENTS:
            steps.turn(t, EVENTS[event], stance)
        return False

    def sent(self, t: float, tau: FloatArray) -> None:
        """Measure and record what acts from now on."""
        self._measure(t, tau)
        if self._ticks % self._every == 0 or self._command.event is not None:
            self._sample(t, self._command, tau)
        self._ticks += 1

    def moved(self, move: Move) -> str | None:
        """The walker learns of events from the sensors at its next tick; only a fall ends the walk here."""
        if move.fell is None:
            return None
        if isinstance(move.fell, str):
            return move.fell
        self._steps.fall(self._ticks * self._period, move.fell, self._command.stance)
        return move.fell.value

    def settings(self) -> dict[str, Any]:
        """What the run keeps of the walker and its steps."""
        controller = getattr(getattr(self._walker, "controller", None), "settings", None)
        counters = getattr(self._walker, "counters", dict)
        return {
            "controller": {
                "kind": type(self._walker).__name__,
                **(asdict(controller) if is_dataclass(controller) and not isinstance(controller, type) else {}),
                **counters(),
            },
            "measured": self._meter.measured.summary(),
        }

    # ------------------------------------------------------------------ records
    def take_impact(self, t: float) -> None:
        """Take the state after the last impact, if by time t [s] the contact has done its work."""
        if self._impact is None:
            return
        began, step, stance = self._impact
        if t - began > RINGING:
            self._recorder.event(began, EventKind.IMPACT, step, self._engine.stance_state(stance))
            self._impact = None

    def _measure(self, t: float, tau: FloatArray) -> None:
        assert self._rates is not None  # the engine knows them
        self._meter.drive(tau, self._rates)
        if self._meter.stands(t, self._touching):
            y, rotation = self._engine.foot_position(self._command.stance)
            self._meter.foot((y,), rotation)

    def _sample(self, t: float, command: WalkerCommand, tau: FloatArray) -> None:
        stance = command.stance
        self._recorder.sample(
            t,
            self._engine.stance_state(stance),
            self._biped.stance_map.torques_to_stance(tau, stance),
            self._engine.reaction(stance),
            p_fri_target=command.p_fri_target,
            q_b_desired=command.q[1:] - command.y,
            phase=command.phase,
            stance=stance,
            stance_y=self._engine.foot_position(stance)[0],
            step=self._steps.count,
        )


class WalkOptions(TypedDict, total=False):
    """What every engine's walk may be told besides.

    Attributes:
        stance: the first stance foot; default: the left one.
        on_step: called with the number of completed steps.
        gait: content of the gait file, kept with the run.
    """

    stance: Stance
    on_step: Callable[[int], None] | None
    gait: Mapping[str, Any] | None


def walk_in(
    engine: Engine,
    biped: FrontalBiped,
    walker: Tickable,
    start: State,
    settings: SimulationSettings,
    errors: ModelErrors | None = None,
    **options: Unpack[WalkOptions],
) -> Trajectory:
    """Walk from a state right after an impact, in any engine.

    Args:
        engine: moves the robot.
        biped: the robot of the files.
        walker: answers readings; it may believe in another robot.
        start: state after the impact.
        settings: steps, period, recording and disturbances.
        errors: of the engine's robot, for the record.
        options: first foot, progress, gait: see `WalkOptions`.

    Returns:
        The run; a fall is an outcome, not an error. ``settings["measured"]`` holds the means and the largest values
        over the steps of what `Measured` lists.
    """
    period = settings.period or PERIOD
    stance = options.get("stance", Stance.LEFT)
    recorder, pushes = Recorder(), PushForces(settings.disturbances.pushes)
    steps = Steps(engine, settings.steps, settings.landing_heights, pushes, recorder, options.get("on_step"))
    engine.place(stance, start)
    walker.reset(stance, *start)
    steps.start(stance)
    pilot = Sensed(engine, biped, walker, settings, steps, recorder)
    motors = Motors(settings.disturbances, period, biped.max_torque)
    outcome = run_sampled(engine, pilot, motors, pushes, period)
    pilot.take_impact(np.inf)
    stored = {
        **asdict(settings),
        "period": period,
        "disturbances": settings.disturbances.as_dict(),
        "engine": engine.name,
        "errors": None if errors is None else errors.as_dict(),
        **pilot.settings(),
    }
    return recorder.finish(biped.name, outcome, steps.count, options.get("gait") or {}, stored)


def walk_sensed(
    biped: FrontalBiped,
    walker: Tickable,
    start: State,
    settings: SimulationSettings | None = None,
    *,
    errors: ModelErrors | None = None,
    **options: Unpack[WalkOptions],
) -> Trajectory:
    """`walk_in` our own engine: rigid impacts, of which the walker learns from the contact flags at its next tick.

    A foot that is below the ground at the reversal has landed early, and more than `rigid.MOST_TURNS` turns outwards
    within a step are a fall, whoever controls the robot.
    """
    chosen = settings or SimulationSettings()
    return walk_in(RigidEngine(biped, errors, chosen), biped, walker, start, chosen, errors, **options)
