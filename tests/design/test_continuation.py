"""Branches of gaits: that they end where they should, and are the gaits that a design from scratch finds."""

from dataclasses import replace

import numpy as np
import pytest

from frontal_biped.design import follow_branch
from frontal_biped.design.continuation import attained, blend
from frontal_biped.gait import GaitSpecification, load_gait
from frontal_biped.gait.holding_wrench import step_holding
from frontal_biped.model import load_robot, models_dir

SAME_COST = 1e-4
"""Relative: both designs stop at a predicted decrease of 1e-5 N^2 m s, on valleys that are flat."""


def test_branch_from_the_free_to_the_level_pelvis(biped, reference_gait, level_gait):
    seen = []
    target = GaitSpecification(max_pelvis_roll=float(np.radians(5.0)))
    branch = follow_branch(biped, reference_gait, target, step=0.5, on_gait=lambda at, gait: seen.append((at, gait)))
    assert branch.complete and branch.reached == 1.0
    assert list(branch.fractions) == sorted(branch.fractions)
    assert [gait for _, gait in seen] == list(branch.gaits)
    costs = [gait.orbit.cost for gait in branch.gaits]
    assert costs == sorted(costs)  # a bound that tightens cannot make the gait cheaper
    assert costs[-1] == pytest.approx(level_gait.orbit.cost, rel=SAME_COST)
    assert branch.gaits[-1].specification == target


@pytest.mark.slow
def test_branch_that_ends_says_where_and_why(biped, reference_gait):
    target = GaitSpecification(max_pelvis_roll=0.001, swing_clearance=0.05)
    branch = follow_branch(biped, reference_gait, target, step=0.5, min_step=0.25)
    assert not branch.complete
    assert 0.0 <= branch.reached < 1.0
    assert f"ends at {100.0 * branch.reached:.1f} %" in branch.message
    assert "\n" not in branch.message


def test_bounds_the_gait_does_not_have_begin_where_it_stands(biped, reference_gait):
    target = GaitSpecification(max_pelvis_roll=0.05, min_energy_margin=2.0, max_multiplier=0.7)
    origin = attained(biped, reference_gait, target)
    step = reference_gait.step(biped)
    rolls = [np.abs(biped.pelvis_roll(orbit.motion.q)).max() for orbit in (step.rising, step.falling)]
    assert origin.max_pelvis_roll == pytest.approx(max(rolls))
    assert origin.max_multiplier == pytest.approx(reference_gait.orbit.multiplier)
    assert origin.max_reversal_shift is None


def test_bounds_on_the_holding_wrench_begin_where_it_is():
    """A centre of pressure that is outside cannot be said in a specification: the target's bound holds at once."""
    robot = load_robot("talos_full")
    gait = load_gait(models_dir() / "talos_full.gait.json")
    origin = attained(robot, gait, replace(gait.specification, cop_margin_x=0.095, yaw_friction=0.15))
    held = [wrench for phase in step_holding(robot, gait.step(robot)) for wrench in phase]
    rooms = [min(np.min(at.sole.front - at.cop_x), np.min(at.sole.back + at.cop_x)) for at in held]
    assert origin.cop_margin_x == pytest.approx(min(rooms))
    assert origin.yaw_friction == pytest.approx(max(np.max(np.abs(at.friction)) for at in held))
    assert attained(robot, gait, gait.specification) == gait.specification


def test_blend():
    origin = GaitSpecification(friction=0.4, step_width=(0.2, 0.3), degree=5)
    target = GaitSpecification(friction=0.8, step_width=(0.3, 0.4), degree=7, max_pelvis_roll=0.1)
    half = blend(origin, target, 0.5)
    assert half.friction == pytest.approx(0.6)
    assert half.step_width == pytest.approx((0.25, 0.35))
    assert (half.degree, half.max_pelvis_roll) == (7, 0.1)
    assert blend(origin, target, 1.0) == target
