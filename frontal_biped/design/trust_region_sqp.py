"""Trust-region sequential quadratic programming for a smooth problem with many inequalities.

    minimise f(x) = sum of squares   subject to   c_E(x) = 0,   c_I(x) >= 0,   low <= x <= high

Each step solves an elastic quadratic program (`local_model`), so the answer of an infeasible problem is the point that
violates it least. Steps are measured with the exact penalty function f + rho max(|c_E|, -c_I); a step that fails for
the curvature of the constraints is corrected to second order before the trust region shrinks. The Hessian is the
Gauss-Newton matrix of the sum of squares while that makes progress; to finish, damped BFGS updates add to it what it
does not see of the Lagrangian (`curvature`; cf. Nocedal and Wright, Numerical Optimization, Ch. 10 and 18).
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.design.curvature import gauss_newton, updated
from frontal_biped.design.local_model import Box, Model, Multipliers, PointEvaluation, Step, largest_violation

GAIN_OF_PENALTY = 0.7
"""A larger penalty that leaves more than this share of the violation will not make the problem feasible."""

STEERED = 0.3
"""A step that leaves more than this share of the violation asks whether a larger penalty would leave less."""

CLOSE = 0.1
"""A predicted decrease below this share of the cost is close to the answer; ..."""

GAIN_OF_GAUSS_NEWTON = 0.75
"""... if less than this share of it comes true there, curvature that Gauss-Newton does not see has the say."""

OUTSIDE_DOMAIN = 1e6
"""A scaled violation this large means that the start lies where the formulas have no meaning."""


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
        self.gauss_newton = gauss_newton(point, scale, settings.cost_scale)
        self.model = Model(point, self.gauss_newton, settings.penalty, scale, settings.cost_scale)
        self.secant = False
        self.multipliers: Multipliers | None = None
        self.active: tuple[int, ...] = ()

    def run(self, on_iteration: Callable[[int, float, float], None] | None) -> SqpResult:
        settings = self.settings
        converged, message, count = False, "the iteration limit was reached", 0
        settled = np.inf  # violation where the iteration settled under the last penalty
        if not (
            self.model.violation_here < OUTSIDE_DOMAIN
            and np.isfinite(self.model.merit_here + np.sum(self.model.hessian))
        ):
            message = "the start is outside the domain of the problem"
            violation = self.model.violation_here
            return SqpResult(self.x, self.model.point.cost, violation, 0, self.evaluations, False, False, message)
        for count in range(1, settings.max_iterations + 1):
            if settings.stop_when_feasible and self.model.violation_here <= settings.feasible:
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
            predicted = self.model.merit_here - self.model.value(answer.step)
            if predicted < settings.tolerance or self.radius < settings.min_radius:
                if not self.secant:  # Gauss-Newton is done: finish with curvature of the constraints
                    self.secant, self.radius = True, max(self.radius, 1e-2)
                    continue
                violation = self.model.violation_here
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
                on_iteration(count, self.model.point.cost, self.model.violation_here)
        violation = self.model.violation_here
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
    def _take(self, answer: Step, predicted: float) -> float:
        """Try the step; returns its gain, the actual over the predicted decrease."""
        merit, step = self.model.merit_here, answer.step
        trial = self._evaluate(step)
        gain = (merit - self.model.merit(trial)) / predicted
        if gain < 0.75 and self.model.violation_here < largest_violation(trial) < 5.0:
            corrected, second = self._corrected(trial, step)
            if self.model.merit(second) < self.model.merit(trial):
                step, trial = corrected, second
                gain = (merit - self.model.merit(trial)) / predicted
        length = float(np.max(np.abs(step)))
        if gain > 1e-4:
            before = self.gauss_newton
            hessian = self.gauss_newton = gauss_newton(trial, self.scale, self.settings.cost_scale)
            if self.secant:
                hessian = updated(self.model, hessian - before, step, trial, answer.multipliers)
            self.x = np.clip(self.x + self.scale * step, self.low, self.high)
            self.model = replace(self.model, point=trial, hessian=hessian)
        if gain > 0.75 and length > 0.9 * self.radius:
            self.radius = min(2.0 * self.radius, self.settings.max_radius)
        elif gain < 0.25:
            self.radius = (0.5 if gain > 0.0 else 0.25) * length
        return gain

    def _steered(self) -> Step:
        """The next step, under a penalty large enough for the constraints' linearisations to be worth meeting.

        Where the step leaves most of the violation but a larger penalty would not, the penalty grows at once
        (steering rule, cf. Byrd, Nocedal and Waltz 2008), not only when the iteration has settled.
        """
        answer = self._subproblem(self.model)
        violation, settings = self.model.violation_here, self.settings
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

    def _subproblem(self, model: Model, at: PointEvaluation | None = None, shift: FloatArray | None = None) -> Step:
        """Step of a model, with constraint values taken at ``at`` = x + shift (second-order correction) or at x."""
        to_low, to_high = (self.low - self.x) / self.scale, (self.high - self.x) / self.scale
        box = Box(
            np.maximum(to_low, -self.radius),
            np.minimum(to_high, self.radius),
            to_low >= -self.radius,
            to_high <= self.radius,
        )
        step = model.step(model.point if at is None else at, shift, box, self.active)
        self.active = step.active
        return step

    def _evaluate(self, step: FloatArray) -> PointEvaluation:
        self.evaluations += 1
        return self.evaluate(np.clip(self.x + self.scale * step, self.low, self.high))
