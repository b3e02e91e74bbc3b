"""What a sampled walk is measured by between two landings, on the plane or in space."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from math import dist

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.model.stance_map import Stance

AIRBORNE = 0.02
"""Time without contact that makes a foot a swing foot [s]; landings without it are not counted as steps."""

SETTLED = 0.03
"""Time after a landing before slip and rotation of the foot are measured [s]."""


@dataclass
class Measured:
    """What the sampled trajectory does not show, step by step.

    Attributes:
        slip: largest motion of the stance foot after it has settled [m].
        rotation: largest rotation of the stance foot from flat after it has settled [rad].
        double_support: time with both feet on the ground [s].
        work: of the joint torques, taken without sign [J].
        effort: integral of the squared torques [N^2 m^2 s].
    """

    slip: list[float] = field(default_factory=list)
    rotation: list[float] = field(default_factory=list)
    double_support: list[float] = field(default_factory=list)
    work: list[float] = field(default_factory=list)
    effort: list[float] = field(default_factory=list)

    def summary(self) -> dict[str, dict[str, float]]:
        """Mean and largest value over the steps."""
        return {
            name: {"mean": float(np.mean(values)), "largest": float(np.max(values))}
            for name, values in asdict(self).items()
            if values
        }


class StepMeter:
    """Measures a walk step by step.

    Args:
        period: control period [s].

    Attributes:
        measured: of the steps that are complete.
        began: when the present step began [s].
    """

    def __init__(self, period: float) -> None:
        self._period = period
        self.measured = Measured()
        self.begin_step(0.0)

    def begin_step(self, t: float) -> None:
        """A step begins at time t [s]."""
        self.began = t
        self._foot: Sequence[float] | None = None
        self._slip = self._rotation = self._double = 0.0
        self._driven: list[tuple[FloatArray, FloatArray]] = []

    def end_step(self) -> None:
        """The step is complete."""
        measured = self.measured
        measured.slip.append(self._slip)
        measured.rotation.append(self._rotation)
        measured.double_support.append(self._double)
        tau, rates = np.array(self._driven).swapaxes(0, 1)  # one look at a step: a tick has no time for it
        measured.work.append(self._period * float(np.abs(tau * rates).sum()))
        measured.effort.append(self._period * float((tau * tau).sum()))

    def drive(self, tau: FloatArray, rates: FloatArray) -> None:
        """Joint torques (n,) [N m] have acted for a period at rates (n,) [rad/s]."""
        self._driven.append((tau, rates))

    def stands(self, t: float, touching: tuple[bool, bool]) -> bool:
        """Count double support; does the stance foot stand alone and settled at time t [s]?"""
        both = touching[0] and touching[1]
        if both:
            self._double += self._period
        return not both and t - self.began >= SETTLED

    def foot(self, position: Sequence[float], rotation: float) -> None:
        """A stance foot that stands is at a position on the ground (k numbers) [m], turned from flat [rad]."""
        if self._foot is None:
            self._foot = position
        self._slip = max(self._slip, dist(position, self._foot))
        self._rotation = max(self._rotation, abs(rotation))


class Airborne:
    """Tells landings from bounces.

    Args:
        period: control period [s].
    """

    def __init__(self, period: float) -> None:
        self._period = period
        self._time = [0.0, 0.0]  # of the left and of the right foot

    def lands(self, foot: Stance) -> bool:
        """A foot is said to have landed: was it in the air for long enough?"""
        side = 0 if foot is Stance.LEFT else 1
        if self._time[side] < AIRBORNE:
            return False
        self._time[side] = 0.0
        return True

    def watch(self, touching: tuple[bool, bool]) -> None:
        """A period passes with the left and the right foot touching the ground or not."""
        left, right = touching
        if not left:
            self._time[0] += self._period
        if not right:
            self._time[1] += self._period
