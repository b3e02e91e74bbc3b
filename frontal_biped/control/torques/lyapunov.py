r"""A rapidly exponentially stabilising control Lyapunov function of the output (RES-CLF).

Source: Ames, Galloway, Sreenath and Grizzle, *Rapidly Exponentially Stabilizing Control Lyapunov Functions and Hybrid
Zero Dynamics*, IEEE Trans. Automatic Control 59 (2014). The output obeys ddy = v; with eta = (y / eps, dy) and P the
solution of the Riccati equation of the double integrator, F'P + P F - P G G'P + Q = 0, Q = I,

.. math:: V = \eta' P \eta, \qquad \dot V = \frac{1}{\epsilon} \eta'(F'P + PF)\eta + 2 \eta'PG\, v

can always be made to fall at the rate gamma/eps, gamma = lambda_min(Q) / lambda_max(P): every v with

.. math:: L_fV + L_gV\, v + \frac{\gamma}{\epsilon} V \le 0

does, the smaller eps the faster. The controller takes the least such v. Both sides are divided by 2 sqrt(V), which
makes it a condition on the rate of the norm sqrt(V) with coefficients of order one, however near the output is to zero:

.. math:: n \cdot v + b \le \delta, \qquad n = L_gV / (2 \sqrt V),\; b = (L_fV + \gamma V/\epsilon) / (2 \sqrt V).

delta >= 0 [rad/s^2] relaxes it where the limits leave no such v, at a price rho per a_0: an exact penalty, so that
delta is zero, not just small, wherever the multiplier of the condition is below rho.
"""

from dataclasses import dataclass
from functools import cached_property
from math import sqrt
from typing import NamedTuple

import numpy as np
from scipy.linalg import solve_continuous_are

from frontal_biped.arrays import FloatArray


class Decrease(NamedTuple):
    """The condition n . v + b <= delta on the output acceleration v.

    Attributes:
        n: (3,) [-].
        b: [rad/s^2].
    """

    n: FloatArray
    b: float


@dataclass(frozen=True)
class LyapunovFunction:
    """V of the three outputs, all alike.

    Attributes:
        epsilon: time scale [s].
    """

    epsilon: float

    @cached_property
    def P(self) -> FloatArray:
        """(2, 2) solution of the Riccati equation; that of the three outputs is P (x) I."""
        F, G = np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0], [1.0]])
        return solve_continuous_are(F, G, np.eye(2), np.eye(1))

    @cached_property
    def gamma(self) -> float:
        """Rate of decrease in units of 1 / epsilon [-]."""
        return float(1.0 / np.linalg.eigvalsh(self.P)[-1])

    @property
    def rate(self) -> float:
        """V falls at least as fast as exp(-rate t) [1/s]; the output half as fast."""
        return self.gamma / self.epsilon

    @cached_property
    def _numbers(self) -> tuple[float, float, float]:
        return float(self.P[0, 0]), float(self.P[0, 1]), float(self.P[1, 1])

    def value(self, y: FloatArray, dy: FloatArray) -> float:
        """V [rad^2/s^2] at the output y (3,) [rad] and its rate dy (3,) [rad/s]."""
        p_11, p_12, p_22 = self._numbers
        eta = y / self.epsilon
        return float(p_11 * eta.dot(eta) + 2.0 * p_12 * eta.dot(dy) + p_22 * dy.dot(dy))

    def decrease(self, y: FloatArray, dy: FloatArray) -> Decrease:
        """The condition at the output y (3,) [rad] and its rate dy (3,) [rad/s]; void at zero."""
        p_11, p_12, p_22 = self._numbers
        eta = y / self.epsilon
        square, cross, speed = eta.dot(eta).item(), eta.dot(dy).item(), dy.dot(dy).item()
        V = p_11 * square + 2.0 * p_12 * cross + p_22 * speed
        if V <= 0.0:
            return Decrease(np.zeros(3), 0.0)
        norm = sqrt(V)
        drift = (p_11 * cross + p_12 * speed) / (self.epsilon * norm)
        return Decrease((p_12 * eta + p_22 * dy) / norm, drift + 0.5 * self.rate * norm)


def least_acceleration(decrease: Decrease, price: float) -> tuple[FloatArray, float]:
    """v (3,) [rad/s^2] that minimises |v|^2 / 2 + price delta under the condition, and delta [rad/s^2].

    Args:
        decrease: the condition.
        price: of delta [rad/s^2].
    """
    n, b = decrease
    if b <= 0.0:
        return np.zeros(3), 0.0
    square = n.dot(n).item()
    multiplier = price if b >= price * square else b / square
    return n * -multiplier, b - multiplier * square if multiplier == price else 0.0
