"""Simulate the full model in closed loop, event by event.

Continuous: the controller is evaluated inside the integrator. Sampled: a zero-order hold at a fixed period, as on a
robot; joint torques stay constant through an impact until the next tick. Events are located, not stepped over.
Noise and pushes act on sampled runs (see `disturbances`).
"""

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, Protocol

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import SimulationError
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.stance_map import Stance, relabel
from frontal_biped.simulation.disturbances import Disturbances, NoisyEncoders, PelvisForce
from frontal_biped.simulation.hybrid_system import EventKind, Guard, land, walking_guards
from frontal_biped.simulation.trajectory import SAMPLED, Trajectory
from frontal_biped.virtual_constraints.phase import StepPhase

PHASE_TIME_LIMIT = 5.0  # [s] a phase that lasts longer is not walking
TIMED_OUT = "a phase lasted longer than 5 s"
MOST_TURNS = 20  # times a push may turn the robot outwards again within one step


class Command(Protocol):
    """What the simulator reads of a command."""

    @property
    def u(self) -> FloatArray:
        """(4,) torques [N m]."""

    @property
    def y(self) -> FloatArray:
        """(3,) output error q_b - h_d(beta) [rad]."""

    @property
    def p_fri_target(self) -> float:
        """Wanted FRI [m]."""


class Controller(Protocol):
    """Anything that turns phase and state into a command."""

    def begin(self, phase: StepPhase, q: FloatArray, dq: FloatArray) -> None:
        """A phase begins at q (4,) [rad], dq (4,) [rad/s]: after an impact or at a reversal."""

    def command(self, phase: StepPhase, q: FloatArray, dq: FloatArray) -> Command:
        """Command at q (4,) [rad], dq (4,) [rad/s]."""


@dataclass(frozen=True)
class SimulationSettings:
    """Settings of the simulator.

    Attributes:
        steps: impacts after which to stop.
        period: control period [s]; None: continuous control.
        rtol: relative tolerance of the integrator (continuous control).
        atol: absolute tolerance of the integrator (continuous control).
        record_rate: samples per second of the recording [1/s].
        disturbances: noise and pushes; they need a period.

    Raises:
        SimulationError: disturbances under continuous control.
    """

    steps: int = 20
    period: float | None = None
    rtol: float = 1e-9
    atol: float = 1e-11
    record_rate: float = 250.0
    disturbances: Disturbances = field(default_factory=Disturbances)

    def __post_init__(self) -> None:
        if self.disturbances.any and self.period is None:
            raise SimulationError("noise and pushes act on sampled control; give a control period")


def simulate_walk(
    biped: FrontalBiped,
    controller: Controller,
    q0: FloatArray,
    dq0: FloatArray,
    settings: SimulationSettings | None = None,
    *,
    stance: Stance = Stance.LEFT,
    on_step: Callable[[int], None] | None = None,
    gait: Mapping[str, Any] | None = None,
    controller_settings: Mapping[str, Any] | None = None,
) -> Trajectory:
    """Walk from a state right after an impact.

    Args:
        biped: the robot.
        controller: commands torques.
        q0: (4,) configuration after the impact [rad].
        dq0: (4,) velocities after the impact [rad/s].
        settings: of the simulator.
        stance: the first stance foot.
        on_step: called with the number of completed steps.
        gait: content of the gait file, kept with the run.
        controller_settings: kept with the run.

    Returns:
        The run; a fall is an outcome, not an error.
    """
    chosen = settings or SimulationSettings()
    flow = (
        _ContinuousFlow(biped, controller, chosen) if chosen.period is None else _SampledFlow(biped, controller, chosen)
    )
    recorder = _Recorder(biped, controller, chosen.disturbances)
    guards = walking_guards(biped)
    state = np.concatenate([q0, dq0])
    flow.begin(state)
    t, phase, step, outcome = 0.0, StepPhase.RISING, 0, "completed"
    # the feet start level about y = 0, as in a walk on the spot
    world_y = (1.0 if stance is Stance.LEFT else -1.0) * 0.5 * float(biped.joint_positions(q0)[3, 0])
    recorder.event(t, EventKind.IMPACT, -1, state)
    turns = 0
    controller.begin(phase, *flow.perceived(state))
    while step < chosen.steps:
        active = guards.rising if phase is StepPhase.RISING else guards.falling
        segment = flow.run(t, state, phase, active, stance)
        recorder.segment(segment, phase, stance, world_y, step)
        t, state = segment.t[-1], segment.x[-1]
        if segment.event is EventKind.REVERSAL:
            phase = StepPhase.FALLING
            recorder.event(t, EventKind.REVERSAL, step, state)
            controller.begin(phase, *flow.perceived(state))
        elif segment.event is EventKind.TURNED_OUTWARDS and turns < MOST_TURNS:
            phase, turns = StepPhase.RISING, turns + 1
            recorder.event(t, EventKind.TURNED_OUTWARDS, step, state)
            controller.begin(phase, *flow.perceived(state))
        elif segment.event is EventKind.IMPACT:
            landing = land(biped, state[:4], state[4:])
            if landing is None:
                recorder.event(t, EventKind.EDGE_LANDING, step, state)
                outcome = EventKind.EDGE_LANDING.value
                break
            width = float(biped.joint_positions(state[:4])[3, 0])
            world_y -= width if stance is Stance.LEFT else -width
            stance, phase, step, turns = stance.other, StepPhase.RISING, step + 1, 0
            state = np.concatenate([landing.q_plus, landing.dq_plus])
            flow.land(state)
            controller.begin(phase, *flow.perceived(state))
            recorder.event(t, EventKind.IMPACT, step - 1, state)
            if on_step is not None:
                on_step(step)
        else:
            outcome = TIMED_OUT if segment.event is None else segment.event.value
            if segment.event is not None:
                recorder.event(t, segment.event, step, state)
            break
    stored = {**asdict(chosen), "controller": dict(controller_settings or {})}
    stored["disturbances"]["pushes"] = list(stored["disturbances"]["pushes"])  # as a run file keeps it
    return recorder.finish(biped.name, outcome, step, dict(gait or {}), stored)


# ---------------------------------------------------------------------- flows
@dataclass(frozen=True)
class _Segment:
    t: FloatArray  # (T,) [s]
    x: FloatArray  # (T, 8)
    u: FloatArray | None  # (T, 4) held torques, or None where the controller acts continuously
    event: EventKind | None


class _ContinuousFlow:
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

    def run(self, t: float, state: FloatArray, phase: StepPhase, guards: tuple[Guard, ...], stance: Stance) -> _Segment:
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
        return _Segment(times, states, None, kind)


def _as_event(guard: Guard) -> Callable[[float, FloatArray], float]:
    def event(_: float, x: FloatArray) -> float:
        return guard.function(x[:4], x[4:])

    event.terminal = True  # type: ignore[attr-defined]
    event.direction = guard.direction  # type: ignore[attr-defined]
    return event


class _SampledFlow:
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

    def run(self, t: float, state: FloatArray, phase: StepPhase, guards: tuple[Guard, ...], stance: Stance) -> _Segment:
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
    ) -> _Segment:
        every = max(1, round(1.0 / (self.settings.record_rate * self.max_step)))
        keep = sorted({*range(0, len(times), every), len(times) - 1})
        torques = [*torques, torques[-1]]
        return _Segment(np.array(times)[keep], np.array(states)[keep], np.array(torques)[keep], kind)

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


# ---------------------------------------------------------------------- recording
class _Recorder:
    """Collects samples and events."""

    def __init__(self, biped: FrontalBiped, controller: Controller, disturbances: Disturbances) -> None:
        self.biped, self.controller, self.disturbances = biped, controller, disturbances
        self.pelvis = PelvisForce(biped)
        self.rows: dict[str, list[Any]] = {name: [] for name in SAMPLED}
        self.times: list[float] = []
        self.kinds: list[str] = []
        self.steps: list[int] = []
        self.states: list[FloatArray] = []

    def segment(self, segment: _Segment, phase: StepPhase, stance: Stance, world_y: float, step: int) -> None:
        for i, (t, x) in enumerate(zip(segment.t, segment.x, strict=True)):
            q, dq = x[:4], x[4:]
            command = self.controller.command(phase, q, dq)
            u = command.u if segment.u is None else segment.u[i]
            push = self.disturbances.lateral_force(t, stance) if self.disturbances.pushes else 0.0
            felt = u if push == 0.0 else u + self.pelvis.torques(q, push)
            ddq = self.biped.forward_dynamics(q, dq, felt)
            wrench = self.biped.inverse_dynamics(q, dq, ddq)
            if push != 0.0:  # the ground carries what the push does not
                wrench[0] -= push
                wrench[2] += push * self.pelvis.height(q)
            sample = {
                "t": t,
                "q": q,
                "dq": dq,
                "u": u,
                "force": wrench[:2],
                "p_fri": wrench[2] / wrench[1],
                "p_fri_target": command.p_fri_target,
                "q_b_desired": q[1:] - command.y,
                "phase": 1.0 if phase is StepPhase.RISING else -1.0,
                "stance": 1.0 if stance is Stance.LEFT else -1.0,
                "stance_y": world_y,
                "step": float(step),
            }
            for name, value in sample.items():
                self.rows[name].append(value)

    def event(self, t: float, kind: EventKind, step: int, state: FloatArray) -> None:
        self.times.append(float(t))
        self.kinds.append(kind.name)
        self.steps.append(step)
        self.states.append(state.copy())

    def finish(
        self, robot: str, outcome: str, steps: int, gait: dict[str, Any], settings: dict[str, Any]
    ) -> Trajectory:
        return Trajectory(
            **{name: np.array(rows, dtype=float) for name, rows in self.rows.items()},
            event_t=np.array(self.times),
            event_kind=tuple(self.kinds),
            event_step=np.array(self.steps, dtype=float),
            event_state=np.array(self.states),
            robot=robot,
            outcome=outcome,
            steps_completed=steps,
            gait=gait,
            settings=settings,
        )
