"""A controller in a run that is told state and events, as in continuous time; only our own engine can tell them.

Where the encoders are noisy it is told an observer's estimate instead. Noise of encoders and motors is drawn along the
chain from stance to swing foot, the coordinates such a controller speaks.
"""

from collections.abc import Callable
from copy import copy
from dataclasses import dataclass

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.answers import check_answer
from frontal_biped.control.interface import Controller, many_at_once
from frontal_biped.exceptions import ControllerError, SimulationError
from frontal_biped.model.state import State
from frontal_biped.simulation.engine import Move
from frontal_biped.simulation.hybrid_system import EventKind
from frontal_biped.simulation.loop import Decision, Steps
from frontal_biped.simulation.motors import Motors
from frontal_biped.simulation.pushes import PushForces
from frontal_biped.simulation.recorder import Recorder
from frontal_biped.simulation.rigid import MAX_STEP, RigidEngine
from frontal_biped.simulation.sensors import NoisyEncoders, Sensors
from frontal_biped.simulation.settings import SimulationSettings
from frontal_biped.simulation.stance_motion import StanceMotion
from frontal_biped.simulation.trajectory import COMPLETED
from frontal_biped.virtual_constraints.phase import StepPhase


@dataclass(frozen=True)
class Segment:
    """A phase as it goes by.

    Attributes:
        phase: rising or falling.
        motion: of the robot on the foot that stands.
        stance_y: where it stands [m].
        t: times [s].
        states: the states there.
        u: (4,) torques held from each of them on [N m]; empty under control in continuous time.
    """

    phase: StepPhase
    motion: StanceMotion
    stance_y: float
    t: list[float]
    states: list[State]
    u: list[FloatArray]


class Told:
    """Tells a controller of events, counts steps and records phases, sampled control or continuous.

    Args:
        engine: moves the robot.
        controller: what decides.
        steps: counts and tells.
        pushes: of the run.
        recorder: of samples and events.
        enough: may the walk end after these post-impact speeds (k,) [rad/s], the start's first? Default: never before
            its last step.

    Attributes:
        speeds: post-impact speeds so far, the start's first [rad/s].
    """

    def __init__(
        self,
        engine: RigidEngine,
        controller: Controller,
        steps: Steps,
        pushes: PushForces,
        recorder: Recorder,
        enough: Callable[[FloatArray], bool] | None = None,
    ) -> None:
        self.engine, self.controller, self.steps = engine, controller, steps
        self._pushes, self._recorder, self._enough = pushes, recorder, enough
        self.speeds = [float(engine.state.dq[0])]

    def continued(self, controller: Controller, pushes: PushForces) -> "Told":
        """A copy of the walk that goes on by itself, under other pushes.

        Args:
            controller: one that has been told what this one has.
            pushes: of the copy.
        """
        engine, recorder = self.engine.copy(), self._recorder.copy()
        steps = self.steps.continued(engine, pushes, recorder)
        twin = Told(engine, controller, steps, pushes, recorder, self._enough)
        twin.speeds = [*self.speeds]
        return twin

    def segment(self, t: float) -> Segment:
        """The phase that begins at time t [s]."""
        engine = self.engine
        return Segment(engine.phase, engine.motion, engine.foot_position(engine.stance)[0], [t], [engine.state], [])

    def record(self, segment: Segment) -> None:
        """Record a phase that has ended; output and FRI target are the controller's answer to the true state."""
        if not self._pushes.any and self._recorded_at_once(segment):
            return
        motion = segment.motion
        held: list[FloatArray] | list[None] = segment.u or [None] * len(segment.t)
        for t, state, u in zip(segment.t, segment.states, held, strict=True):
            command = self.controller.command(segment.phase, *state)
            motion.u = command.u if u is None else u
            motion.feel(self._pushes, t)
            self._recorder.sample(
                t,
                state,
                motion.u,
                motion.reaction(state),
                p_fri_target=command.p_fri_target,
                q_b_desired=state.q[1:] - command.y,
                phase=segment.phase,
                stance=motion.stance,
                stance_y=segment.stance_y,
                step=self.steps.count,
            )

    def _recorded_at_once(self, segment: Segment) -> bool:
        """Record a phase without pushes in a few calls, where the controller answers many states at once."""
        many = many_at_once(self.controller)
        states = State(*(np.array(part) for part in zip(*segment.states, strict=True)))
        asked = None if many is None else many.commands(segment.phase, *states)
        if asked is None:
            return False
        u = np.array(segment.u) if segment.u else asked.u
        self._recorder.samples(
            np.array(segment.t),
            states,
            u,
            segment.motion.reactions(states, u),
            p_fri_target=asked.p_fri_target,
            q_b_desired=states.q[:, 1:] - asked.y,
            phase=segment.phase,
            stance=segment.motion.stance,
            stance_y=segment.stance_y,
            step=self.steps.count,
        )
        return True

    def passed(self, t: float, event: EventKind, fell: EventKind | None, perceived: State) -> str | None:
        """An event was passed at time t [s]: the next phase begins, or the walk ends with an outcome.

        Args:
            t: when.
            event: which.
            fell: how the robot fell at it, if it did.
            perceived: what the controller takes the state after it for.
        """
        steps, stance = self.steps, self.engine.stance
        if event in (EventKind.REVERSAL, EventKind.TURNED_OUTWARDS) and event is not fell:
            steps.turn(t, event, stance)
        if fell is not None:
            steps.fall(t, fell, stance)
            return fell.value
        if event is EventKind.IMPACT:
            steps.land(t, stance)
            self._recorder.event(t, EventKind.IMPACT, steps.count - 1, self.engine.state)
            steps.announce()
            self.speeds.append(float(self.engine.state.dq[0]))
            if steps.complete or (self._enough is not None and self._enough(np.array(self.speeds))):
                return COMPLETED  # the controller is not asked for a phase that nobody walks
        self.controller.begin(self.engine.phase, *perceived)
        return None


class StateFed:
    """The pilot of a controller that is told state and events.

    Args:
        told: tells them.
        settings: period, recording and disturbances.
        motors: whose commands the observer predicts with.
    """

    def __init__(self, told: Told, settings: SimulationSettings, motors: Motors) -> None:
        assert settings.period is not None
        self._told, self._engine, self._motors = told, told.engine, motors
        self._period = settings.period
        self._every = max(1, round(1.0 / (settings.record_rate * MAX_STEP)))
        state = self._engine.state
        noisy = settings.disturbances.noisy_sensors
        self._observer = NoisyEncoders(self._engine.biped, Sensors(settings.disturbances), *state) if noisy else None
        self._segment = told.segment(0.0)
        told.controller.begin(self._engine.phase, *self._perceived)

    def continued(self, told: Told, motors: Motors) -> "StateFed":
        """The pilot of a copy of the walk.

        Raises:
            SimulationError: an observer watches noisy sensors; it is not copied.
        """
        if self._observer is not None:
            raise SimulationError("a walk with noisy sensors cannot be continued in copies")
        twin, segment = copy(self), self._segment
        twin._told, twin._engine, twin._motors = told, told.engine, motors
        motion, so_far = told.engine.motion, ([*segment.t], [*segment.states], [*segment.u])
        twin._segment = Segment(segment.phase, motion, segment.stance_y, *so_far)
        return twin

    @property
    def since(self) -> float:
        """When the present phase began [s]."""
        return self._told.steps.since

    @property
    def _perceived(self) -> State:
        """What the controller takes the state for."""
        return self._engine.state if self._observer is None else State(self._observer.q, self._observer.dq)

    def decide(self, t: float) -> Decision:
        """The controller's torques at the state it perceives."""
        if self._observer is not None:
            self._observer.read(self._engine.state.q, self._period)
        stance = self._engine.stance
        command = self._told.controller.command(self._engine.phase, *self._perceived)
        q = self._engine.state.q
        try:
            check_answer(command, "u", len(q), "command", t)
        except ControllerError:
            if np.isfinite(q).all():  # of a state that has diverged no controller makes torques
                raise
        return Decision(self._engine.biped.stance_map.torques_to_urdf(command.u, stance), stance)

    def sent(self, t: float, tau: FloatArray) -> None:
        """The engine knows what acts."""

    def moved(self, move: Move) -> str | None:
        """Record the way, tell the observer and the controller; the outcome, if that ends the walk."""
        segment = self._segment
        u = segment.motion.u
        for h, t, state in move.steps:
            segment.u.append(u)
            segment.t.append(t)
            segment.states.append(state)
            if self._observer is not None:
                known = self._engine.biped.stance_map.torques_to_stance(self._motors.arriving, segment.motion.stance)
                self._observer.advance(known, h)
        if move.event is None:
            return None
        self.record()
        if self._observer is not None and self._engine.motion is not segment.motion:
            self._observer.land(self._engine.state.q)
        fell = move.fell if isinstance(move.fell, EventKind) else None
        outcome = self._told.passed(move.t, move.event, fell, self._perceived)
        self._segment = self._told.segment(move.t)
        return outcome

    def record(self) -> None:
        """Record the present phase as far as it has come, at the record rate and its end."""
        segment = self._segment
        last = len(segment.t) - 1
        keep = sorted({*range(0, last + 1, self._every), last})
        held = [*segment.u, segment.motion.u]
        self._told.record(
            Segment(
                segment.phase,
                segment.motion,
                segment.stance_y,
                [segment.t[i] for i in keep],
                [segment.states[i] for i in keep],
                [held[i] for i in keep],
            )
        )
