"""Minimum-jerk motions to goals that move: the swing sole's way forwards, and what else is led somewhere in time."""

FROZEN = 0.25
"""Last share of a step in which the path stays as it is: the jerk of a late change grows as 1/(time left)^3."""

LARGEST = 100.0
"""Largest acceleration that is carried on from a period to the next [m/s^2]."""


class MinimumJerk:
    """Position, rate and acceleration of one coordinate that is led to a goal.

    Attributes:
        x: reference [m].
        dx: its rate [m/s].
        ddx: its acceleration [m/s^2].
    """

    def __init__(self) -> None:
        self.x = self.dx = self.ddx = 0.0

    def start(self, x: float, dx: float) -> None:
        """Begin somewhere [m], at a speed [m/s]."""
        self.x, self.dx, self.ddx = x, dx, 0.0

    def towards(self, goal: float, left: float, period: float, speed: float = 0.0) -> None:
        """One control period on, towards a goal [m] and a speed there [m/s] in a time left [s]."""
        T, h = left, period
        D = goal - self.x
        # the quintic from (x, dx, ddx) to (goal, speed, 0)
        c3 = (20.0 * D - (8.0 * speed + 12.0 * self.dx) * T - 3.0 * self.ddx * T**2) / (2.0 * T**3)
        c4 = (-30.0 * D + (14.0 * speed + 16.0 * self.dx) * T + 3.0 * self.ddx * T**2) / (2.0 * T**4)
        c5 = (12.0 * D - 6.0 * (speed + self.dx) * T - self.ddx * T**2) / (2.0 * T**5)
        x = self.x + h * self.dx + 0.5 * h**2 * self.ddx + c3 * h**3 + c4 * h**4 + c5 * h**5
        dx = self.dx + h * self.ddx + 3.0 * c3 * h**2 + 4.0 * c4 * h**3 + 5.0 * c5 * h**4
        ddx = self.ddx + 6.0 * c3 * h + 12.0 * c4 * h**2 + 20.0 * c5 * h**3
        self.x, self.dx, self.ddx = x, dx, min(max(ddx, -LARGEST), LARGEST)

    def coast(self, speed: float, period: float) -> None:
        """One control period on at a speed [m/s]."""
        self.x, self.dx, self.ddx = self.x + period * self.dx, speed, 0.0


class SwingPath(MinimumJerk):
    """The swing sole's way forwards, to a foothold that may move until the last part of the step.

    Attributes:
        goal: foothold [m].
    """

    def __init__(self) -> None:
        super().__init__()
        self.goal = 0.0

    def start(self, x: float, dx: float) -> None:
        """A step begins where the foot is."""
        super().start(x, dx)
        self.goal = x

    def advance(self, goal: float, left: float, duration: float, period: float) -> None:
        """One control period on, towards a goal [m] in a time left [s]; frozen for the last part of the step."""
        if left > FROZEN * duration:
            self.goal = goal
        if left < 2.0 * period:
            self.coast(0.5 * self.dx, period)
        else:
            self.towards(self.goal, left, period)
