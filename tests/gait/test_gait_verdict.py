"""The verdict on a gait: one function, asked by whatever accepts, analyses or shows a gait."""

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

from frontal_biped.analysis.closed_form import analyze
from frontal_biped.design.optimise import optimise_gait
from frontal_biped.gait.file import gait_from_dict, gait_to_dict, load_gait
from frontal_biped.gait.gait import Gait, Quadrature, orbit_numbers
from frontal_biped.gait.verdict import RESIDUAL_BOUND, Objection, judge
from frontal_biped.model.catalogue import load_robot
from frontal_biped.numerics.verdict import Verdict
from frontal_biped.studio import jobs
from frontal_biped.zero_dynamics.reversal.problem import ReversalProblem

CLOSE_ZEROS = Path(__file__).parent.parent / "data" / "icub_close_zeros.gait.json"
"""A gait of iCub whose second reversal point is 3.5e-5 rad beyond the planned one, and I_P = 0 another 2.1e-5."""


def bent(gait: Gait, size: float, column: int = 3) -> Gait:
    joints = gait.rising.joint_bezier.copy()
    joints[1, column] += size
    return dataclasses.replace(gait, rising=dataclasses.replace(gait.rising, joint_bezier=joints))


def test_a_pair_of_zeros_closer_than_any_scan_is_seen():
    gait, robot = load_gait(CLOSE_ZEROS), load_robot("icub")
    judged = judge(robot, gait)
    assert judged.verdict is Verdict.CERTIFIED, judged.objections
    assert judged.reversal.beta == pytest.approx(gait.beta_reversal, abs=1e-12)
    # the pair: E is negative between the zeros only, and has no sign beyond the second
    E = ReversalProblem.of_phases(robot, gait.rising, gait.falling, gait.step_width, judged.nodes).at_fixed_parameters()
    values = [E(gait.beta_reversal + x, judged.nodes).surplus for x in (-1e-5, 1e-5, 5e-5, 6e-5)]
    assert values[0] > 0.0 > values[1]
    assert values[2] > 0.0
    assert np.isnan(values[3])


@pytest.mark.slow
def test_certificate_agrees_on_the_close_pair():
    analysis = analyze(load_robot("icub"), load_gait(CLOSE_ZEROS), in_space=False)
    assert analysis.certified
    assert analysis.certificate is not None
    assert analysis.certificate.fixed.existence is analysis.reversal.existence is Verdict.CERTIFIED
    assert analysis.certificate.planned_is_a_zero


@pytest.mark.parametrize(
    ("size", "expected"),
    [
        (0.0, Verdict.CERTIFIED),
        (1e-14, Verdict.CERTIFIED),
        (-1e-7, Verdict.REFUTED),
        pytest.param(1e-3, Verdict.REFUTED, marks=pytest.mark.slow),
    ],
)
def test_every_route_gives_the_same_verdict_on_perturbed_gaits(biped, reference_gait, size, expected, monkeypatch):
    """Design's verdict is analyze's is the report's is the studio's, before and after a round trip through a file."""
    gait = bent(reference_gait, size)
    judged = judge(biped, gait)
    assert judged.verdict is expected
    again = gait_from_dict(json.loads(json.dumps(gait_to_dict(gait))), "gait.json")
    analysis = analyze(biped, again, certify=False, in_space=False)
    assert analysis.verdict is expected
    assert analysis.objections == tuple(objection.reason for objection in judged.objections)
    table = json.loads(json.dumps(analysis.as_dict(), allow_nan=False))
    assert table["verdict"] == expected.value
    assert table["certified"] == (expected is Verdict.CERTIFIED)
    assert analysis.certificate_text.startswith("yes" if analysis.certified else "NO: ")
    assert str(analysis).splitlines()[0].split()[1] == ("yes:" if analysis.certified else "NO:")
    monkeypatch.setattr(jobs, "robot", lambda name: biped)
    monkeypatch.setattr(jobs, "analyze", lambda *args: analysis)
    shown = jobs.certify(lambda line: None, biped.name, gait)
    assert shown.certified == analysis.certified
    assert shown.text == analysis.certificate_text


def test_design_refuses_what_the_verdict_refuses(biped, reference_gait, monkeypatch):
    """No second opinion: where the verdict is not 'certified' there is no gait, and the reason is told."""
    true = judge(biped, reference_gait)
    for verdict in (Verdict.REFUTED, Verdict.UNDECIDED):
        said = dataclasses.replace(true, objections=(Objection(verdict, "the moon is full"),))
        monkeypatch.setattr("frontal_biped.design.optimise.judge", lambda *args, said=said, **more: said)
        result = optimise_gait(biped, reference_gait.specification, start=reference_gait, fall_back=False, advise=False)
        assert result.gait is None
        assert not result.success
        assert "the moon is full" in result.message
        assert verdict.value in result.message


def test_a_step_at_hand_gives_the_same_verdict(biped, reference_gait):
    fresh = judge(biped, reference_gait)
    again = judge(biped, reference_gait, checked=(fresh.step, fresh.constraints))
    assert again.step is fresh.step
    assert again.constraints is fresh.constraints
    assert again.objections == fresh.objections
    coarse = judge(biped, reference_gait, checked=(reference_gait.step(biped, fresh.nodes - 8), fresh.constraints))
    assert len(coarse.step.rising.tau) == fresh.nodes  # a step on other nodes is not the gait's
    assert coarse.residuals == fresh.residuals


def test_a_quadrature_at_hand_gives_the_same_verdict(biped, reference_gait):
    fresh = judge(biped, reference_gait)
    again = judge(biped, reference_gait, quadrature=Quadrature(fresh.nodes, fresh.quadrature_error))
    assert (again.nodes, again.quadrature_error) == (fresh.nodes, fresh.quadrature_error)
    assert again.residuals == fresh.residuals
    assert again.objections == fresh.objections


@pytest.mark.parametrize(
    ("multiplier", "expected"),
    [
        (0.999, None),
        (1.0 - 1e-9, None),
        (1.0 - 1e-12, Verdict.UNDECIDED),
        (1.0 + 1e-12, Verdict.UNDECIDED),
        (1.01, Verdict.REFUTED),
    ],
)
def test_stability_is_asked_with_the_error_as_margin(biped, level_gait, multiplier, expected, monkeypatch):
    monkeypatch.setattr("frontal_biped.zero_dynamics.poincare.HybridZeroDynamics.multiplier", multiplier)
    said = [o for o in judge(biped, level_gait).objections if "multiplier" in o.reason]
    assert [objection.verdict for objection in said] == ([] if expected is None else [expected])


def test_a_gait_that_reverses_elsewhere_is_refuted_with_both_places(biped, level_gait):
    """All residuals but the energy balance in order: the zero of Z is beside the plan."""
    gait = bent(level_gait, 1e-6)
    gait = dataclasses.replace(gait, orbit=orbit_numbers(biped, gait.step(biped)))
    judged = judge(biped, gait)
    assert judged.reversal.exists
    assert judged.reversal.at_the_plan is Verdict.REFUTED
    reason = next(o.reason for o in judged.objections if "the reversal point" in o.reason)
    assert f"{judged.reversal.beta:.9g}" in reason
    assert f"{gait.beta_reversal:.9g}" in reason
    assert judged.residuals["energy_balance"] > RESIDUAL_BOUND


@pytest.mark.slow
def test_no_step_at_the_plan_is_a_verdict_not_an_error(biped, level_gait):
    """A centre of mass outside the FRI target: the robot tips where it should turn back."""
    rising = dataclasses.replace(level_gait.rising, fri_bezier=level_gait.rising.fri_bezier + 1.0)
    with np.errstate(all="ignore"):
        analysis = analyze(biped, dataclasses.replace(level_gait, rising=rising), certify=False, in_space=False)
        assert analysis.verdict is Verdict.REFUTED
        text = json.dumps(analysis.as_dict(), allow_nan=False)
    assert json.loads(text)["reversal"]["exists"] is False
