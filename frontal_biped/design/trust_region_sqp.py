"""Trust-region sequential quadratic programming for a smooth problem with many inequalities.

    minimise f(x) = sum of squares   subject to   c_E(x) = 0,   c_I(x) >= 0,   low <= x <= high

Each step solves an elastic quadratic program (the linearised constraints may be violated by one common slack t, at
the price rho t), so no linearisation is ever inconsistent, and the answer of an infeasible problem is the point that
violates it least. Steps are measured with the exact penalty function f + rho max(|c_E|, -c_I); a step that fails for
the curvature of the constraints is corrected to second order before the trust region shrinks. The Hessian is the
Gauss-Newton matrix of the sum of squares while that makes progress, and a damped BFGS matrix of the Lagrangian,
started from it, to finish (cf. Nocedal and Wright, Numerical Optimization, Ch. 18).
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.numerics.least_distance import solve_least_distance

GAIN_OF_PENALTY = 0.7
"""A larger penalty that leaves more than this share of the violation will not make the problem feasible."""

STEERED = 0.3
"""A step that leaves more than this share of the violation asks whether a larger penalty would leave less."""

CLOSE = 0.02
"""A predicted decrease below this share of the cost is close to the answer; ..."""

GAIN_OF_GAUSS_NEWTON = 0.6
"""... if less than this share of it comes true there, curvature that Gauss-Newton does not see has the say."""

OUTSIDE_DOMAIN = 1e6
"""A scaled violation this large means that the start lies where the formulas have no meaning."""


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


@dataclass(frozen=True)
class SqpSettings:
    """Settings of the iteration, in units of the scaled problem.

    Attributes:
        cost_scale: the objective is multiplied by this.
        penalty: first rho; it must exceed the sum of the multipliers for the penalty to be exact, so it grows tenfold
            whenever the iteration settles on a point that is not feasible.
        max_penalty: largest rho; a point that is not feasible then has the least violation nearby.
        radius: first trust region, in scaled variables.
        max_radius: largest trust region.
        min_radius: smallest trust region; below it the iteration stops.
        max_iterations: of the whole iteration.
        tolerance: predicted decrease of the scaled penalty function at which to stop.
        feasible: largest violation of a point that counts as feasible.
        stop_when_feasible: end at the first such point, whatever it costs.
    """

    cost_scale: float = 1e-2
    penalty: float = 1e3
    max_penalty: float = 1e6
    radius: float = 0.1
    max_radius: float = 10.0
    min_radius: float = 1e-9
    max_iterations: int = 300
    tolerance: float = 1e-7
    feasible: float = 1e-7
    stop_when_feasible: bool = False


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


@dataclass(frozen=True)
class SqpResult:
    """Where the iteration stopped.

    Attributes:
        x: (P,) best point.
        cost: objective there.
        violation: largest violation of a scaled constraint there.
        iterations: quadratic programs solved for a step.
        evaluations: of objective and constraints.
        converged: was the predicted decrease below the tolerance?
        feasible: was the violation small enough?
        message: why it stopped.
        multipliers: of the last subproblem; None before the first.
    """

    x: FloatArray
    cost: float
    violation: float
    iterations: int
    evaluations: int
    converged: bool
    feasible: bool
    message: str
    multipliers: Multipliers | None = None


def minimise(
    evaluate: Callable[[FloatArray], PointEvaluation],
    x0: FloatArray,
    low: FloatArray,
    high: FloatArray,
    scale: FloatArray,
    settings: SqpSettings,
    on_iteration: Callable[[int, float, float], None] | None = None,
) -> SqpResult:
    """Minimise from x0.

    Args:
        evaluate: objective and constraints with derivatives at x (P,); values that are not finite reject the step.
        x0: (P,) start.
        low: (P,) lower bounds.
        high: (P,) upper bounds.
        scale: (P,) typical changes of the variables.
        settings: of the iteration.
        on_iteration: called with iteration, objective and violation.

    Returns:
        The best point and how it was reached; infeasibility is a result, not an exception.
    """
    iteration = _Iteration(evaluate, np.clip(x0, low, high), low, high, scale, settings)
    return iteration.run(on_iteration)


class _Step(NamedTuple):
    """Answer of a subproblem: scaled step (P,) and multipliers."""

    step: FloatArray
    multipliers: Multipliers


class _Iteration:
    """State of one run: point, Hessian, trust region."""

    def __init__(
        self,
        evaluate: Callable[[FloatArray], PointEvaluation],
        x0: FloatArray,
        low: FloatArray,
        high: FloatArray,
        scale: FloatArray,
        settings: SqpSettings,
    ) -> None:
        self.evaluate, self.low, self.high, self.scale, self.settings = evaluate, low, high, scale, settings
        self.x = x0
        self.point = evaluate(x0)
        self.evaluations = 1
        self.radius = settings.radius
        self.penalty = settings.penalty
        self.hessian = self._gauss_newton()
        self.secant = False
        self.multipliers: Multipliers | None = None

    def run(self, on_iteration: Callable[[int, float, float], None] | None) -> SqpResult:
        settings = self.settings
        converged, message, count = False, "the iteration limit was reached", 0
        settled = np.inf  # violation where the iteration settled under the last penalty
        if not (
            largest_violation(self.point) < OUTSIDE_DOMAIN
            and np.isfinite(self._merit(self.point) + np.sum(self.hessian))
        ):
            message = "the start is outside the domain of the problem"
            violation = largest_violation(self.point)
            return SqpResult(self.x, self.point.cost, violation, 0, self.evaluations, False, False, message)
        for count in range(1, settings.max_iterations + 1):
            if settings.stop_when_feasible and largest_violation(self.point) <= settings.feasible:
                message = "a feasible point"
                break
            try:
                answer = self._steered()
            except ArithmeticError:  # never without rounding: the slack makes every subproblem feasible
                if self.radius < settings.min_radius:
                    message = "rounding: the subproblem has no answer"
                    break
                self.radius, self.hessian = 0.25 * self.radius, self._gauss_newton()
                continue
            self.multipliers = answer.multipliers
            predicted = self._merit(self.point) - self._model(answer.step)
            if predicted < settings.tolerance or self.radius < settings.min_radius:
                if not self.secant:  # Gauss-Newton is done: finish with curvature of the constraints
                    self.secant, self.radius = True, max(self.radius, 1e-2)
                    self.hessian = self._gauss_newton()
                    continue
                violation = largest_violation(self.point)
                worth_it = violation < GAIN_OF_PENALTY * settled
                if violation > settings.feasible and self.penalty < settings.max_penalty and worth_it:
                    settled = violation
                    self.penalty, self.radius = 10.0 * self.penalty, max(self.radius, 1e-2)
                    self.hessian, self.secant = self._gauss_newton(), False
                    continue
                converged = predicted < settings.tolerance
                message = "converged" if converged else "the trust region became too small"
                break
            gain = self._take(answer, predicted)
            close = predicted < CLOSE * settings.cost_scale * self.point.cost
            self.secant = self.secant or (close and gain < GAIN_OF_GAUSS_NEWTON)
            if on_iteration is not None:
                on_iteration(count, self.point.cost, largest_violation(self.point))
        violation = largest_violation(self.point)
        return SqpResult(
            self.x,
            self.point.cost,
            violation,
            count,
            self.evaluations,
            converged,
            violation <= settings.feasible,
            message,
            self.multipliers,
        )

    # ------------------------------------------------------------------ one step
    def _take(self, answer: _Step, predicted: float) -> float:
        """Try the step; returns its gain, the actual over the predicted decrease."""
        merit, step = self._merit(self.point), answer.step
        trial = self._evaluate(step)
        gain = (merit - self._merit(trial)) / predicted
        if gain < 0.75 and largest_violation(self.point) < largest_violation(trial) < 5.0:
            corrected, second = self._corrected(trial, step)
            if self._merit(second) < self._merit(trial):
                step, trial = corrected, second
                gain = (merit - self._merit(trial)) / predicted
        length = float(np.max(np.abs(step)))
        if gain > 1e-4:
            if self.secant:
                self._update_hessian(step, trial, answer.multipliers)
            self.x = np.clip(self.x + self.scale * step, self.low, self.high)
            self.point = trial
            if not self.secant:
                self.hessian = self._gauss_newton()
        if gain > 0.75 and length > 0.9 * self.radius:
            self.radius = min(2.0 * self.radius, self.settings.max_radius)
        elif gain < 0.25:
            self.radius = (0.5 if gain > 0.0 else 0.25) * length
        return gain

    def _steered(self) -> _Step:
        """The next step, under a penalty large enough for the constraints' linearisations to be worth meeting.

        Where the step leaves most of the violation but a larger penalty would not, the penalty grows at once
        (steering rule, cf. Byrd, Nocedal and Waltz 2008), not only when the iteration has settled.
        """
        answer = self._subproblem(self.point, np.zeros_like(self.x))
        violation = largest_violation(self.point)
        left = self._linear_violation(answer.step)
        while left > max(STEERED * violation, self.settings.feasible) and self.penalty < self.settings.max_penalty:
            self.penalty *= 10.0
            other = self._subproblem(self.point, np.zeros_like(self.x))
            other_left = self._linear_violation(other.step)
            if other_left > GAIN_OF_PENALTY * left:
                self.penalty /= 10.0
                break
            answer, left = other, other_left
        return answer

    def _corrected(self, trial: PointEvaluation, step: FloatArray) -> tuple[FloatArray, PointEvaluation]:
        """Second-order correction: the same step with the constraints' values where it ended."""
        try:
            corrected = self._subproblem(trial, step).step
        except ArithmeticError:
            return step, trial
        return corrected, self._evaluate(corrected)

    def _subproblem(self, at: PointEvaluation, shift: FloatArray) -> _Step:
        """Elastic QP in (step, t), with constraint values taken at ``at`` = x + shift (second-order correction)."""
        point, scale, n = self.point, self.scale, len(self.x)
        A, a = point.margins_jacobian * scale, point.equality_jacobian * scale
        margins, equality = at.margins - A @ shift, at.equality - a @ shift
        low = np.maximum((self.low - self.x) / scale, -self.radius)
        high = np.minimum((self.high - self.x) / scale, self.radius)
        # rows that cannot become active inside the box are left out
        kept = margins - np.abs(A) @ np.maximum(-low, high) < 0.0
        elastic = np.concatenate([A[kept], a, -a])
        rows, k = np.eye(n + 1), len(elastic)
        C = np.zeros((k + 2 * n + 1, n + 1))
        C[:k, :n], C[:k, n] = elastic, 1.0
        C[k : k + n + 1], C[k + n + 1 :] = rows, -rows[:n]
        c = np.concatenate([-margins[kept], -equality, equality, low, [0.0], -high])
        H = np.zeros((n + 1, n + 1))
        H[:n, :n], H[n, n] = self.hessian, self.penalty
        g = np.append(self.settings.cost_scale * point.cost_gradient * scale, self.penalty)
        answer = solve_least_distance(H, g, C, c)
        inequality = np.zeros(len(kept))
        e, count = len(equality), k - 2 * len(equality)
        inequality[kept] = answer.multipliers[:count]
        both = answer.multipliers[count:k]
        at_low = np.where((self.low - self.x) / scale >= -self.radius, answer.multipliers[k : k + n], 0.0)
        at_high = np.where((self.high - self.x) / scale <= self.radius, answer.multipliers[k + n + 1 :], 0.0)
        multipliers = Multipliers(inequality, both[:e] - both[e:], at_low - at_high)
        return _Step(np.clip(answer.x[:n], low, high), multipliers)

    # ------------------------------------------------------------------ models
    def _evaluate(self, step: FloatArray) -> PointEvaluation:
        self.evaluations += 1
        return self.evaluate(np.clip(self.x + self.scale * step, self.low, self.high))

    def _merit(self, point: PointEvaluation) -> float:
        merit = self.settings.cost_scale * point.cost + self._price(largest_violation(point))
        # an iterate outside the domain of the formulas (nan, or a cost of nonsense) is no progress
        return merit if np.isfinite(merit) and point.cost > 0.0 else np.inf

    def _price(self, violation: float) -> float:
        """Of a violation t: rho (t + t^2/2). The square keeps the subproblem strictly convex in the slack."""
        return self.penalty * (violation + 0.5 * violation * violation)

    def _linear_violation(self, step: FloatArray) -> float:
        """Largest violation of the linearised constraints after a step."""
        point, change = self.point, self.scale * step
        margins = point.margins + point.margins_jacobian @ change
        equality = point.equality + point.equality_jacobian @ change
        return max(0.0, float(-np.min(margins, initial=0.0)), float(np.max(np.abs(equality), initial=0.0)))

    def _model(self, step: FloatArray) -> float:
        gradient = self.settings.cost_scale * self.point.cost_gradient * self.scale
        quadratic = gradient @ step + 0.5 * step @ self.hessian @ step
        price = self._price(self._linear_violation(step))
        return float(self.settings.cost_scale * self.point.cost + quadratic + price)

    def _gauss_newton(self) -> FloatArray:
        R = self.point.residual_jacobian * self.scale
        # einsum, not a BLAS product: the digits must not depend on the number of threads
        return 2.0 * self.settings.cost_scale * np.einsum("ri,rj->ij", R, R) + 1e-6 * np.eye(len(self.x))

    def _update_hessian(self, step: FloatArray, trial: PointEvaluation, price: Multipliers) -> None:
        """Powell's damped BFGS update with the multipliers of the quadratic program."""

        def gradient(point: PointEvaluation) -> FloatArray:
            lagrangian = self.settings.cost_scale * point.cost_gradient
            lagrangian = lagrangian - price.margins @ point.margins_jacobian - price.equality @ point.equality_jacobian
            return lagrangian * self.scale

        change = gradient(trial) - gradient(self.point)
        Hs = self.hessian @ step
        curvature, along = float(step @ Hs), float(step @ change)
        if curvature <= 0.0:
            return
        if along < 0.2 * curvature:
            blend = 0.8 * curvature / (curvature - along)
            change = blend * change + (1.0 - blend) * Hs
            along = float(step @ change)
        self.hessian = self.hessian - np.outer(Hs, Hs) / curvature + np.outer(change, change) / along


def largest_violation(point: PointEvaluation) -> float:
    """Of a scaled constraint at a point; inf where one has no value."""
    worst = max(float(-np.min(point.margins, initial=0.0)), float(np.max(np.abs(point.equality), initial=0.0)))
    return max(0.0, worst) if np.isfinite(worst) else np.inf
