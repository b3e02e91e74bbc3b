"""What stands between a command and the joints: delay, noise, weak motors, torque limits."""

from collections import deque

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.model.stance_map import Stance, relabel
from frontal_biped.simulation.disturbances import Disturbances


class DelayLine:
    """Torques on their way to the motors, in URDF order: no impact exchanges their places.

    Args:
        ticks: control periods from command to motor.
    """

    def __init__(self, ticks: int) -> None:
        self._waiting: deque[FloatArray] = deque(maxlen=ticks + 1)
        self._ticks = ticks

    def push(self, commanded: FloatArray) -> FloatArray:
        """Send this tick's torques (n,) [N m]; returns those that arrive now: at the start, the first ones sent."""
        if not self._ticks:
            return commanded
        while len(self._waiting) < self._ticks:
            self._waiting.append(commanded)
        self._waiting.append(commanded)
        return self._waiting[0]


class Motors:
    """The motors of a run.

    Args:
        disturbances: delay, noise and limits of the motors.
        period: control period [s].
        max_torque: (n,) what no motor exceeds [N m].

    Attributes:
        arriving: (n,) the command that acts since the last tick, as an observer would predict with it [N m].
    """

    def __init__(self, disturbances: Disturbances, period: float, max_torque: FloatArray) -> None:
        self._disturbances, self._least, self._most = disturbances, -max_torque, max_torque
        self._line = DelayLine(disturbances.delay_ticks(period))
        self._generator = disturbances.generator("torques")
        self._worse = bool(disturbances.torque_noise) or disturbances.torque_limits is not None
        self.arriving: FloatArray = np.zeros(len(max_torque))

    def send(self, tau: FloatArray, drawn_from: Stance = Stance.LEFT) -> FloatArray:
        """Torques that act from this tick on, (n,) URDF order [N m].

        Args:
            tau: (n,) commanded.
            drawn_from: the foot whose chain of four, from stance to swing, the random numbers follow; the left one's is
                the URDF order.
        """
        acting = self.arriving = self._line.push(tau)
        if self._worse:
            acting = self._disturbed(acting, drawn_from)
        return np.minimum(np.maximum(acting, self._least), self._most)

    def _disturbed(self, acting: FloatArray, drawn_from: Stance) -> FloatArray:
        """What noisy and weak motors make of it."""
        if self._disturbances.torque_noise:
            factor = 1.0 + self._disturbances.torque_noise * self._generator.standard_normal(len(acting))
            acting = acting * (factor if drawn_from is Stance.LEFT else relabel(factor))
        if self._disturbances.torque_limits is not None:
            limit = self._disturbances.chain_torque_limits()
            acting = np.clip(acting, -limit, limit)
        return acting
