"""What moves the robot in a sampled walk: the contract that our engine and MuJoCo's keep."""

from collections.abc import Sequence
from typing import NamedTuple, Protocol

from frontal_biped.arrays import FloatArray
from frontal_biped.control.interface import Reading
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.state import State
from frontal_biped.simulation.hybrid_system import EventKind
from frontal_biped.simulation.pushes import PushForces
from frontal_biped.simulation.stance_motion import Reaction

AT_ONCE = 1e-12
"""Time before the end of a control period that is not worth a step [s]."""


class Move(NamedTuple):
    """What happened until the end of a control period, or until the first event in it.

    Attributes:
        t: when it ends [s].
        steps: of the integrator: duration [s], time reached [s] and state there; at an event, before it.
        event: what ended it, if anything did.
        fell: how the robot fell, if it did.
    """

    t: float
    steps: Sequence[tuple[float, float, State]] = ()
    event: EventKind | None = None
    fell: EventKind | str | None = None


class Engine(Protocol):
    """What moves the robot."""

    @property
    def name(self) -> str:
        """For the record."""

    def place(self, stance: Stance, state: State) -> None:
        """Stand on a foot right after an impact; the feet are level about y = 0."""

    def read(self, t: float) -> Reading:
        """True values of everything a sensor measures, at time t [s]."""

    def stance_state(self, stance: Stance) -> State:
        """The state for a foot taken as the stance foot."""

    def reaction(self, stance: Stance) -> Reaction:
        """Ground reaction on a foot."""

    def foot_position(self, stance: Stance) -> tuple[float, float]:
        """y of a foot's ankle [m] and the foot's rotation about +X [rad]."""

    def raise_ground(self, stance: Stance, height: float) -> None:
        """Height of the ground on which a foot in the air will land [m]."""

    def advance(self, t: float, end: float, tau: FloatArray, pushes: PushForces) -> Move:
        """Under held joint torques (4,) [N m] from t to ``end`` [s], or to the first event the engine tells of."""


def first_foothold(biped: FrontalBiped, stance: Stance, q: FloatArray) -> float:
    """y of the first stance ankle [m]: the feet are level about y = 0, as in a walk on the spot."""
    return 0.5 * stance.sign * float(biped.joint_positions(q)[-1, 0])
