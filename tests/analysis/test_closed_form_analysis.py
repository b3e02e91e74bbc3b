"""A certificate is given to gaits, and withheld from what only looks like one."""

import dataclasses
import json

import numpy as np
import pytest

from frontal_biped.analysis.closed_form import analyze
from frontal_biped.gait import GaitSpecification
from frontal_biped.gait.gait import Gait
from frontal_biped.gait.verdict import RESIDUAL_BOUND
from frontal_biped.virtual_constraints import Phase


@pytest.mark.slow
def test_designed_gaits_are_certified(biped, reference_gait, level_gait):
    for gait in (reference_gait, level_gait):
        analysis = analyze(biped, gait)
        assert analysis.certified, analysis.objections
        assert max(analysis.residuals.values()) <= RESIDUAL_BOUND
        assert 0.0 < analysis.multiplier < 1.0
        assert analysis.fixed_point == pytest.approx(gait.orbit.zeta_f_star, rel=1e-12)
        json.dumps(analysis.as_dict(), allow_nan=False)
        text = str(analysis)
        for code in ("C01", "C02", "C03", "C04", "C05", "C06", "C07", "C08", "C09"):
            assert code in text


def _with_rising(gait: Gait, **changes) -> Gait:
    return dataclasses.replace(gait, rising=dataclasses.replace(gait.rising, **changes))


def test_a_bent_gait_loses_its_certificate(biped, reference_gait):
    bent = reference_gait.rising.joint_bezier.copy()
    bent[1, 3] += 1e-5  # an inner coefficient: invariance holds, the energy balance does not
    analysis = analyze(biped, _with_rising(reference_gait, joint_bezier=bent), certify=False)
    assert not analysis.certified
    assert any("energy_balance" in objection for objection in analysis.objections)


def test_a_gap_at_the_reversal_is_found(biped, reference_gait):
    gap = reference_gait.rising.joint_bezier.copy()
    gap[0, -1] += 1e-7
    analysis = analyze(biped, _with_rising(reference_gait, joint_bezier=gap), certify=False)
    assert any("reversal_pose" in objection for objection in analysis.objections)


def test_a_gap_at_the_impact_is_found(biped, reference_gait):
    gap = reference_gait.rising.joint_bezier.copy()
    gap[2, 1] += 1e-7
    analysis = analyze(biped, _with_rising(reference_gait, joint_bezier=gap), certify=False)
    assert any("impact_slope" in objection for objection in analysis.objections)


def test_tighter_specification_is_reported_as_violated(biped, reference_gait):
    analysis = analyze(biped, reference_gait, GaitSpecification(max_pelvis_roll=np.radians(1.0)), certify=False)
    assert not analysis.certified
    assert {check.code for check in analysis.constraints.violated} == {"max_pelvis_roll"}


def test_stored_numbers_are_checked(biped, reference_gait):
    orbit = dataclasses.replace(reference_gait.orbit, cost=reference_gait.orbit.cost * (1.0 + 1e-6))
    analysis = analyze(biped, dataclasses.replace(reference_gait, orbit=orbit), certify=False)
    assert any("stored_orbit" in objection for objection in analysis.objections)


def test_phase_is_immutable(reference_gait):
    with pytest.raises(dataclasses.FrozenInstanceError):
        reference_gait.rising.beta_end = 0.0
    assert isinstance(reference_gait.rising, Phase)
