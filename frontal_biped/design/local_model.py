"""A problem around one point, as sequential quadratic programming sees it: quadratic cost, linear constraints.

The program is elastic: the linearised constraints may be violated by one common slack t, at the price rho (t + t^2/2),
so no linearisation is inconsistent.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from frontal_biped.arrays import FloatArray
from frontal_biped.numerics.active_set import ConvexProgram


class PointEvaluation(Protocol):
    """Values and derivatives at one point."""

    @property
    def cost(self) -> float:
        """Objective."""

    @property
    def cost_gradient(self) -> FloatArray:
        """(P,)."""

    @property
    def residual_jacobian(self) -> FloatArray:
        """(R, P) of residuals whose squares add up to the objective."""

    @property
    def equality(self) -> FloatArray:
        """(e,)."""

    @property
    def equality_jacobian(self) -> FloatArray:
        """(e, P)."""

    @property
    def margins(self) -> FloatArray:
        """(k,) must be >= 0."""

    @property
    def margins_jacobian(self) -> FloatArray:
        """(k, P)."""


class Multipliers(NamedTuple):
    """Of the scaled problem: what a unit of each bound costs.

    Attributes:
        margins: (k,) not negative.
        equality: (e,).
        box: (P,) of the bounds of the scaled variables, positive at the lower one; zero where the trust region and
            not the bound holds the variable.
    """

    margins: FloatArray
    equality: FloatArray
    box: FloatArray


class Step(NamedTuple):
    """Answer of a subproblem: scaled step (P,), multipliers, and which constraints are met exactly."""

    step: FloatArray
    multipliers: Multipliers
    active: tuple[int, ...]


class Box(NamedTuple):
    """Where a scaled step may end: inside the bounds of the variables and of the trust region, (P,) each."""

    low: FloatArray
    high: FloatArray
    low_is_bound: NDArray[np.bool_]
    high_is_bound: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Model:
    """The problem around one point: quadratic cost, linear constraints, and the price of violating them.

    Attributes:
        point: values and derivatives.
        hessian: (P, P) of the scaled cost.
        penalty: rho.
        scale: (P,) of the variables.
        cost_scale: of the cost.
    """

    point: PointEvaluation
    hessian: FloatArray
    penalty: float
    scale: FloatArray
    cost_scale: float

    @cached_property
    def gradient(self) -> FloatArray:
        """(P,) of the scaled cost."""
        return self.cost_scale * self.point.cost_gradient * self.scale

    @cached_property
    def merit_here(self) -> float:
        """The penalty function at the point."""
        return self.merit(self.point)

    @cached_property
    def violation_here(self) -> float:
        """Largest violation of a constraint at the point."""
        return largest_violation(self.point)

    def merit(self, point: PointEvaluation) -> float:
        """The scaled penalty function at any point; inf where it lies outside the domain of the formulas."""
        merit = self.cost_scale * point.cost + self.price(largest_violation(point))
        # an iterate without a value (nan, or a cost of nonsense) is no progress
        return merit if np.isfinite(merit) and point.cost > 0.0 else np.inf

    def value(self, step: FloatArray) -> float:
        """Of the scaled penalty function after a step, as the model has it."""
        quadratic = self.gradient @ step + 0.5 * step @ self.hessian @ step
        return float(self.cost_scale * self.point.cost + quadratic + self.price(self.violation(step)))

    def violation(self, step: FloatArray) -> float:
        """Largest violation of the linearised constraints after a step."""
        margins, equality = self._slopes
        return _violation(self.point.margins + margins @ step, self.point.equality + equality @ step)

    def price(self, violation: float) -> float:
        """Of a violation t: rho (t + t^2/2). The square keeps the subproblem strictly convex in the slack."""
        return self.penalty * (violation + 0.5 * violation * violation)

    @cached_property
    def _normals(self) -> FloatArray:
        """(rows, P + 1) of the elastic program in (step, t).

        Margins, equalities from either side, lower bounds, t >= 0, upper bounds.
        """
        k, (e, n) = len(self.point.margins), self.point.equality_jacobian.shape
        elastic = k + 2 * e
        C = np.zeros((elastic + 2 * n + 1, n + 1))
        np.multiply(self.point.margins_jacobian, self.scale, out=C[:k, :n])
        np.multiply(self.point.equality_jacobian, self.scale, out=C[k : k + e, :n])
        np.negative(C[k : k + e, :n], out=C[k + e : elastic, :n])
        C[:elastic, n] = 1.0
        rows = np.arange(n + 1)
        C[elastic + rows, rows] = 1.0
        C[elastic + n + 1 + rows[:n], rows[:n]] = -1.0
        return C

    @cached_property
    def _slopes(self) -> tuple[FloatArray, FloatArray]:
        """(k, P) of the margins and (e, P) of the equalities, by scaled variables."""
        C, k, (e, n) = self._normals, len(self.point.margins), self.point.equality_jacobian.shape
        return C[:k, :n], C[k : k + e, :n]

    @cached_property
    def _program(self) -> ConvexProgram:
        n = len(self.scale)
        H = np.zeros((n + 1, n + 1))
        H[:n, :n], H[n, n] = self.hessian, self.penalty
        return ConvexProgram(H, np.append(self.gradient, self.penalty), self._normals)

    def step(self, at: PointEvaluation, shift: FloatArray | None, box: Box, expected: Sequence[int]) -> Step:
        """The step in a box that the model likes best.

        Args:
            at: where the values of the constraints are taken.
            shift: (P,) from the model's point to there; None: it is there.
            box: where the step may end.
            expected: rows that may be active.

        Raises:
            ArithmeticError: rounding.
        """
        margins, equality = at.margins, at.equality
        if shift is not None:
            steepness, steepness_of_equality = self._slopes
            margins, equality = margins - steepness @ shift, equality - steepness_of_equality @ shift
        answer = self._program.solve(
            np.concatenate([-margins, -equality, equality, box.low, [0.0], -box.high]), expected
        )
        k, e, n = len(margins), len(equality), len(self.scale)
        elastic = k + 2 * e
        price = answer.multipliers
        above, below = price[k : k + e], price[k + e : elastic]
        at_low, at_high = price[elastic : elastic + n], price[elastic + n + 1 :]
        at_bounds = np.where(box.low_is_bound, at_low, 0.0) - np.where(box.high_is_bound, at_high, 0.0)
        multipliers = Multipliers(price[:k], above - below, at_bounds)
        return Step(np.clip(answer.x[:n], box.low, box.high), multipliers, answer.active)


def largest_violation(point: PointEvaluation) -> float:
    """Of a scaled constraint at a point; inf where one has no value."""
    worst = _violation(point.margins, point.equality)
    return worst if np.isfinite(worst) else np.inf


def _violation(margins: FloatArray, equality: FloatArray) -> float:
    """Largest violation of a constraint; nan where one has no value."""
    return float(np.maximum(-np.min(margins, initial=0.0), np.max(np.abs(equality), initial=0.0)))
