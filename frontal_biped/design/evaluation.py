"""Objective and constraints of a design at one point after another, recorded at the first."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple, cast

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.design.forward_mode import Dual, independent
from frontal_biped.design.rows import MarginLayout
from frontal_biped.design.tape import Tape
from frontal_biped.gait.constraints import Constraint

EQUALITY = 0.1
"""Unit of the equalities [rad^2/s^2], [rad]."""


@dataclass(frozen=True)
class Evaluation:
    """Objective and constraints at one point, with first derivatives.

    Attributes:
        cost: J [N^2 m s].
        cost_gradient: (P,).
        residual_jacobian: (8 n, P) of the weighted torques, whose squares add up to J.
        equality: (e,) periodicity defect, in units of 0.1 rad^2/s^2; then, of outputs with a lower degree than the
            highest, the differences of the columns that must vanish, in units of 0.1 rad.
        equality_jacobian: (e, P).
        margins: (k,) scaled margins, >= 0 where satisfied.
        margins_jacobian: (k, P).
    """

    cost: float
    cost_gradient: FloatArray
    residual_jacobian: FloatArray
    equality: FloatArray
    equality_jacobian: FloatArray
    margins: FloatArray
    margins_jacobian: FloatArray


class Quantities(NamedTuple):
    """What a design is about, as functions of its variables.

    Attributes:
        constraints: their values are `Dual`.
        equality: (e,) [rad^2/s^2], [rad].
        residuals: (r,) whose squares add up to J.
    """

    constraints: Sequence[Constraint]
    equality: Dual
    residuals: Dual


class RecordedEvaluation:
    """Quantities at a point, and, without asking the formulas again, at others.

    Args:
        x: (P,) the first point.
        quantities: of the variables.
    """

    def __init__(self, x: FloatArray, quantities: Callable[[Dual], Quantities]) -> None:
        self._tape = Tape()
        self._at: FloatArray | None = x.copy()
        self._variables = independent(x, self._tape)
        self._found = quantities(self._variables)
        values = [constraint.values for constraint in self._found.constraints]
        self._values = cast("Dual", np.concatenate(values)).block

    def move(self, x: FloatArray) -> None:
        """Go to a point (P,); nothing is to be done where it is already."""
        if self._at is None or not np.array_equal(self._at, x):
            self._at = None  # nowhere, should the formulas have no value at x
            self._variables.value[...] = x
            self._tape.run()
            self._at = x.copy()

    def evaluation(self, layout: Callable[[Sequence[Constraint]], MarginLayout]) -> Evaluation:
        """At the point where it is.

        Args:
            layout: of the margins.
        """
        rows, equality, residuals = layout(self._found.constraints), self._found.equality, self._found.residuals
        margins = np.take(self._values, rows.picks, axis=1)
        margins[0] -= rows.bound
        margins *= rows.factor
        residual, jacobian = residuals.value.copy(), residuals.derivative.T.copy()
        return Evaluation(
            float(residual @ residual),
            2.0 * residual @ jacobian,
            jacobian,
            equality.value / EQUALITY,
            equality.derivative.T / EQUALITY,
            margins[0],
            margins[1:].T,
        )
