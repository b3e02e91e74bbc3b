"""Trust-region sequential quadratic programming for a smooth problem with many inequalities.

    minimise f(x) = sum of squares   subject to   c_E(x) = 0,   c_I(x) >= 0,   low <= x <= high

Each step solves an elastic quadratic program (the linearised constraints may be violated by one common slack t, at
the price rho t), so no linearisation is ever inconsistent, and the answer of an infeasible problem is the point that
violates it least. Steps are measured with the exact penalty function f + rho max(|c_E|, -c_I); a step that fails for
the curvature of the constraints is corrected to second order before the trust region shrinks. The Hessian is the
Gauss-Newton matrix of the sum of squares while that makes progress; to finish, damped BFGS updates add to it what it
does not see of the Lagrangian (cf. Nocedal and Wright, Numerical Optimization, Ch. 10 and 18).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from frontal_biped.arrays import FloatArray
from frontal_biped.numerics.active_set import ConvexProgram

GAIN_OF_PENALTY = 0.7
"""A larger penalty that leaves more than this share of the violation will not make the problem feasible."""

STEERED = 0.3
"""A step that leaves more than this share of the violation asks whether a larger penalty would leave less."""

CLOSE = 0.05
"""A predicted decrease below this share of the cost is close to the answer; ..."""

GAIN_OF_GAUSS_NEWTON = 0.75
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
    """Answer of a subproblem: scaled step (P,), multipliers, and which constraints are met exactly."""

    step: FloatArray
    multipliers: Multipliers
    active: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class _Model:
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
    def _margins(self) -> FloatArray:
        return np.ascontiguousarray(self.point.margins_jacobian * self.scale)

    @cached_property
    def _equality(self) -> FloatArray:
        return self.point.equality_jacobian * self.scale

    def value(self, step: FloatArray) -> float:
        """Of the scaled penalty function after a step, as the model has it."""
        quadratic = self.gradient @ step + 0.5 * step @ self.hessian @ step
        return float(self.cost_scale * self.point.cost + quadratic + self.price(self.violation(step)))

    def violation(self, step: FloatArray) -> float:
        """Largest violation of the linearised constraints after a step."""
        return _violation(self.point.margins + self._margins @ step, self.point.equality + self._equality @ step)

    def price(self, violation: float) -> float:
        """Of a violation t: rho (t + t^2/2). The square keeps the subproblem strictly convex in the slack."""
        return self.penalty * (violation + 0.5 * violation * violation)

    @cached_property
    def _program(self) -> ConvexProgram:
        """Elastic QP in (step, t): margins, equalities from either side, lower bounds, t >= 0, upper bounds."""
        A, a = self._margins, self._equality
        k, (e, n) = len(A), a.shape
        elastic = k + 2 * e
        C = np.zeros((elastic + 2 * n + 1, n + 1))
        C[:k, :n], C[k : k + e, :n], C[k + e : elastic, :n], C[:elastic, n] = A, a, -a, 1.0
        C[elastic : elastic + n + 1], C[elastic + n + 1 :] = np.eye(n + 1), -np.eye(n, n + 1)
        H = np.zeros((n + 1, n + 1))
        H[:n, :n], H[n, n] = self.hessian, self.penalty
        return ConvexProgram(H, np.append(self.gradient, self.penalty), C)

    def step(self, at: PointEvaluation, shift: FloatArray, box: "_Box", expected: Sequence[int]) -> _Step:
        """The step in a box that the model likes best, with constraint values taken at ``at``, a ``shift`` away.

        Raises:
            ArithmeticError: rounding.
        """
        margins, equality = at.margins - self._margins @ shift, at.equality - self._equality @ shift
        answer = self._program.solve(
            np.concatenate([-margins, -equality, equality, box.low, [0.0], -box.high]), expected
        )
        k, e, n = len(margins), len(equality), len(shift)
        of_margins, above, below, at_low, _, at_high = np.split(answer.multipliers, np.cumsum([k, e, e, n, 1]))
        at_bounds = np.where(box.low_is_bound, at_low, 0.0) - np.where(box.high_is_bound, at_high, 0.0)
        multipliers = Multipliers(of_margins, above - below, at_bounds)
        return _Step(np.clip(answer.x[:n], box.low, box.high), multipliers, answer.active)


class _Box(NamedTuple):
    """Where a scaled step may end: inside the bounds of the variables and of the trust region, (P,) each."""

    low: FloatArray
    high: FloatArray
    low_is_bound: NDArray[np.bool_]
    high_is_bound: NDArray[np.bool_]


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
        self.evaluations = 1
        self.radius = settings.radius
        point = evaluate(x0)
        self.gauss_newton = self._gauss_newton_at(point)
        self.model = _Model(point, self.gauss_newton, settings.penalty, scale, settings.cost_scale)
        self.secant = False
        self.multipliers: Multipliers | None = None
        self.active: tuple[int, ...] = ()

    def run(self, on_iteration: Callable[[int, float, float], None] | None) -> SqpResult:
        settings = self.settings
        converged, message, count = False, "the iteration limit was reached", 0
        settled = np.inf  # violation where the iteration settled under the last penalty
        if not (
            largest_violation(self.model.point) < OUTSIDE_DOMAIN
            and np.isfinite(self._merit(self.model.point) + np.sum(self.model.hessian))
        ):
            message = "the start is outside the domain of the problem"
            violation = largest_violation(self.model.point)
            return SqpResult(self.x, self.model.point.cost, violation, 0, self.evaluations, False, False, message)
        for count in range(1, settings.max_iterations + 1):
            if settings.stop_when_feasible and largest_violation(self.model.point) <= settings.feasible:
                message = "a feasible point"
                break
            try:
                answer = self._steered()
            except ArithmeticError:  # never without rounding: the slack makes every subproblem feasible
                if self.radius < settings.min_radius:
                    message = "rounding: the subproblem has no answer"
                    break
                self.radius *= 0.25
                self.model = replace(self.model, hessian=self.gauss_newton)
                continue
            self.multipliers = answer.multipliers
            predicted = self._merit(self.model.point) - self.model.value(answer.step)
            if predicted < settings.tolerance or self.radius < settings.min_radius:
                if not self.secant:  # Gauss-Newton is done: finish with curvature of the constraints
                    self.secant, self.radius = True, max(self.radius, 1e-2)
                    continue
                violation = largest_violation(self.model.point)
                worth_it = violation < GAIN_OF_PENALTY * settled
                if violation > settings.feasible and self.model.penalty < settings.max_penalty and worth_it:
                    settled = violation
                    self.radius, self.secant = max(self.radius, 1e-2), False
                    dearer = 10.0 * self.model.penalty
                    self.model = replace(self.model, hessian=self.gauss_newton, penalty=dearer)
                    continue
                converged = predicted < settings.tolerance
                message = "converged" if converged else "the trust region became too small"
                break
            gain = self._take(answer, predicted)
            close = predicted < CLOSE * settings.cost_scale * self.model.point.cost
            self.secant = self.secant or (close and gain < GAIN_OF_GAUSS_NEWTON)
            if on_iteration is not None:
                on_iteration(count, self.model.point.cost, largest_violation(self.model.point))
        violation = largest_violation(self.model.point)
        return SqpResult(
            self.x,
            self.model.point.cost,
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
        merit, step = self._merit(self.model.point), answer.step
        trial = self._evaluate(step)
        gain = (merit - self._merit(trial)) / predicted
        if gain < 0.75 and largest_violation(self.model.point) < largest_violation(trial) < 5.0:
            corrected, second = self._corrected(trial, step)
            if self._merit(second) < self._merit(trial):
                step, trial = corrected, second
                gain = (merit - self._merit(trial)) / predicted
        length = float(np.max(np.abs(step)))
        if gain > 1e-4:
            before, self.gauss_newton = self.gauss_newton, self._gauss_newton_at(trial)
            hessian = self.gauss_newton
            if self.secant:
                hessian = self._updated(hessian - before, step, trial, answer.multipliers)
            self.x = np.clip(self.x + self.scale * step, self.low, self.high)
            self.model = replace(self.model, point=trial, hessian=hessian)
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
        answer = self._subproblem(self.model)
        violation, settings = largest_violation(self.model.point), self.settings
        left = self.model.violation(answer.step)
        while left > max(STEERED * violation, settings.feasible) and self.model.penalty < settings.max_penalty:
            dearer = replace(self.model, penalty=10.0 * self.model.penalty)
            other = self._subproblem(dearer)
            other_left = dearer.violation(other.step)
            if other_left > GAIN_OF_PENALTY * left:
                break
            self.model, answer, left = dearer, other, other_left
        return answer

    def _corrected(self, trial: PointEvaluation, step: FloatArray) -> tuple[FloatArray, PointEvaluation]:
        """Second-order correction: the same step with the constraints' values where it ended."""
        try:
            corrected = self._subproblem(self.model, trial, step).step
        except ArithmeticError:
            return step, trial
        return corrected, self._evaluate(corrected)

    def _subproblem(self, model: _Model, at: PointEvaluation | None = None, shift: FloatArray | None = None) -> _Step:
        """Step of a model, with constraint values taken at ``at`` = x + shift (second-order correction) or at x."""
        to_low, to_high = (self.low - self.x) / self.scale, (self.high - self.x) / self.scale
        box = _Box(
            np.maximum(to_low, -self.radius),
            np.minimum(to_high, self.radius),
            to_low >= -self.radius,
            to_high <= self.radius,
        )
        shift = np.zeros_like(self.x) if shift is None else shift
        step = model.step(model.point if at is None else at, shift, box, self.active)
        self.active = step.active
        return step

    # ------------------------------------------------------------------ models
    def _evaluate(self, step: FloatArray) -> PointEvaluation:
        self.evaluations += 1
        return self.evaluate(np.clip(self.x + self.scale * step, self.low, self.high))

    def _merit(self, point: PointEvaluation) -> float:
        merit = self.settings.cost_scale * point.cost + self.model.price(largest_violation(point))
        # an iterate outside the domain of the formulas (nan, or a cost of nonsense) is no progress
        return merit if np.isfinite(merit) and point.cost > 0.0 else np.inf

    def _gauss_newton_at(self, point: PointEvaluation) -> FloatArray:
        R = point.residual_jacobian * self.scale
        # einsum, not a BLAS product: the digits must not depend on the number of threads
        return 2.0 * self.settings.cost_scale * np.einsum("ri,rj->ij", R, R) + 1e-6 * np.eye(len(self.x))

    def _updated(self, seen: FloatArray, step: FloatArray, trial: PointEvaluation, price: Multipliers) -> FloatArray:
        """Powell's damped BFGS update with the multipliers of the quadratic program.

        Of the matrix so far with ``seen``, what Gauss-Newton has seen change on the way, so that updates add up to what
        it does not see (a structured secant, cf. Nocedal and Wright, Sec. 10.3); or, where that is not convex, of the
        matrix so far.
        """
        so_far = self.model.hessian
        change = self._lagrangian_gradient(trial, price) - self._lagrangian_gradient(self.model.point, price)
        for hessian in (so_far + seen, so_far):
            updated = _damped_bfgs(hessian, step, change)
            if updated is not None:
                return updated
        return so_far

    def _lagrangian_gradient(self, point: PointEvaluation, price: Multipliers) -> FloatArray:
        gradient = self.settings.cost_scale * point.cost_gradient
        gradient = gradient - price.margins @ point.margins_jacobian - price.equality @ point.equality_jacobian
        return gradient * self.scale


def _damped_bfgs(hessian: FloatArray, step: FloatArray, change: FloatArray) -> FloatArray | None:
    """A Hessian (P, P) after a step (P,) that changed the gradient by ``change``; None if not positive definite."""
    Hs = hessian @ step
    curvature, along = float(step @ Hs), float(step @ change)
    if curvature <= 0.0:
        return None
    if along < 0.2 * curvature:
        blend = 0.8 * curvature / (curvature - along)
        change = blend * change + (1.0 - blend) * Hs
        along = float(step @ change)
    updated = hessian - np.outer(Hs, Hs) / curvature + np.outer(change, change) / along
    try:
        np.linalg.cholesky(updated)
    except np.linalg.LinAlgError:
        return None
    return updated


def largest_violation(point: PointEvaluation) -> float:
    """Of a scaled constraint at a point; inf where one has no value."""
    worst = _violation(point.margins, point.equality)
    return worst if np.isfinite(worst) else np.inf


def _violation(margins: FloatArray, equality: FloatArray) -> float:
    """Largest violation of a constraint; nan where one has no value."""
    return float(np.maximum(-np.min(margins, initial=0.0), np.max(np.abs(equality), initial=0.0)))
