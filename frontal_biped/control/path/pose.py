"""Poses on the ground: where something is, and where it looks."""

from math import atan2, cos, sin
from typing import NamedTuple


class Pose(NamedTuple):
    """A place on the ground and a direction.

    Attributes:
        x: forwards in the world [m].
        y: to the left in the world [m].
        yaw: about Z from the world's X, to the left, not wrapped [rad].
    """

    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0

    def moved(self, ahead: float, aside: float, turned: float) -> "Pose":
        """The pose after a motion told in this pose's own axes: ahead [m], to the left [m], to the left [rad]."""
        c, s = cos(self.yaw), sin(self.yaw)
        return Pose(self.x + c * ahead - s * aside, self.y + s * ahead + c * aside, self.yaw + turned)

    def seen(self, other: "Pose") -> "Pose":
        """Another pose in this pose's axes: the motion that leads there; the inverse of `moved`."""
        c, s = cos(self.yaw), sin(self.yaw)
        x, y = other.x - self.x, other.y - self.y
        return Pose(c * x + s * y, -s * x + c * y, other.yaw - self.yaw)


ORIGIN = Pose()


def unwrapped(yaw: float, near: float) -> float:
    """The same direction as ``yaw`` [rad], within half a turn of another one that is not wrapped."""
    return near + atan2(sin(yaw - near), cos(yaw - near))
