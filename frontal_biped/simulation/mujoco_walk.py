"""Walk in MuJoCo: another engine, whose contact nobody here wrote, under the same walker.

MuJoCo computes contact, friction and impact; the disturbances are those of our own simulator. The run is a
`Trajectory` like any other, so page, figures and expectations work on it. Its phases and stance foot are those that the
walker took them for; q, dq, forces and FRI are MuJoCo's.
"""

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.phase_machine import PhaseEvent
from frontal_biped.control.walker import Reading, Walker, WalkerCommand
from frontal_biped.exceptions import SimulationError
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.perturbation import ModelErrors
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.flows import PHASE_TIME_LIMIT
from frontal_biped.simulation.hybrid_system import EventKind
from frontal_biped.simulation.mujoco_model import TIMESTEP, ContactSettings
from frontal_biped.simulation.mujoco_robot import MujocoRobot
from frontal_biped.simulation.pushes import PushForces
from frontal_biped.simulation.sensors import DelayLine, Sensors
from frontal_biped.simulation.settings import SimulationSettings
from frontal_biped.simulation.simulate import TIMED_OUT
from frontal_biped.simulation.trajectory import SAMPLED, Trajectory
from frontal_biped.virtual_constraints.phase import StepPhase

AIRBORNE = 0.02
"""Time without contact that makes a foot a swing foot [s]; landings without it are not counted as steps."""

SETTLED = 0.03
"""Time after a landing before slip and rotation of the foot are measured [s]."""

LOWEST = 0.6
"""Height of the centre of mass, relative to upright, below which the robot has fallen."""

CLEAR = 5e-4
"""Clearance above old and new ground at which the floor under a swing foot changes its height [m]."""

DIVERGED = "MuJoCo's state is no longer finite"


@dataclass
class Measured:
    """What the rigid simulator has none of, step by step.

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


def walk_in_mujoco(
    plant: FrontalBiped,
    walker: Walker,
    q0: FloatArray,
    dq0: FloatArray,
    settings: SimulationSettings | None = None,
    *,
    errors: ModelErrors | None = None,
    stance: Stance = Stance.LEFT,
    on_step: Callable[[int], None] | None = None,
    gait: Mapping[str, Any] | None = None,
    contact: ContactSettings | None = None,
) -> Trajectory:
    """Walk from a state right after an impact.

    Args:
        plant: the robot whose URDF and description MuJoCo's model is built from.
        walker: the controller; it may believe in another robot.
        q0: (4,) stance coordinates after the impact [rad].
        dq0: (4,) their rates [rad/s].
        settings: steps, recording and disturbances; the period is the walker's.
        errors: of MuJoCo's bodies.
        stance: the first stance foot.
        on_step: called with the number of completed steps.
        gait: content of the gait file, kept with the run.
        contact: contact and physics step; the disturbances' friction takes precedence.

    Returns:
        The run; a fall is an outcome, not an error. ``settings["measured"]`` holds the means and the largest values of
        `Measured` over the steps.

    Raises:
        MissingExtraError: MuJoCo is not installed.
        SimulationError: the physics step does not divide the period.
    """
    return _MujocoWalk(plant, walker, settings or SimulationSettings(), errors, contact).run(
        q0, dq0, stance, on_step, dict(gait or {})
    )


class _MujocoWalk:
    """One run: the loop over control periods and what it records."""

    def __init__(
        self,
        plant: FrontalBiped,
        walker: Walker,
        settings: SimulationSettings,
        errors: ModelErrors | None,
        contact: ContactSettings | None,
    ) -> None:
        self.plant, self.walker, self.settings, self.errors = plant, walker, settings, errors
        disturbances = settings.disturbances
        chosen = contact or ContactSettings(timestep=min(TIMESTEP, walker.period))
        if disturbances.friction is not None:
            chosen = chosen._replace(friction=disturbances.friction)
        self.contact = chosen
        self.substeps = round(walker.period / chosen.timestep)
        if self.substeps < 1 or abs(self.substeps * chosen.timestep - walker.period) > 1e-9:
            raise SimulationError(
                f"a physics step of {chosen.timestep:g} s does not divide the period of {walker.period:g} s;"
                f" give {walker.period / max(1, round(walker.period / TIMESTEP)):g} s"
            )
        self.robot = MujocoRobot(plant, errors, chosen)
        self.sensors = Sensors(disturbances)
        self.line = DelayLine(disturbances.delay_ticks(walker.period))
        self.noise = disturbances.generator("torques")
        self.heights = disturbances.landing_heights(settings.steps)
        self.pushes = PushForces(disturbances.pushes)
        self.max_torque = plant.max_torque
        self.every = max(1, round(1.0 / (settings.record_rate * walker.period)))
        self.rows: dict[str, list[Any]] = {name: [] for name in SAMPLED}
        self.events: list[tuple[float, str, int, FloatArray]] = []
        self.measured = Measured()

    def run(
        self,
        q0: FloatArray,
        dq0: FloatArray,
        stance: Stance,
        on_step: Callable[[int], None] | None,
        gait: dict[str, Any],
    ) -> Trajectory:
        robot, walker, h = self.robot, self.walker, self.walker.period
        # the feet start level about y = 0, as in a walk on the spot
        foot_y = (1.0 if stance is Stance.LEFT else -1.0) * 0.5 * float(self.plant.joint_positions(q0)[3, 0])
        robot.place(stance, q0, dq0, foot_y)
        walker.reset(stance, q0, dq0)
        self._event(0.0, EventKind.IMPACT, -1, stance)
        self.pushes.begin(0.0, 0, StepPhase.RISING)
        self._new_step(0.0)
        step = tick = 0
        outcome, started = "completed", 0.0
        airborne = {side: 0.0 for side in Stance}
        waiting: dict[Stance, float] = {stance.other: self.heights[0]} if len(self.heights) else {}
        while step < self.settings.steps:
            t = tick * h
            touching = robot.contact
            reading = self.sensors.read(
                t,
                robot.joint_positions,
                robot.joint_velocities,
                robot.base_roll,
                robot.base_roll_rate,
                touching,
            )
            command = walker.tick(Reading(*reading))
            if command.event is PhaseEvent.LANDING and airborne[command.stance] >= AIRBORNE:
                step += 1
                airborne[command.stance] = 0.0
                self._end_step()
                self._new_step(t)
                started = t
                if step < len(self.heights):
                    waiting[command.stance.other] = self.heights[step]
                self._event(t, EventKind.IMPACT, step - 1, command.stance)
                self.pushes.begin(t, step, StepPhase.RISING)
                if on_step is not None:
                    on_step(step)
            elif command.event is PhaseEvent.REVERSAL:
                self._event(t, EventKind.REVERSAL, step, command.stance)
                self.pushes.begin(t, step, StepPhase.FALLING)
            elif command.event is PhaseEvent.TURNED_OUTWARDS:
                self._event(t, EventKind.TURNED_OUTWARDS, step, command.stance)
            for side, touches in zip(Stance, touching, strict=True):
                airborne[side] = airborne[side] if touches else airborne[side] + h
            swing = command.stance.other
            if swing in waiting:
                old, new = robot.ground(swing), waiting[swing]
                if robot.clearance(swing) > max(old, new) + CLEAR:
                    robot.raise_ground(swing, waiting.pop(swing))
            tau = self.settings.disturbances.applied(self.line.push(command.joint_torques), self.noise)
            tau = np.clip(tau, -self.max_torque, self.max_torque)
            self._measure(t, command, touching, tau)
            if tick % self.every == 0 or command.event is not None:
                self._sample(t, command, tau, step)
            robot.run(tau, self.substeps, self.pushes.at(t))
            tick += 1
            fate = self._fate(t - started, command.stance)
            if fate is not None:
                outcome = fate if isinstance(fate, str) else fate.value
                if isinstance(fate, EventKind):
                    self._event(t, fate, step, command.stance)
                break
        return self._finish(outcome, step, gait)

    def _fate(self, since_landing: float, stance: Stance) -> EventKind | str | None:
        if not np.isfinite(self.robot.data.qpos).all():
            return DIVERGED
        if self.robot.height < LOWEST * self.robot.upright_height:
            outer, _ = self.plant.sole
            tipped = self.robot.com_offset(stance) < outer
            return EventKind.TIPPED_OUTWARDS if tipped else EventKind.COLLAPSED
        return TIMED_OUT if since_landing > PHASE_TIME_LIMIT else None

    # ------------------------------------------------------------------ records
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

    def _measure(self, t: float, command: WalkerCommand, touching: tuple[bool, bool], tau: FloatArray) -> None:
        h = self.walker.period
        self._double += h * all(touching)
        self._work += h * float(np.abs(tau * self.robot.joint_velocities).sum())
        self._effort += h * float(tau @ tau)
        if t - self._since < SETTLED or all(touching):
            return
        y, rotation = self.robot.foot_position(command.stance)
        if self._foot is None:
            self._foot = y
        self._slip = max(self._slip, abs(y - self._foot))
        self._rotation = max(self._rotation, abs(rotation))

    def _sample(self, t: float, command: WalkerCommand, tau: FloatArray, step: int) -> None:
        stance = command.stance
        q, dq = self.robot.stance_state(stance)
        F_h, F_v, fri = self.robot.reaction(stance)
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
            "stance_y": self.robot.foot_position(stance)[0],
            "step": float(step),
        }
        for name, value in sample.items():
            self.rows[name].append(value)

    def _event(self, t: float, kind: EventKind, step: int, stance: Stance) -> None:
        self.events.append((t, kind.name, step, np.concatenate(self.robot.stance_state(stance))))

    def _finish(self, outcome: str, steps: int, gait: dict[str, Any]) -> Trajectory:
        settings = asdict(self.settings)
        settings["period"] = self.walker.period
        settings["disturbances"] = self.settings.disturbances.as_dict()
        settings |= {
            "engine": "mujoco",
            "contact": self.contact._asdict(),
            "errors": None if self.errors is None else self.errors.as_dict(),
            "controller": {
                **asdict(self.walker.controller.settings),
                "stabiliser": self.walker.controller.stabiliser.name,
                **self.walker.counters(),
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
