"""Walk in space: a walker that sees sensor readings only, in any engine; MuJoCo where none is named.

Phases, steps and stance foot of the run are those that the walker takes them for; configuration, forces and the frontal
state are the engine's.
"""

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import asdict, is_dataclass, replace
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.control.answers import check_answer
from frontal_biped.control.interface import PhaseEvent
from frontal_biped.control.spatial_walker.interface import SpatialCommand, SpatialReading, SpatialTickable
from frontal_biped.model.space.errors import SpatialErrors
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.model.space.virtual_legs import SpaceState
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.state import State
from frontal_biped.simulation.engine import Move
from frontal_biped.simulation.hybrid_system import EventKind
from frontal_biped.simulation.loop import Decision, Steps, run_sampled
from frontal_biped.simulation.measured import Airborne, StepMeter
from frontal_biped.simulation.motors import Motors
from frontal_biped.simulation.mujoco.space_engine import SpaceEngine
from frontal_biped.simulation.mujoco.spec import ContactSettings, contact_for
from frontal_biped.simulation.sensed import EVENTS, RINGING
from frontal_biped.simulation.space.engine import SpatialEngine, SpatialState
from frontal_biped.simulation.space.measured import JointMeter, self_collisions
from frontal_biped.simulation.space.pushes import SpatialPushForces, link_place
from frontal_biped.simulation.space.recorder import SpatialRecorder
from frontal_biped.simulation.space.run import SpatialRun
from frontal_biped.simulation.space.sensors import SpatialSensors
from frontal_biped.simulation.space.settings import SpatialSettings


def walk_in_space(
    free: FreeRobot,
    walker: SpatialTickable,
    start: SpatialState,
    settings: SpatialSettings | None = None,
    *,
    stance: Stance = Stance.LEFT,
    errors: SpatialErrors | None = None,
    contact: ContactSettings | None = None,
    engine: SpatialEngine | None = None,
    on_step: Callable[[int], None] | None = None,
    gait: Mapping[str, Any] | None = None,
) -> SpatialRun:
    """Walk from a state right after an impact.

    Args:
        free: the robot of the files.
        walker: answers readings; it may believe in another robot.
        start: see `start_in_space`.
        settings: steps, period, recording, disturbances, pushes and commands.
        stance: the first stance foot.
        errors: of MuJoCo's bodies.
        contact: contact and physics step of MuJoCo; the disturbances' friction takes precedence.
        engine: moves the robot in place of MuJoCo; it then has errors and contact of its own.
        on_step: called with the number of completed steps.
        gait: content of the gait file, kept with the run.

    Returns:
        The run; a fall is an outcome, not an error. ``settings["measured"]`` holds what the samples do not show: means
        and largest values over the steps of what `Measured` lists, the largest shares of the joints' limits, and
        whether the robot ran into itself.

    Raises:
        MissingExtraError: MuJoCo is not installed.
        SimulationError: the physics step does not divide the period, a push names no link of the robot, or errors or
            contact come with an engine.
    """
    chosen = settings or SpatialSettings()
    told: dict[str, Any] = {}
    if engine is None:
        used = contact_for(chosen.period, contact, chosen.disturbances.friction)
        engine = SpaceEngine(free, chosen.period, errors, used)
        told = {"contact": used._asdict(), "errors": None if errors is None else errors.as_dict()}
    for push in chosen.pushes:
        link_place(free, push.link)
    recorder, pushes = SpatialRecorder(), SpatialPushForces(chosen.pushes)
    world = _World(engine, free)
    steps = Steps(world, chosen.steps, chosen.landing_heights, pushes, recorder, on_step)
    pilot = SpatialPilot(free, world, walker, chosen, steps, recorder)
    pilot.command(0.0)  # before the walk begins, so that its first step is as commanded
    engine.place(*start)
    walker.reset(stance, *start)
    steps.start(stance)
    motors = Motors(chosen.disturbances, chosen.period, free.limits.effort)
    outcome = run_sampled(engine, pilot, motors, pushes, chosen.period)
    pilot.take_impact(np.inf)
    stored = {**chosen.as_dict(), "engine": engine.name, **told, **pilot.settings()}
    run = recorder.finish(free, outcome, steps.count, gait or {}, stored)
    stored["measured"]["self_collision"] = self_collisions(free, run.t, run.q)
    return replace(run, settings=stored)


class _World:
    """The robot as steps and samples see it: with a frontal state."""

    def __init__(self, engine: SpatialEngine, free: FreeRobot) -> None:
        self.engine = engine
        self._space = SpaceState(free)

    def stance_state(self, stance: Stance) -> State:
        """The frontal state, for a foot taken as the stance foot, seen along that foot."""
        seen = self._space.at(*self.engine.state(), heading(self.engine.sole(stance).rotation)).frontal(stance)
        return State(seen.q, seen.dq)

    def raise_ground(self, stance: Stance, height: float) -> None:
        """Height of the ground on which a foot in the air will land [m]."""
        self.engine.raise_ground(stance, height)


class _Sent(NamedTuple):
    """What has been decided for the present period.

    Attributes:
        t: when it began [s].
        reading: the true one.
        command: the walker's answer to what the sensors made of it.
    """

    t: float
    reading: SpatialReading
    command: SpatialCommand


class SpatialPilot:
    """The pilot of a walker in space.

    Args:
        free: the robot of the files.
        world: engine and frontal state.
        walker: answers readings.
        settings: period, recording, disturbances and commands.
        steps: counts and tells.
        recorder: of samples and events.
    """

    def __init__(
        self,
        free: FreeRobot,
        world: _World,
        walker: SpatialTickable,
        settings: SpatialSettings,
        steps: Steps,
        recorder: SpatialRecorder,
    ) -> None:
        self._world, self._engine, self._walker = world, world.engine, walker
        self._steps, self._recorder = steps, recorder
        self._sensors = SpatialSensors(settings)
        self._commands = list(settings.commands)
        self._every = max(1, round(1.0 / (settings.record_rate * settings.period)))
        self._ticks = 0
        self._airborne, self._meter = Airborne(settings.period), StepMeter(settings.period)
        self._joints = JointMeter(free)
        self._gave_way: Counter[str] = Counter()
        self._unsolved = 0
        self._impact: tuple[float, int, Stance] | None = None  # whose state is still to be taken
        self._pelvis_at_posture = pin.Quaternion(free.posture[3:7]).matrix()
        self._yaw, self._stood = 0.0, 0.0
        self._row: dict[str, Any] | None = None  # a sample that waits for the forces of its period

    @property
    def since(self) -> float:
        """When the present step began, as the walker believes [s]: one that rocks on the spot is not walking either.

        One that stands on purpose, as `PathWalker` does, may.
        """
        return max(self._meter.began, self._stood)

    def command(self, t: float) -> None:
        """Give the commands that are due at time t [s]."""
        while self._commands and self._commands[0].due(t, self._steps.count):
            change = self._commands.pop(0)
            self._walker.command(change.speed, change.lateral, change.turn)

    def decide(self, t: float) -> Decision | None:
        """Show the walker what the sensors tell; None after the last landing it noticed, or when it has arrived."""
        self.command(t)
        true = self._engine.read(t)
        command = self._walker.tick(self._sensors.read(true))
        if np.isfinite(true.joint_positions).all():  # of a state that has diverged no controller makes torques
            fields = SpatialCommand.__dataclass_fields__
            check_answer(command, "joint_torques", len(true.joint_positions), "tick", t, fields)
        self.take_impact(t)
        event, stance, steps = command.event, command.stance, self._steps
        if event is PhaseEvent.LANDING and self._airborne.lands(stance):
            self._meter.end_step()
            self._meter.begin_step(t)
            self._impact = (t, steps.count, stance)
            steps.land(t, stance)
            steps.announce()
            if steps.complete:
                return None
        elif event in EVENTS:
            steps.turn(t, EVENTS[event], stance)
        if getattr(self._walker, "standing", False):
            self._stood = t
            if getattr(self._walker, "finished", False):
                return None
        self._airborne.watch(true.contact)
        self._sent = _Sent(t, true, command)
        return Decision(command.joint_torques)

    def sent(self, t: float, tau: FloatArray) -> None:
        """Count, measure and record what is decided; the forces come with the motion."""
        true, command = self._sent.reading, self._sent.command
        self._unsolved += not command.solved
        if command.given_way:
            self._gave_way[command.given_way] += 1
        if self._meter.stands(t, true.contact):
            foot = self._engine.sole(command.stance)
            self._meter.foot(foot.position[:2].tolist(), float(np.arccos(min(1.0, foot.rotation[2, 2]))))
        if self._ticks % self._every == 0 or command.event is not None:
            self._row = self._sample()
        self._ticks += 1

    def moved(self, move: Move) -> str | None:
        """Measure and record what acted; only a fall ends the walk here, the walker learns from sensors."""
        tau, true = self._engine.torques(), self._sent.reading
        assert true.joint_velocities is not None  # the engine knows them
        self._meter.drive(tau, true.joint_velocities)
        self._joints.measure(true.joint_positions, true.joint_velocities, tau)
        if self._row is not None:
            wrenches = self._engine.wrenches()
            if np.isfinite(wrenches).all():  # the last period of a state that has diverged is not worth keeping
                self._recorder.sample({**self._row, "tau": tau, "wrench": wrenches})
            self._row = None
        if move.fell is None:
            return None
        if isinstance(move.fell, str):
            return move.fell
        self._steps.fall(move.t, move.fell, self._sent.command.stance)
        return move.fell.value

    def settings(self) -> dict[str, Any]:
        """What the run keeps of the walker, its steps and its joints."""
        kept = getattr(self._walker, "settings", None)
        counters = getattr(self._walker, "counters", dict)
        return {
            "controller": {
                "kind": type(self._walker).__name__,
                **(asdict(kept) if is_dataclass(kept) and not isinstance(kept, type) else {}),
                "ticks": self._ticks,
                "unsolved": self._unsolved,
                "gave_way": dict(self._gave_way),
                **counters(),
            },
            "measured": {**self._meter.measured.summary(), **self._joints.summary()},
        }

    # ------------------------------------------------------------------ records
    def take_impact(self, t: float) -> None:
        """Take the state after the last impact, if by time t [s] the contact has done its work."""
        if self._impact is None:
            return
        began, step, stance = self._impact
        if t - began > RINGING:
            self._recorder.event(began, EventKind.IMPACT, step, self._world.stance_state(stance))
            self._impact = None

    def _sample(self) -> dict[str, Any]:
        """Everything of a sample but torques and forces, which act from now on."""
        (t, true, command), engine = self._sent, self._engine
        state = engine.state()
        soles = [engine.sole(side) for side in Stance]
        frontal = self._world.stance_state(command.stance)
        com, com_velocity = engine.com()
        yaw = heading(true.base_rotation @ self._pelvis_at_posture.T)
        self._yaw += (yaw - self._yaw + np.pi) % (2.0 * np.pi) - np.pi
        return {
            "t": t,
            "q": state.q,
            "v": state.v,
            "contact": true.contact,
            "com": com,
            "com_velocity": com_velocity,
            "sole_position": [sole.position for sole in soles],
            "sole_yaw": [heading(sole.rotation) for sole in soles],
            "frontal_q": frontal.q,
            "frontal_dq": frontal.dq,
            # what the walker wants of the joints, against where they are
            "frontal_y": frontal.q[1:] - (command.q[1:] - command.y),
            "p_fri_target": command.p_fri_target,
            "cop_target_x": command.cop_target_x,
            "phase": command.phase.sign,
            "stance": command.stance.sign,
            "step": self._steps.count,
            "speed_target": command.speed_target,
            "yaw": self._yaw,
            "foothold": command.foothold,
            "solved": command.solved,
        }


def heading(rotation: FloatArray) -> float:
    """Direction of the X axis of a rotation (3, 3) about world Z [rad]."""
    return float(np.arctan2(rotation[1, 0], rotation[0, 0]))
