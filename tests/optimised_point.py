"""A point of a small problem, as the optimiser asks for it."""

from typing import NamedTuple

from random_states import FloatArray


class Point(NamedTuple):
    cost: float
    cost_gradient: FloatArray
    residual_jacobian: FloatArray
    equality: FloatArray
    equality_jacobian: FloatArray
    margins: FloatArray
    margins_jacobian: FloatArray
