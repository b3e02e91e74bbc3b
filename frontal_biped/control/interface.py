"""What a controller and what drives it exchange: readings and commands, phases and states."""

from enum import Enum
from typing import NamedTuple, Protocol, cast

from frontal_biped.arrays import FloatArray
from frontal_biped.model.stance_map import Stance
from frontal_biped.virtual_constraints.phase import StepPhase


class PhaseEvent(Enum):
    """What the phase machine has noticed."""

    REVERSAL = "reversal"
    TURNED_OUTWARDS = "turned outwards again"
    LANDING = "landing"


class Reading(NamedTuple):
    """What a real robot can measure at one tick.

    Attributes:
        time: [s].
        joint_positions: (4,) URDF joint angles in the order of `StanceMap.joint_names` [rad].
        joint_velocities: (4,) their rates [rad/s]; None: the walker estimates them.
        base_roll: rotation of the pelvis about +X, 0 upright [rad].
        base_roll_rate: [rad/s].
        contact: does the left, the right foot touch the ground?
    """

    time: float
    joint_positions: FloatArray
    joint_velocities: FloatArray | None
    base_roll: float
    base_roll_rate: float
    contact: tuple[bool, bool]


class WalkerCommand(NamedTuple):
    """Answer to one reading.

    Attributes:
        joint_torques: (4,) URDF order [N m].
        phase: rising or falling.
        stance: the foot the walker takes for the stance foot.
        u: (4,) the same torques in stance coordinates [N m].
        q: (4,) state the command is for, as estimated [rad].
        dq: (4,) [rad/s].
        y: (3,) output error there [rad].
        p_fri_target: wanted FRI [m].
        solved: did the quadratic program reach its accuracy?
        event: what the walker noticed in this reading, if anything.
    """

    joint_torques: FloatArray
    phase: StepPhase
    stance: Stance
    u: FloatArray
    q: FloatArray
    dq: FloatArray
    y: FloatArray
    p_fri_target: float
    solved: bool
    event: PhaseEvent | None


class Tickable(Protocol):
    """Anything that answers readings as `Walker` does."""

    def reset(self, stance: Stance, q: FloatArray, dq: FloatArray) -> None:
        """Start right after an impact at q (4,) [rad], dq (4,) [rad/s]."""

    def tick(self, reading: Reading) -> WalkerCommand:
        """Torques for a reading."""


class Contract(Enum):
    """How a controller is asked for torques."""

    SENSED = ("tick", "reset")
    """It is shown sensor readings only, as `Walker`: a `Tickable`."""
    TOLD = ("begin", "command")
    """It is told state and events, as `QpController`: a `Controller`."""

    @classmethod
    def of(cls, thing: object) -> "Contract | None":
        """The contract that an object keeps, by its methods; None for none, and for a class: that is a factory."""
        if isinstance(thing, type):
            return None
        return next((kind for kind in cls if all(hasattr(thing, name) for name in kind.value)), None)


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
    """Anything that turns phase and state into a command.

    Configuration and velocities come apart, not as a `State`: scenario files name controllers that users write, and
    nothing of the package need be known to write one.
    """

    def begin(self, phase: StepPhase, q: FloatArray, dq: FloatArray) -> None:
        """A phase begins at q (4,) [rad], dq (4,) [rad/s]: after an impact or at a reversal."""

    def command(self, phase: StepPhase, q: FloatArray, dq: FloatArray) -> Command:
        """Command at q (4,) [rad], dq (4,) [rad/s]."""


class Commands(NamedTuple):
    """Answers to many states.

    Attributes:
        u: (m, 4) torques [N m].
        y: (m, 3) output errors [rad].
        p_fri_target: (m,) wanted FRI [m].
    """

    u: FloatArray
    y: FloatArray
    p_fri_target: FloatArray


class ManyAtOnce(Controller, Protocol):
    """A controller that can also answer many states in one call, which is far cheaper."""

    def commands(self, phase: StepPhase, q: FloatArray, dq: FloatArray) -> Commands | None:
        """What `command` answers at q (m, 4) [rad], dq (m, 4) [rad/s]; None: ask one by one."""


def many_at_once(controller: Controller) -> ManyAtOnce | None:
    """The controller, if it answers many states at once as it answers one.

    That is what the class says that defines both methods; of a subclass, or where ``command`` has been replaced on the
    object itself, nobody knows.
    """
    replaced = "command" in getattr(controller, "__dict__", ())
    return cast("ManyAtOnce", controller) if "commands" in vars(type(controller)) and not replaced else None
