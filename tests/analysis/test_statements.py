"""Measured verdicts beside proved ones, and what a proof contradicts."""

from dataclasses import replace

import pytest

from frontal_biped.analysis.closed_form import analyze
from frontal_biped.analysis.statements import Statement, defects, in_brief, statements, table_text
from frontal_biped.numerics.verdict import COLUMNS, Verdict
from frontal_biped.zero_dynamics.proof.theorems import Proof


@pytest.fixture(scope="module")
def analysis(biped, reference_gait):
    return analyze(biped, reference_gait, in_space=False)


@pytest.fixture(scope="module")
def proof(reference_certificate):
    return reference_certificate.proof


def test_nothing_is_contradicted_of_a_gait(analysis, proof):
    found = statements(analysis, proof)
    assert defects(found) == ()
    verdicts = {statement.name: (statement.measured, statement.proved) for statement in found}
    # two zeros with b fixed: that there is one only is refuted either way
    assert verdicts["b fixed: it has one at most"] == (Verdict.REFUTED, Proof.REFUTED)
    assert verdicts["0 < multiplier < 1"] == (Verdict.CERTIFIED, Proof.PROVED)


def test_a_measurement_that_errs_is_told(analysis, proof):
    """A multiplier above 1 was measured of a gait that is proved to be stable."""
    (told,) = defects(statements(replace(analysis, multiplier=1.01), proof))
    assert "0 < multiplier < 1" in told
    assert "\n" not in told


@pytest.mark.parametrize("measured", [*Verdict, None])
@pytest.mark.parametrize("proved", Proof)
def test_only_contraries_contradict(measured, proved):
    opposite = {Verdict.CERTIFIED: Proof.REFUTED, Verdict.REFUTED: Proof.PROVED}.get(measured)
    statement = Statement("it walks", measured, proved)
    assert statement.contradicted == (proved is opposite)
    assert len(defects([statement])) == int(statement.contradicted)


def test_without_a_certificate_nothing_was_measured_of_zeros(analysis, proof):
    found = statements(replace(analysis, certificate=None), proof)
    assert found[0].measured is None
    assert found[0].as_dict() == {"statement": found[0].name, "measured": None, "proved": "proved"}


def test_table(analysis, proof):
    found = statements(analysis, proof)
    lines = table_text(found).splitlines()
    assert len(lines) == len(found) + 1
    assert lines[0].split() == list(COLUMNS)
    starts = {line.index(row.row[1]) for line, row in zip(lines[1:], found, strict=True)}
    assert len(starts) == 1, "columns are aligned"


def test_in_brief_what_is_open_stays_visible():
    def limit(name, proved):
        return Statement(name, Verdict.CERTIFIED, proved, is_limit=True)

    found = [Statement("it walks", Verdict.CERTIFIED, Proof.PROVED), limit("C02", Proof.PROVED)]
    found += [limit("C03", Proof.PROVED), limit("C04", Proof.UNDECIDED), limit("C05", Proof.REFUTED)]
    assert [statement.name for statement in in_brief(found)] == ["it walks", "C04", "C05", "C01 to C09, 2 bounds"]
    assert in_brief(found[:1]) == tuple(found[:1])
