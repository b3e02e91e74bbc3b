"""From targets to torques: closed form, quadratic program, relaxed program, in this order.

The program is solved exactly in the residuals of its targets (`nearest_motion`); by ProxQP, to its tolerance, where
that is not possible to rounding, and at every tick if the settings say so.
"""

from enum import Enum
from math import isfinite
from typing import NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.settings import ControllerSettings
from frontal_biped.control.torques.few_rows import FewRows, compiled
from frontal_biped.control.torques.limits import WalkingLimits
from frontal_biped.control.torques.linearisation import StanceDynamics, StanceModel, Targets
from frontal_biped.control.torques.nearest_motion import NearestMotion
from frontal_biped.control.torques.relaxation import relaxed, violation, weights, widened
from frontal_biped.control.torques.walking_qp import DDQ, DELTA, FORCE, FORCES, VARIABLES, PosedProgram, U, WalkingQp
from frontal_biped.model.biped import BASE, FrontalBiped
from frontal_biped.model.state import State
from frontal_biped.numerics.quadratic_program import ProxQpSolver, refined

PENALTY_PARAMETER = 1e-2
"""ProxQP's mu of the inequalities: a third fewer iterations on walking programs than with its default of 0.1.

With 1e-3 they are fewer still, but one feasible program in a thousand is given up.
"""

RELAXED_ACCURACY = 1e-6
"""Absolute and relative, of the relaxed program: far outside the limits its numbers grow large."""


class Source(Enum):
    """Where the torques of a tick come from."""

    CLOSED_FORM = "closed form"
    """No limit is active: the optimum of the quadratic program in closed form."""
    PROGRAM = "program"
    """The quadratic program, to its accuracy."""
    RELAXED = "relaxed"
    """The program had no solution: that of the nearest one that has."""
    HELD = "held"
    """Nothing could be solved: the last command again."""

    __hash__ = object.__hash__  # as `Stance`


CLOSED_FORM, PROGRAM, RELAXED = Source.CLOSED_FORM, Source.PROGRAM, Source.RELAXED
"""Kept: a member of an enumeration is a search."""


class Answer(NamedTuple):
    """Torques of one tick.

    Attributes:
        source: where they come from; never `Source.HELD`.
        u: (4,) torques [N m].
        ddq: (4,) accelerations expected [rad/s^2].
        force: (2,) ground reaction expected [N].
        violation: by how much limits are overstepped, in the units of the program [-].
        relaxation: delta of the control Lyapunov function [rad/s^2].
    """

    source: Source
    u: FloatArray
    ddq: FloatArray
    force: FloatArray
    violation: float = 0.0
    relaxation: float = 0.0


class TorqueProgram:
    """Solves for the torques of one tick.

    Args:
        biped: the robot.
        settings: limits and tolerances.

    Attributes:
        at_limits: was a limit active when it was asked last?
    """

    def __init__(self, biped: FrontalBiped, settings: ControllerSettings) -> None:
        price = settings.relaxation_price if settings.outputs == "clf" else None
        self.qp = WalkingQp(biped, WalkingLimits.of(biped, settings), price)
        self._most_torque = self.qp.limits.contact.max_torque
        self._least_torque = -self._most_torque
        self._stance = StanceModel(biped)
        self._exact = settings.solver != "proxqp"
        self._nearest = NearestMotion(self.qp)
        self._few_rows = FewRows(self._nearest, compiled()) if settings.solver == "compiled" else None
        self._solver = ProxQpSolver(settings.accuracy, settings.max_iterations, penalty_parameter=PENALTY_PARAMETER)
        self._relaxed_solver = ProxQpSolver(RELAXED_ACCURACY, settings.max_iterations, relative=RELAXED_ACCURACY)
        self._was_active = False
        self.at_limits = False

    def pose(self, state: State, targets: Targets) -> PosedProgram:
        """The quadratic program at a state, as `solve` solves it by whatever way."""
        return self.qp.pose(self._stance.at(state), targets)

    def dynamics(self, state: State) -> StanceDynamics:
        """The dynamics at a state."""
        return self._stance.at(state)

    def solve(
        self,
        state: State,
        targets: Targets,
        dynamics: StanceDynamics | None = None,
        oversteps: bool = False,
    ) -> Answer | None:
        """Torques at a state; None where even the relaxed program is not solved.

        Args:
            state: of the robot.
            targets: what is asked of it.
            dynamics: there, where they are known already.
            oversteps: is it known that the motion that meets the targets does not keep all limits?
        """
        dynamics = dynamics or self._stance.at(state)
        answer = self._exactly(dynamics, targets, oversteps) if self._exact else None
        if answer is None:
            return self._by_proxqp(dynamics, targets)
        self._was_active = False
        self.at_limits = answer.source is not CLOSED_FORM
        return answer

    def _exactly(self, dynamics: StanceDynamics, targets: Targets, oversteps: bool) -> Answer | None:
        """The answer to rounding; None where that cannot be had."""
        few = None if self._few_rows is None else self._few_rows.solve(dynamics, targets)
        if few is not None:
            (ddq, forces), limited = few
            source = PROGRAM if limited else CLOSED_FORM
            return Answer(source, self._clipped(forces[BASE:]), ddq, forces[:FORCES])
        # what the last tick was this one mostly is: where the answer is sought first depends on that, and nothing else
        expected = oversteps or (self.at_limits and targets.decrease is None)
        nearest = self._nearest.solve(dynamics, targets) if expected else None
        if not (oversteps or (nearest and nearest.limited)):
            motion = dynamics.linearising(targets)
            if motion is None:
                return None
            if self.qp.limits.keep(dynamics.state, motion):
                # it meets the targets: both costs are zero (with a control Lyapunov function: the least of any v, and
                # zero), and no other motion can be better
                forces = motion.forces
                return Answer(CLOSED_FORM, forces[BASE:], motion.ddq, forces[:FORCES], 0.0, targets.relaxation)
            nearest = nearest or self._nearest.solve(dynamics, targets)
        if nearest is None:
            return None
        ddq, forces, relaxation, overstepped, _ = nearest
        source = RELAXED if overstepped else PROGRAM
        return Answer(source, self._clipped(forces[BASE:]), ddq, forces[:FORCES], overstepped, relaxation)

    def _clipped(self, u: FloatArray) -> FloatArray:
        """The torques within the motors' limits to the last digit, whatever the tolerance they were found to."""
        return np.minimum(np.maximum(u, self._least_torque), self._most_torque)

    def _by_proxqp(self, dynamics: StanceDynamics, targets: Targets) -> Answer | None:
        """ProxQP's answer, of the relaxed program where it finds none; None where it finds neither."""
        qp = self.qp
        program, delta_unit = qp.pose(dynamics, targets)
        if not isfinite(program.g.sum() + program.b.sum() + program.A.sum()):
            return None
        # the limits active at the last tick are mostly those of this one
        solution = self._solver.solve(program, warm=self._was_active)
        source, overstepped = Source.PROGRAM, 0.0
        self._was_active = solution.solved
        if solution.solved:
            solution = refined(program, solution)
        else:
            weight = weights(qp.rows)
            least = self._relaxed_solver.solve(relaxed(program, weight), warm=False)
            if not least.solved:
                return None
            wider = widened(program, weight, least.x)
            solution = self._solver.solve(wider, warm=False)
            solution = refined(wider, solution) if solution.solved else least
            source, overstepped = Source.RELAXED, violation(program, solution.x)
        x = solution.x[:VARIABLES] * qp.scale
        relaxation = 0.0 if targets.decrease is None else delta_unit * float(solution.x[DELTA])
        return Answer(source, self._clipped(x[U]), x[DDQ], x[FORCE], overstepped, relaxation)
