"""What moves a robot in space: the contract that MuJoCo keeps, and that another simulator could keep."""

from typing import NamedTuple, Protocol

from frontal_biped.arrays import FloatArray
from frontal_biped.control.spatial_walker.interface import SpatialReading
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.engine import Move
from frontal_biped.simulation.space.pushes import SpatialPushForces


class SpatialState(NamedTuple):
    """Configuration and velocity of a `FreeRobot`.

    Attributes:
        q: (nq,) root position [m], root quaternion (x, y, z, w), joints [rad].
        v: (nv,) linear [m/s] and angular [rad/s] velocity of the root link in its own axes, joint rates [rad/s].
    """

    q: FloatArray
    v: FloatArray


class SolePose(NamedTuple):
    """Where a foot's sole is.

    Attributes:
        position: (3,) of the origin of its frame, below the ankle, in the world [m].
        rotation: (3, 3) its axes in the world.
    """

    position: FloatArray
    rotation: FloatArray


class SpatialEngine(Protocol):
    """What moves the robot."""

    @property
    def name(self) -> str:
        """For the record."""

    def place(self, q: FloatArray, v: FloatArray) -> None:
        """Put the robot at q (nq,), v (nv,) of its `FreeRobot`, on level ground at z = 0."""

    def read(self, t: float) -> SpatialReading:
        """True values of everything a sensor measures, at time t [s]."""

    def state(self) -> SpatialState:
        """Configuration and velocity."""

    def com(self) -> tuple[FloatArray, FloatArray]:
        """Centre of mass (3,) of the true robot in the world [m] and its velocity (3,) [m/s]."""

    def sole(self, side: Stance) -> SolePose:
        """Where a foot's sole is."""

    def wrenches(self) -> FloatArray:
        """(2, 6) what the ground does to the left and the right foot as the last period began.

        Force [N], then moment about the origin of the sole's frame [N m], in world axes.
        """

    def torques(self) -> FloatArray:
        """(n,) what the motors gave in the last period, within all their limits, on average [N m]."""

    def raise_ground(self, stance: Stance, height: float) -> None:
        """Height of the ground on which a foot in the air will land [m]."""

    def advance(self, t: float, end: float, tau: FloatArray, pushes: SpatialPushForces) -> Move:
        """Under commanded joint torques (n,) [N m] from t to ``end`` [s]; of events only a fall is told."""
