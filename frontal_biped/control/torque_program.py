"""From targets to torques: closed form, quadratic program, relaxed program, in this order."""

from enum import Enum
from math import isfinite
from typing import NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.closed_form import Targets
from frontal_biped.control.limits import ContactLimits, JointLimits
from frontal_biped.control.relaxation import RelaxedQp, violation
from frontal_biped.control.settings import ControllerSettings
from frontal_biped.control.walking_qp import DDQ, DELTA, FORCE, VARIABLES, U, WalkingQp
from frontal_biped.model.biped import BASE, FrontalBiped
from frontal_biped.quadratic_program import ProxQpSolver, refined

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
        shortcut: take the closed form where no limit is active? False: ask ProxQP at every tick.
    """

    def __init__(self, biped: FrontalBiped, settings: ControllerSettings, shortcut: bool = True) -> None:
        outer, inner = biped.sole
        torque = biped.max_torque if settings.max_torque is None else np.array(settings.max_torque)
        limits = ContactLimits(settings.friction, settings.min_normal_force * biped.weight, outer, inner, torque)
        joints = None
        if settings.joint_rate is not None:
            joints = JointLimits(biped.joint_lower, biped.joint_upper, biped.joint_max_velocity, settings.joint_rate)
        price = settings.relaxation_price if settings.outputs == "clf" else None
        self.qp = WalkingQp(biped, limits, joints, price)
        self.shortcut = shortcut
        self._solver = ProxQpSolver(settings.accuracy, settings.max_iterations, penalty_parameter=PENALTY_PARAMETER)
        self._relaxed = RelaxedQp(self.qp.program, self.qp.rows)
        self._relaxed_solver = ProxQpSolver(RELAXED_ACCURACY, settings.max_iterations, relative=RELAXED_ACCURACY)
        self._was_active = False

    def solve(self, q: FloatArray, dq: FloatArray, targets: Targets) -> Answer | None:
        """Torques at q (4,) [rad], dq (4,) [rad/s]; None where even the relaxed program is not solved."""
        qp = self.qp
        qp.move_to(q, dq)
        if self.shortcut:
            motion = qp.closed_form(targets)
            if motion is not None:
                self._was_active = False
                forces = motion.forces
                return Answer(Source.CLOSED_FORM, forces[BASE:], motion.ddq, forces[:2], 0.0, targets.relaxation)
        program = qp.build(targets)
        if not isfinite(program.g.sum() + program.b.sum() + program.A.sum()):
            return None
        # the limits active at the last tick are mostly those of this one
        solution = self._solver.solve(program, warm=self._was_active)
        source, overstepped = Source.PROGRAM, 0.0
        self._was_active = solution.solved
        if solution.solved:
            solution = refined(program, solution)
        else:
            least = self._relaxed_solver.solve(self._relaxed.build(program), warm=False)
            if not least.solved:
                return None
            widened = self._relaxed.widened(program, least.x)
            solution = self._solver.solve(widened, warm=False)
            solution = refined(widened, solution) if solution.solved else least
            source, overstepped = Source.RELAXED, violation(program, solution.x)
        x = solution.x[:VARIABLES] * qp.scale
        relaxation = 0.0 if targets.decrease is None else qp.delta_unit * float(solution.x[DELTA])
        most = qp.limits.max_torque
        u = np.clip(x[U], -most, most)  # to the last digit, whatever the solver's tolerance
        return Answer(source, u, x[DDQ], x[FORCE], overstepped, relaxation)
