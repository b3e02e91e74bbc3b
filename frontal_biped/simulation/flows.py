"""One phase of a simulated step, up to the event that ends it: control in continuous time, or held for a period."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from frontal_biped.arrays import FloatArray
from frontal_biped.control.interface import Controller
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.perturbation import Plant
from frontal_biped.model.stance_map import Stance, relabel
from frontal_biped.simulation.hybrid_system import EventKind, Guard
from frontal_biped.simulation.pushes import PelvisForce, PushForces, along_h
from frontal_biped.simulation.sensors import DelayLine, NoisyEncoders, Sensors
from frontal_biped.simulation.settings import SimulationSettings
from frontal_biped.simulation.stance_motion import StanceMotion
from frontal_biped.virtual_constraints.phase import StepPhase

PHASE_TIME_LIMIT = 5.0  # [s] a phase that lasts longer is not walking


@dataclass(frozen=True)
class Segment:
    """A phase as it was run.

    Attributes:
        t: (T,) [s].
        x: (T, 8) q [rad] and dq [rad/s].
        u: (T, 4) held torques [N m], or None where the controller acts continuously.
        event: what ended it; None where nothing did within the time limit.
    """

    t: FloatArray
    x: FloatArray
    u: FloatArray | None
    event: EventKind | None


class ContinuousFlow:
    """The controller inside the right-hand side; DOP853 with located events."""

    def __init__(self, plant: Plant, controller: Controller, settings: SimulationSettings) -> None:
        self.plant, self.controller, self.settings = plant, controller, settings

    def begin(self, state: FloatArray) -> None:
        """Nothing is held."""

    def land(self, state: FloatArray) -> None:
        """Nothing is held across an impact."""

    def perceived(self, state: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The state itself."""
        return state[:4], state[4:]

    def run(self, t: float, state: FloatArray, phase: StepPhase, guards: tuple[Guard, ...], stance: Stance) -> Segment:
        """From a state (8,) at time t [s] to the first guard crossed, or to the time limit of a phase."""
        biped = self.plant.on(stance)

        def derivative(_: float, x: FloatArray) -> FloatArray:
            q, dq = x[:4], x[4:]
            u = self.controller.command(phase, q, dq).u
            return np.concatenate([dq, biped.forward_dynamics(q, dq, u)])

        settings = self.settings
        solution = solve_ivp(
            derivative,
            (t, t + PHASE_TIME_LIMIT),
            state,
            method="DOP853",
            rtol=settings.rtol,
            atol=settings.atol,
            events=[_as_event(guard) for guard in guards],
            dense_output=True,
        )
        kind, end = None, float(solution.t[-1])
        if solution.status == 1:
            kind = next(g.kind for g, hits in zip(guards, solution.t_events or [], strict=True) if len(hits))
        count = max(2, int(np.ceil((end - t) * settings.record_rate)) + 1)
        times = np.linspace(t, end, count)
        assert solution.sol is not None  # dense_output=True
        states = solution.sol(times).T
        states[0], states[-1] = state, solution.y[:, -1]
        return Segment(times, states, None, kind)


def _as_event(guard: Guard) -> Callable[[float, FloatArray], float]:
    def event(_: float, x: FloatArray) -> float:
        return guard.function(x[:4], x[4:])

    event.terminal = True  # type: ignore[attr-defined]
    event.direction = guard.direction  # type: ignore[attr-defined]
    return event


class SampledFlow:
    """Zero-order hold.

    Between ticks the torques are constant and a Runge-Kutta step of order 4 per millisecond is exact to rounding;
    solve_ivp would spend most of its time on starting up every period.

    Args:
        plant: what moves.
        biped: the robot as an observer knows it.
        controller: asked at every tick.
        settings: period and disturbances.
        pushes: on the robot.
    """

    max_step = 1e-3  # [s]

    def __init__(
        self,
        plant: Plant,
        biped: FrontalBiped,
        controller: Controller,
        settings: SimulationSettings,
        pushes: PushForces,
    ) -> None:
        self.plant, self.biped, self.controller, self.settings = plant, biped, controller, settings
        assert settings.period is not None
        self.period = settings.period
        self._u: FloatArray | None = None  # applied
        self._commanded: FloatArray | None = None
        self._next_tick = 0
        self._disturbances = settings.disturbances
        self._generator = settings.disturbances.generator("torques")
        self._delay = DelayLine(settings.disturbances.delay_ticks(settings.period))
        self._encoders: NoisyEncoders | None = None
        self._pushes = pushes
        self._pelvis = {stance: PelvisForce(plant.on(stance)) for stance in Stance}

    def begin(self, state: FloatArray) -> None:
        """Start the observer, if the encoders are noisy, at the true state."""
        if self._disturbances.noisy_sensors:
            self._encoders = NoisyEncoders(self.biped, Sensors(self._disturbances), state[:4], state[4:])

    def land(self, state: FloatArray) -> None:
        """Joint torques persist through the impact: in stance coordinates they change places."""
        if self._u is not None and self._commanded is not None:
            self._u, self._commanded = relabel(self._u), relabel(self._commanded)
        self._delay.relabel()
        if self._encoders is not None:
            self._encoders.land(state[:4])

    def perceived(self, state: FloatArray) -> tuple[FloatArray, FloatArray]:
        """What the controller takes the state for."""
        return (state[:4], state[4:]) if self._encoders is None else (self._encoders.q, self._encoders.dq)

    def _tick(self, state: FloatArray, phase: StepPhase) -> None:
        if self._encoders is not None:
            self._encoders.read(state[:4], self.period)
        # what arrives at the motors now; the robot knows its own delay, so its observer predicts with the same
        self._commanded = self._delay.push(self.controller.command(phase, *self.perceived(state)).u)
        u = self._disturbances.applied(self._commanded, self._generator)
        self._u = np.clip(u, -self.biped.max_torque, self.biped.max_torque)  # no motor gives more

    def run(self, t: float, state: FloatArray, phase: StepPhase, guards: tuple[Guard, ...], stance: Stance) -> Segment:
        """From a state (8,) at time t [s] to the first guard crossed, or to the time limit of a phase."""
        deadline = t + PHASE_TIME_LIMIT
        motion = StanceMotion(self.plant.on(stance), self._pelvis[stance])
        times, states, torques = [t], [state], []
        values = [guard.function(state[:4], state[4:]) for guard in guards]
        while t < deadline:
            tick_time = self._next_tick * self.period
            if self._u is None or t >= tick_time - 1e-12:
                self._tick(state, phase)
                self._next_tick += 1
                tick_time = self._next_tick * self.period
            assert self._u is not None
            torques.append(self._u)
            motion.u = self._u
            motion.pushes = [(along_h(force, stance), height) for force, height in self._pushes.at(t)]
            if self._disturbances.friction is not None and motion.friction_used(state) > self._disturbances.friction:
                return self._segment(times, states, torques, EventKind.SLIPPED)
            h = min(tick_time - t, self.max_step)
            after = motion.advance(state, h)
            new_values = [guard.function(after[:4], after[4:]) for guard in guards]
            hit = motion.first_crossing(state, h, guards, values, new_values)
            if hit is not None:
                h, kind = hit
                self._predict(h)
                times.append(t + h)
                states.append(motion.advance(state, h))
                return self._segment(times, states, torques, kind)
            self._predict(h)
            t, state, values = (tick_time if h == tick_time - t else t + h), after, new_values
            times.append(t)
            states.append(state)
        return self._segment(times, states, torques, None)

    def _segment(
        self, times: list[float], states: list[FloatArray], torques: list[FloatArray], kind: EventKind | None
    ) -> Segment:
        every = max(1, round(1.0 / (self.settings.record_rate * self.max_step)))
        keep = sorted({*range(0, len(times), every), len(times) - 1})
        torques = [*torques, torques[-1]][: len(times)]
        return Segment(np.array(times)[keep], np.array(states)[keep], np.array(torques)[keep], kind)

    def _predict(self, h: float) -> None:
        if self._encoders is not None and self._commanded is not None and h > 0.0:
            self._encoders.advance(self._commanded, h)
