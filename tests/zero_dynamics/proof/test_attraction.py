"""Successive approximation from far: what is proved, tried by the quadrature, and tiles that show nothing."""

import numpy as np
import pytest

from frontal_biped.model.catalogue import biped_of
from frontal_biped.zero_dynamics.proof.attraction import Attraction, Tiles, attraction, hold
from frontal_biped.zero_dynamics.proof.ball_gait import BallGait
from frontal_biped.zero_dynamics.proof.balls import working
from frontal_biped.zero_dynamics.proof.chain import BallChain
from frontal_biped.zero_dynamics.proof.imposed_zeros import imposed_zeros
from frontal_biped.zero_dynamics.proof.theorems import Convergence, Proof, convergence, nearest_zero
from frontal_biped.zero_dynamics.reversal.problem import ReversalProblem
from frontal_biped.zero_dynamics.reversal.solver import successive_approximation

BESIDE = 4e-4
"""Half of the region of S [rad]."""


@pytest.fixture(scope="module")
def problem(reference_gait):
    gait = reference_gait
    return ReversalProblem.of_phases(biped_of("frontal_biped"), gait.rising, gait.falling, gait.step_width, 32)


@pytest.fixture(autouse=True, scope="module")
def _working():
    with working():
        yield


@pytest.fixture(scope="module")
def balls(problem, _working):
    return BallGait.of(BallChain.of(problem.biped.chain), problem.free)


@pytest.fixture(scope="module")
def known(balls):
    """The zero, convergence near it, and the zeros on a region about it."""
    zero, planned = nearest_zero(balls), balls.free.beta_reversal
    return zero, convergence(balls, zero), imposed_zeros(balls, ((planned - BESIDE, planned + BESIDE),))


@pytest.fixture(scope="module")
def found(balls, known):
    return attraction(balls, *known)


def test_it_reaches_as_far_as_the_zero_is_alone(problem, found):
    assert found.proved is Proof.PROVED
    assert found.tiles.reach == (problem.planned - BESIDE, problem.planned + BESIDE)


def test_from_starts_within_it_the_quadrature_converges(problem, found):
    low, high = found.tiles.reach
    for start in (low, high):
        assert found.converges_from(float(start)) is Proof.PROVED
        walked = successive_approximation(problem, float(start), tolerance=1e-6)
        assert walked.converged
        assert abs(walked.beta - problem.planned) < 1e-4
        distances = np.abs(np.array(walked.history) - problem.planned)
        assert np.all(distances[1:-1] < distances[:-2])


def test_from_others_it_is_undecided(found):
    low, high = found.tiles.reach
    for start in (low - 1e-6, high + 1e-6, np.nan):
        assert found.converges_from(start) is Proof.UNDECIDED


def test_what_was_found_is_checked_without_the_search(balls, known, found):
    assert attraction(balls, *known, found.tiles) == found


class TestTilesThatShowNothing:
    """Each is one change away from those that do."""

    def test_a_share_that_the_contraction_exceeds(self, balls, known, found):
        """Phi' is 0.96: iterates do not cross beta*, but a tile of share 1 would not contract either."""
        assert not hold(balls, known[0].reversal, found.tiles._replace(share=1.0))

    def test_a_gap(self, balls, known, found):
        right = tuple((low + 1e-6, high) for low, high in found.tiles.right)
        assert not hold(balls, known[0].reversal, found.tiles._replace(right=right))

    def test_a_middle_beside_the_zero(self, balls, known, found):
        tiles = found.tiles
        planned = balls.free.beta_reversal
        moved = Tiles(tiles.share, (), ((planned + 1e-5, planned + 1e-4),), ())
        assert not hold(balls, known[0].reversal, moved)

    def test_too_far_to_the_left(self, balls, known, found):
        """Z has no zero there that the iteration could go to."""
        low = found.tiles.reach[0]
        left = ((low - 2e-3, low), *found.tiles.left)
        assert not hold(balls, known[0].reversal, found.tiles._replace(left=left))

    def test_beyond_the_region(self, balls, known, found):
        high = found.tiles.reach[1]
        tiles = found.tiles._replace(right=(*found.tiles.right, (high, high + 1e-4)))
        assert attraction(balls, *known, tiles).proved is Proof.UNDECIDED

    def test_nothing_near(self, balls, known):
        """Where convergence is not even proved near the zero nothing is sought."""
        zero, near, zeros = known
        unknown = Convergence(0.0, near.factor, Proof.UNDECIDED)
        assert attraction(balls, zero, unknown, zeros) == Attraction(None, Proof.UNDECIDED)
