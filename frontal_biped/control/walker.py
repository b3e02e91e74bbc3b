"""The walking robot's own controller: from what its sensors say to torques, with no simulator in sight."""

from dataclasses import dataclass

from frontal_biped.arrays import FloatArray
from frontal_biped.control.controller import ControllerSettings
from frontal_biped.control.transitions import Stabiliser
from frontal_biped.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.stance_map import Stance
from frontal_biped.virtual_constraints.phase import StepPhase


@dataclass(frozen=True)
class Reading:
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


@dataclass(frozen=True)
class WalkerCommand:
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


class Walker:
    """Walks a gait from sensor readings alone; the same object drives any simulator, or a robot.

    Args:
        biped: the robot as the walker believes it to be.
        gait: what to walk.
        period: time between readings [s].
        settings: gains and limits; default: the gait's limits and the gains of `sampled_frequency`.
        stabiliser: chooses the virtual constraints of each phase; an object or one of `STABILISERS` by name.
        delay: known time from a reading to the torques it leads to [s], a multiple of the period.
    """

    def __init__(
        self,
        biped: FrontalBiped,
        gait: Gait,
        *,
        period: float = 1e-3,
        settings: ControllerSettings | None = None,
        stabiliser: Stabiliser | str = "adaptive",
        delay: float = 0.0,
    ) -> None:
        raise NotImplementedError

    def reset(self, stance: Stance, q: FloatArray, dq: FloatArray) -> None:
        """Start right after an impact, standing on ``stance`` at q (4,) [rad], dq (4,) [rad/s]."""

    def tick(self, reading: Reading) -> WalkerCommand:
        """Torques for a reading."""
        raise NotImplementedError

    def counters(self) -> dict[str, int]:
        """What happened so far: ticks, unsolved, declined, landings early and late, ..."""
        raise NotImplementedError
