"""One phase of a simulated step, up to the event that ends it: control in continuous time, or held for a period."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from frontal_biped.arrays import FloatArray
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.stance_map import Stance, relabel
from frontal_biped.simulation.disturbances import NoisyEncoders, PelvisForce
from frontal_biped.simulation.hybrid_system import EventKind, Guard
from frontal_biped.simulation.settings import Controller, SimulationSettings
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

    def __init__(self, biped: FrontalBiped, controller: Controller, settings: SimulationSettings) -> None:
        self.biped, self.controller, self.settings = biped, controller, settings

    def begin(self, state: FloatArray) -> None:
        """Nothing is held."""

    def land(self, state: FloatArray) -> None:
        """Nothing is held across an impact."""

    def perceived(self, state: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The state itself."""
        return state[:4], state[4:]

    def run(self, t: float, state: FloatArray, phase: StepPhase, guards: tuple[Guard, ...], stance: Stance) -> Segment:
        """From a state (8,) at time t [s] to the first guard crossed, or to the time limit of a phase."""

        def derivative(_: float, x: FloatArray) -> FloatArray:
            q, dq = x[:4], x[4:]
            u = self.controller.command(phase, q, dq).u
            return np.concatenate([dq, self.biped.forward_dynamics(q, dq, u)])

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
    """

    max_step = 1e-3  # [s]

    def __init__(self, biped: FrontalBiped, controller: Controller, settings: SimulationSettings) -> None:
        self.biped, self.controller, self.settings = biped, controller, settings
        assert settings.period is not None
        self.period = settings.period
        self._u: FloatArray | None = None  # applied
        self._commanded: FloatArray | None = None
        self._next_tick = 0
        self._disturbances = settings.disturbances
        self._generator = np.random.default_rng(settings.disturbances.seed)
        self._encoders: NoisyEncoders | None = None
        self._pelvis = PelvisForce(biped)
        self._force = 0.0

    def begin(self, state: FloatArray) -> None:
        """Start the observer, if the encoders are noisy, at the true state."""
        noise = self._disturbances.encoder_noise
        if noise:
            self._encoders = NoisyEncoders(self.biped, noise, self._generator, state[:4], state[4:])

    def land(self, state: FloatArray) -> None:
        """Joint torques persist through the impact: in stance coordinates they change places."""
        if self._u is not None and self._commanded is not None:
            self._u, self._commanded = relabel(self._u), relabel(self._commanded)
        if self._encoders is not None:
            self._encoders.land(state[:4])

    def perceived(self, state: FloatArray) -> tuple[FloatArray, FloatArray]:
        """What the controller takes the state for."""
        return (state[:4], state[4:]) if self._encoders is None else (self._encoders.q, self._encoders.dq)

    def _tick(self, state: FloatArray, phase: StepPhase) -> None:
        if self._encoders is not None:
            self._encoders.read(state[:4], self.period)
        self._commanded = self.controller.command(phase, *self.perceived(state)).u
        self._u = self._commanded
        if self._disturbances.torque_noise:
            factor = 1.0 + self._disturbances.torque_noise * self._generator.standard_normal(4)
            self._u = self._commanded * factor

    def run(self, t: float, state: FloatArray, phase: StepPhase, guards: tuple[Guard, ...], stance: Stance) -> Segment:
        """From a state (8,) at time t [s] to the first guard crossed, or to the time limit of a phase."""
        deadline = t + PHASE_TIME_LIMIT
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
            self._force = self._disturbances.lateral_force(t, stance) if self._disturbances.pushes else 0.0
            h = min(tick_time - t, self.max_step)
            after = self._advance(state, self._u, h)
            new_values = [guard.function(after[:4], after[4:]) for guard in guards]
            hit = self._first_crossing(state, self._u, h, guards, values, new_values)
            if hit is not None:
                h, kind = hit
                self._predict(h)
                times.append(t + h)
                states.append(self._advance(state, self._u, h))
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
        torques = [*torques, torques[-1]]
        return Segment(np.array(times)[keep], np.array(states)[keep], np.array(torques)[keep], kind)

    def _predict(self, h: float) -> None:
        if self._encoders is not None and self._commanded is not None and h > 0.0:
            self._encoders.advance(self._commanded, h)

    def _advance(self, x: FloatArray, u: FloatArray, h: float) -> FloatArray:
        def derivative(x: FloatArray) -> FloatArray:
            torques = u if self._force == 0.0 else u + self._pelvis.torques(x[:4], self._force)
            return np.concatenate([x[4:], self.biped.forward_dynamics(x[:4], x[4:], torques)])

        k1 = derivative(x)
        k2 = derivative(x + 0.5 * h * k1)
        k3 = derivative(x + 0.5 * h * k2)
        k4 = derivative(x + h * k3)
        return x + (h / 6.0) * (k1 + 2.0 * (k2 + k3) + k4)

    def _first_crossing(
        self,
        x: FloatArray,
        u: FloatArray,
        h: float,
        guards: tuple[Guard, ...],
        before: list[float],
        after: list[float],
    ) -> tuple[float, EventKind] | None:
        """Time into the step and kind of the earliest guard crossed in its direction."""
        found = []
        for guard, a, b in zip(guards, before, after, strict=True):
            if a * guard.direction < 0.0 <= b * guard.direction:

                def value(tau: float, guard: Guard = guard) -> float:
                    y = self._advance(x, u, tau)
                    return guard.function(y[:4], y[4:])

                found.append((float(brentq(value, 0.0, h, xtol=1e-14)), guard.kind))
        return min(found, key=lambda item: item[0]) if found else None
