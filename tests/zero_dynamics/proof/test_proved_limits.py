"""C01 to C09 in ball arithmetic against the measured check of seven gaits; what is not kept is not proved."""

from math import comb

import numpy as np
import pytest

from frontal_biped.analysis.proof_inputs import asked_bounds
from frontal_biped.gait.check import check_constraints
from frontal_biped.gait.constraints import SoleHeights, sole_heights, step_constraints
from frontal_biped.gait.file import load_gait
from frontal_biped.gait.shipped import gait_path
from frontal_biped.model.catalogue import biped_of
from frontal_biped.virtual_constraints.invariance import free_parameters
from frontal_biped.zero_dynamics.orbit import resample
from frontal_biped.zero_dynamics.proof.ball_gait import BallGait
from frontal_biped.zero_dynamics.proof.balls import arb, working
from frontal_biped.zero_dynamics.proof.chain import BallChain
from frontal_biped.zero_dynamics.proof.limits import BallOrbit, Bound, prove_limits
from frontal_biped.zero_dynamics.proof.theorems import NearestZero, Proof, nearest_zero

BETWEEN = 1e-2
"""Of a typical size: what the grid of the measured check, 1/640 in tau, leaves out of a bend between its points."""

QUADRATURE = 1e-7
"""Relative error of the measured quantities, with margin: columns as the file rounded them, divided by short ranges."""

ROUNDING = 1e-14
"""Of lengths that the check measures [m]."""


class Proved:
    """A gait, the check that measures it and the proof."""

    def __init__(self, biped, gait):
        self.biped, self.gait, self.step = biped, gait, gait.step(biped)
        self.bounds = asked_bounds(biped, gait)
        free = free_parameters(gait.rising, gait.falling, gait.step_width)
        with working():
            self.balls = BallGait.of(BallChain.of(biped.chain), free)
            self.zero = nearest_zero(self.balls)
        self.limits = self.prove(self.bounds)

    def prove(self, bounds, cuts=None):
        with working():
            return prove_limits(self.balls, self.zero, bounds, self.biped.sole, cuts)

    @property
    def checks(self):
        gait = self.gait
        return check_constraints(self.biped, gait.specification, gait.rising, gait.falling, self.step).checks


@pytest.fixture(scope="module")
def proved(biped, reference_gait):
    return Proved(biped, reference_gait)


def holds_and_agrees(proved):
    """Every bound is enclosed and kept; nowhere is there more room than the grid has, nor much less."""
    assert proved.limits.proved is Proof.PROVED
    for limit, check in zip(proved.limits.limits, proved.checks, strict=True):
        assert (limit.bound.code, limit.bound.name) == (check.code, check.name)
        assert limit.proved is Proof.PROVED
        margin, slack = limit.margin, QUADRATURE * max(check.scale, abs(check.value)) + ROUNDING
        assert margin.lower() <= check.margin + slack
        assert check.margin - float(margin.mid()) < BETWEEN * check.scale
        assert margin.rad() < QUADRATURE * max(check.scale, abs(check.value))


def test_the_reference_gait(proved):
    holds_and_agrees(proved)


@pytest.mark.slow
@pytest.mark.parametrize("which", ["level", "robust"])
def test_gaits_of_the_table_robot(which, biped, request):
    holds_and_agrees(Proved(biped, request.getfixturevalue(f"{which}_gait")))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["talos_full", "g1", "romeo", "icub"])
def test_gaits_of_humanoids(name):
    holds_and_agrees(Proved(biped_of(name), load_gait(gait_path(name))))


def value_at(panels, cuts, y):
    """Of a row at a share of the way from the reversal."""
    i = min(int(np.searchsorted(cuts, y, side="right")), len(cuts) - 1) - 1
    x = (arb(y) - cuts[i]) / (arb(cuts[i + 1]) - cuts[i])
    degree = len(panels[i]) - 1
    return sum((a * comb(degree, k) * x**k * (1 - x) ** (degree - k) for k, a in enumerate(panels[i])), arb(0))


def test_every_row_contains_the_measured_values(proved):
    """At random points of both phases."""
    tau = np.sort(np.random.default_rng(5).uniform(0.0, 1.0, 40))
    gait, step = proved.gait, proved.step
    halves = [
        resample(proved.biped, phase, orbit, tau)
        for phase, orbit in ((gait.rising, step.rising), (gait.falling, step.falling))
    ]
    sampled = step._replace(rising=halves[0], falling=halves[1])
    soles = SoleHeights(*(sole_heights(proved.biped, orbit.motion.q) for orbit in halves))
    constraints = step_constraints(proved.biped, gait.specification, sampled, soles, step.duration)
    seen = 0
    with working():
        orbit = BallOrbit.of(proved.balls, proved.zero.reversal, proved.biped.sole, proved.limits.cuts)
        for constraint in constraints:
            row, _, phase = constraint.name.rpartition(", ")
            half = {"rising": orbit.rising, "falling": orbit.falling}.get(phase)
            if half is None or row not in half.rows | half.squares:
                continue
            seen += 1
            size = np.abs(constraint.values).max()
            panels = half.rows.get(row) or half.squares[row]
            # of the sole both ends are listed in one row, two for each panel, from the impact on
            inner = panels[::2][::-1] if row.startswith("sole") else panels
            for t, value in list(zip(tau, constraint.values, strict=False))[:-1]:
                known = value_at(inner, half.cuts, t * t)
                told = value**2 if row in half.squares else value
                assert known.overlaps(arb(told, QUADRATURE * max(size, size**2)))
                assert known.rad() < 1e-6 * max(size, 1.0) ** 2
    assert seen == 2 * (1 + 1 + 1 + 2 + 1 + 4 + 8)


def moved(bound, margin, by):
    """The bound that is nearer, tightened by its margin and some more; bounds of one side only."""
    inwards = float(margin.upper()) + by
    lower = None if bound.lower is None else bound.lower + inwards
    upper = None if bound.upper is None else bound.upper - inwards
    return bound._replace(lower=lower, upper=upper)


def test_a_bound_that_is_tightened_beyond_its_margin_is_not_proved(proved):
    """By a hair: not proved; by more than what balls leave open: refuted."""
    tried = [limit for limit in proved.limits.limits if limit.bound.name != "step width"]
    hair = [moved(x.bound, x.margin, 1e-12 + x.bound.tolerance) for x in tried]
    assert all(limit.proved is not Proof.PROVED for limit in proved.prove(hair, proved.limits.cuts).limits)
    more = [moved(x.bound, x.margin, 1e-6 * (1.0 + abs(float(x.margin.mid())))) for x in tried]
    refuted = proved.prove(more, proved.limits.cuts)
    assert all(limit.proved is Proof.REFUTED for limit in refuted.limits)
    assert refuted.proved is Proof.REFUTED
    assert len(refuted.rows) == 1 + len(tried)


def test_a_bound_met_exactly_is_kept_and_its_exclusion_refuted(proved):
    width = next(bound for bound in proved.bounds if bound.name == "step width")
    kept, excluded = proved.prove([width, width._replace(strict=True, tolerance=0.0)], proved.limits.cuts).limits
    assert kept.exactly is Proof.PROVED
    assert excluded.proved is Proof.REFUTED


def test_panels_that_are_known_are_not_sought_again(proved):
    again = proved.prove(proved.bounds, proved.limits.cuts)
    assert again.cuts == proved.limits.cuts
    assert again.rows == proved.limits.rows


def test_too_few_panels_prove_nothing_false(proved):
    """A verifier that is given bad panels finds wide balls, or none."""
    coarse = type(proved.limits.cuts)((0.0, 0.5, 1.0), (0.0, 0.5, 1.0))
    found = proved.prove(proved.bounds, coarse)
    assert found.proved is Proof.UNDECIDED


@pytest.mark.parametrize("cuts", [(0.0, 0.5), (0.1, 1.0), (0.0, 0.6, 0.5, 1.0)])
def test_panels_that_leave_a_gap_prove_nothing(proved, cuts):
    given = type(proved.limits.cuts)(cuts, proved.limits.cuts.falling)
    assert proved.prove(proved.bounds, given).proved is Proof.UNDECIDED


def test_a_quantity_without_an_enclosure_is_undecided(proved):
    unknown = Bound("C10", "colour of the pelvis, rising", "-", 0.0, None, False, 1.0)
    found = proved.prove([*proved.bounds, unknown], proved.limits.cuts)
    assert [limit.bound for limit in found.left] == [unknown]
    assert found.proved is Proof.UNDECIDED


def test_no_orbit_no_limits(proved):
    nowhere = NearestZero(proved.zero.planned, arb.nan(), arb.nan(), arb.nan(), Proof.UNDECIDED)
    with working():
        found = prove_limits(proved.balls, nowhere, proved.bounds, proved.biped.sole)
    assert found.cuts is None
    assert all(limit.proved is Proof.UNDECIDED for limit in found.limits)
