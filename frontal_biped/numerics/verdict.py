"""What was shown of a statement: it holds, it does not hold, or the errors of the numbers leave it open."""

from collections.abc import Iterable
from enum import Enum

COLUMNS = ("statement", "measured", "proved")
"""Of a table that sets what was measured beside what was proved."""


class Verdict(Enum):
    """What was shown."""

    CERTIFIED = "certified"
    REFUTED = "refuted"
    UNDECIDED = "undecided"


def together(verdicts: Iterable[Verdict]) -> Verdict:
    """Of statements that must all hold: one that is refuted refutes them, one that is undecided leaves them open."""
    found = set(verdicts)
    for verdict in (Verdict.REFUTED, Verdict.UNDECIDED):
        if verdict in found:
            return verdict
    return Verdict.CERTIFIED


def below(value: float, bound: float, error: float = 0.0) -> Verdict:
    """Is a value that is known to +- ``error`` below a bound? Undecided within the error, and where it is nan."""
    if value + error < bound:
        return Verdict.CERTIFIED
    return Verdict.REFUTED if value - error > bound else Verdict.UNDECIDED
