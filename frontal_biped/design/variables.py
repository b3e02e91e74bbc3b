"""Which of the free parameters stands where among the variables of a design."""

from typing import cast

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.design.forward_mode import Dual
from frontal_biped.gait.gait import Gait
from frontal_biped.gait.sideways import SidewaysStep
from frontal_biped.virtual_constraints.bezier import bernstein, elevate
from frontal_biped.virtual_constraints.invariance import FreeParameters, free_parameters
from frontal_biped.virtual_constraints.phase import Phase

BETA_REVERSAL, BETA_IMPACT, STEP_WIDTH = 0, 1, 2
"""The first variables of every design."""


class VariableLayout:
    """Order of the variables (P,).

    beta_r-, beta_f-, L_s, rising columns 2..M, falling columns 2..M-1 (both column by column), rising FRI coefficients,
    falling FRI coefficients 1..M_FRI.

    Args:
        degree: M of the joints.
        fri_degree: M_FRI.

    Attributes:
        size: P.
        fri: which variables are FRI coefficients.
        last_falling_column: which variables are the falling column M - 1.
    """

    def __init__(self, degree: int, fri_degree: int) -> None:
        self.degree, self.fri_degree = degree, fri_degree
        sizes = [3, 3 * (degree - 1), 3 * (degree - 2), fri_degree + 1, fri_degree]
        self._splits = np.cumsum(sizes)
        self.size = int(self._splits[-1])
        self.last_falling_column = range(int(self._splits[2]) - 3, int(self._splits[2]))
        self.fri = slice(int(self._splits[2]), self.size)

    def unpack(self, x: FloatArray) -> FreeParameters:
        """Free parameters of a variable vector (P,)."""
        a, b, c, d, e = self._splits
        rising = np.reshape(x[a:b], (-1, 3)).T if not isinstance(x, Dual) else _columns(x, a, b)
        falling = np.reshape(x[b:c], (-1, 3)).T if not isinstance(x, Dual) else _columns(x, b, c)
        return FreeParameters(x[BETA_REVERSAL], x[BETA_IMPACT], x[STEP_WIDTH], rising, falling, x[c:d], x[d:e])

    def pack(self, free: FreeParameters) -> FloatArray:
        """Variable vector (P,) of free parameters."""
        head = [free.beta_reversal, free.beta_impact, free.step_width]
        columns = [free.rising_columns.T.ravel(), free.falling_columns.T.ravel()]
        return np.concatenate([head, *columns, free.rising_fri, free.falling_fri])

    def of(self, gait: Gait | SidewaysStep) -> FloatArray:
        """Variables (P,) of a gait, of any degree: raised exactly, lowered by least squares."""
        rising, falling = self._as_phase(gait.rising), self._as_phase(gait.falling)
        return self.pack(free_parameters(rising, falling, gait.step_width))

    def scale(self) -> FloatArray:
        """(P,) changes of the variables that matter alike: 0.1 rad of a joint, 0.02 of the rest."""
        scale = np.full(self.size, 0.1)
        scale[:3] = 0.02, 0.02, 0.05
        scale[self.fri] = 0.02
        return scale

    def _as_phase(self, phase: Phase) -> Phase:
        """The phase in this layout's degrees."""
        joints, fri = _of_degree(phase.joint_bezier, self.degree), _of_degree(phase.fri_bezier, self.fri_degree)
        return Phase(phase.beta_start, phase.beta_end, joints, fri)


def _columns(x: Dual, begin: int, end: int) -> FloatArray:
    return cast("FloatArray", x[begin:end].reshape(-1, 3).T)


def _of_degree(coefficients: FloatArray, degree: int) -> FloatArray:
    """Bezier coefficients (..., degree + 1) of the same polynomials, or of the nearest of a lower degree."""
    if coefficients.shape[-1] <= degree + 1:
        return elevate(coefficients, degree)
    s = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, 4 * coefficients.shape[-1]))
    values = bernstein(coefficients.shape[-1] - 1, s) @ coefficients.T
    return np.asarray(np.linalg.lstsq(bernstein(degree, s), values, rcond=None)[0].T, dtype=np.float64)
