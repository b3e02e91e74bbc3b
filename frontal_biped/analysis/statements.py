"""What was measured of a gait beside what was proved of it, statement by statement.

A measured verdict rests on interpolants and grids whose error was measured; a proved one on balls
(`zero_dynamics.proof.theorems`). They may both be open, and one may know what the other does not. What is proved
cannot be otherwise: a measured verdict to the contrary is a defect of the measurement.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from frontal_biped.analysis.closed_form import GaitAnalysis
from frontal_biped.gait.check import ConstraintCheck
from frontal_biped.numerics.verdict import COLUMNS, Verdict
from frontal_biped.zero_dynamics.proof.gait_proof import GaitProof
from frontal_biped.zero_dynamics.proof.limits import Bound
from frontal_biped.zero_dynamics.proof.theorems import Proof

_CONTRARY = {(Verdict.CERTIFIED, Proof.REFUTED), (Verdict.REFUTED, Proof.PROVED)}


@dataclass(frozen=True)
class Statement:
    """A statement about a gait.

    Attributes:
        name: the statement.
        measured: verdict by measurement; None: it was not measured.
        proved: verdict by balls.
        is_limit: is it one of C01 to C09?
    """

    name: str
    measured: Verdict | None
    proved: Proof
    is_limit: bool = False

    @property
    def held(self) -> bool:
        """Do measurement and proof both say so?"""
        return self.measured is Verdict.CERTIFIED and self.proved is Proof.PROVED

    @property
    def contradicted(self) -> bool:
        """Does the proof say the contrary of the measurement?"""
        return (self.measured, self.proved) in _CONTRARY

    @property
    def row(self) -> tuple[str, str, str]:
        """(name, measured, proved) for a table."""
        measured = "-" if self.measured is None else self.measured.value
        return self.name, measured, self.proved.value + ("  CONTRADICTION" if self.contradicted else "")

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        measured = None if self.measured is None else self.measured.value
        return {"statement": self.name, "measured": measured, "proved": self.proved.value}


def statements(analysis: GaitAnalysis, proof: GaitProof) -> tuple[Statement, ...]:
    """Every statement that was proved, refuted or left open, beside its measured verdict."""
    measured: dict[str, Verdict] = {}
    if (found := analysis.certificate) is not None:
        measured = {
            "fixed exists": found.fixed.existence,
            "fixed unique": found.fixed.uniqueness,
            "imposed exists": found.self_consistent.existence,
            "imposed unique": found.self_consistent.uniqueness,
            "converges": found.successive_approximation_converges,
        }
    stable = Verdict.CERTIFIED if 0.0 < analysis.multiplier < 1.0 else Verdict.REFUTED
    limits = {(check.code, check.name): check for check in analysis.constraints.checks}
    return (
        Statement("b fixed: Z has a zero on its region", measured.get("fixed exists"), proof.fixed.exists),
        Statement("b fixed: it has one at most", measured.get("fixed unique"), proof.fixed.unique),
        Statement("invariance imposed: the gait reverses as planned", analysis.reversal.existence, proof.zero.proved),
        Statement("0 < multiplier < 1", stable, proof.zero.stable),
        Statement("successive approximation converges near it", measured.get("converges"), proof.convergence.proved),
        Statement(
            "invariance imposed: Z has a zero on its regions", measured.get("imposed exists"), proof.imposed.exists
        ),
        Statement("invariance imposed: it has one at most", measured.get("imposed unique"), proof.imposed.unique),
        *(
            Statement(f"{limit.bound.code} {limit.bound.name}", _kept(limits, limit.bound), limit.proved, True)
            for limit in proof.limits.limits
        ),
    )


def _kept(checks: Mapping[tuple[str, str], ConstraintCheck], bound: Bound) -> Verdict | None:
    check = checks.get((bound.code, bound.name))
    return None if check is None else Verdict.CERTIFIED if check.satisfied else Verdict.REFUTED


def defects(found: Iterable[Statement]) -> tuple[str, ...]:
    """The measured verdicts that a proof contradicts, one line each."""
    return tuple(
        f"defect: measured {statement.row[1]}, but {statement.proved.value}: {statement.name};"
        " please report it with the gait file"
        for statement in found
        if statement.contradicted
    )


def in_brief(found: Sequence[Statement]) -> tuple[Statement, ...]:
    """C01 to C09 that are both certified and proved as one statement."""
    kept = [statement for statement in found if statement.is_limit and statement.held]
    others = [statement for statement in found if statement not in kept]
    if not kept:
        return tuple(others)
    return (*others, Statement(f"C01 to C09, {len(kept)} bounds", Verdict.CERTIFIED, Proof.PROVED))


def table_text(found: Sequence[Statement]) -> str:
    """A table of statements as text."""
    rows = [COLUMNS, *(statement.row for statement in found)]
    widths = [max(len(row[i]) for row in rows) for i in (0, 1)]
    return "\n".join(f"{name:{widths[0]}}  {measured:{widths[1]}}  {proved}" for name, measured, proved in rows)
