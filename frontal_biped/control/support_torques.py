"""Torques in double support: the acceleration along the family that is asked for, the load shared between both soles.

Four numbers are free, ddbeta and the wrench of the swing foot (see `support_dynamics`). Where soles and motors
allow it both are as wanted, in closed form: the swing foot takes the share that brings the pressure point where ddbeta
needs it, either foot pressed at the same distance inwards. Otherwise a quadratic program looks for the nearest four
that are allowed, ddbeta first.
"""

from typing import NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.numerics.quadratic_program import UNBOUNDED, ProxQpSolver, QuadraticProgram
from frontal_biped.zero_dynamics.support_dynamics import WRENCH, SupportForces, SupportLimits, SupportPoint

ACCELERATION = 0.1
"""What of ddbeta counts as much as all of the weight on the wrong foot [rad/s^2]: the motion comes first."""

LEVER = 0.1
"""Moments are weighed as if at this lever [m]."""

ACCURACY = 1e-7
"""Of the program, in units of weight and of 0.1 rad/s^2: some mN."""


class SupportTorques(NamedTuple):
    """Answer of one tick.

    Attributes:
        u: (4,) torques [N m].
        acceleration: ddbeta to expect [rad/s^2].
        forces: both feet's wrenches to expect.
        allowed: do soles and motors allow what was asked for?
        solved: are all limits kept?
    """

    u: FloatArray
    acceleration: float
    forces: SupportForces
    allowed: bool
    solved: bool


class SupportProgram:
    """Solves for the torques of one tick in double support.

    Args:
        limits: of soles and motors.
        p_fri: where a foot that carries all of the weight is pressed, from the ankle inwards [m].

    Attributes:
        ticks: commands given.
        bounded: of these, those for which limits were active.
        unsolved: of these, those for which no torques kept every limit.
    """

    def __init__(self, limits: SupportLimits, p_fri: float) -> None:
        self.limits, self.p_fri = limits, p_fri
        self._solver = ProxQpSolver(ACCURACY)
        self.ticks = self.bounded = self.unsolved = 0

    def solve(self, point: SupportPoint, speed: float, acceleration: float) -> SupportTorques:
        """Torques at a pose, for dbeta [rad/s] and the ddbeta that is wanted [rad/s^2]."""
        self.ticks += 1
        speed_squared = speed**2
        swing = point.shared(acceleration, speed_squared, self.p_fri)
        wanted = np.array([acceleration, *swing])
        C, c = point.rows(self.limits, speed_squared)
        if np.all(C @ wanted >= c):
            forces = point.forces(acceleration, speed_squared, swing)
            return SupportTorques(forces.u, acceleration, forces, True, True)
        self.bounded += 1
        weight = point.biped.weight
        scale = np.array([ACCELERATION, weight, weight, LEVER * weight])
        high = np.full(len(c), UNBOUNDED)
        none = np.zeros((0, WRENCH + 1))
        unit = np.full(len(c), weight)
        program = QuadraticProgram(
            np.eye(WRENCH + 1), -wanted / scale, none, np.zeros(0), C * scale / unit[:, None], c / unit, high
        )
        answer = self._solver.solve(program)
        if answer.solved:
            nearest = answer.x * scale
        else:
            self.unsolved += 1
            nearest = wanted
        forces = point.forces(float(nearest[0]), speed_squared, nearest[1:])
        most = self.limits.max_torque
        u = np.clip(forces.u, -most, most)
        return SupportTorques(u, float(nearest[0]), forces, False, answer.solved)
