"""From targets to torques: closed form, quadratic program, relaxed program, in this order."""

from enum import Enum
from typing import NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.closed_form import Targets
from frontal_biped.control.limits import ContactLimits, JointLimits
from frontal_biped.control.relaxation import RelaxedQp, violation
from frontal_biped.control.settings import ControllerSettings
from frontal_biped.control.walking_qp import DDQ, FORCE, U, WalkingQp
from frontal_biped.model.biped import BASE, FrontalBiped
from frontal_biped.quadratic_program import ProxQpSolver

PENALTY_PARAMETER = 1e-3
"""ProxQP's mu of the inequalities: with its default of 0.1 most walking programs take half as many iterations more."""


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
    """

    source: Source
    u: FloatArray
    ddq: FloatArray
    force: FloatArray
    violation: float = 0.0


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
        self.qp = WalkingQp(biped, limits, joints)
        self.shortcut = shortcut
        self._solver = ProxQpSolver(settings.accuracy, settings.max_iterations, penalty_parameter=PENALTY_PARAMETER)
        self._relaxed = RelaxedQp(self.qp.program)
        self._relaxed_solver = ProxQpSolver(settings.accuracy, settings.max_iterations)
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
                return Answer(Source.CLOSED_FORM, forces[BASE:], motion.ddq, forces[:2])
        program = qp.build(targets)
        if not np.isfinite(program.g.sum() + program.b.sum() + program.A.sum()):
            return None
        # the limits active at the last tick are mostly those of this one
        solution = self._solver.solve(program, warm=self._was_active)
        source, overstepped = Source.PROGRAM, 0.0
        self._was_active = solution.solved
        if not solution.solved:
            solution = self._relaxed_solver.solve(self._relaxed.build(program), warm=False)
            if not solution.solved:
                return None
            source, overstepped = Source.RELAXED, violation(program, solution.x)
        x = solution.x[: len(qp.scale)] * qp.scale
        return Answer(source, x[U], x[DDQ], x[FORCE], overstepped)
