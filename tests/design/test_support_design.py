"""Design of gaits with a finite double support."""

from dataclasses import replace

import numpy as np
import pytest
from support_gaits import designed

from frontal_biped.design import support_design
from frontal_biped.design.support_design import design_support_gait
from frontal_biped.design.trust_region_sqp import SqpSettings
from frontal_biped.exceptions import DesignFailedError, UnreachablePoseError
from frontal_biped.gait.support_certificate import certify_support_gait
from frontal_biped.gait.support_constraints import evaluate_support_step
from frontal_biped.gait.support_gait import SupportSpecification
from frontal_biped.model.catalogue import biped_of


def test_the_cost_is_that_of_a_finer_quadrature(biped):
    found = designed("frontal_biped")
    step = evaluate_support_step(biped, found.gait, 120)
    assert found.cost == pytest.approx(step.cost, rel=1e-6)
    assert found.gait.speed == pytest.approx(float(step.orbit.dbeta[-1]), rel=1e-8)


def test_double_support_is_as_long_as_was_asked_for(biped):
    found = designed("frontal_biped")
    low, high = found.gait.asked.double_support
    assert low <= found.double_support <= high
    assert np.isclose(found.duration, 2.0 * found.gait.orbit(biped, 60).duration + found.double_support)


def test_what_cannot_be_is_said(biped, monkeypatch):
    """An optimiser that gives up at once stands for one that finds nothing: that would take minutes."""
    hasty = replace(SqpSettings(), max_iterations=1)
    monkeypatch.setattr(support_design, "SqpSettings", lambda: hasty)
    with pytest.raises(DesignFailedError, match="double_support") as caught:
        design_support_gait(biped)
    assert "\n" not in str(caught.value)


def test_feet_too_far_apart(biped):
    with pytest.raises(UnreachablePoseError, match="width"):
        design_support_gait(biped, width=3.0)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["talos_full", "g1"])
def test_humanoids(name):
    found = designed(name)
    assert found.margin >= 0.0
    assert certify_support_gait(biped_of(name), found.gait).holds


@pytest.mark.slow
def test_a_wider_range_costs_more(biped):
    narrow = replace(designed("frontal_biped").gait.asked.bounds, min_phase_range=0.02)
    assert design_support_gait(biped, SupportSpecification(narrow)).cost < designed("frontal_biped").cost
