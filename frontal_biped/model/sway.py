"""The sway: how far the centre of mass is inwards of the stance ankle, as one state has it."""

from typing import NamedTuple

from frontal_biped.arrays import FloatArray


class Sway(NamedTuple):
    """How far the centre of mass is inwards of the stance ankle, which is taken to be at rest.

    Attributes:
        value: [m].
        rate: [m/s].
        J: (nv,) Jacobian; of the planar robot (4,).
        drift: its acceleration where the robot does not accelerate [m/s^2].
    """

    value: float
    rate: float
    J: FloatArray
    drift: float
