r"""When the swing foot lands, from the frontal zero dynamics in closed form.

On the orbit :math:`\tfrac12 \dot\beta^2 = E(\beta)` in both phases. With an energy e more than that the time left is

.. math:: t = \int \frac{d\beta}{\sqrt{2 (E(\beta) + e)}}

over what is left of the falling phase, and while rising over the way to the reversal, where E + e vanishes, besides.
E is tabulated and linear between the points, where the acceleration is constant and every piece exact.
"""

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.gait.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.virtual_constraints.phase import StepPhase

POINTS = 65


class LandingTime:
    """Time to landing of one gait.

    Args:
        biped: the robot.
        gait: the gait.

    Attributes:
        duration: of a step on the orbit [s].
    """

    def __init__(self, biped: FrontalBiped, gait: Gait) -> None:
        step = gait.step(biped)
        self.duration = float(step.duration)
        rising, falling = step.rising, step.falling
        self._rising = _path(rising.beta, rising.dbeta)
        self._falling = _path(falling.beta, falling.dbeta)
        self._fall_time = _time(*self._falling, 0.0)
        # a robot that rises more than the orbit goes on as the orbit's last piece decelerates
        beta, energy = self._rising
        self._beyond = float((energy[-1] - energy[-2]) / (beta[-1] - beta[-2]))

    def left(self, phase: StepPhase, beta: float, dbeta: float) -> float:
        """Time left [s] at a frontal state; at least zero."""
        if phase is StepPhase.FALLING:
            grid, energy = self._falling
            excess = 0.5 * dbeta**2 - float(np.interp(beta, grid[::-1], energy[::-1]))
            return _time(*_rest(grid, energy, beta), excess)
        grid, energy = self._rising
        excess = 0.5 * dbeta**2 - float(np.interp(beta, grid, energy))
        if beta >= grid[-1]:
            return self._fall_time + max(dbeta, 0.0) / abs(self._beyond)
        grid, energy = _rest(grid, energy, beta)
        left = _time(grid, energy, excess)
        at_end = float(energy[-1]) + excess
        if at_end > 0.0:
            left += float(np.sqrt(2.0 * at_end)) / abs(self._beyond)
        return left + self._fall_time


def _path(beta: FloatArray, dbeta: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Points of a phase in the order of the motion, and dbeta^2/2 there."""
    order = np.argsort(beta)
    grid = np.linspace(float(beta.min()), float(beta.max()), POINTS)
    energy = np.interp(grid, beta[order], 0.5 * dbeta[order] ** 2)
    return (grid, energy) if beta[-1] > beta[0] else (grid[::-1], energy[::-1])


def _rest(grid: FloatArray, energy: FloatArray, beta: float) -> tuple[FloatArray, FloatArray]:
    """What of a path is still to come at beta."""
    sense = 1.0 if grid[-1] > grid[0] else -1.0
    first = int(np.searchsorted(sense * grid, sense * beta))
    if first == 0:
        return grid, energy
    if first >= len(grid):
        return grid[-1:], energy[-1:]
    share = (beta - grid[first - 1]) / (grid[first] - grid[first - 1])
    at = energy[first - 1] + share * (energy[first] - energy[first - 1])
    return np.concatenate([[beta], grid[first:]]), np.concatenate([[at], energy[first:]])


def _time(grid: FloatArray, energy: FloatArray, excess: float) -> float:
    if len(grid) < 2:
        return 0.0
    speed = np.sqrt(2.0 * np.maximum(energy + excess, 0.0))
    mean = 0.5 * (speed[1:] + speed[:-1])
    moving = mean > 1e-9  # where the energy is spent the robot has turned
    return float(np.sum(np.abs(np.diff(grid))[moving] / mean[moving]))
