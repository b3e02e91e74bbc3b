"""What `design` asks more of where a certified gait does not walk: remedies of `simulation.falls`, and against what."""

from collections.abc import Iterator
from dataclasses import dataclass

from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.simulation.falls import Remedy, remedies


@dataclass(frozen=True)
class Tightening(Remedy):
    """One change of a specification, and why.

    Attributes:
        event: what it is against.
        engine: where that was seen.
    """

    event: str = ""
    engine: str = ""

    def __str__(self) -> str:
        return f"{super().__str__()} against: {self.event}, in {self.engine}"


def tightenings(spec: GaitSpecification, event: str) -> Iterator[Tightening]:
    """Changes of a specification against an event, see `simulation.falls.remedies`.

    Args:
        spec: what is asked.
        event: outcome of a walk.
    """
    return remedies(spec, event, Tightening)
