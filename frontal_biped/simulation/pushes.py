"""Pushes: lateral forces on the pelvis, at a time of the run or at a moment of a step."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Generic, Protocol, Self, TypeVar

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import SimulationError
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.stance_map import Stance
from frontal_biped.virtual_constraints.phase import StepPhase

PROFILES = ("constant", "half-sine")

_EARLY = 1e-9  # [s] so that a push that starts on a tick acts in it


@dataclass(frozen=True)
class Push:
    """A lateral force on the pelvis for a while.

    Attributes:
        start: when it begins [s]: after the start of the run, or, with ``step`` and ``phase``, after the start of
            that phase.
        duration: [s].
        impulse: of the whole push, positive to the robot's left [N s].
        profile: "constant", or "half-sine": rising from zero and falling back.
        height: of the point where it acts above the hip line, along the torso [m].
        step: index of the step, from 0; None: ``start`` counts from the start of the run.
        phase: "rising" (begins at the impact) or "falling" (begins at the reversal).

    Raises:
        SimulationError: a value that makes no push.
    """

    start: float
    duration: float
    impulse: float
    profile: str = "constant"
    height: float = 0.0
    step: int | None = None
    phase: str | None = None

    def __post_init__(self) -> None:
        check_timing(self)

    def force(self, t: float) -> float:
        """Force to the left at time t since whatever ``start`` counts from [N]."""
        return impulse_rate(self, t, self.impulse)


class Timed(Protocol):
    """When something pushes, and how its force rises and falls; fields as `Push` has them."""

    @property
    def start(self) -> float:
        """[s]."""

    @property
    def duration(self) -> float:
        """[s]."""

    @property
    def profile(self) -> str:
        """One of `PROFILES`."""

    @property
    def step(self) -> int | None:
        """Index of the step, from 0."""

    @property
    def phase(self) -> str | None:
        """Of the step."""


def check_timing(push: Timed) -> None:
    """Raise `SimulationError` where duration, start, profile, step and phase make no push."""
    if not push.duration > 0.0:
        raise SimulationError(f"push: duration = {push.duration!r} s must be positive")
    if not push.start >= 0.0:
        raise SimulationError(f"push: start = {push.start!r} s must not be negative")
    if push.profile not in PROFILES:
        raise SimulationError(f"push: profile = {push.profile!r} is unknown; known: {', '.join(PROFILES)}")
    if (push.step is None) is not (push.phase is None):
        raise SimulationError("push: step and phase belong together; give both or neither")
    if push.phase is not None and push.phase not in {kind.value for kind in StepPhase}:
        raise SimulationError(f"push: phase = {push.phase!r}; write 'rising' or 'falling'")


def impulse_rate(push: Timed, t: float, impulse: float) -> float:
    """Force [N] at time t since whatever ``start`` counts from [s], of a push of an impulse [N s]."""
    elapsed = t - push.start
    if not -_EARLY <= elapsed < push.duration - _EARLY:
        return 0.0
    mean = impulse / push.duration
    if push.profile == "constant":
        return mean
    return 0.5 * np.pi * mean * max(0.0, float(np.sin(np.pi * elapsed / push.duration)))


AnyPush = TypeVar("AnyPush", bound=Timed)


class PushTimes(Generic[AnyPush]):
    """The pushes of one run, as time and phases go by. Whoever drives the engine tells it when a phase begins.

    Args:
        pushes: of the run.
    """

    def __init__(self, pushes: Sequence[AnyPush]) -> None:
        self._pushes = tuple(pushes)
        self._origin: list[float | None] = [0.0 if push.step is None else None for push in pushes]
        self._phases: list[tuple[float, int, StepPhase]] = []

    def replaced(self, pushes: Sequence[AnyPush]) -> Self:
        """Other pushes in the same run, as if they had been its from the start."""
        others = type(self)(pushes)
        for begun in self._phases:
            others.begin(*begun)
        return others

    @property
    def any(self) -> bool:
        """Does anything push in this run?"""
        return bool(self._pushes)

    def begin(self, t: float, step: int, phase: StepPhase) -> None:
        """A phase of a step (from 0) begins at time t [s]; only its first beginning counts."""
        self._phases.append((t, step, phase))
        for i, push in enumerate(self._pushes):
            if self._origin[i] is None and push.step == step and push.phase == phase.value:
                self._origin[i] = t

    def begun(self, t: float) -> Iterator[tuple[AnyPush, float]]:
        """Pushes whose phase has begun, and the time since whatever their ``start`` counts from [s]."""
        for push, origin in zip(self._pushes, self._origin, strict=True):
            if origin is not None:
                yield push, t - origin


class PushForces(PushTimes[Push]):
    """The lateral pushes of one run."""

    def at(self, t: float) -> list[tuple[float, float]]:
        """What acts at time t [s]: force to the left [N] and height of its point above the hip line [m]."""
        acting = []
        for push, elapsed in self.begun(t):
            force = push.force(elapsed)
            if force != 0.0:
                acting.append((force, push.height))
        return acting

    def lateral(self, t: float) -> float:
        """Sum of the forces to the left [N]."""
        return sum(force for force, _ in self.at(t))


class PelvisForce:
    """A horizontal force on the pelvis, as the robot feels it.

    Args:
        biped: the robot, on its stance foot.
    """

    def __init__(self, biped: FrontalBiped) -> None:
        self.biped = biped
        self._data = biped.pinned.createData()

    def torques(self, q: FloatArray, force: float, height: float = 0.0) -> FloatArray:
        """(4,) generalized forces [N m] of a force along h [N], ``height`` [m] above the middle of the hip line."""
        model, data = self.biped.pinned, self._data
        pin.computeJointJacobians(model, data, q)
        ends = [pin.getJointJacobian(model, data, joint, pin.LOCAL_WORLD_ALIGNED)[0] for joint in (2, 3)]
        torques = 0.5 * force * (ends[0] + ends[1])
        # the pelvis turns with the first two joints, and a point above the hips then moves back
        torques[:2] -= force * height * float(np.cos(self.biped.pelvis_roll(q)))
        return torques

    def height(self, q: FloatArray, height: float = 0.0) -> float:
        """Height of the point where it acts above the ground under the stance foot [m]."""
        middle = float(self.biped.joint_positions(q)[1:3, 1].mean())
        return middle + height * float(np.cos(self.biped.pelvis_roll(q)))


def along_h(force_to_the_left: float, stance: Stance) -> float:
    """Force along h, from the stance foot towards the swing foot [N]."""
    return -stance.sign * force_to_the_left
