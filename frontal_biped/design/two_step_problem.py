"""The design problem of a gait that travels sideways: two different steps in turn, under C01 to C09.

Pose and slope at all four transitions are eliminated, as in `problem`: either step begins with the landing of the
other one. So is the travel, which leaves one step width. The two equalities that are left are the energy balances at
the two impacts, with both reversals as decision variables. Everything of one step is `DesignProblem`'s.
"""

from typing import cast

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.design.evaluation import EQUALITY, Quantities, RecordedProblem
from frontal_biped.design.forward_mode import Dual
from frontal_biped.design.problem import FLOOR_Z, DesignProblem
from frontal_biped.design.two_step_start import carried_over
from frontal_biped.design.variables import STEP_WIDTH
from frontal_biped.gait.constraints import STEP_WIDTH as WIDTH_CONSTRAINT
from frontal_biped.gait.constraints import Constraint
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.gait.two_step_constraints import TwoPhases, two_step_constraints
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.virtual_constraints.invariance import StepBegin, complete_in_turn
from frontal_biped.zero_dynamics.poincare import step_orbit
from frontal_biped.zero_dynamics.two_steps import TwoSteps


class TwoStepProblem(RecordedProblem):
    """Objective, constraints, bounds and start of one design.

    Its variables (2 P - 1,) are those of step B in the order of `VariableLayout`, then those of step A without its
    step width, which is B's and the travel.

    Args:
        biped: the robot.
        specification: degrees, bounds and travel.
        size: quadrature nodes a phase.
        tighten_by: distance that every scaled constraint keeps from its bound.
    """

    def __init__(
        self, biped: FrontalBiped, specification: GaitSpecification, size: int, tighten_by: float = 0.0
    ) -> None:
        super().__init__(tighten_by)
        self.biped, self.specification = biped, specification
        self.travel = specification.travel or 0.0
        self.step = DesignProblem(biped, specification, size)
        P = self.step.size
        self.size = 2 * P - 1
        self._of_b = np.arange(P)
        self._of_a = np.insert(np.arange(P, self.size), STEP_WIDTH, STEP_WIDTH)

    def on_nodes(self, size: int, tighten_by: float = 0.0) -> "TwoStepProblem":
        """The same problem on ``size`` quadrature nodes a phase, tightened by no more than ``tighten_by``."""
        return TwoStepProblem(self.biped, self.specification, size, tighten_by)

    @property
    def nodes(self) -> int:
        """Quadrature nodes a phase."""
        return self.step.rule.tau.size

    # ------------------------------------------------------------------ variables
    def split(self, x: FloatArray, travel: float | None = None) -> tuple[FloatArray, FloatArray]:
        """Variables (P,) of step A and of step B, of a travel [m]; default: the problem's."""
        wider = np.zeros(self.step.size)
        wider[STEP_WIDTH] = self.travel if travel is None else travel
        return x[self._of_a] + wider, x[self._of_b]

    def widths(self, x: FloatArray) -> tuple[float, float]:
        """Distance between the ankles where step A, where step B lands [m]."""
        narrow = float(x[STEP_WIDTH])
        return narrow + self.travel, narrow

    def joined(self, a: FloatArray, b: FloatArray) -> FloatArray:
        """Variables (2 P - 1,) of steps whose widths are as much apart as they can be made by moving both alike."""
        b = b.copy()
        b[STEP_WIDTH] = 0.5 * (a[STEP_WIDTH] - self.travel + b[STEP_WIDTH])
        return np.concatenate([b, np.delete(a, STEP_WIDTH)])

    def scale(self) -> FloatArray:
        """(2 P - 1,) changes of the variables that matter alike."""
        scale = self.step.scale()
        return np.concatenate([scale, np.delete(scale, STEP_WIDTH)])

    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Lower and upper bounds (2 P - 1,) of the variables; of each step those of `DesignProblem`."""
        low, high = (np.concatenate([bound, np.delete(bound, STEP_WIDTH)]) for bound in self.step.bounds())
        high[STEP_WIDTH] = max(high[STEP_WIDTH] - self.travel, low[STEP_WIDTH])  # but for rounding
        return low, high

    def start(self) -> FloatArray:
        """Default start (2 P - 1,): that of one step, twice, carried over to the travel."""
        return self.twice(self.step.start())

    def twice(self, x: FloatArray) -> FloatArray:
        """Variables (2 P - 1,) of one step (P,), twice, carried over to the travel."""
        return self.carried(np.concatenate([x, np.delete(x, STEP_WIDTH)]), 0.0)

    def carried(self, x: FloatArray, travel: float) -> FloatArray:
        """Variables of another travel [m], carried over to this one; see `two_step_start`.

        Raises:
            UnreachablePoseError: the feet cannot stand so.
        """
        low, high = self.bounds()
        narrow = x[STEP_WIDTH] + 0.5 * (travel - self.travel)
        narrow = float(np.clip(narrow, low[STEP_WIDTH], high[STEP_WIDTH]))
        a, b = (self.step.unpack(one) for one in self.split(x, travel))
        a, b = carried_over(self.biped, (a, b), (narrow + self.travel, narrow))
        layout = self.step.layout
        return np.clip(self.joined(layout.pack(a), layout.pack(b)), low, high)

    # ------------------------------------------------------------------ evaluation
    def _quantities(self, x: Dual) -> Quantities:
        both = self.split(cast("FloatArray", x))
        free, poses, landings = zip(*(self.step.landing(cast("Dual", one)) for one in both), strict=True)
        begins = [StepBegin(pose, landing.slope) for pose, landing in zip(poses, landings, strict=True)]
        a, b = (self.step.step_from(begins[1 - i], free[i], poses[i], landings[i]) for i in range(2))
        steps = TwoSteps(a.step, b.step)
        found = two_step_constraints(
            self.biped, self.specification, TwoSteps(a.lifted, b.lifted), (a.soles, b.soles), (a.holding, b.holding)
        )
        # the widths are one variable, bounded as such; the orbit itself must exist, whatever the floor says
        constraints = [constraint for constraint in found if not constraint.name.endswith(WIDTH_CONSTRAINT)]
        constraints += [
            Constraint("", "orbit", "", orbit.z, FLOOR_Z, None, 10.0)
            for step in steps
            for orbit in (step.rising, step.falling)
        ]
        equality = np.concatenate([np.stack(steps.periodicity), *a.surplus, *b.surplus])
        # the mean of J is the sum of the squares of these
        torques = np.sqrt(0.5) * np.concatenate([a.torques, b.torques])
        return Quantities(constraints, cast("Dual", equality), cast("Dual", torques))

    def equality(self, x: FloatArray, nodes: int) -> FloatArray:
        """(e,) the equalities of `evaluate` at x (2 P - 1,) on other quadrature nodes, without derivatives.

        Raises:
            UnreachablePoseError: a final pose does not exist.
            ReversalError: a phase has no range of beta.
        """
        phases = self.phases(x)
        steps = self.steps(x, phases, nodes)
        surplus = [part for own in phases for part in self.step.surplus(*own)]
        return np.concatenate([steps.periodicity, *surplus]) / EQUALITY

    def steps(self, x: FloatArray, phases: TwoPhases, nodes: int) -> TwoSteps:
        """Both steps at x (2 P - 1,), whose phases are known, on so many quadrature nodes a phase.

        Raises:
            ReversalError: a phase has no range of beta.
        """
        of_steps = zip(phases, self.widths(x), strict=True)
        return TwoSteps(*(step_orbit(self.biped, *own, width, nodes) for own, width in of_steps))

    def phases(self, x: FloatArray) -> TwoPhases:
        """Phases of both steps at x (2 P - 1,).

        Raises:
            UnreachablePoseError: a final pose does not exist.
        """
        a, b = self.split(x)
        return TwoPhases(*complete_in_turn(self.biped, self.step.unpack(a), self.step.unpack(b)))
