"""State of the pinned robot: configuration and velocities, one value that travels together."""

from typing import NamedTuple

from frontal_biped.arrays import FloatArray
from frontal_biped.model.stance_map import relabel


class State(NamedTuple):
    """Where the robot is and how fast it moves, in stance coordinates.

    Attributes:
        q: (4,) configuration [rad].
        dq: (4,) velocities [rad/s].
    """

    q: FloatArray
    dq: FloatArray

    @property
    def beta(self) -> float:
        """Stance ankle angle [rad]."""
        return float(self.q[0])

    @property
    def dbeta(self) -> float:
        """Rate of the stance ankle [rad/s]."""
        return float(self.dq[0])

    def relabelled(self) -> "State":
        """The same state with the roles of the legs exchanged."""
        return State(relabel(self.q), relabel(self.dq))
