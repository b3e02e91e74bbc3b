"""The loop of every sampled walk, whatever moves the robot and whatever decides: decide, send, move.

An engine moves the robot: in the plane an `Engine`, ours (`rigid`) or MuJoCo, in space a `SpatialEngine`. A `Pilot`
decides: a walker that is shown sensor readings only (`sensed`), or a controller that is told state and events
(`state_fed`). Control in continuous time (`event_driven`) has no periods and no loop; it is what sampled walks are
compared with.
"""

from collections.abc import Callable
from typing import Any, NamedTuple, Protocol, TypeVar

from frontal_biped.arrays import FloatArray
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.state import State
from frontal_biped.simulation.engine import AT_ONCE, Move
from frontal_biped.simulation.hybrid_system import EventKind
from frontal_biped.simulation.motors import Motors
from frontal_biped.simulation.pushes import PushTimes
from frontal_biped.simulation.trajectory import COMPLETED
from frontal_biped.virtual_constraints.phase import StepPhase

PHASE_TIME_LIMIT = 5.0
"""A phase that lasts longer is not walking [s]."""

TIMED_OUT = f"a phase lasted longer than {PHASE_TIME_LIMIT:g} s"

TOO_STIFF = "torques at their limits made the motion too stiff to follow in continuous time"


class Decision(NamedTuple):
    """What a pilot wants for a control period.

    Attributes:
        tau: (n,) joint torques, URDF order [N m]; four in the plane.
        drawn_from: see `Motors.send`.
    """

    tau: FloatArray
    drawn_from: Stance = Stance.LEFT


class Pilot(Protocol):
    """What decides; it also knows when a phase begins, and what of a run is worth recording."""

    @property
    def since(self) -> float:
        """Since when nothing has happened that walking must lead to, a phase or a step [s]."""

    def decide(self, t: float) -> Decision | None:
        """Torques from time t [s] on; None where the walk is complete."""

    def sent(self, t: float, tau: FloatArray) -> None:
        """These torques (n,) [N m] act from now on."""

    def moved(self, move: Move) -> str | None:
        """The robot has moved; the outcome, if that ends the walk."""


Pushes = TypeVar("Pushes", contravariant=True)


class Mover(Protocol[Pushes]):
    """What of an engine the loop needs."""

    def advance(self, t: float, end: float, tau: FloatArray, pushes: Pushes) -> Move:
        """Under held joint torques (n,) [N m] from t to ``end`` [s], or to the first event the engine tells of."""


def run_sampled(
    engine: Mover[Pushes], pilot: Pilot, motors: Motors, pushes: Pushes, period: float, tick: int = 0
) -> str:
    """Walk until the pilot is content or the robot has fallen.

    Args:
        engine: moves the robot.
        pilot: decides.
        motors: between the two.
        pushes: that act.
        period: of control [s].
        tick: with which to begin, or to go on.

    Returns:
        `COMPLETED`, or what made the robot fall.
    """
    t = tick * period
    while True:
        now, end = tick * period, (tick + 1) * period
        decision = pilot.decide(now)
        if decision is None:
            return COMPLETED
        tau = motors.send(*decision)
        pilot.sent(now, tau)
        while end - t > AT_ONCE:
            move = engine.advance(t, end, tau, pushes)
            outcome = pilot.moved(move)
            if outcome is not None:
                return outcome
            t = move.t
        tick += 1
        if t - pilot.since >= PHASE_TIME_LIMIT:
            return TIMED_OUT


class World(Protocol):
    """What steps need to know of the robot and to do to its ground."""

    def stance_state(self, stance: Stance) -> State:
        """The frontal state for a foot taken as the stance foot."""

    def raise_ground(self, stance: Stance, height: float) -> None:
        """Height of the ground on which a foot in the air will land [m]."""


class EventRecorder(Protocol):
    """Keeps events."""

    def event(self, t: float, kind: EventKind, step: int, state: State) -> None:
        """Add an event at time t [s], and the state right after it."""


class Steps:
    """Steps of a walk as they go by: counts them, and tells pushes and ground.

    Args:
        world: whose ground is raised.
        wanted: steps to walk.
        heights: (wanted + 1,) of the ground under their footholds [m].
        pushes: of the run.
        recorder: of the events.
        on_step: called with the number of completed steps.

    Attributes:
        count: completed steps.
        since: when the present phase began [s].
    """

    def __init__(
        self,
        world: World,
        wanted: int,
        heights: FloatArray,
        pushes: PushTimes[Any],
        recorder: EventRecorder,
        on_step: Callable[[int], None] | None,
    ) -> None:
        self._world, self._pushes, self._recorder, self._on_step = world, pushes, recorder, on_step
        self._wanted, self._heights = wanted, heights
        self.count, self.since = 0, 0.0

    @property
    def complete(self) -> bool:
        """Are there as many as wanted?"""
        return self.count >= self._wanted

    def continued(self, world: World, pushes: PushTimes[Any], recorder: EventRecorder) -> "Steps":
        """The same steps of a copy of the walk, which go on by themselves."""
        twin = Steps(world, self._wanted, self._heights, pushes, recorder, self._on_step)
        twin.count, twin.since = self.count, self.since
        return twin

    def start(self, stance: Stance) -> None:
        """The walk begins right after an impact."""
        self._recorder.event(0.0, EventKind.IMPACT, -1, self._world.stance_state(stance))
        self._begin(0.0, StepPhase.RISING, stance)

    def turn(self, t: float, kind: EventKind, stance: Stance) -> None:
        """The robot reverses at time t [s], or is pushed outwards again."""
        self._recorder.event(t, kind, self.count, self._world.stance_state(stance))
        self.since = t
        if kind is EventKind.REVERSAL:
            self._pushes.begin(t, self.count, StepPhase.FALLING)

    def land(self, t: float, stance: Stance) -> None:
        """A step is completed at time t [s]; ``stance`` is the foot that has landed."""
        self.count += 1
        self._begin(t, StepPhase.RISING, stance)

    def fall(self, t: float, kind: EventKind, stance: Stance) -> None:
        """The robot falls at time t [s]."""
        self._recorder.event(t, kind, self.count, self._world.stance_state(stance))

    def announce(self) -> None:
        """Say how many steps are completed."""
        if self._on_step is not None:
            self._on_step(self.count)

    def _begin(self, t: float, phase: StepPhase, stance: Stance) -> None:
        self.since = t
        if not self.complete:
            self._world.raise_ground(stance.other, float(self._heights[self.count]))
        self._pushes.begin(t, self.count, phase)
