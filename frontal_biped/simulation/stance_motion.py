"""Motion of the robot on one foot while its torques are held."""

import numpy as np
from scipy.optimize import brentq

from frontal_biped.arrays import FloatArray
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.simulation.hybrid_system import EventKind, Guard
from frontal_biped.simulation.pushes import PelvisForce


class StanceMotion:
    """The robot on one foot under held torques and forces.

    Args:
        biped: the robot that moves.
        pelvis: how it feels a push.

    Attributes:
        u: (4,) torques of the motors [N m].
        pushes: force along h [N] and height above the hip line [m] of each push.
    """

    def __init__(self, biped: FrontalBiped, pelvis: PelvisForce) -> None:
        self.biped, self.pelvis = biped, pelvis
        self.u: FloatArray = np.zeros(4)
        self.pushes: list[tuple[float, float]] = []

    def felt(self, q: FloatArray) -> FloatArray:
        """(4,) generalized forces of motors and pushes at q (4,) [N m]."""
        u = self.u
        for force, height in self.pushes:
            u = u + self.pelvis.torques(q, force, height)
        return u

    def friction_used(self, x: FloatArray) -> float:
        """Coefficient of friction |F_h| / F_v that keeps the stance foot at rest; inf if the ground would pull."""
        q, dq = x[:4], x[4:]
        wrench = self.biped.inverse_dynamics(q, dq, self.biped.forward_dynamics(q, dq, self.felt(q)))
        F_h = wrench[0] - sum(force for force, _ in self.pushes)
        return float(abs(F_h) / wrench[1]) if wrench[1] > 0.0 else float("inf")

    def advance(self, x: FloatArray, h: float) -> FloatArray:
        """State (8,) after h [s], by a Runge-Kutta step of order 4."""

        def derivative(x: FloatArray) -> FloatArray:
            return np.concatenate([x[4:], self.biped.forward_dynamics(x[:4], x[4:], self.felt(x[:4]))])

        k1 = derivative(x)
        k2 = derivative(x + 0.5 * h * k1)
        k3 = derivative(x + 0.5 * h * k2)
        k4 = derivative(x + h * k3)
        return x + (h / 6.0) * (k1 + 2.0 * (k2 + k3) + k4)

    def first_crossing(
        self,
        x: FloatArray,
        h: float,
        guards: tuple[Guard, ...],
        before: list[float],
        after: list[float],
    ) -> tuple[float, EventKind] | None:
        """Time into the step and kind of the earliest guard crossed in its direction."""
        found = []
        for guard, a, b in zip(guards, before, after, strict=True):
            if a * guard.direction < 0.0 <= b * guard.direction:

                def value(tau: float, guard: Guard = guard) -> float:
                    y = self.advance(x, tau)
                    return guard.function(y[:4], y[4:])

                found.append((float(brentq(value, 0.0, h, xtol=1e-14)), guard.kind))
        return min(found, key=lambda item: item[0]) if found else None
