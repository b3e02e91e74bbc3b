"""Proofs of gaits against the measured certificate, on file, and what is refused of a file."""

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

import frontal_biped.analysis.proof
from frontal_biped.analysis.proof import _digest, prove, verify
from frontal_biped.control.stabilisers.tabulation import tabulated
from frontal_biped.exceptions import GaitFileError, ProofError
from frontal_biped.gait.file import load_gait, save_gait
from frontal_biped.gait.gait import converged_nodes
from frontal_biped.gait.shipped import gait_path
from frontal_biped.model.catalogue import biped_of
from frontal_biped.zero_dynamics.proof.balls import arb
from frontal_biped.zero_dynamics.proof.theorems import Proof
from frontal_biped.zero_dynamics.reversal.certificate import certify_reversal
from frontal_biped.zero_dynamics.reversal.problem import ReversalProblem

DATA = Path(__file__).parent.parent / "data"

MULTIPLIER = 1e-6
"""Largest radius of a multiplier's ball."""


BESIDE = 4e-4
"""Half of the region of S with which a certificate is made quickly [rad]."""


def prove_quickly(biped, gait):
    """Of the whole region at fixed parameters, of a small one with invariance imposed, and without stretched phases."""
    planned = gait.rising.beta_end
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(
            "frontal_biped.analysis.proof.imposed_regions", lambda _: ((planned - BESIDE, planned + BESIDE),)
        )
        patched.setattr("frontal_biped.zero_dynamics.proof.ankle_basin.MOST_STRETCHES", 0)
        return prove(biped, gait)


@pytest.fixture(scope="module")
def proof(biped, reference_gait):
    return prove_quickly(biped, reference_gait)


@pytest.fixture
def stored(proof, tmp_path):
    proof.save(tmp_path / "gait.proof.json")
    return tmp_path / "gait.proof.json"


@pytest.fixture
def stored_before(stored):
    """As it was before zeros with invariance imposed, and starts from far, were proved."""
    table = json.loads(stored.read_text())
    content = {key: value for key, value in table.items() if key not in ("imposed", "attraction", "sha256")}
    stored.write_text(json.dumps(content | {"sha256": _digest(content)}))
    return stored


def measured_of(biped, gait):
    phases = gait.rising, gait.falling, gait.step_width
    return ReversalProblem.of_phases(biped, *phases, converged_nodes(biped, *phases))


def agrees(measured, certificate):
    """No contradiction between what is proved and what is measured."""
    proved = certificate.proof
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


def first_zero(problem, x):
    """Phi as the proof has it: the zero of E(.; b(x)) met first from x on, where the surplus tells; by a scan."""
    surplus = problem.S(x)
    near = x
    for step in np.geomspace(1e-7, 1.0, 120):
        far = x + np.sign(surplus) * step
        if not problem.balance(far, x).surplus * surplus > 0.0:
            return brentq(lambda beta: problem.balance(beta, x).surplus, near, far, xtol=1e-13)
        near = far
    raise AssertionError("no zero")


def agrees_everywhere(biped, gait):
    """Of all zeros with invariance imposed too, and of starts from far."""
    certificate, problem = prove(biped, gait), measured_of(biped, gait)
    measured, proved = certify_reversal(problem), certificate.proof
    agrees(measured, certificate)
    assert np.array(proved.imposed.regions) == pytest.approx(np.array(measured.self_consistent.region), abs=1e-9)
    assert proved.imposed.counted is Proof.PROVED
    assert len(proved.imposed.places) == len(measured.self_consistent.zeros)
    for (low, high), zero in zip(proved.imposed.places, measured.self_consistent.zeros, strict=True):
        assert low <= zero.place <= high
    low, high = proved.attraction.tiles.reach
    assert proved.attraction.proved is Proof.PROVED
    for start in (low, 0.5 * (low + high), high - 1e-4):
        assert certificate.converges_from(start) is Proof.PROVED
        for _ in range(6):
            following = first_zero(problem, start)
            assert abs(following - problem.planned) < abs(start - problem.planned)
            start = following
    # to the right nothing is left: to the next zero of S, or to the end of the region
    others = [zero.place for zero in measured.self_consistent.zeros if zero.place > problem.planned + 1e-6]
    assert high == pytest.approx(min([*others, measured.self_consistent.region[-1][1]]), abs=1e-4)


def test_a_gait_of_the_table_robot(biped, reference_gait, proof):
    agrees(certify_reversal(measured_of(biped, reference_gait)), proof)
    assert proof.proof.imposed.unique is Proof.PROVED
    planned = reference_gait.rising.beta_end
    assert proof.converges_from(planned + BESIDE) is Proof.PROVED
    assert proof.converges_from(planned + 2 * BESIDE) is Proof.UNDECIDED


@pytest.mark.slow
@pytest.mark.parametrize("which", ["reference", "level", "robust"])
def test_gaits_of_the_table_robot(which, biped, request):
    agrees_everywhere(biped, request.getfixturevalue(f"{which}_gait"))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["talos_full", "g1", "romeo", "icub"])
def test_gaits_of_humanoids(name):
    agrees_everywhere(biped_of(name), load_gait(gait_path(name)))


@pytest.mark.slow
def test_a_gait_with_close_zeros():
    """Its two zeros at fixed parameters are 35 microradians apart: starts to the left are few, to the right all."""
    agrees_everywhere(biped_of("icub"), load_gait(DATA / "icub_close_zeros.gait.json"))


def test_a_certificate_is_checked_from_its_file_alone(proof, stored):
    again = verify(stored)
    assert again.proof.rows == proof.proof.rows


@pytest.mark.slow
def test_a_basin_by_a_table_is_kept_and_checked(biped, reference_gait, tmp_path, monkeypatch):
    """Up to where the table stretches, and a little past it; one that is said to be wider is refused."""
    gait = tabulated(biped, reference_gait, slowest=0.997, fastest=1.045)
    certificate = prove_quickly(biped, gait)
    found = certificate.proof.choices
    assert found.proved is Proof.PROVED and found.tiles
    assert found.high > max(1.04, certificate.proof.basin.high)
    certificate.save(tmp_path / "gait.proof.json")
    assert verify(tmp_path / "gait.proof.json").proof.rows == certificate.proof.rows
    changed(tmp_path / "gait.proof.json", lambda table: table["choices"].update(high=1.1))
    accept_any_digest(monkeypatch, tmp_path / "gait.proof.json")
    with pytest.raises(ProofError, match=r"choices.* does not hold"):
        verify(tmp_path / "gait.proof.json")


def test_every_part_of_a_file_is_described(stored):
    described = re.findall(r"^``(\w+)``", frontal_biped.analysis.proof.__doc__, re.MULTILINE)
    assert sorted(described) == sorted(json.loads(stored.read_text()))


def test_a_file_from_before_makes_fewer_statements(proof, stored_before):
    again = verify(stored_before).proof
    assert again.imposed.counted is Proof.UNDECIDED
    assert again.attraction.proved is Proof.UNDECIDED
    assert again.fixed.found == proof.proof.fixed.found


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

    @pytest.mark.parametrize("group", ["fixed", "reversal", "convergence", "imposed", "attraction"])
    def test_a_statement_that_does_not_hold_with_a_digest_that_does(self, group, request, monkeypatch):
        """The digest guards against accidents; the balls against everything else."""
        stored = request.getfixturevalue("stored" if group in ("imposed", "attraction") else "stored_before")
        false = {
            "fixed": lambda table: table["fixed"]["zeros"].pop(),
            "reversal": lambda table: table["reversal"]["multiplier"].update(mid="1*2^-1"),
            "convergence": lambda table: table["convergence"].update(radius=1e-2),
            "imposed": lambda table: table["imposed"]["zeros"].pop(),
            "attraction": lambda table: table["attraction"]["right"].append(
                [table["attraction"]["reach"][1], table["attraction"]["reach"][1] + 1e-3]
            ),
        }
        changed(stored, false[group])
        accept_any_digest(monkeypatch, stored)
        with pytest.raises(ProofError, match=f"{group}.* does not hold"):
            verify(stored)

    @pytest.mark.parametrize(
        "pieces", [lambda table: table["fixed"]["pieces"], lambda table: table["imposed"]["pieces"][0]]
    )
    def test_pieces_that_leave_a_gap(self, stored, pieces, monkeypatch):
        changed(stored, lambda table: pieces(table).pop(0))
        accept_any_digest(monkeypatch, stored)
        with pytest.raises(ProofError, match="do not cover"):
            verify(stored)

    def test_a_statement_that_is_left_out(self, stored, monkeypatch):
        changed(stored, lambda table: table.pop("reversal"))
        accept_any_digest(monkeypatch, stored)
        with pytest.raises(ProofError, match="not what a certificate holds"):
            verify(stored)

    def test_a_gait_one_ulp_off(self, stored_before, reference_gait, tmp_path):
        columns = reference_gait.rising.joint_bezier.copy()
        columns[1, 3] = np.nextafter(columns[1, 3], 1.0)
        other = replace(reference_gait, rising=replace(reference_gait.rising, joint_bezier=columns))
        save_gait(reference_gait, tmp_path / "same.gait.json")
        save_gait(other, tmp_path / "other.gait.json")
        verify(stored_before, gait=tmp_path / "same.gait.json")
        with pytest.raises(ProofError, match="another gait"):
            verify(stored_before, gait=tmp_path / "other.gait.json")

    def test_a_robot_one_gram_heavier(self, stored, biped):
        with pytest.raises(ProofError, match="another URDF or description"):
            verify(stored, robot=biped.with_mass(biped.mass + 1e-3))

    @pytest.mark.parametrize("group", ["gait", "fixed", "reversal", "convergence", "settings", "imposed", "attraction"])
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
