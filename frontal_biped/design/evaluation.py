"""Objective and constraints of a design at one point after another, recorded at the first."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass
from typing import NamedTuple, Self, cast

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.design.forward_mode import Dual, independent
from frontal_biped.design.rows import MarginLayout, MarginRow, lay_out
from frontal_biped.design.tape import Tape, done
from frontal_biped.gait.constraints import Constraint

EQUALITY = 0.1
"""Unit of the equalities [rad^2/s^2], [rad]."""

LEAST_TIGHTENING = 1e-7
"""Least scaled distance that a bound is moved inwards by: what counts as feasible to the optimiser."""


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
        # (values, 1 + P), so that a margin has its derivatives behind it
        values = [cast("Dual", constraint.values).block.T for constraint in self._found.constraints]
        self._values = done(self._tape, np.concatenate, values, 0)

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
        margins = np.take(self._values, rows.picks, axis=0)
        margins[:, 0] -= rows.bound
        margins *= rows.factor[:, None]
        weighted = np.array(residuals.block.T, order="C")
        residual, jacobian = weighted[:, 0].copy(), weighted[:, 1:]
        return Evaluation(
            float(residual @ residual),
            2.0 * residual @ jacobian,
            jacobian,
            equality.value / EQUALITY,
            equality.derivative.T / EQUALITY,
            margins[:, 0].copy(),
            margins[:, 1:],
        )


class RecordedProblem(ABC):
    """A design problem at one point after another; its bounds can be moved inwards.

    Args:
        tighten_by: distance that every scaled constraint keeps from its bound.
    """

    def __init__(self, tighten_by: float) -> None:
        self.tighten_by = tighten_by
        self._tightened: dict[tuple[str, str], float] = {}
        self._margins: MarginLayout | None = None
        self._recorded: RecordedEvaluation | None = None

    @abstractmethod
    def _quantities(self, x: Dual) -> Quantities:
        """What the design is about, at x (P,)."""

    # a point without an orbit has roots of negative numbers; it is told by its values, not by warnings
    @np.errstate(over="ignore", invalid="ignore", divide="ignore")
    def evaluate(self, x: FloatArray) -> Evaluation:
        """Objective and constraints at x (P,), with exact derivatives."""
        if self._recorded is None:
            self._recorded = RecordedEvaluation(x, self._quantities)
        else:
            self._recorded.move(x)
        return self._recorded.evaluation(self._layout)

    def rows(self) -> tuple[MarginRow, ...]:
        """What the margins of the last evaluation mean, in their order."""
        return () if self._margins is None else self._margins.meaning

    def tighten(self, shortfall: Mapping[tuple[str, str], float]) -> None:
        """Move bounds inwards by the scaled violations found between the nodes, by code and name of the constraint.

        By a little more, and never by less than an optimiser's rounding: the next violation lies elsewhere.
        """
        for key, violation in shortfall.items():
            self._tightened[key] = self._tightened.get(key, 0.0) + max(1.2 * violation, LEAST_TIGHTENING)
        self._margins = None

    @property
    def tightened(self) -> bool:
        """Has any bound been moved inwards?"""
        return bool(self._tightened)

    def untightened(self) -> Self:
        """The same problem with no bound moved inwards; what was recorded serves both."""
        other = copy(self)
        other._tightened, other._margins = {}, None
        return other

    def _layout(self, constraints: Sequence[Constraint]) -> MarginLayout:
        """Rows of margins under the bounds as they are tightened now."""
        if self._margins is None:
            self._margins = lay_out(constraints, self._distance)
        return self._margins

    def _distance(self, constraint: Constraint) -> float:
        """What a constraint keeps from its bounds, in units of its scale."""
        return self.tighten_by + self._tightened.get((constraint.code, constraint.name), 0.0)
