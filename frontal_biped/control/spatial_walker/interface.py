"""What the controller of the whole robot is shown, and what it answers."""

from dataclasses import dataclass
from typing import Protocol

from frontal_biped.arrays import FloatArray
from frontal_biped.control.interface import PhaseEvent
from frontal_biped.model.stance_map import Stance
from frontal_biped.virtual_constraints.phase import StepPhase


@dataclass(frozen=True)
class SpatialReading:
    """What the sensors of a free robot tell at one tick.

    Attributes:
        time: [s].
        joint_positions: (n,) in the order of `FreeRobot.joint_names` [rad].
        joint_velocities: (n,) [rad/s]; None: to be estimated.
        base_rotation: (3, 3) axes of the root link in the world, as an inertial unit at the pelvis tells.
        base_angular_velocity: (3,) in the axes of the root link [rad/s].
        contact: does the left, the right foot touch the ground?
    """

    time: float
    joint_positions: FloatArray
    joint_velocities: FloatArray | None
    base_rotation: FloatArray
    base_angular_velocity: FloatArray
    contact: tuple[bool, bool]


@dataclass(frozen=True)
class SpatialCommand:
    """Answer to one reading. The world is the walker's own: where it believes to be, by its steps.

    Attributes:
        joint_torques: (n,) [N m].
        phase: rising or falling.
        stance: the foot the walker takes for the stance foot.
        event: what the walker noticed in this reading, if anything.
        q: (4,) frontal state as estimated, stance coordinates [rad].
        dq: (4,) its rate [rad/s].
        y: (3,) output error of the virtual constraints [rad].
        p_fri_target: wanted FRI, along h from the stance ankle [m].
        cop_target_x: wanted centre of pressure ahead of the stance ankle [m].
        foothold: (3,) planned x, y [m] and yaw [rad] of the next foot.
        wrench: (6,) expected on the stance sole: force [N] and moment about the origin of its frame [N m], world axes.
        speed_target: commanded mean speed forwards [m/s].
        solved: did the quadratic program reach its accuracy with every limit kept?
        given_way: which limits or tasks gave way, "" for none.
    """

    joint_torques: FloatArray
    phase: StepPhase
    stance: Stance
    event: PhaseEvent | None
    q: FloatArray
    dq: FloatArray
    y: FloatArray
    p_fri_target: float
    cop_target_x: float
    foothold: FloatArray
    wrench: FloatArray
    speed_target: float
    solved: bool
    given_way: str


class SpatialTickable(Protocol):
    """Anything that answers readings as `SpatialWalker` does."""

    def reset(self, stance: Stance, q: FloatArray, v: FloatArray) -> None:
        """Start right after an impact at q (nq,), v (nv,) of a `FreeRobot`."""

    def tick(self, reading: SpatialReading) -> SpatialCommand:
        """Torques for a reading."""

    def command(self, speed: float | None = None, lateral: float | None = None, turn: float | None = None) -> None:
        """Walk like this from the next step on: forwards [m/s], to the left [m/s], turning to the left [rad/s].

        What is None stays as it is.
        """
