"""Change from one gait to another in a single step, without leaving the zero dynamics.

A transition step begins with the pose, slope and speed in which one gait has landed and ends with the pose, slope and
speed in which another one lands. Pose and slope are built in, as hybrid invariance is in a gait; two equalities match
the speeds. The tracking error is zero at both switches, so a library of gaits can be walked from one to the other.
"""

from dataclasses import dataclass, replace

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.design.closing import close_step
from frontal_biped.design.optimise import OPTIMISER_NODES, SAFETY, TIGHTENING_ROUNDS
from frontal_biped.design.problem import COLUMN_REACH, DesignProblem
from frontal_biped.design.trust_region_sqp import SqpSettings, minimise
from frontal_biped.exceptions import DesignFailedError, GaitFileError
from frontal_biped.gait.check import ConstraintReport, check_constraints
from frontal_biped.gait.constraints import Constraint, SoleHeights, step_constraints
from frontal_biped.gait.gait import Gait
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.virtual_constraints.invariance import (
    FreeParameters,
    PhaseParameters,
    double_support_pose,
    falling_parameters,
    rising_parameters,
)
from frontal_biped.virtual_constraints.phase import Phase
from frontal_biped.zero_dynamics.poincare import Landing, StepOrbit, landing_on_constraints


@dataclass(frozen=True)
class Transition:
    """One step from a gait to another.

    Attributes:
        gait: phases, step width and figures of the step; no periodic gait, its ``orbit.multiplier`` means nothing.
        report: the constraints on the dense grid.
        speed_error: relative error of the speed it ends with, against the second gait's [-].
    """

    gait: Gait
    report: ConstraintReport
    speed_error: float


class TransitionProblem(DesignProblem):
    """Design of a transition; variables as in `DesignProblem`, those of the final pose and slope held.

    Args:
        biped: the robot.
        specification: the bounds.
        size: quadrature nodes a phase.
        before: the gait walked until now.
        after: the gait walked from the next impact on.
        tighten_by: distance that every scaled constraint keeps from its bound.
    """

    def __init__(
        self,
        biped: FrontalBiped,
        specification: GaitSpecification,
        size: int,
        before: Gait,
        after: Gait,
        tighten_by: float = 0.0,
    ) -> None:
        super().__init__(biped, specification, size, tighten_by)
        self.before, self.after = before, after
        start = before.rising.motion(np.array([before.rising.beta_start]))
        end = after.falling.motion(np.array([after.falling.beta_end]))
        self._q_plus, self._slope_plus = start.q[0], start.dq[0, 1:]
        self._slope_minus = end.dq[0, 1:]
        self._q_minus = double_support_pose(biped, after.falling.beta_end, after.step_width)
        landed = before.falling.motion(np.array([before.falling.beta_end]))
        self.departure: Landing = landing_on_constraints(biped, landed.q[0], landed.dq[0])
        arrival = landing_on_constraints(biped, end.q[0], end.dq[0])
        self._speed_start = before.orbit.beta_dot_after_impact
        self._speed_end = after.orbit.beta_dot_after_impact / float(arrival.speed_ratio)

    def on_nodes(self, size: int) -> "TransitionProblem":
        """The same problem on ``size`` quadrature nodes a phase, nothing tightened."""
        return TransitionProblem(self.biped, self.specification, size, self.before, self.after)

    def unpack(self, x: FloatArray) -> FreeParameters:
        """Free parameters, with the last free falling column where the final slope wants it."""
        free = super().unpack(x)
        M = max(self.specification.degrees)
        column = self._q_minus[1:] - self._slope_minus * (free.beta_impact - free.beta_reversal) / M
        columns = np.concatenate([free.falling_columns[:, :-1], column[:, None]], axis=1)
        return replace(free, falling_columns=columns)

    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Bounds (P,): what the second gait's landing fixes is held."""
        around = 0.5 * (self.variables(self.before) + self.variables(self.after))
        low, high = around - COLUMN_REACH, around + COLUMN_REACH
        low[0], high[0] = around[0] - 0.15, around[0] + 0.15
        outer, inner = self.biped.sole
        fri = slice(self._splits[2], None)
        low[fri], high[fri] = 3.0 * outer, 3.0 * inner
        held = self.variables(self.after)
        column = slice(self._splits[1] - 3, self._splits[1])
        for part in (slice(1, 3), column):
            low[part] = high[part] = held[part]
        return low, high

    def start(self) -> FloatArray:
        """First gait, second gait or their mean (P,), with the final pose held: the one nearest to a step."""
        low, high = self.bounds()
        ends = self.variables(self.before), self.variables(self.after)
        tried = [np.clip(x, low, high) for x in (*ends, 0.5 * (ends[0] + ends[1]))]

        def defect(x: FloatArray) -> float:
            point = self.evaluate(x)
            worst = max(float(-np.min(point.margins)), float(np.max(np.abs(point.equality))))
            return worst if np.isfinite(point.cost) and np.isfinite(worst) else np.inf

        return min(tried, key=defect)

    def phases(self, x: FloatArray) -> tuple[Phase, Phase]:
        """Rising and falling phase at x (P,)."""
        free = self.unpack(x)
        rising = self._rising(free, self._q_minus, self.departure)
        falling = falling_parameters(free, self._q_minus, rising)
        first, second = (
            Phase(float(part.beta_start), float(part.beta_end), np.asarray(part.joint_bezier), part.fri_bezier)
            for part in (rising, falling)
        )
        return first, second

    def _rising(self, free: FreeParameters, q_minus: FloatArray, landing: Landing) -> PhaseParameters:
        """The rising phase begins where the first gait has landed."""
        return rising_parameters(free, self._q_plus[::-1], self._slope_plus)

    def balance(self, step: StepOrbit) -> list[float]:
        """Squared speeds less what the gaits want, at the start and at the end [rad^2/s^2]."""
        ends = ((step.rising, self._speed_start), (step.falling, self._speed_end))
        return [2.0 * orbit.z[-1] / orbit.restricted.I_P[-1] ** 2 - speed**2 for orbit, speed in ends]

    def constraints(self, step: StepOrbit, soles: SoleHeights, duration: float | None = None) -> list[Constraint]:
        """As for a gait, but the step departs from the first gait's impact."""
        return step_constraints(self.biped, self.specification, step, soles, duration, self.departure)


def design_transition(
    biped: FrontalBiped, before: Gait, after: Gait, specification: GaitSpecification | None = None
) -> Transition:
    """The cheapest step from one gait to another.

    Args:
        biped: the robot.
        before: the gait walked until now.
        after: the gait walked from the next impact on.
        specification: bounds of the step; default: of each bound the looser one of both gaits.

    Returns:
        The transition, checked on the dense grid.

    Raises:
        DesignFailedError: no such step keeps the bounds.
        GaitFileError: the gaits belong to different robots.
    """
    if before.robot.fingerprint != after.robot.fingerprint:
        raise GaitFileError(
            f"a transition from {before.robot.name!r} to {after.robot.name!r}: the gaits must be of one robot"
        )
    spec = _looser(before, after) if specification is None else specification
    problem = TransitionProblem(biped, spec, OPTIMISER_NODES, before, after, SAFETY)
    low, high = problem.bounds()
    x = problem.start()
    for _ in range(TIGHTENING_ROUNDS):
        result = minimise(problem.evaluate, x, low, high, problem.scale(), SqpSettings())
        if not result.feasible:
            raise DesignFailedError(
                f"no single step leads from one gait to the other within the bounds: {result.message}, violation"
                f" {result.violation:.2g}; take gaits nearer to each other, or relax the specification"
            )
        closed = close_step(problem, result.x)
        x = closed.x
        report = check_constraints(biped, spec, *closed.phases, closed.step, departure=problem.departure)
        if report.satisfied:
            break
        problem.tighten(report.shortfall)
    else:
        raise DesignFailedError(
            f"the step found violates {report.violated[0].name} between the optimiser's nodes; relax the specification"
        )
    gait = closed.gait(problem)
    speed = float(closed.step.falling.dbeta[-1] / problem._speed_end) - 1.0
    return Transition(gait, report, speed)


def _looser(before: Gait, after: Gait) -> GaitSpecification:
    """Of each bound the looser one; a bound that one of the gaits does not have is dropped."""
    first, second = (gait.specification.as_dict() for gait in (before, after))
    table = {}
    for key in first.keys() & second.keys():
        a, b = first[key], second[key]
        if key in ("step_duration", "step_width"):
            table[key] = [min(a[0], b[0]), max(a[1], b[1])]
        elif key in ("friction", "fri_degree", "seed") or (key.startswith("max_") and key != "max_torque"):
            table[key] = max(a, b)
        elif key in ("max_torque", "degree"):
            table[key] = np.maximum(a, b).tolist()
        else:
            table[key] = min(a, b)
    return GaitSpecification.from_dict(table)
