r"""What a step of a walk in space is to do, and the steps that commanded speeds make.

Feet are placed as if the robot could stop at any of them: to a foot that looks along psi belongs the stand

.. math:: m = p_{foot} + R(\psi)\,(0, \mp w/2)

(minus for the left foot), the middle between two parallel feet a gait's width w apart. A step leads from the stand of
the stance foot to that of the next: ``length`` forwards, ``aside`` to the left, turned by ``turn``. A foot that steps
to its own side lands wider than the gait by ``aside``, the other one narrower. The heading of a step, in whose axes the
frontal plane is seen, lies half-way between both feet.
"""

from typing import NamedTuple, Protocol

from frontal_biped.control.path.pose import ORIGIN, Pose
from frontal_biped.model.stance_map import Stance


class StepPlan(NamedTuple):
    """A step, and what is expected of the next one.

    Attributes:
        yaw: where the stance foot looks, as it was planned [rad].
        length: forwards [m].
        aside: to the left [m].
        turn: to the left [rad].
        next_length: of the next step [m].
        next_turn: of the next step [rad].
        speed: commanded mean speed forwards [m/s].
    """

    yaw: float = 0.0
    length: float = 0.0
    aside: float = 0.0
    turn: float = 0.0
    next_length: float = 0.0
    next_turn: float = 0.0
    speed: float = 0.0

    @property
    def heading(self) -> float:
        """Of the frame in which the step is walked, about Z [rad]."""
        return self.yaw + 0.5 * self.turn

    @property
    def next_yaw(self) -> float:
        """Where the next foot is to look [rad]."""
        return self.yaw + self.turn

    def widening(self, stance: Stance) -> float:
        """How much wider than the gait's this step lands [m]."""
        return -stance.sign * self.aside


class StepPlanner(Protocol):
    """Decides on steps, one by one."""

    def reset(self, yaw: float) -> None:
        """The robot stands on feet that look along ``yaw`` [rad], or begins right after an impact."""

    def begin(self, stance: Stance, foot: Pose) -> StepPlan:
        """A step begins.

        Args:
            stance: the foot it stands on.
            foot: where that is, by the robot's own estimate.
        """

    def plan(self) -> StepPlan:
        """The present step, what is expected of the next one told anew."""


def stand_of(stance: Stance, foot: Pose, width: float) -> Pose:
    """The stand that belongs to a foot.

    Args:
        stance: which foot.
        foot: where it is.
        width: of the gait [m].
    """
    return foot.moved(0.0, -0.5 * stance.sign * width, 0.0)


class CommandedSpeeds:
    """Steps at commanded speeds.

    Args:
        duration: of a step [s].
        speed_change: by how much the speed forwards may change from a step to the next [m/s].

    Attributes:
        speed: forwards, of the present step [m/s].
        asked: forwards [m/s].
        lateral: to the left [m/s].
        turning: to the left [rad/s].
    """

    def __init__(self, duration: float, speed_change: float) -> None:
        self._duration, self._change = duration, speed_change
        self.asked = self.lateral = self.turning = 0.0
        self.reset(ORIGIN.yaw)

    def reset(self, yaw: float) -> None:
        """Begin on the spot, looking along ``yaw`` [rad]."""
        self.speed = 0.0
        self._yaw, self._turn, self._aside = yaw, 0.0, 0.0

    def begin(self, stance: Stance, foot: Pose) -> StepPlan:
        """A step begins: as near to the command as one step may come."""
        self.speed = self._next_speed()
        self._yaw += self._turn
        self._turn, self._aside = self.turning * self._duration, self.lateral * self._duration
        return self.plan()

    def plan(self) -> StepPlan:
        """The present step."""
        T = self._duration
        return StepPlan(
            self._yaw,
            self.speed * T,
            self._aside,
            self._turn,
            self._next_speed() * T,
            self.turning * T,
            self.speed,
        )

    def _next_speed(self) -> float:
        return self.speed + min(max(self.asked - self.speed, -self._change), self._change)
