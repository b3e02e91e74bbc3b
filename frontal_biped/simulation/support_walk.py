"""Stand, set off, walk, stop and stand: a `SupportWalker` in our engine or in MuJoCo, and a record of it all."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.interface import Reading
from frontal_biped.control.support_walker import SupportCommand, SupportMode, SupportWalker
from frontal_biped.exceptions import SimulationError
from frontal_biped.gait.support_gait import SupportGait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.state import State
from frontal_biped.simulation.hybrid_system import LOWEST, EventKind
from frontal_biped.simulation.mujoco.robot import MujocoRobot
from frontal_biped.simulation.mujoco.spec import ContactSettings, contact_for, substeps
from frontal_biped.simulation.recorder import Recorder
from frontal_biped.simulation.stance_motion import Reaction
from frontal_biped.simulation.support_engine import SupportEngine
from frontal_biped.simulation.trajectory import COMPLETED, Trajectory
from frontal_biped.virtual_constraints.double_support import DoubleSupportFamily
from frontal_biped.virtual_constraints.phase import StepPhase

PERIOD = 1e-3
"""Control period [s]."""

STAND = 1.0
"""Time for which the robot stands before it sets off, and after it has come to rest [s]."""

LONGEST_STEP = 5.0
"""A step that lasts longer is not walking [s]."""


class SupportWorld(Protocol):
    """What moves the robot."""

    @property
    def name(self) -> str:
        """For the record."""

    def stand(self, stance: Stance, family: DoubleSupportFamily, beta: float) -> None:
        """Stand at rest on both feet."""

    def lift(self, stance: Stance, state: State) -> None:
        """Stand on one foot, the other one just leaving the ground."""

    def read(self, t: float) -> Reading:
        """True values of everything a sensor measures."""

    def stance_state(self, stance: Stance) -> State:
        """The state for a foot taken as the stance foot."""

    def reactions(self) -> dict[Stance, Reaction]:
        """What the ground does to either foot."""

    def foot_y(self, stance: Stance) -> float:
        """y of a foot's ankle [m]."""

    def advance(self, t: float, end: float, tau: FloatArray) -> EventKind | str | None:
        """Under held joint torques (4,) [N m]; how the robot fell, if it did."""


class MujocoSupport(MujocoRobot):
    """`MujocoRobot` that stands on both feet, as a `SupportWorld`."""

    name = "mujoco"

    def __init__(self, biped: FrontalBiped, contact: ContactSettings, period: float) -> None:
        super().__init__(biped, None, contact)
        self._substeps = substeps(period, contact.timestep)
        self._lowest = LOWEST * self.upright_height

    def stand(self, stance: Stance, family: DoubleSupportFamily, beta: float) -> None:  # type: ignore[override]
        """Stand at rest on both feet, the soles just touching the ground; the contact settles by itself."""
        self.lift(stance, State(family.at(beta).q, np.zeros(4)))

    def lift(self, stance: Stance, state: State) -> None:
        """Stand on one foot, the other one just leaving the ground."""
        width = float(self.biped.joint_positions(state.q)[-1, 0])
        super().stand(stance, state, 0.5 * stance.sign * width)

    def read(self, t: float) -> Reading:
        """True values of everything a sensor measures."""
        return Reading(
            t, self.joint_positions, self.joint_velocities, self.base_roll, self.base_roll_rate, self.contact
        )

    def foot_y(self, stance: Stance) -> float:
        """y of a foot's ankle [m]."""
        return self.foot_position(stance)[0]

    def reactions(self) -> dict[Stance, Reaction]:
        """What the ground does to either foot."""
        return {side: self.reaction(side) for side in Stance}

    def advance(self, t: float, end: float, tau: FloatArray) -> EventKind | str | None:
        """One control period under joint torques (4,) [N m]; how the robot fell, if it did."""
        self.run(tau, self._substeps, [])
        if not np.isfinite(self.data.qpos).all():
            return "MuJoCo's state is no longer finite"
        return EventKind.COLLAPSED if self.height < self._lowest else None


class WalkedStep(NamedTuple):
    """One step as it was walked.

    Attributes:
        lift_off: when the single support began [s].
        speed: dbeta then, along the family [rad/s].
        landing: when the swing foot landed [s]; nan where it has not.
        arrival: dbeta then, along the family, in the coordinates of the foot that landed [rad/s].
    """

    lift_off: float
    speed: float
    landing: float
    arrival: float


@dataclass(frozen=True)
class SupportRun:
    """A walk with finite double supports.

    Attributes:
        trajectory: the run as any other's; force and FRI are those of ``stance``.
        mode: (T,) what the walker was doing, by index in `SupportMode`.
        loads: (T, 2) vertical force on the left and on the right foot [N].
        steps: those that were walked.
        outcome: "completed", or what made the robot fall.
        asked_to_stop: when [s]; nan: never.
        at_rest: when it stood again [s]; nan: never.
        counters: of the walker.
    """

    trajectory: Trajectory
    mode: FloatArray
    loads: FloatArray
    steps: tuple[WalkedStep, ...]
    outcome: str
    asked_to_stop: float
    at_rest: float
    counters: dict[str, int] = field(default_factory=dict)

    @property
    def fell(self) -> bool:
        """Did the robot fall?"""
        return self.outcome != COMPLETED

    @property
    def landings_to_rest(self) -> int:
        """Landings between the command to stop and rest."""
        return sum(self.asked_to_stop < step.landing <= self.at_rest for step in self.steps)


def stand_walk_stand(
    biped: FrontalBiped,
    gait: SupportGait,
    *,
    steps: int = 10,
    engine: str = "ours",
    stance: Stance = Stance.LEFT,
    stand: float = STAND,
    contact: ContactSettings | None = None,
    on_step: Callable[[int], None] | None = None,
) -> SupportRun:
    """From standing at rest into the gait, some steps, and back to standing at rest.

    Args:
        biped: the robot.
        gait: what to walk.
        steps: landings after which the command to stop is given; the robot comes to rest at the next one.
        engine: "ours" or "mujoco" (extra ``mujoco``).
        stance: the foot that the first step is taken on.
        stand: time to stand before and after [s].
        contact: MuJoCo's.
        on_step: called with the number of completed steps.

    Raises:
        MissingExtraError: MuJoCo is not installed.
        SimulationError: the engine is unknown.
    """
    world, walker = support_world(biped, engine, contact), SupportWalker(biped, gait, period=PERIOD)
    world.stand(stance, walker.family, walker.half_way)
    walker.reset(stance)
    return _Walk(world, walker, steps, stand, on_step).run()


def walk_from_lift_off(
    biped: FrontalBiped,
    gait: SupportGait,
    *,
    steps: int = 10,
    engine: str = "ours",
    stance: Stance = Stance.LEFT,
    speed_error: float = 0.0,
    dead_beat: bool = True,
    contact: ContactSettings | None = None,
) -> SupportRun:
    """Walk from a lift-off on, all speeds off by a relative error; as `stand_walk_stand`.

    Args:
        biped: the robot.
        gait: what to walk.
        steps: lift-offs to record, the first one included.
        engine: "ours" or "mujoco".
        stance: the first stance foot.
        speed_error: of the first lift-off, relative.
        dead_beat: as `SupportWalker`.
        contact: MuJoCo's.
    """
    world = support_world(biped, engine, contact)
    walker = SupportWalker(biped, gait, period=PERIOD, dead_beat=dead_beat)
    at = walker.family.at(gait.rising.beta_start)
    world.lift(stance, State(at.q, (1.0 + speed_error) * gait.speed * at.dq))
    walker.begin_single_support(stance)
    walker.walking = True
    return _Walk(world, walker, steps, None, None).run()


def support_world(biped: FrontalBiped, engine: str, contact: ContactSettings | None = None) -> SupportWorld:
    """The engine of a name.

    Raises:
        MissingExtraError: MuJoCo is not installed.
        SimulationError: the engine is unknown.
    """
    if engine == "ours":
        return SupportEngine(biped, PERIOD)
    if engine == "mujoco":
        return MujocoSupport(biped, contact_for(PERIOD, contact, None), PERIOD)
    raise SimulationError(f"no engine {engine!r}; known: ours, mujoco")


class _Walk:
    """One run: the loop, and what is recorded on the way."""

    def __init__(
        self,
        world: SupportWorld,
        walker: SupportWalker,
        steps: int,
        stand: float | None,
        on_step: Callable[[int], None] | None,
    ) -> None:
        self._world, self._walker, self._wanted, self._stand, self._on_step = world, walker, steps, stand, on_step
        self._recorder = Recorder()
        self._modes: list[float] = []
        self._loads: list[tuple[float, float]] = []
        self._steps: list[WalkedStep] = []
        self._asked = self._rest = float("nan")

    def run(self) -> SupportRun:
        """Until the robot stands again, has taken its steps, or has fallen."""
        walker, world, tick, since = self._walker, self._world, 0, 0.0
        first = walker.stance
        self._recorder.event(0.0, EventKind.IMPACT, -1, world.stance_state(first))
        if walker.mode is SupportMode.SINGLE:
            speed = world.stance_state(first).dbeta
            self._steps.append(WalkedStep(0.0, speed, float("nan"), float("nan")))
        while True:
            t = tick * PERIOD
            if self._stand is not None and walker.mode is SupportMode.STANDING:
                if np.isfinite(self._asked) and not walker.walking:
                    self._rest = t if np.isnan(self._rest) else self._rest
                    if t - self._rest >= self._stand:
                        return self._finish(COMPLETED)
                elif t >= self._stand:
                    walker.walking = True
                since = t
            command = walker.tick(world.read(t))
            if command.began is not None:
                since = t
                self._begin(t, command.began, command.speed)
                if self._stand is None and len(self._steps) > self._wanted:
                    return self._finish(COMPLETED)
            fell = self._move(t, command)
            if fell is not None or t - since > LONGEST_STEP:
                outcome = f"a phase lasted longer than {LONGEST_STEP:g} s" if fell is None else _why(fell)
                return self._finish(outcome)
            tick += 1

    def _move(self, t: float, command: SupportCommand) -> EventKind | str | None:
        world, stance = self._world, command.stance
        fell = world.advance(t, t + PERIOD, command.joint_torques)
        reactions = world.reactions()
        self._recorder.sample(
            t,
            State(command.q, command.dq),
            command.u,
            reactions[stance],
            p_fri_target=command.p_target,
            q_b_desired=command.q_b_desired,
            phase=StepPhase.RISING if command.rising else StepPhase.FALLING,
            stance=stance,
            stance_y=world.foot_y(stance),
            step=max(len(self._steps) - 1, 0),
        )
        self._modes.append(float(list(SupportMode).index(command.mode)))
        self._loads.append((reactions[Stance.LEFT].F_v, reactions[Stance.RIGHT].F_v))
        return fell

    def _begin(self, t: float, mode: SupportMode, speed: float) -> None:
        walker = self._walker
        if mode is SupportMode.SINGLE:
            self._steps.append(WalkedStep(t, speed, float("nan"), float("nan")))
        elif mode in (SupportMode.HAND_OVER, SupportMode.STOPPING) and self._steps:
            self._steps[-1] = self._steps[-1]._replace(landing=t, arrival=speed)
            state = self._world.stance_state(walker.stance)
            self._recorder.event(t, EventKind.IMPACT, len(self._steps) - 1, state)
            if self._on_step is not None:
                self._on_step(walker.landings)
            if self._stand is not None and walker.walking and walker.landings >= self._wanted:
                walker.walking = False
                self._asked = t

    def _finish(self, outcome: str) -> SupportRun:
        gait, walker = self._walker.gait, self._walker
        settings = {"engine": self._world.name, "period": PERIOD, "double_support": True}
        trajectory = self._recorder.finish(gait.robot.name, outcome, walker.landings, {}, settings)
        return SupportRun(
            trajectory,
            np.array(self._modes),
            np.array(self._loads).reshape(-1, 2),
            tuple(self._steps),
            outcome,
            self._asked,
            self._rest,
            walker.counters(),
        )


def _why(fell: EventKind | str) -> str:
    return fell if isinstance(fell, str) else fell.value
