"""What a walking controller tracks: a step of a gait, or the one step between two gaits."""

from typing import Protocol

from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.virtual_constraints.phase import Phase


class PlannedStep(Protocol):
    """A step as designed: a `Gait` is one, walked again and again, a `Transition` another, walked once."""

    @property
    def rising(self) -> Phase:
        """Virtual constraints from impact to reversal."""

    @property
    def falling(self) -> Phase:
        """Virtual constraints from reversal to impact."""

    @property
    def speed_after_impact(self) -> float:
        """dbeta_r+, with which it begins [rad/s]."""

    @property
    def specification(self) -> GaitSpecification:
        """What it was designed for."""
