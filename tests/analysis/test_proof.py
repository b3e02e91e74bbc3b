"""Proofs of gaits against the measured certificate, on file, and what is refused of a file."""

import json
from dataclasses import replace

import numpy as np
import pytest

from frontal_biped.analysis.proof import prove, verify
from frontal_biped.exceptions import GaitFileError, ProofError
from frontal_biped.gait.file import load_gait, save_gait
from frontal_biped.gait.gait import converged_nodes
from frontal_biped.gait.shipped import gait_path
from frontal_biped.model.catalogue import biped_of
from frontal_biped.zero_dynamics.proof.balls import arb
from frontal_biped.zero_dynamics.proof.theorems import Proof
from frontal_biped.zero_dynamics.reversal.certificate import certify_reversal
from frontal_biped.zero_dynamics.reversal.problem import ReversalProblem

MULTIPLIER = 1e-6
"""Largest radius of a multiplier's ball."""


@pytest.fixture(scope="module")
def proof(biped, reference_gait):
    return prove(biped, reference_gait)


@pytest.fixture
def stored(proof, tmp_path):
    proof.save(tmp_path / "gait.proof.json")
    return tmp_path / "gait.proof.json"


def agrees(biped, gait, certificate):
    """No contradiction between what is proved and what is measured."""
    phases = gait.rising, gait.falling, gait.step_width
    problem = ReversalProblem.of_phases(biped, *phases, converged_nodes(biped, *phases))
    measured, proved = certify_reversal(problem), certificate.proof
    assert proved.fixed.region == pytest.approx(measured.fixed.region[0], abs=1e-9)
    assert proved.fixed.counted is Proof.PROVED
    assert len(proved.fixed.found.zeros) == len(measured.fixed.zeros)
    for (low, high), zero in zip(proved.fixed.found.zeros, measured.fixed.zeros, strict=True):
        assert low <= zero.place <= high
    assert proved.zero.proved is Proof.PROVED
    assert proved.zero.stable is Proof.PROVED
    assert proved.zero.multiplier.rad() < MULTIPLIER
    assert proved.zero.multiplier.overlaps(arb(measured.multiplier, 1e-7))
    assert proved.convergence.proved is Proof.PROVED
    assert proved.convergence.factor.overlaps(arb(measured.contraction, measured.contraction_error + 1e-6))


@pytest.mark.parametrize(
    "which", ["reference", *(pytest.param(name, marks=pytest.mark.slow) for name in ("level", "robust"))]
)
def test_gaits_of_the_table_robot(which, biped, request):
    gait = request.getfixturevalue(f"{which}_gait")
    agrees(biped, gait, prove(biped, gait))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["talos_full", "g1", "romeo", "icub"])
def test_gaits_of_humanoids(name):
    biped, gait = biped_of(name), load_gait(gait_path(name))
    agrees(biped, gait, prove(biped, gait))


def test_a_certificate_is_checked_from_its_file_alone(proof, stored):
    again = verify(stored)
    assert again.proof.rows == proof.proof.rows


def changed(path, change):
    table = json.loads(path.read_text())
    change(table)
    path.write_text(json.dumps(table))


def digit(text):
    return text[:3] + str((int(text[3]) + 1) % 10) + text[4:]


def accept_any_digest(monkeypatch, path):
    told = json.loads(path.read_text())["sha256"]
    monkeypatch.setattr("frontal_biped.analysis.proof._digest", lambda content: told)


class TestRefusal:
    """Whatever is not what was proved."""

    def test_one_digit(self, stored):
        def change(table):
            ball = table["reversal"]["multiplier"]
            ball["mid"] = digit(ball["mid"])

        changed(stored, change)
        with pytest.raises(ProofError, match="was changed"):
            verify(stored)

    @pytest.mark.parametrize("group", ["fixed", "reversal", "convergence"])
    def test_a_statement_that_does_not_hold_with_a_digest_that_does(self, stored, group, monkeypatch):
        """The digest guards against accidents; the balls against everything else."""
        false = {
            "fixed": lambda table: table["fixed"]["zeros"].pop(),
            "reversal": lambda table: table["reversal"]["multiplier"].update(mid="1*2^-1"),
            "convergence": lambda table: table["convergence"].update(radius=1e-2),
        }
        changed(stored, false[group])
        accept_any_digest(monkeypatch, stored)
        with pytest.raises(ProofError, match=f"{group}.* does not hold"):
            verify(stored)

    def test_pieces_that_leave_a_gap(self, stored, monkeypatch):
        changed(stored, lambda table: table["fixed"]["pieces"].pop(3))
        accept_any_digest(monkeypatch, stored)
        with pytest.raises(ProofError, match="do not cover"):
            verify(stored)

    def test_a_gait_one_ulp_off(self, stored, reference_gait, tmp_path):
        columns = reference_gait.rising.joint_bezier.copy()
        columns[1, 3] = np.nextafter(columns[1, 3], 1.0)
        other = replace(reference_gait, rising=replace(reference_gait.rising, joint_bezier=columns))
        save_gait(reference_gait, tmp_path / "same.gait.json")
        save_gait(other, tmp_path / "other.gait.json")
        verify(stored, gait=tmp_path / "same.gait.json")
        with pytest.raises(ProofError, match="another gait"):
            verify(stored, gait=tmp_path / "other.gait.json")

    def test_a_robot_one_gram_heavier(self, stored, biped):
        with pytest.raises(ProofError, match="another URDF or description"):
            verify(stored, robot=biped.with_mass(biped.mass + 1e-3))

    @pytest.mark.parametrize("group", ["gait", "fixed", "reversal", "convergence", "settings"])
    @pytest.mark.parametrize("value", [None, {}, [], "text", 3])
    def test_a_part_that_is_none(self, stored, group, value, monkeypatch):
        changed(stored, lambda table: table.update({group: value}))
        accept_any_digest(monkeypatch, stored)
        with pytest.raises((ProofError, GaitFileError), match=str(stored)):
            verify(stored)

    @pytest.mark.parametrize("content", ["{}", "[]", '{"format": "frontal-biped-proof", "version": 2}', "nonsense"])
    def test_no_certificate(self, tmp_path, content):
        path = tmp_path / "c.json"
        path.write_text(content)
        with pytest.raises(ProofError, match=str(path)) as caught:
            verify(path)
        assert "\n" not in str(caught.value)

    def test_no_file(self, tmp_path):
        with pytest.raises(ProofError, match="no such certificate"):
            verify(tmp_path / "none.json")
