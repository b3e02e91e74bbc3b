"""Between URDF joint coordinates and the stance coordinates of the paper, for either stance foot.

The URDF turns a child link against its parent about +X from pelvis to foot; the paper's chain runs from the
stance foot to the swing foot and counts counter-clockwise in (h, v). Let phi = sign * (q_urdf - reference) be the
URDF angles about +X in the order left ankle, left hip, right hip, right ankle, and S = diag(1, 1, -1, -1). Then

    left stance:   q = -pi/2 + S phi                 right stance:   q = -pi/2 + reverse(S phi)

since mirroring the robot changes the sign of every roll angle. Velocities follow by differentiation and, power
being the same in both coordinates, torques transform like velocities: u = S sign tau, reversed in right stance.
Relabelling at impact is therefore a plain reversal of q, dq and u alike.
"""

from dataclasses import dataclass
from enum import Enum
from functools import cached_property

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.model.chain import UPRIGHT

_CHAIN_SIGN = np.array([1.0, 1.0, -1.0, -1.0])
_UPRIGHT = np.full(4, UPRIGHT)


class Stance(Enum):
    """Which foot stands.

    Attributes:
        sign: +1 for the left foot, -1 for the right one: where it stands on the world's y axis, and how runs store it.
            The h axis of the frontal plane, from the stance foot towards the swing foot, points to -sign on the y axis.
    """

    LEFT = "left"
    RIGHT = "right"

    sign: float

    def __init__(self, name: str) -> None:
        self.sign = 1.0 if name == "left" else -1.0  # kept: `Stance.LEFT` is a search, and ticks ask for a sign often

    @property
    def other(self) -> "Stance":
        """The other foot."""
        return _OTHER[self]

    __hash__ = object.__hash__  # members are single; Enum's own is a Python call, some fifty in a control tick

    @classmethod
    def of_sign(cls, sign: float) -> "Stance":
        """The foot that `sign` stands for."""
        return cls.LEFT if sign > 0.0 else cls.RIGHT


_OTHER = {Stance.LEFT: Stance.RIGHT, Stance.RIGHT: Stance.LEFT}


def relabel(chain_vector: FloatArray) -> FloatArray:
    """Exchange the roles of stance and swing leg: (4,) q, dq or u, reversed ([O], symmetry of Sec. II-B)."""
    return chain_vector[..., ::-1]


@dataclass(frozen=True)
class StanceMap:
    """Coordinates of one robot.

    Attributes:
        axis_sign: (4,) +1 where a URDF axis points along +X, -1 where it points along -X.
        reference: (4,) URDF angles of the roll joints at the upright reference [rad].
        joint_names: URDF joint names, left ankle, left hip, right hip, right ankle.
    """

    axis_sign: FloatArray
    reference: FloatArray
    joint_names: tuple[str, ...]

    def positions_to_stance(self, q_urdf: FloatArray, stance: Stance) -> FloatArray:
        """Stance coordinates q (..., 4) [rad] of URDF joint angles (..., 4), in the order of `joint_names`."""
        return _UPRIGHT + self._to_chain(q_urdf - self.reference, stance)

    def positions_to_urdf(self, q: FloatArray, stance: Stance) -> FloatArray:
        """URDF joint angles (..., 4) [rad] of stance coordinates q (..., 4)."""
        return self._to_urdf(q - _UPRIGHT, stance) + self.reference

    def velocities_to_stance(self, dq_urdf: FloatArray, stance: Stance) -> FloatArray:
        """Stance velocities dq (..., 4) [rad/s] of URDF joint velocities (..., 4)."""
        return self._to_chain(dq_urdf, stance)

    def velocities_to_urdf(self, dq: FloatArray, stance: Stance) -> FloatArray:
        """URDF joint velocities (..., 4) [rad/s] of stance velocities dq (..., 4)."""
        return self._to_urdf(dq, stance)

    def torques_to_stance(self, tau_urdf: FloatArray, stance: Stance) -> FloatArray:
        """Stance torques u (..., 4) [N m] of URDF joint torques (..., 4)."""
        return self._to_chain(tau_urdf, stance)

    def torques_to_urdf(self, u: FloatArray, stance: Stance) -> FloatArray:
        """URDF joint torques (..., 4) [N m] of stance torques u (..., 4)."""
        return self._to_urdf(u, stance)

    @cached_property
    def chain(self) -> dict[Stance, tuple[tuple[int, float, float], ...]]:
        """Of the joints of the chain on a foot: place in `joint_names`, sense, and URDF angle upright [rad]."""
        rows = list(zip(range(4), (_CHAIN_SIGN * self.axis_sign).tolist(), self.reference.tolist(), strict=True))
        return {Stance.LEFT: tuple(rows), Stance.RIGHT: tuple(reversed(rows))}

    @cached_property
    def _sign(self) -> dict[Stance, FloatArray]:
        """(4,) sense in which the chain from a stance foot counts each of its joints."""
        left = _CHAIN_SIGN * self.axis_sign
        return {Stance.LEFT: left, Stance.RIGHT: relabel(left).copy()}

    def _to_chain(self, urdf_vector: FloatArray, stance: Stance) -> FloatArray:
        chain = urdf_vector if stance.sign > 0.0 else relabel(urdf_vector)
        return self._sign[stance] * chain

    def _to_urdf(self, chain_vector: FloatArray, stance: Stance) -> FloatArray:
        urdf = self._sign[stance] * chain_vector
        return urdf if stance.sign > 0.0 else relabel(urdf)
