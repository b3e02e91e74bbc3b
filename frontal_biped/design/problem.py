"""The gait design problem: minimise J over what hybrid invariance leaves free, under C01 to C09.

Pose and slope at impact and reversal, the final pose and the continuity of the FRI are eliminated, not constrained;
the one equality left is periodicity, Z(beta_r-) = 0, with beta_r- a decision variable. Everything is evaluated on the
quadrature nodes from the reversal with exact derivatives.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import ClassVar, cast

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.design.derivatives import DifferentiableBiped, Projection
from frontal_biped.design.forward_mode import Dual, elementwise, independent
from frontal_biped.design.rows import MarginLayout, MarginRow, lay_out
from frontal_biped.design.start import swayed_stand
from frontal_biped.exceptions import UnreachablePoseError
from frontal_biped.gait.constraints import Constraint, SoleHeights, step_constraints
from frontal_biped.gait.gait import Gait
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.numerics.quadrature import reversal_quadrature
from frontal_biped.virtual_constraints.bezier import bernstein, elevate
from frontal_biped.virtual_constraints.invariance import (
    FreeParameters,
    PhaseParameters,
    complete,
    falling_parameters,
    final_falling_slope,
    rising_parameters,
)
from frontal_biped.virtual_constraints.phase import ConstrainedMotion, Phase, constrained_motion, phase_basis
from frontal_biped.zero_dynamics.orbit import PhaseOrbit, integrate_from_reversal
from frontal_biped.zero_dynamics.poincare import Landing, StepOrbit
from frontal_biped.zero_dynamics.restricted import TORQUES, RestrictedDynamics

FLOOR_Z = 1e-2
"""Below this zeta/tau^2 [kg^2 m^4/s^2] the square root is continued smoothly, so that an iterate without an orbit
still has a cost and a gradient; a gait has values of about 10."""


WORKABLE = 30.0
"""Scaled violation up to which linearised constraints lead anywhere: thirty times a typical size."""

COLUMN_REACH = 3.0
"""How far a Bezier column may be from that of the start [rad]."""

RESTORATIONS = 12
"""Halvings of the way from a start without an orbit to the default start."""


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


class DesignProblem:
    """Objective, constraints, bounds and start of one design.

    Variables, in this order: beta_r-, beta_f-, L_s, rising columns 2..M, falling columns 2..M-1 (both column by
    column), rising FRI coefficients, falling FRI coefficients 1..M_FRI.

    Args:
        biped: the robot.
        specification: degrees and bounds.
        size: quadrature nodes a phase.
        tighten_by: distance that every scaled constraint keeps from its bound.
    """

    SPECIFIED_VARIABLES: ClassVar = {2: ("step_width[0]", "step_width[1]")}
    """Index of a variable whose bounds stand in the specification: their entries."""

    def __init__(
        self, biped: FrontalBiped, specification: GaitSpecification, size: int, tighten_by: float = 0.0
    ) -> None:
        self.biped = biped
        self.specification = specification
        self.rule = reversal_quadrature(size)
        self._differentiable = DifferentiableBiped(biped)
        M, F = max(specification.degrees), specification.fri_degree
        tau_squared = self.rule.tau**2
        self._rising_basis = phase_basis(M, F, 1.0 - tau_squared)
        self._falling_basis = phase_basis(M, F, tau_squared)
        sizes = [3, 3 * (M - 1), 3 * (M - 2), F + 1, F]
        self._splits = np.cumsum(sizes)
        self.size = int(self._splits[-1])
        self.tighten_by = tighten_by
        self._tightened: dict[tuple[str, str], float] = {}
        self._layout: MarginLayout | None = None

    def on_nodes(self, size: int) -> "DesignProblem":
        """The same problem on ``size`` quadrature nodes a phase, nothing tightened."""
        return DesignProblem(self.biped, self.specification, size)

    # ------------------------------------------------------------------ variables
    def unpack(self, x: FloatArray) -> FreeParameters:
        """Free parameters of a variable vector (P,)."""
        a, b, c, d, e = self._splits
        rising = np.reshape(x[a:b], (-1, 3)).T if not isinstance(x, Dual) else _columns(x, a, b)
        falling = np.reshape(x[b:c], (-1, 3)).T if not isinstance(x, Dual) else _columns(x, b, c)
        return FreeParameters(x[0], x[1], x[2], rising, falling, x[c:d], x[d:e])

    def pack(self, free: FreeParameters) -> FloatArray:
        """Variable vector (P,) of free parameters."""
        head = [free.beta_reversal, free.beta_impact, free.step_width]
        columns = [free.rising_columns.T.ravel(), free.falling_columns.T.ravel()]
        return np.concatenate([head, *columns, free.rising_fri, free.falling_fri])

    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Lower and upper bounds (P,) of the variables.

        Bezier columns may leave the start by 3 rad and FRI coefficients the middle of the sole by three of its halves,
        since only the polynomials, not their coefficients, have to stay in the robot's limits.
        """
        start = self.start()
        low, high = start - COLUMN_REACH, start + COLUMN_REACH
        low[:2], high[:2] = start[:2] - 0.15, start[:2] + 0.15
        low[2], high[2] = self.specification.step_width
        outer, inner = self.biped.sole
        fri = slice(self._splits[2], None)
        low[fri], high[fri] = 3.0 * outer, 3.0 * inner
        return low, high

    def start(self) -> FloatArray:
        """Default start (P,): `swayed_stand`."""
        return self.pack(swayed_stand(self.biped, self.specification))

    def scale(self) -> FloatArray:
        """(P,) changes of the variables that matter alike: 0.1 rad of a joint, 0.02 of the rest."""
        scale = np.full(self.size, 0.1)
        scale[:3] = 0.02, 0.02, 0.05
        scale[self._splits[2] :] = 0.02
        return scale

    # ------------------------------------------------------------------ evaluation
    # a point without an orbit has roots of negative numbers; it is told by its values, not by warnings
    @np.errstate(over="ignore", invalid="ignore", divide="ignore")
    def evaluate(self, x: FloatArray) -> Evaluation:
        """Objective and constraints at x (P,), with exact derivatives."""
        step, soles, surplus = self._step(independent(x))
        lifted = step._replace(
            rising=_with_floor(step.rising),
            falling=_with_floor(step.falling),
        )
        constraints = self.constraints(lifted, soles)
        # the orbit itself must exist, whatever the floor says
        constraints += [
            Constraint("", "orbit", "", orbit.z, FLOOR_Z, None, 10.0) for orbit in (step.rising, step.falling)
        ]
        if self._layout is None:
            self._layout = lay_out(constraints, self._distance)
        layout = self._layout
        values = cast("Dual", np.concatenate([constraint.values for constraint in constraints])).block[:, layout.picks]
        equality = cast("Dual", np.concatenate([np.stack(self.balance(step)), *surplus]))
        # J is the sum of the squares of these
        torques = np.concatenate(
            [_weighted_torques(orbit, lifted.step_width) for orbit in (lifted.rising, lifted.falling)]
        )
        residual, residual_jacobian = cast("Dual", torques).value, cast("Dual", torques).derivative.T
        return Evaluation(
            float(residual @ residual),
            2.0 * residual @ residual_jacobian,
            residual_jacobian,
            equality.value / 0.1,
            equality.derivative.T / 0.1,
            (values[0] - layout.bound) * layout.factor,
            (values[1:] * layout.factor).T,
        )

    def constraints(self, step: StepOrbit, soles: SoleHeights, duration: float | None = None) -> list[Constraint]:
        """The constraints of a step of this problem; ``duration`` where the step is not on quadrature nodes."""
        return step_constraints(self.biped, self.specification, step, soles, duration)

    def balance(self, step: StepOrbit) -> list[float]:
        """Energies that must match [rad^2/s^2]: a periodic step returns the speed it began with."""
        return [step.periodicity]

    def phases(self, x: FloatArray) -> tuple[Phase, Phase]:
        """Rising and falling phase at x (P,).

        Raises:
            UnreachablePoseError: the final pose does not exist.
        """
        return complete(self.biped, self.unpack(x))

    def _distance(self, constraint: Constraint) -> float:
        """What a constraint keeps from its bounds, in units of its scale."""
        return self.tighten_by + self._tightened.get((constraint.code, constraint.name), 0.0)

    def rows(self) -> tuple[MarginRow, ...]:
        """What the margins of the last evaluation mean, in their order."""
        return () if self._layout is None else self._layout.meaning

    def restored(self, x: FloatArray) -> FloatArray:
        """The point itself, or where the formulas have no value there, one on the way to the default start.

        I_P next to zero, a knee of the polynomials beyond reach: half-way back, until the values are of a size that
        an optimiser can work with.
        """
        start = self.start()
        for _ in range(RESTORATIONS):
            try:
                point = self.evaluate(x)
                worst = max(float(-np.min(point.margins)), float(np.max(np.abs(point.equality))))
                if np.isfinite(point.cost) and worst < WORKABLE:
                    return x
            except UnreachablePoseError:
                pass
            x = 0.5 * (x + start)
        return start

    def variables(self, gait: Gait) -> FloatArray:
        """Variables (P,) of a gait, of any degree: raised exactly, lowered by least squares."""
        M, F = max(self.specification.degrees), self.specification.fri_degree
        rising, falling = (_of_degree(phase.joint_bezier, M) for phase in (gait.rising, gait.falling))
        rising_fri, falling_fri = (_of_degree(phase.fri_bezier, F) for phase in (gait.rising, gait.falling))
        return self.pack(
            FreeParameters(
                gait.beta_reversal,
                gait.falling.beta_end,
                gait.step_width,
                rising[:, 2:],
                falling[:, 2:-1],
                rising_fri,
                falling_fri[1:],
            )
        )

    def tighten(self, shortfall: Mapping[tuple[str, str], float]) -> None:
        """Move bounds inwards by the scaled violations found between the nodes, by code and name of the constraint."""
        for key, violation in shortfall.items():
            self._tightened[key] = self._tightened.get(key, 0.0) + 1.2 * violation
        self._layout = None

    def _step(self, x: Dual) -> tuple[StepOrbit, SoleHeights, list[FloatArray]]:
        free = self.unpack(cast("FloatArray", x))
        q_minus = self._differentiable.double_support_pose(x[1], x[2])
        dq_minus = final_falling_slope(free, cast("FloatArray", q_minus))
        flat = self._differentiable.impact(q_minus, cast("Dual", dq_minus))
        landing = Landing(*(cast("FloatArray", flat[part]) for part in _LANDING_PARTS))
        rising = self._rising(free, cast("FloatArray", q_minus), landing)
        falling = falling_parameters(free, cast("FloatArray", q_minus), rising)
        motions = [self._motion(+1, rising), self._motion(-1, falling)]
        up, down = self._differentiable.project(motions)
        rise = self._orbit(+1, free.beta_reversal - rising.beta_start, motions[0], up)
        fall = self._orbit(-1, free.beta_reversal - falling.beta_end, motions[1], down)
        surplus = [_surplus(phase.joint_bezier, self.specification.degrees) for phase in (rising, falling)]
        step = StepOrbit(rise, fall, landing, free.step_width)
        return step, SoleHeights(up.soles, down.soles), [part for parts in surplus for part in parts]

    def _rising(self, free: FreeParameters, q_minus: FloatArray, landing: Landing) -> PhaseParameters:
        """The rising phase begins where this very step lands."""
        return rising_parameters(free, q_minus, landing.dq_plus[1:] / landing.speed_ratio)

    def _motion(self, direction: int, phase: PhaseParameters) -> ConstrainedMotion:
        rising = direction > 0
        reversal, end = (phase.beta_end, phase.beta_start) if rising else (phase.beta_start, phase.beta_end)
        beta = reversal - (reversal - end) * self.rule.tau**2
        basis = self._rising_basis if rising else self._falling_basis
        return constrained_motion(basis, beta, phase.beta_end - phase.beta_start, phase.joint_bezier, phase.fri_bezier)

    def _orbit(self, direction: int, Delta: float, motion: ConstrainedMotion, projection: Projection) -> PhaseOrbit:
        restricted = RestrictedDynamics(projection.dynamics, motion.p_fri, motion.dp_fri)
        return integrate_from_reversal(self.rule, direction, Delta, motion, restricted)


def _surplus(joint_bezier: FloatArray, degrees: tuple[int, int, int]) -> list[FloatArray]:
    """Leading coefficients that an output of lower degree must not have: differences of its columns."""
    M = joint_bezier.shape[1] - 1
    return [joint_bezier[i] @ _leading(M, degree).T for i, degree in enumerate(degrees) if degree < M]


@lru_cache(maxsize=64)
def _leading(M: int, degree: int) -> FloatArray:
    """(M - degree, M + 1) rows that vanish on the M + 1 coefficients of a polynomial of the lower degree.

    They span the differences of order degree + 1 .. M, which grow like binomials; orthonormal rows do not.
    """
    rows = [np.diff(np.eye(M + 1), n=order, axis=0)[0] for order in range(degree + 1, M + 1)]
    return np.ascontiguousarray(np.linalg.qr(np.array(rows).T)[0].T)


_LANDING_PARTS = (slice(0, 4), slice(4, 7), slice(7, 9), slice(9, 11))


def _weighted_torques(orbit: PhaseOrbit, step_width: float) -> FloatArray:
    """(4 n,) u sqrt(weight dt/dtau / L_s) at the nodes."""
    density = np.sqrt(orbit.time_density / step_width) * np.sqrt(orbit.weights)
    return (orbit.generalized_forces[TORQUES] * density).reshape(-1)


def _columns(x: Dual, begin: int, end: int) -> FloatArray:
    return cast("FloatArray", x[begin:end].reshape(-1, 3).T)


def _with_floor(orbit: PhaseOrbit) -> PhaseOrbit:
    """The orbit with z > 0 everywhere: below FLOOR_Z a hyperbola that continues it with equal slope."""
    z = cast("Dual", orbit.z)
    low = z.value < FLOOR_Z
    if not np.any(low):
        return orbit
    share = FLOOR_Z / (2.0 * FLOOR_Z - np.minimum(z.value, FLOOR_Z))
    value = np.where(low, FLOOR_Z * share, z.value)
    slope = np.where(low, share**2, 1.0)
    return replace(orbit, z=cast("FloatArray", elementwise(z, value, slope)))


def _of_degree(coefficients: FloatArray, degree: int) -> FloatArray:
    """Bezier coefficients (..., degree + 1) of the same polynomials, or of the nearest of a lower degree."""
    if coefficients.shape[-1] <= degree + 1:
        return elevate(coefficients, degree)
    s = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, 4 * coefficients.shape[-1]))
    values = bernstein(coefficients.shape[-1] - 1, s) @ coefficients.T
    return np.asarray(np.linalg.lstsq(bernstein(degree, s), values, rcond=None)[0].T, dtype=np.float64)
