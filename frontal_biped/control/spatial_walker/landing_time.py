r"""When the swing foot lands, from the frontal zero dynamics in closed form.

On the orbit :math:`\tfrac12 \dot\beta^2 = E(\beta)` in both phases. A robot whose energy is e more than that is brought
back to the orbit by the energy law, so that the time left is

.. math:: t = \int \frac{d\beta}{\sqrt{2 (E(\beta) + e(\beta))}},

e going linearly from what it is here to nothing at the end of the phase, reversal or landing; while rising, the falling
phase comes on top. A robot that rises too slowly is not taken to need more than `LONGEST` times as long as the orbit,
for it turns before. E is tabulated and linear between the points; beyond the orbit's reversal the acceleration is that
at the reversal.
"""

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.gait.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.virtual_constraints.phase import StepPhase

POINTS = 65
"""Of the table of a phase."""

LONGEST = 1.25
"""Times the orbit's, the longest that the rest of a rising phase is taken to last [-]."""

SLOWEST = 1e-6
"""Rate below which a piece of a path is left out: the robot has turned there [rad/s]."""


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
        self._rising = _path(rising.beta, rising.dbeta, upwards=True)
        self._falling = _path(falling.beta, falling.dbeta, upwards=False)
        beta, energy = self._rising
        self._slowing = abs(float((energy[-1] - energy[-2]) / (beta[-1] - beta[-2])))
        speed = np.sqrt(2.0 * energy)
        pieces = 2.0 * np.diff(beta) / (speed[1:] + speed[:-1])
        self._rise_left = np.concatenate([np.cumsum(pieces[::-1])[::-1], [0.0]])  # on the orbit, at every point
        self._fall = self._falling_time(float(self._falling[0][0]), 0.0)

    def left(self, phase: StepPhase, beta: float, dbeta: float) -> float:
        """Time left [s] at a frontal state; at least zero."""
        if phase is StepPhase.FALLING:
            return self._falling_time(beta, dbeta)
        grid, energy = self._rising
        slowing, beyond = self._slowing, beta - float(grid[-1])
        if beyond >= 0.0:
            highest = beta + 0.5 * dbeta**2 / slowing
            return max(dbeta, 0.0) / slowing + self._falling_time(highest, 0.0)
        excess = 0.5 * dbeta**2 - float(np.interp(beta, grid, energy))
        longest = LONGEST * float(np.interp(beta, grid, self._rise_left))
        return min(_time(*_rest(grid, energy, beta), excess), longest) + self._fall

    def _falling_time(self, beta: float, dbeta: float) -> float:
        grid, energy = self._falling
        slowing = self._slowing
        # from beyond the orbit's reversal it comes back to it
        speed = float(np.sqrt(dbeta**2 + 2.0 * slowing * max(beta - float(grid[0]), 0.0)))
        late = (speed - abs(dbeta)) / slowing
        excess = 0.5 * speed**2 - float(np.interp(beta, grid[::-1], energy[::-1]))
        return late + _time(*_rest(grid, energy, beta), excess)


def _path(beta: FloatArray, dbeta: FloatArray, upwards: bool) -> tuple[FloatArray, FloatArray]:
    """Points of a phase in the order of the motion, and dbeta^2/2 there; orbits are kept from the reversal on."""
    order = np.argsort(beta)
    grid = np.linspace(float(beta.min()), float(beta.max()), POINTS)
    energy = np.interp(grid, beta[order], 0.5 * dbeta[order] ** 2)
    # an orbit's points run from the reversal to the impact in both phases; the rate tells which way it moves
    return (grid, energy) if float(np.sum(dbeta)) > 0.0 else (grid[::-1], energy[::-1])


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
    """Time along what is left of a path, an excess of energy at its start dying out towards its end [s]."""
    if len(grid) < 2 or grid[-1] == grid[0]:
        return 0.0
    total = energy + (excess / (grid[-1] - grid[0])) * (grid[-1] - grid)
    speed = np.sqrt(2.0 * np.maximum(total, 0.0))
    twice = speed[1:] + speed[:-1]
    moving = twice > SLOWEST
    return 2.0 * float(np.abs((grid[1:] - grid[:-1])[moving] / twice[moving]).sum())
