"""All zeros of S: where they are, at an end, none, nearly double ones. Proved or undecided, never wrong."""

import numpy as np
import pytest

from frontal_biped.model.catalogue import biped_of
from frontal_biped.zero_dynamics.proof import imposed_zeros as module
from frontal_biped.zero_dynamics.proof import surplus
from frontal_biped.zero_dynamics.proof.ball_gait import BallGait
from frontal_biped.zero_dynamics.proof.balls import arb, working
from frontal_biped.zero_dynamics.proof.chain import BallChain
from frontal_biped.zero_dynamics.proof.imposed_zeros import Partition, imposed_zeros
from frontal_biped.zero_dynamics.proof.signs import Known
from frontal_biped.zero_dynamics.proof.theorems import Proof
from frontal_biped.zero_dynamics.reversal.problem import ReversalProblem


@pytest.fixture(autouse=True)
def _working():
    with working():
        yield


@pytest.fixture
def balls(reference_gait):
    gait = reference_gait
    problem = ReversalProblem.of_phases(biped_of("frontal_biped"), gait.rising, gait.falling, gait.step_width, 32)
    return BallGait.of(BallChain.of(problem.biped.chain), problem.free)


def test_one_zero(balls):
    planned = balls.free.beta_reversal
    found = imposed_zeros(balls, ((planned - 1e-3, planned + 2e-3),))
    assert found.counted is Proof.PROVED
    assert found.unique is Proof.PROVED
    ((low, high),) = found.places
    assert low <= planned <= high < low + 1e-4
    assert found.around(arb(planned)) == found.regions[0]


def test_no_zero(balls):
    planned = balls.free.beta_reversal
    found = imposed_zeros(balls, ((planned + 1e-3, planned + 3e-3),))
    assert found.counted is Proof.PROVED
    assert found.places == ()
    assert found.around(arb(planned)) is None


@pytest.mark.parametrize(("error", "counted"), [(1e-18, Proof.PROVED), (1e-13, Proof.UNDECIDED)])
def test_a_robot_that_is_not_well_known(balls, error, counted, monkeypatch):
    """With all of its numbers widened the count is the same, or undecided, and the effort is bounded."""
    monkeypatch.setattr(surplus, "MOST_DISCS", 6)
    chain = BallChain.of(biped_of("frontal_biped").chain, error)
    planned = balls.free.beta_reversal
    found = imposed_zeros(BallGait.of(chain, balls.free), ((planned - 1e-3, planned + 2e-3),))
    assert found.counted is counted
    assert len(found.places) == (1 if counted is Proof.PROVED else 0)


@pytest.mark.parametrize("side", [-1, 1])
def test_a_zero_at_an_end_is_undecided(balls, side):
    planned = balls.free.beta_reversal
    ends = sorted((planned, planned + side * 1e-3))
    found = imposed_zeros(balls, (tuple(ends),))
    assert found.counted is Proof.UNDECIDED
    assert found.unique is Proof.UNDECIDED
    assert found.places == ()


def test_two_regions(balls):
    planned = balls.free.beta_reversal
    regions = ((planned - 1e-3, planned - 5e-4), (planned - 4e-4, planned + 1e-3))
    found = imposed_zeros(balls, regions)
    assert found.counted is Proof.PROVED
    assert len(found.places) == 1
    assert found.around(arb(planned)) == regions[1]


def test_no_region_proves_nothing(balls):
    assert imposed_zeros(balls, ()).counted is Proof.UNDECIDED


class Parabola:
    """(x - 0.3)^2 + shift, in place of S."""

    def __init__(self, shift):
        self.shift, self.discs = shift, []

    def __call__(self, *_):
        return self

    def on(self, low, high):
        x = arb(low).union(arb(high))
        return Known((x - arb("0.3")) * (x - arb("0.3")) + arb(self.shift), 2 * (x - arb("0.3")))

    def at(self, x):
        return self.on(x, x).value


@pytest.mark.parametrize(("shift", "number"), [(1e-7, 0), (-1e-7, 2), (0.0, None), (1e-30, None)])
def test_nearly_double_zeros(balls, monkeypatch, shift, number):
    monkeypatch.setattr(module, "Surplus", Parabola(shift))
    monkeypatch.setattr(module, "Imposed", Parabola(shift))
    found = imposed_zeros(balls, ((0.0, 1.0),))
    if number is None:
        assert found.counted is not Proof.PROVED
        assert all(low <= 0.3 + 1e-6 and high >= 0.3 - 1e-6 for low, high in found.undecided)
    else:
        assert found.counted is Proof.PROVED
        roots = [] if number == 0 else [0.3 - np.sqrt(-shift), 0.3 + np.sqrt(-shift)]
        assert len(found.places) == number
        assert all(low <= root <= high for (low, high), root in zip(found.places, roots, strict=True))


class TestPartition:
    """Checked without the search."""

    @pytest.fixture
    def found(self, balls):
        planned = balls.free.beta_reversal
        return imposed_zeros(balls, ((planned - 1e-3, planned + 1e-3),))

    def test_what_was_found_does(self, balls, found):
        partition = Partition(found.discs, tuple(own.pieces for own in found.found), found.places)
        assert imposed_zeros(balls, found.regions, partition) == found

    def test_a_place_without_the_zero_does_not(self, balls, found):
        moved = tuple((high, high + 1e-6) for _, high in found.places)
        partition = Partition(found.discs, tuple(own.pieces for own in found.found), moved)
        assert imposed_zeros(balls, found.regions, partition).places != moved

    def test_discs_that_leave_a_gap_do_not(self, balls, found):
        planned = balls.free.beta_reversal
        discs = ((planned - 1e-3, planned - 1e-4), (planned + 1e-4, planned + 1e-3))
        partition = Partition(discs, tuple(own.pieces for own in found.found), found.places)
        assert imposed_zeros(balls, found.regions, partition).counted is Proof.UNDECIDED
