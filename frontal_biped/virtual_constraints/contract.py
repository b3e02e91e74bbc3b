"""What the virtual constraints of a phase answer, whatever they are made of: one Bezier polynomial or several pieces.

Controllers and the closed form of the zero dynamics ask nothing else. `Phase` is the plain answer; `anchoring` wraps
phases to begin where the robot is.
"""

from typing import Protocol, Self, TypeVar

from frontal_biped.arrays import FloatArray
from frontal_biped.virtual_constraints.phase import ConstrainedMotion


class VirtualConstraints(Protocol):
    """Virtual constraints of one phase of a step."""

    @property
    def beta_start(self) -> float:
        """Beta at the start of the phase as planned [rad]."""

    @property
    def beta_end(self) -> float:
        """Beta at its end [rad]."""

    @property
    def range(self) -> float:
        """beta_end - beta_start [rad], negative when falling."""

    @property
    def breaks(self) -> tuple[float, ...]:
        """Where the virtual constraints change form [rad]; none where they are one polynomial."""

    def motion(self, beta: FloatArray) -> ConstrainedMotion:
        """The robot on the virtual constraints at beta (n,) [rad]."""

    def desired(self, beta: float) -> tuple[FloatArray, FloatArray, FloatArray, float]:
        """h_d (3,), dh_d/dbeta (3,), d2h_d/dbeta2 (3,) and the FRI target at one beta: what a control tick needs."""

    def shifted(self, shift: float) -> Self:
        """The same with its FRI target moved by a constant [m]."""


class RisingConstraints(VirtualConstraints, Protocol):
    """Virtual constraints of a rising phase, which may be followed past their planned end."""

    @property
    def past_end(self) -> tuple[float, ...]:
        """From the end upwards, where interpolants past it should meet [rad]; further than the last nobody looks."""

    def unshifted(self) -> Self:
        """The same without what `shifted` has added to it, where it keeps account of that."""

    def stretched(self, end: float) -> Self:
        """The same poses in the same order, the final one at another beta [rad]; pose and slope at the start stay."""


RisingT = TypeVar("RisingT", bound=RisingConstraints)
