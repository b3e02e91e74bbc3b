"""The swing sole's way forwards: a minimum-jerk path to a foothold that may move until the last part of the step."""

import numpy as np

FROZEN = 0.25
"""Last share of a step in which the path stays as it is: the jerk of a late change grows as 1/(time left)^3."""


class SwingPath:
    """Position, rate and acceleration of one coordinate of the swing sole.

    Attributes:
        x: reference [m].
        dx: its rate [m/s].
        ddx: its acceleration [m/s^2].
    """

    def __init__(self) -> None:
        self.start(0.0, 0.0)

    def start(self, x: float, dx: float) -> None:
        """A step begins where the foot is."""
        self.x, self.dx, self.ddx = x, dx, 0.0
        self.goal = x
        self._jerk: tuple[float, float, float] | None = None

    def advance(self, goal: float, left: float, duration: float, period: float) -> None:
        """One control period on, towards a goal [m] in a time left [s]; frozen for the last part of the step."""
        if left > FROZEN * duration:
            self.goal = goal
        left = max(left, 0.0)
        if left < 2.0 * period:
            self.x, self.dx, self.ddx = self.x + period * self.dx, 0.5 * self.dx, 0.0
            return
        # quintic from (x, dx, ddx) to rest at the goal
        T = left
        D = self.goal - self.x
        c3 = (20.0 * D - 12.0 * self.dx * T - 3.0 * self.ddx * T**2) / (2.0 * T**3)
        c4 = (-30.0 * D + 16.0 * self.dx * T + 3.0 * self.ddx * T**2) / (2.0 * T**4)
        c5 = (12.0 * D - 6.0 * self.dx * T - self.ddx * T**2) / (2.0 * T**5)
        h = period
        x = self.x + h * self.dx + 0.5 * h**2 * self.ddx + c3 * h**3 + c4 * h**4 + c5 * h**5
        dx = self.dx + h * self.ddx + 3.0 * c3 * h**2 + 4.0 * c4 * h**3 + 5.0 * c5 * h**4
        ddx = self.ddx + 6.0 * c3 * h + 12.0 * c4 * h**2 + 20.0 * c5 * h**3
        self.x, self.dx, self.ddx = x, dx, float(np.clip(ddx, -100.0, 100.0))
