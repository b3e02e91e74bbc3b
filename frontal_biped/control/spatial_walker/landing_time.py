r"""When the swing foot lands, from the frontal zero dynamics in closed form.

On the orbit :math:`\tfrac12 \dot\beta^2 = E(\beta)` in both phases. On the same virtual constraints zeta differs from
the orbit's by what grows as delta_FRI^2, and sigma = I_P dbeta: the excess of dbeta^2/2 is

.. math:: e(\beta) = c\, w(\beta), \qquad w = (\delta_{FRI} / I_P)^2,

w scaled to one at the reversal, and the time left

.. math:: t = \int \frac{d\beta}{\sqrt{2 (E(\beta) + e(\beta))}}

over what is left of the phase; while rising over the way to where E + e vanishes and from there down. E and
w are tabulated and dbeta^2 is linear between the points, where the acceleration is constant and every piece exact.

w falls by two orders from the reversal to the ends: right after a landing, c is mostly noise. It is taken no larger
than `LARGEST` of the orbit's energy; the energy law takes the rest off before it counts.
"""

from typing import NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.gait.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.virtual_constraints.phase import StepPhase
from frontal_biped.zero_dynamics.orbit import PhaseOrbit

POINTS = 129

LARGEST = 0.1
"""Largest excess c that is believed, of the largest E [-]."""


class _Path(NamedTuple):
    """A phase, or what is left of it, in the order of the motion: beta [rad], E [rad^2/s^2], w [-], (n,) each."""

    beta: FloatArray
    energy: FloatArray
    weight: FloatArray

    @classmethod
    def of(cls, orbit: PhaseOrbit, rising: bool) -> "_Path":
        # an orbit's points run from the reversal to the impact in both phases, beta falls
        beta = orbit.beta[::-1]
        w = np.exp(orbit.log_delta_squared) / orbit.restricted.I_P**2
        grid = np.linspace(float(beta[0]), float(beta[-1]), POINTS)
        energy, weight = np.interp(grid, beta, 0.5 * orbit.dbeta[::-1] ** 2), np.interp(grid, beta, (w / w[0])[::-1])
        return cls(grid, energy, weight) if rising else cls(grid[::-1], energy[::-1], weight[::-1])

    def rest(self, beta: float) -> "_Path":
        """From beta on; from where it begins, or only its last point, for a beta beyond its ends."""
        sense = 1.0 if self.beta[-1] > self.beta[0] else -1.0
        along = sense * self.beta
        first = int(np.searchsorted(along, sense * beta))
        if first == 0:
            return self
        here = [beta, *(np.interp(sense * beta, along, part) for part in self[1:])]
        return _Path(*(np.concatenate([[at], part[first:]]) for at, part in zip(here, self, strict=True)))

    def time(self, excess: float) -> float:
        """To its end with an excess c [rad^2/s^2]; pieces without energy are left out."""
        energy = self.energy + excess * self.weight
        first, last = energy[:-1], energy[1:]
        # of a piece in which the robot turns, the part with energy
        share = np.ones(len(first))
        turns = (first < 0.0) != (last < 0.0)
        share[turns] = np.maximum(first, last)[turns] / np.abs(last - first)[turns]
        speeds = np.sqrt(2.0 * np.maximum(first, 0.0)) + np.sqrt(2.0 * np.maximum(last, 0.0))
        moves = speeds > SLOWEST
        return float(np.sum(2.0 * (np.abs(np.diff(self.beta)) * share)[moves] / speeds[moves]))


SLOWEST = 1e-9
"""Sum of two rates below which a piece counts as one without energy [rad/s]."""


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
        self._rising, self._falling = _Path.of(step.rising, True), _Path.of(step.falling, False)
        self._largest = LARGEST * float(max(self._rising.energy.max(), self._falling.energy.max()))
        # beyond the reversal the robot is slowed down, and comes back, as on the pieces next to it
        (up, down) = (
            abs(float((path.energy[a] - path.energy[a + 1]) / (path.beta[a] - path.beta[a + 1])))
            for path, a in ((self._rising, -2), (self._falling, 0))
        )
        self._slowing, self._coming_back = up, down

    def left(self, phase: StepPhase, beta: float, dbeta: float) -> float:
        """Time left [s] at a frontal state; at least zero.

        Args:
            phase: rising or falling.
            beta: of the stance ankle [rad].
            dbeta: its rate [rad/s].
        """
        rising = phase is StepPhase.RISING
        rest = (self._rising if rising else self._falling).rest(beta)
        excess = (0.5 * dbeta**2 - float(rest.energy[0])) / float(rest.weight[0])
        excess = min(max(excess, -self._largest), self._largest)
        if not rising:
            return rest.time(excess)
        if len(rest.beta) == 1:  # beyond the reversal of the orbit
            return max(dbeta, 0.0) / self._slowing + self._falling.time(0.0)
        left = rest.time(excess) + self._falling.time(excess)
        if excess > 0.0:
            speed = float(np.sqrt(2.0 * excess))
            left += speed / self._slowing + speed / self._coming_back
        return left
