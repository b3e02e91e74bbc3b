"""The polynomial of degree 5 between two states of a point: position, rate and acceleration at both ends."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray


class Kinematics(NamedTuple):
    """A moving point at one instant.

    Attributes:
        x: position.
        dx: its rate [1/s].
        ddx: its acceleration [1/s^2].
    """

    x: float
    dx: float
    ddx: float


@dataclass(frozen=True)
class Quintic:
    """x(t) = sum of c_k (t/T)^k; before the start and past the end it stays as it is there, at rest or at that rate.

    Attributes:
        c: (6,) coefficients.
        duration: T [s].
    """

    c: FloatArray
    duration: float

    @classmethod
    def between(cls, start: Kinematics, end: Kinematics, duration: float) -> "Quintic":
        """The one polynomial of degree 5 that meets both ends."""
        T = duration
        c_0, c_1, c_2 = start.x, start.dx * T, 0.5 * start.ddx * T**2
        left = np.array(
            [
                end.x - c_0 - c_1 - c_2,
                end.dx * T - c_1 - 2.0 * c_2,
                end.ddx * T**2 - 2.0 * c_2,
            ]
        )
        rest = np.linalg.solve(np.array([[1.0, 1.0, 1.0], [3.0, 4.0, 5.0], [6.0, 12.0, 20.0]]), left)
        return cls(np.array([c_0, c_1, c_2, *rest]), T)

    def at(self, t: float) -> Kinematics:
        """The point at time t [s] after the start; outside of [0, T] the rate stays, without acceleration."""
        T = self.duration
        inside = min(max(t, 0.0), T)
        s = inside / T
        powers = s ** np.arange(6)
        k = np.arange(1.0, 6.0)
        x = float(self.c @ powers)
        dx = float((k * self.c[1:]) @ powers[:5]) / T
        ddx = float((k[1:] * (k[1:] - 1.0) * self.c[2:]) @ powers[:4]) / T**2
        beyond = t - inside
        return Kinematics(x, dx, ddx) if beyond == 0.0 else Kinematics(x + beyond * dx, dx, 0.0)
