r"""From the legs of a path to steps: where the next stand is, and when to stand.

At every landing the robot knows, by its own odometry, the stand that belongs to its stance foot (`step_plan`). The next
one lies towards the end of the present leg, as far as a step goes: forwards, sideways and about the vertical each on
its own, in the axes of the stand. So every error of a step is taken up by the next, and a leg ends where it was to end
whatever happened on the way.

Forwards the length of a step may change by a limited amount c from one to the next, the last of them included: with r
left to go it is at most the L of

.. math:: L + (L - c) + (L - 2c) + \dots = \frac{L (L + c)}{2 c} = r.

A leg is over as soon as a step is to end at its end, and the next leg begins with the step after that; where a stand
follows, as soon as both feet are there, or after as many attempts at it as the settings allow.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import radians, sqrt

from frontal_biped.control.path.language import Leg, Verb
from frontal_biped.control.path.pose import ORIGIN, Pose
from frontal_biped.control.spatial_walker.step_plan import StepPlan, stand_of
from frontal_biped.model.stance_map import Stance


@dataclass(frozen=True)
class FollowerSettings:
    """How fast a path is followed, and how near to its corners.

    Attributes:
        speed: forwards and backwards, where a leg does not say [m/s].
        lateral: sideways, likewise [m/s].
        turning: likewise [rad/s].
        speed_change: by how much the speed forwards may change from a step to the next [m/s].
        near: distance from its end at which a leg is over where the robot is to stand [m].
        straight: angle likewise [rad].
        attempts: steps at its end after which the robot stands where it is.
        rest: time for which it stands at the end of the path [s].
    """

    speed: float = 0.25
    lateral: float = 0.06
    turning: float = radians(12.0)
    speed_change: float = 0.15
    near: float = 0.02
    straight: float = radians(1.5)
    attempts: int = 6
    rest: float = 1.0


class PathFollower:
    """Makes steps of the legs of a path; a `StepPlanner`.

    Args:
        legs: at least one, the last of them a stand.
        duration: of a step [s].
        width: of the gait [m].
        settings: how fast and how near.

    Attributes:
        legs: of the path.
        at: index of the present one.
        finished: has the robot stood long enough at the end?
    """

    def __init__(
        self, legs: Sequence[Leg], duration: float, width: float, settings: FollowerSettings | None = None
    ) -> None:
        self.legs, self.settings = tuple(legs), settings or FollowerSettings()
        self._duration, self._width = duration, width
        self._change = self.settings.speed_change * duration
        self.reset(ORIGIN.yaw)

    def reset(self, yaw: float) -> None:
        """The robot stands at the start of the path, looking along ``yaw`` [rad]."""
        self.at, self.finished = 0, False
        self._plan = StepPlan(yaw)
        self._still, self._attempts = 0, 0
        self._spent = 0.0

    @property
    def leg(self) -> Leg:
        """The present leg."""
        return self.legs[self.at]

    # ------------------------------------------------------------------ standing
    def stand(self, stood: float) -> bool:
        """The robot has stood at rest for a time [s]; is it to walk?"""
        while self.leg.standing:
            last = self.at == len(self.legs) - 1
            if stood - self._spent < max(self.leg.duration, self.settings.rest if last else 0.0):
                return False
            if last:
                self.finished = True
                return False
            self._spent += self.leg.duration
            self.at += 1
        self._spent = 0.0
        return True

    @property
    def first_stance(self) -> Stance:
        """The foot to stand on first: the other one steps to its own side."""
        way = self._walk
        aside = way.verb is Verb.RIGHT or (way.verb is Verb.TURN and way.target.yaw < self._plan.yaw)
        return Stance.LEFT if aside else Stance.RIGHT

    @property
    def _walk(self) -> Leg:
        return next((leg for leg in self.legs[self.at :] if not leg.standing), self.leg)

    # ------------------------------------------------------------------ walking
    def begin(self, stance: Stance, foot: Pose) -> StepPlan:
        """A step begins: the foot is where odometry has it, looking where it was to look."""
        stand = stand_of(stance, foot, self._width)
        self._plan = plan = self._step(stand, self._plan.length)
        after = stand.moved(plan.length, plan.aside, plan.turn)
        if self._there(after) and not self._stands_next():
            self.at += 1  # the step after this one is of the next leg
        following = self._step(after, plan.length)
        self._plan = _with_next(plan, following)
        return self._plan

    def plan(self) -> StepPlan:
        """The present step."""
        return self._plan

    def arrives(self, stance: Stance, foot: Pose) -> bool:
        """A foot has landed where the robot may come to a stand; is it to?"""
        if not self._stands_next():
            self._still = self._attempts = 0
            return False
        there = self._there(stand_of(stance, foot, self._width))
        self._attempts += there or self._attempts > 0
        self._still = self._still + 1 if there else 0
        arrived = self._still >= 2 or self._attempts >= self.settings.attempts
        if arrived:
            self._still = self._attempts = 0
            self.at += not self.leg.standing
        return arrived

    def _stands_next(self) -> bool:
        return self.leg.standing or self.legs[self.at + 1].standing

    def _there(self, stand: Pose) -> bool:
        missing = stand.seen(self.leg.target)
        near, straight = self.settings.near, self.settings.straight
        return abs(missing.x) < near and abs(missing.y) < near and abs(missing.yaw) < straight

    def _step(self, stand: Pose, last: float) -> StepPlan:
        """A step from a stand towards the end of the leg, after one of a length [m]."""
        settings, leg, T = self.settings, self.leg, self._duration
        missing = stand.seen(leg.target)
        rates = {Verb.FORWARD: settings.speed, Verb.LEFT: settings.lateral, Verb.TURN: settings.turning}
        own = {Verb.BACK: Verb.FORWARD, Verb.RIGHT: Verb.LEFT}.get(leg.verb, leg.verb)
        if leg.rate is not None and own in rates:
            rates[own] = leg.rate
        c = self._change
        braked = 0.5 * (-c + sqrt(c * c + 8.0 * c * abs(missing.x)))
        longest = min(rates[Verb.FORWARD] * T, braked)
        length = min(max(missing.x, -longest), longest)
        length = min(max(length, last - c), last + c)
        return StepPlan(
            yaw=stand.yaw,
            length=length,
            aside=_within(missing.y, rates[Verb.LEFT] * T),
            turn=_within(missing.yaw, rates[Verb.TURN] * T),
            speed=length / T,
        )


def _with_next(plan: StepPlan, following: StepPlan) -> StepPlan:
    """A plan that knows of the step after it."""
    return plan._replace(next_length=following.length, next_turn=following.turn)


def _within(value: float, most: float) -> float:
    return min(max(value, -most), most)
