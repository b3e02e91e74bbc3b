"""The gait design problem: minimise J over what hybrid invariance leaves free, under C01 to C09.

Pose and slope at impact and reversal, the final pose and the continuity of the FRI are eliminated, not constrained;
the one equality left is periodicity, Z(beta_r-) = 0, with beta_r- a decision variable. Everything is evaluated on the
quadrature nodes from the reversal with exact derivatives.
"""

from functools import lru_cache
from typing import ClassVar, NamedTuple, cast

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.design.both_phases import BothPhases
from frontal_biped.design.derivatives import DifferentiableBiped, Nodes, Z
from frontal_biped.design.ends import Periodic, StepEnds
from frontal_biped.design.evaluation import EQUALITY, Quantities, RecordedProblem
from frontal_biped.design.forward_mode import Dual
from frontal_biped.design.landing import DifferentiableLanding
from frontal_biped.design.local_model import largest_violation
from frontal_biped.design.plane_derivatives import plane_dynamics
from frontal_biped.design.tape import written
from frontal_biped.design.variables import BETA_IMPACT, STEP_WIDTH, VariableLayout
from frontal_biped.gait.constraints import Constraint, SoleHeights, step_constraints
from frontal_biped.gait.gait import Gait
from frontal_biped.gait.holding_wrench import HoldingWrench, StepHolding
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.impact import Landing
from frontal_biped.model.robot import FootSole
from frontal_biped.model.space.plane_masses import PlaneMasses
from frontal_biped.model.stance_map import relabel
from frontal_biped.numerics.quadrature import reversal_quadrature
from frontal_biped.virtual_constraints.invariance import (
    FreeParameters,
    PhaseParameters,
    StepBegin,
    complete,
    falling_parameters,
    final_falling_slope,
    rising_parameters,
)
from frontal_biped.virtual_constraints.phase import Phase
from frontal_biped.zero_dynamics.orbit import PhaseOrbit
from frontal_biped.zero_dynamics.poincare import StepOrbit, step_orbit

FLOOR_Z = 1e-2
"""Below this zeta/tau^2 [kg^2 m^4/s^2] the square root is continued smoothly, so that an iterate without an orbit
still has a cost and a gradient; a gait has values of about 10."""

COLUMN_REACH = 3.0
"""How far a Bezier column may be from that of the start [rad]."""

ANGLE_REACH = 0.15
"""How far beta_r- and beta_f- may be from those of the start [rad]."""


class DesignProblem(RecordedProblem):
    """Objective, constraints, bounds and start of one design.

    Its variables are those of `VariableLayout`.

    Args:
        biped: the robot.
        specification: degrees and bounds.
        size: quadrature nodes a phase.
        tighten_by: distance that every scaled constraint keeps from its bound.
        ends: what the step begins and ends with; default: its own landing, as a gait does.
        column_reach: how far a Bezier column may be from that of the start [rad].
        within: (P,) variables that the bounds leave room for as well, but for those that the specification and the
            ends bound.

    Raises:
        RobotError: the specification bounds the holding wrench, and the length of the soles is not known.
    """

    SPECIFIED_VARIABLES: ClassVar = {STEP_WIDTH: ("step_width[0]", "step_width[1]")}
    """Index of a variable whose bounds stand in the specification: their entries."""

    def __init__(
        self,
        biped: FrontalBiped,
        specification: GaitSpecification,
        size: int,
        tighten_by: float = 0.0,
        *,
        ends: StepEnds | None = None,
        column_reach: float = COLUMN_REACH,
        within: FloatArray | None = None,
    ) -> None:
        super().__init__(tighten_by)
        self.biped = biped
        self.specification = specification
        self.ends: StepEnds = Periodic(biped, specification) if ends is None else ends
        self.column_reach = column_reach
        self.within = within
        self.rule = reversal_quadrature(size)
        self._differentiable, self._landing = DifferentiableBiped(biped), DifferentiableLanding(biped)
        self._in_space: list[tuple[FootSole, PlaneMasses]] = []
        if specification.bounds_holding_wrench:
            self._in_space = [(sole, PlaneMasses.of(biped, sole.side)) for sole in biped.robot.soles]
        M, F = max(specification.degrees), specification.fri_degree
        self._both = BothPhases(self.rule, M, F)
        self.layout = VariableLayout(M, F)
        self.size = self.layout.size

    def on_nodes(self, size: int, tighten_by: float = 0.0) -> "DesignProblem":
        """The same problem on ``size`` quadrature nodes a phase, tightened by no more than ``tighten_by``."""
        return DesignProblem(
            self.biped,
            self.specification,
            size,
            tighten_by,
            ends=self.ends,
            column_reach=self.column_reach,
            within=self.within,
        )

    # ------------------------------------------------------------------ variables
    def unpack(self, x: FloatArray) -> FreeParameters:
        """Free parameters of a variable vector (P,), as the ends of the step want them."""
        return self.ends.completed(self.layout.unpack(x))

    def variables(self, gait: Gait) -> FloatArray:
        """Variables (P,) of a gait, of any degree: raised exactly, lowered by least squares."""
        return self.layout.of(gait)

    def scale(self) -> FloatArray:
        """(P,) changes of the variables that matter alike."""
        return self.layout.scale()

    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Lower and upper bounds (P,) of the variables.

        Bezier columns may leave the start by ``column_reach`` and FRI coefficients the middle of the sole by three of
        its halves, since only the polynomials, not their coefficients, have to stay in the robot's limits. A point that
        the bounds shall leave room for has the same reach around it.
        """
        middle = self.ends.starts(self.layout)[-1]
        low, high = middle - self.column_reach, middle + self.column_reach
        low[:2], high[:2] = middle[:2] - ANGLE_REACH, middle[:2] + ANGLE_REACH
        outer, inner = self.biped.sole
        low[self.layout.fri], high[self.layout.fri] = 2.0 * outer - inner, 2.0 * inner - outer
        if self.within is not None:
            away = self.within - middle
            low, high = low + np.minimum(away, 0.0), high + np.maximum(away, 0.0)
        low[STEP_WIDTH], high[STEP_WIDTH] = self.specification.step_width
        which, values = self.ends.held(self.layout)
        low[which] = high[which] = values
        return low, high

    def start(self) -> FloatArray:
        """Default start (P,): of those that the ends of the step name, the one nearest to a step."""
        tried = self.ends.starts(self.layout)
        if len(tried) == 1:
            return tried[0]

        def defect(x: FloatArray) -> float:
            point = self.evaluate(x)
            return largest_violation(point) if np.isfinite(point.cost) else np.inf

        low, high = self.bounds()
        return min((np.clip(x, low, high) for x in tried), key=defect)

    # ------------------------------------------------------------------ evaluation
    def _quantities(self, x: Dual) -> Quantities:
        free, q_minus, landing = self.landing(x)
        departure = self.ends.departure
        begin = StepBegin(q_minus, landing.slope) if departure is None else departure.begin
        found = self.step_from(begin, free, q_minus, landing)
        constraints = step_constraints(
            self.biped, self.specification, found.lifted, found.soles, departure=self.departing, holding=found.holding
        )
        # the orbit itself must exist, whatever the floor says
        constraints += [
            Constraint("", "orbit", "", orbit.z, FLOOR_Z, None, 10.0)
            for orbit in (found.step.rising, found.step.falling)
        ]
        balance = np.stack(self.ends.balance(found.step))
        return Quantities(constraints, cast("Dual", np.concatenate([balance, *found.surplus])), found.torques)

    def equality(self, x: FloatArray, nodes: int) -> FloatArray:
        """(e,) the equalities of `evaluate` at x (P,) on other quadrature nodes, without derivatives.

        Raises:
            UnreachablePoseError: the final pose does not exist.
            ReversalError: a phase has no range of beta.
        """
        phases = self.phases(x)
        step = step_orbit(self.biped, *phases, float(x[STEP_WIDTH]), nodes)
        return np.concatenate([self.ends.balance(step), *self.surplus(*phases)]) / EQUALITY

    def surplus(self, rising: Phase | PhaseParameters, falling: Phase | PhaseParameters) -> list[FloatArray]:
        """Leading coefficients of outputs of a lower degree than the highest, which must vanish [rad]."""
        degrees = self.specification.degrees
        return [*_surplus(rising.joint_bezier, degrees), *_surplus(falling.joint_bezier, degrees)]

    def phases(self, x: FloatArray) -> tuple[Phase, Phase]:
        """Rising and falling phase at x (P,).

        Raises:
            UnreachablePoseError: the final pose does not exist.
        """
        departure = self.ends.departure
        return complete(self.biped, self.unpack(x), departure and departure.begin)

    @property
    def departing(self) -> Landing | None:
        """The impact that the step begins with, where it is not the one it ends with."""
        departure = self.ends.departure
        return departure and departure.landing

    def _holding(self, lifted: PhaseOrbit) -> StepHolding | None:
        """What the ground must hold at the nodes of both phases, where the specification bounds it."""
        if not self._in_space:
            return None
        of_foot = []
        for sole, masses in self._in_space:
            [dynamics] = plane_dynamics(masses, [lifted.motion])
            rows = dynamics.at(lifted.ddbeta, lifted.dbeta**2)
            of_foot.append([HoldingWrench(sole, rows[:, nodes]) for nodes in self._both.slices])
        return StepHolding(*zip(*of_foot, strict=True))

    def landing(self, x: Dual) -> tuple[FreeParameters, FloatArray, Landing]:
        """Free parameters at x (P,), the pose (4,) that the step lands in [rad], and its impact per unit of dbeta."""
        free = self.unpack(cast("FloatArray", x))
        final = self._landing.pose(x[BETA_IMPACT], x[STEP_WIDTH])
        q_minus = cast("FloatArray", final.q)
        flat = self._landing.impact(final, cast("Dual", final_falling_slope(free, q_minus)))
        rates = (cast("FloatArray", flat[rows]) for rows in _LANDING_ROWS)
        return free, q_minus, Landing(relabel(q_minus), *rates)

    def step_from(
        self, begin: StepBegin, free: FreeParameters, q_minus: FloatArray, landing: Landing
    ) -> "EvaluatedStep":
        """The step that begins with one landing and ends with another, as `landing` has it."""
        rising = rising_parameters(free, *begin)
        falling = falling_parameters(free, q_minus, rising)
        Delta, nodes = self._both.motion(rising, falling)
        projection = self._differentiable.project(nodes)
        orbit = self._both.orbit(nodes, projection.restricted)
        put_above_floor(orbit, nodes)
        width = cast("Dual", free.step_width)
        lifted, torques = self._differentiable.passing(nodes, orbit, width, self._both.sign, projection.terms)
        return EvaluatedStep(
            StepOrbit(*self._both.apart(Delta, orbit), landing, free.step_width),
            StepOrbit(*self._both.apart(Delta, lifted), landing, free.step_width),
            SoleHeights(*(projection.soles[:, nodes] for nodes in self._both.slices)),
            self.surplus(rising, falling),
            self._both.in_turn(cast("Dual", torques)),
            self._holding(lifted),
        )


class EvaluatedStep(NamedTuple):
    """A step at the variables of a design.

    Attributes:
        step: the step.
        lifted: the step with z > 0 everywhere, see `put_above_floor`.
        soles: heights of its swing sole.
        surplus: the leading coefficients that must vanish.
        torques: (8 n,) whose squares add up to J, of the lifted step.
        holding: what the ground must hold along the lifted step, where that is bounded.
    """

    step: StepOrbit
    lifted: StepOrbit
    soles: SoleHeights
    surplus: list[FloatArray]
    torques: Dual
    holding: StepHolding | None


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


_LANDING_ROWS = (slice(0, 4), slice(4, 7), slice(7, 9), slice(9, 11))
"""Of `DifferentiableLanding.impact`: dq_plus, impulse, lift_off, touchdown."""


def put_above_floor(orbit: PhaseOrbit, nodes: Nodes) -> None:
    """Let the nodes have z > 0 everywhere: below FLOOR_Z a hyperbola that continues it with equal slope."""
    z, table = cast("Dual", orbit.z), nodes.scalars.block[:, Z]

    def fill() -> None:
        low = z.value < FLOOR_Z
        np.copyto(table, z.block.T)
        if low.any():
            share = FLOOR_Z / (2.0 * FLOOR_Z - z.value[low])
            table[low] *= share[:, None] ** 2
            table[low, 0] = FLOOR_Z * share

    written(z.tape, fill)
