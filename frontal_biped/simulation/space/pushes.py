"""Pushes in space: a force in any direction on any link, at a time of the run or at a moment of a step."""

import difflib
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import SimulationError
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.simulation.pushes import PushTimes, check_timing, impulse_rate


@dataclass(frozen=True)
class SpatialPush:
    """A force on a link for a while; its direction stays in the world.

    Attributes:
        start: when it begins [s]: after the start of the run, or, with ``step`` and ``phase``, after the start of
            that phase.
        duration: [s].
        impulse: of the whole push in world axes, X forward, Y left, Z up [N s].
        link: URDF name of the link; "" for the root link.
        point: where it acts, in the axes of the link from its origin [m].
        profile: "constant", or "half-sine": rising from zero and falling back.
        step: index of the step, from 0; None: ``start`` counts from the start of the run.
        phase: "rising" (begins at the impact) or "falling" (begins at the reversal).

    Raises:
        SimulationError: a value that makes no push.
    """

    start: float
    duration: float
    impulse: tuple[float, float, float]
    link: str = ""
    point: tuple[float, float, float] = (0.0, 0.0, 0.0)
    profile: str = "constant"
    step: int | None = None
    phase: str | None = None

    def __post_init__(self) -> None:
        check_timing(self)
        for name in ("impulse", "point"):
            vector = np.asarray(getattr(self, name), dtype=float)
            if vector.shape != (3,) or not np.all(np.isfinite(vector)):
                raise SimulationError(f"push: {name} = {getattr(self, name)!r} is no vector (x, y, z)")
            object.__setattr__(self, name, tuple(vector.tolist()))

    def force(self, t: float) -> FloatArray:
        """(3,) force in world axes at time t since whatever ``start`` counts from [N]."""
        return impulse_rate(self, t, 1.0) * np.array(self.impulse)


class LinkPlace(NamedTuple):
    """Where a link is on the joint that moves it.

    Attributes:
        joint: index in Pinocchio's model; 1 is the free root.
        placement: of the link in the frame of that joint.
    """

    joint: int
    placement: pin.SE3


def link_place(free: FreeRobot, link: str) -> LinkPlace:
    """Where a URDF link, "" for the root, is on a robot.

    Raises:
        SimulationError: the robot has no such link.
    """
    if not link:
        return LinkPlace(1, pin.SE3.Identity())
    model = free.model
    if not model.existFrame(link, pin.FrameType.BODY):
        names = [frame.name for frame in model.frames if frame.type == pin.FrameType.BODY]
        close = difflib.get_close_matches(link, names, n=1)
        remedy = f"did you mean {close[0]!r}?" if close else "name a link of its URDF"
        raise SimulationError(f"push: link = {link!r}: {free.name} has no such link; {remedy}")
    frame = model.frames[model.getFrameId(link, pin.FrameType.BODY)]
    return LinkPlace(frame.parentJoint, frame.placement)


class LinkForce(NamedTuple):
    """What acts on a link.

    Attributes:
        force: (3,) in world axes [N].
        link: URDF name; "" for the root link.
        point: (3,) where it acts, in the axes of the link from its origin [m].
    """

    force: FloatArray
    link: str
    point: FloatArray


class SpatialPushForces(PushTimes[SpatialPush]):
    """The pushes of one run."""

    def at(self, t: float) -> list[LinkForce]:
        """What acts at time t [s]."""
        return [
            LinkForce(force, push.link, np.array(push.point))
            for push, elapsed in self.begun(t)
            if (force := push.force(elapsed)).any()
        ]
