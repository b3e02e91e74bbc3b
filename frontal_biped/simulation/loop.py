"""The loop of a run under a walker, whatever the engine: read, decide, send, move, record.

The walker sees sensor readings only. Phases and stance foot of the recording are those that it took them for; q, dq,
forces and FRI are the engine's.
"""

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field, is_dataclass
from typing import Any, Protocol

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.interface import PhaseEvent, Reading, Tickable, WalkerCommand
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.perturbation import ModelErrors
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.event_driven import TIMED_OUT
from frontal_biped.simulation.flows import PHASE_TIME_LIMIT
from frontal_biped.simulation.hybrid_system import EventKind
from frontal_biped.simulation.pushes import PushForces
from frontal_biped.simulation.sensors import DelayLine, Sensors
from frontal_biped.simulation.settings import SimulationSettings
from frontal_biped.simulation.trajectory import SAMPLED, Trajectory
from frontal_biped.virtual_constraints.phase import StepPhase

PERIOD = 1e-3
"""Control period where the settings name none [s]."""

AIRBORNE = 0.02
"""Time without contact that makes a foot a swing foot [s]; landings without it are not counted as steps."""

SETTLED = 0.03
"""Time after a landing before slip and rotation of the foot are measured [s]."""


RINGING = 0.01
"""Time after a landing when the state after the impact is taken [s]: a soft contact has done its work by then."""


class Engine(Protocol):
    """What moves the robot."""

    @property
    def name(self) -> str:
        """For the record."""

    def place(self, stance: Stance, q: FloatArray, dq: FloatArray, foot_y: float) -> None:
        """Stand on a foot at ``foot_y`` [m], at q (4,) [rad], dq (4,) [rad/s]."""

    def read(self) -> tuple[FloatArray, FloatArray, float, float, tuple[bool, bool]]:
        """Joint positions and rates in URDF order, roll of the pelvis and its rate, contact of left and right foot."""

    def stance_state(self, stance: Stance) -> tuple[FloatArray, FloatArray]:
        """q (4,) [rad] and dq (4,) [rad/s] for a foot taken as the stance foot."""

    def reaction(self, stance: Stance) -> tuple[float, float, float]:
        """Ground reaction F_h, F_v [N] on a foot and its FRI [m]."""

    def foot_position(self, stance: Stance) -> tuple[float, float]:
        """y of a foot's ankle [m] and the foot's rotation about +X [rad]."""

    def raise_ground(self, stance: Stance, height: float) -> None:
        """Height of the ground on which a foot in the air will land [m]."""

    def advance(self, t: float, tau: FloatArray, pushes: PushForces) -> EventKind | str | None:
        """One control period from t [s] under joint torques (4,) [N m]; how the robot fell, if it did."""


@dataclass
class Measured:
    """What the sampled trajectory does not show, step by step.

    Attributes:
        slip: largest motion of the stance foot after it has settled [m].
        rotation: largest rotation of the stance foot from flat after it has settled [rad].
        double_support: time with both feet on the ground [s].
        work: of the joint torques, taken without sign [J].
        effort: integral of the squared torques [N^2 m^2 s].
    """

    slip: list[float] = field(default_factory=list)
    rotation: list[float] = field(default_factory=list)
    double_support: list[float] = field(default_factory=list)
    work: list[float] = field(default_factory=list)
    effort: list[float] = field(default_factory=list)


class SensedLoop:
    """One run: the loop over control periods and what it records.

    Args:
        engine: moves the robot.
        plant: the robot of the files.
        walker: answers readings.
        settings: steps, period, recording and disturbances.
        errors: of the engine's robot, for the record.
    """

    def __init__(
        self,
        engine: Engine,
        plant: FrontalBiped,
        walker: Tickable,
        settings: SimulationSettings,
        errors: ModelErrors | None,
    ) -> None:
        self.engine, self.plant, self.walker, self.settings, self.errors = engine, plant, walker, settings, errors
        self.period = settings.period or PERIOD
        disturbances = settings.disturbances
        self.sensors = Sensors(disturbances)
        self.line = DelayLine(disturbances.delay_ticks(self.period))
        self.noise = disturbances.generator("torques")
        self.heights = disturbances.landing_heights(settings.steps)
        self.pushes = PushForces(disturbances.pushes)
        self.every = max(1, round(1.0 / (settings.record_rate * self.period)))
        self.rows: dict[str, list[Any]] = {name: [] for name in SAMPLED}
        self.events: list[tuple[float, str, int, FloatArray]] = []
        self.measured = Measured()
        self._impact: tuple[float, int, Stance] | None = None  # whose state is still to be taken

    def run(
        self,
        q0: FloatArray,
        dq0: FloatArray,
        stance: Stance,
        on_step: Callable[[int], None] | None,
        gait: Mapping[str, Any] | None,
    ) -> Trajectory:
        """Walk from a state right after an impact."""
        engine, walker, h = self.engine, self.walker, self.period
        # the feet start level about y = 0, as in a walk on the spot
        foot_y = (1.0 if stance is Stance.LEFT else -1.0) * 0.5 * float(self.plant.joint_positions(q0)[3, 0])
        engine.place(stance, q0, dq0, foot_y)
        walker.reset(stance, q0, dq0)
        self._event(0.0, EventKind.IMPACT, -1, stance)
        self.pushes.begin(0.0, 0, StepPhase.RISING)
        engine.raise_ground(stance.other, float(self.heights[0]))
        self._new_step(0.0)
        step = tick = 0
        outcome, started = "completed", 0.0
        airborne = dict.fromkeys(Stance, 0.0)
        while True:
            t = tick * h
            positions, rates, roll, roll_rate, touching = engine.read()
            reading = Reading(*self.sensors.read(t, positions, rates, roll, roll_rate, touching))
            command = walker.tick(reading)
            self._settle_impact(t)
            if command.event is PhaseEvent.LANDING and airborne[command.stance] >= AIRBORNE:
                step += 1
                airborne[command.stance] = 0.0
                self._end_step()
                self._new_step(t)
                started = t
                self._impact = (t, step - 1, command.stance)
                if on_step is not None:
                    on_step(step)
                if step >= self.settings.steps:
                    break
                engine.raise_ground(command.stance.other, float(self.heights[step]))
                self.pushes.begin(t, step, StepPhase.RISING)
            elif command.event is PhaseEvent.REVERSAL:
                self._event(t, EventKind.REVERSAL, step, command.stance)
                self.pushes.begin(t, step, StepPhase.FALLING)
            elif command.event is PhaseEvent.TURNED_OUTWARDS:
                self._event(t, EventKind.TURNED_OUTWARDS, step, command.stance)
            for side, touches in zip(Stance, touching, strict=True):
                airborne[side] = airborne[side] if touches else airborne[side] + h
            tau = self.settings.disturbances.applied(self.line.push(command.joint_torques), self.noise)
            limit = self.plant.max_torque
            tau = np.minimum(np.maximum(tau, -limit), limit)
            self._measure(t, command.stance, touching, tau, rates)
            if tick % self.every == 0 or command.event is not None:
                self._sample(t, command, tau, step)
            fate = engine.advance(t, tau, self.pushes)
            tick += 1
            if fate is None and tick * h - started > PHASE_TIME_LIMIT:
                fate = TIMED_OUT
            if fate is not None:
                outcome = fate if isinstance(fate, str) else fate.value
                if isinstance(fate, EventKind):
                    self._event(tick * h, fate, step, command.stance)
                break
        self._settle_impact(np.inf)
        return self._finish(outcome, step, dict(gait or {}))

    # ------------------------------------------------------------------ records
    def _settle_impact(self, t: float) -> None:
        """The state after an impact is taken when the contact has done its work."""
        if self._impact is None:
            return
        began, step, stance = self._impact
        if t - began > RINGING:
            self._event(began, EventKind.IMPACT, step, stance)
            self._impact = None

    def _new_step(self, t: float) -> None:
        self._since = t
        self._foot: float | None = None
        self._slip = self._rotation = self._double = self._work = self._effort = 0.0

    def _end_step(self) -> None:
        measured = self.measured
        measured.slip.append(self._slip)
        measured.rotation.append(self._rotation)
        measured.double_support.append(self._double)
        measured.work.append(self._work)
        measured.effort.append(self._effort)

    def _measure(
        self, t: float, stance: Stance, touching: tuple[bool, bool], tau: FloatArray, rates: FloatArray
    ) -> None:
        h = self.period
        self._double += h * all(touching)
        self._work += h * float(np.abs(tau) @ np.abs(rates))
        self._effort += h * float(tau @ tau)
        if t - self._since < SETTLED or all(touching):
            return
        y, rotation = self.engine.foot_position(stance)
        if self._foot is None:
            self._foot = y
        self._slip = max(self._slip, abs(y - self._foot))
        self._rotation = max(self._rotation, abs(rotation))

    def _sample(self, t: float, command: WalkerCommand, tau: FloatArray, step: int) -> None:
        stance = command.stance
        q, dq = self.engine.stance_state(stance)
        F_h, F_v, fri = self.engine.reaction(stance)
        sample = {
            "t": t,
            "q": q,
            "dq": dq,
            "u": self.plant.stance_map.torques_to_stance(tau, stance),
            "force": (F_h, F_v),
            "p_fri": fri,
            "p_fri_target": command.p_fri_target,
            "q_b_desired": command.q[1:] - command.y,
            "phase": 1.0 if command.phase is StepPhase.RISING else -1.0,
            "stance": 1.0 if stance is Stance.LEFT else -1.0,
            "stance_y": self.engine.foot_position(stance)[0],
            "step": float(step),
        }
        for name, value in sample.items():
            self.rows[name].append(value)

    def _event(self, t: float, kind: EventKind, step: int, stance: Stance) -> None:
        self.events.append((t, kind.name, step, np.concatenate(self.engine.stance_state(stance))))

    def _finish(self, outcome: str, steps: int, gait: dict[str, Any]) -> Trajectory:
        walker = self.walker
        controller = getattr(getattr(walker, "controller", None), "settings", None)
        counters = getattr(walker, "counters", dict)
        settings = {
            **asdict(self.settings),
            "period": self.period,
            "disturbances": self.settings.disturbances.as_dict(),
            "engine": self.engine.name,
            "errors": None if self.errors is None else self.errors.as_dict(),
            "controller": {
                "kind": type(walker).__name__,
                **(asdict(controller) if is_dataclass(controller) and not isinstance(controller, type) else {}),
                **counters(),
            },
            "measured": {
                name: {"mean": float(np.mean(values)), "largest": float(np.max(values))}
                for name, values in asdict(self.measured).items()
                if values
            },
        }
        times, kinds, event_steps, states = zip(*self.events, strict=True)
        return Trajectory(
            **{name: np.array(rows, dtype=float) for name, rows in self.rows.items()},
            event_t=np.array(times),
            event_kind=tuple(kinds),
            event_step=np.array(event_steps, dtype=float),
            event_state=np.array(states),
            robot=self.plant.name,
            outcome=outcome,
            steps_completed=steps,
            gait=gait,
            settings=settings,
        )
