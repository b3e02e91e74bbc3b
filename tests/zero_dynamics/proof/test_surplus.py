"""E on discs of imposed reversals against balls at points, the quadrature, and functions of one's own."""

import numpy as np
import pytest

from frontal_biped.zero_dynamics.proof.ball_gait import BallGait
from frontal_biped.zero_dynamics.proof.balls import arb, working
from frontal_biped.zero_dynamics.proof.chain import BallChain
from frontal_biped.zero_dynamics.proof.functions import Imposed
from frontal_biped.zero_dynamics.proof.half_step import NotEnclosedError
from frontal_biped.zero_dynamics.proof.signs import Kind, cut
from frontal_biped.zero_dynamics.proof.surplus import DIAGONAL, Ray, Surplus
from frontal_biped.zero_dynamics.reversal.zeros import imposed_regions

QUADRATURE = 1e-7
"""Relative error of an energy from the quadrature, with margin."""


@pytest.fixture(autouse=True)
def _working():
    with working():
        yield


@pytest.fixture
def balls(problem):
    return BallGait.of(BallChain.of(problem.biped.chain), problem.free)


def random_interval(rng, low, high, begin):
    """Of a width up to a third of the distance from the impact."""
    a = rng.uniform(low, high)
    return a, min(high, a + rng.uniform(0.01, 0.35) * (a - begin))


def enclosed(function, a, b):
    try:
        return function.disc(a, b)
    except NotEnclosedError:
        return None


@pytest.mark.parametrize("count", [3, pytest.param(60, marks=pytest.mark.slow)])
def test_discs_contain_their_points(problem, balls, count):
    """All over the region S and its difference quotients, which are slopes somewhere between.

    Either enclosure may be the wider one, near the ends that at points is: they have a number in common.
    """
    rng = np.random.default_rng(0)
    sharp, function, (region,) = Imposed(balls), Surplus(balls), imposed_regions(problem)
    discs = [enclosed(function, *random_interval(rng, *region, float(balls.begin.mid()))) for _ in range(count)]
    discs = [disc for disc in discs if disc is not None]
    assert len(discs) > 0.6 * count
    for disc in discs:
        ends = sorted(rng.uniform(disc.low, disc.high, 2))
        values = [sharp.at(float(beta)) for beta in ends]
        known = disc.known(*map(float, ends))
        for beta, value in zip(ends, values, strict=True):
            point = disc.surplus.value(disc.y(float(beta), float(beta)))
            assert point.overlaps(value)
            assert known.value.overlaps(value)
            assert point.rad() + value.rad() <= 2e-3 * float(disc.surplus.norm[0])
        assert known.slope.overlaps((values[1] - values[0]) / (arb(ends[1]) - arb(ends[0])))


def test_a_disc_contains_more_than_its_middle(problem, balls):
    """What is cut off counts: with a radius of nothing the model is wrong by more than the rounding of its points."""
    disc = Surplus(balls).disc(problem.planned - 2e-3, problem.planned + 2e-3)
    disc.surplus.radius[:] = 0.0
    sharp = Imposed(balls)
    betas = [problem.planned + share * 2e-3 for share in (-1.0, -0.4, 0.3, 1.0)]
    assert not all(disc.surplus.value(disc.y(beta, beta)).contains(sharp.at(beta)) for beta in betas)


def test_rays(problem, balls):
    """E(beta; b(x)) where beta is not x, by the quadrature."""
    scale = abs(problem.balance(problem.planned).required)
    pivot = arb(problem.planned)
    for share in (0.0, -0.5, 0.3):
        low, high = problem.planned + 1e-3, problem.planned + 3e-3
        disc = Surplus(balls, Ray(pivot, share)).disc(low, high)
        for x in (low, 0.7 * low + 0.3 * high, high):
            beta = problem.planned + share * (x - problem.planned)
            step = problem.balance(beta, x)
            found = disc.surplus.value(disc.y(x, x))
            assert abs(float(found.mid()) - step.surplus) <= float(found.rad()) + QUADRATURE * scale


def test_a_ray_along_the_diagonal_is_the_diagonal(problem, balls):
    ends = problem.planned - 1e-3, problem.planned + 1e-3
    along = Surplus(balls, Ray(arb(problem.planned), 1.0)).disc(*ends)
    own = Surplus(balls, DIAGONAL).disc(*ends)
    for y in (-0.9, 0.2, 0.9):
        assert along.surplus.value(arb(y)).overlaps(own.surplus.value(arb(y)))


def test_a_piece_with_a_zero_has_no_sign(problem, balls):
    rng = np.random.default_rng(1)
    for exponent in rng.uniform(-6.0, -2.6, 4):
        width = 10.0**exponent
        low = problem.planned - rng.uniform(0.0, 1.0) * width
        disc = enclosed(Surplus(balls), low, low + width)
        if disc is not None:
            assert disc.known(low, low + width).kind not in (Kind.POSITIVE, Kind.NEGATIVE, Kind.INCREASING)


def test_where_the_rising_phase_is_empty_nothing_is_known(balls):
    begin = float(balls.begin.mid())
    for low, high in ((begin - 1e-3, begin + 1e-3), (begin + 1e-4, begin + 1e-2), (begin - 2e-3, begin - 1e-3)):
        with pytest.raises(NotEnclosedError):
            Surplus(balls).disc(low, high)


def test_where_I_P_vanishes_nothing_is_known(problem, balls):
    """Below the region it does."""
    (region,) = imposed_regions(problem)
    with pytest.raises(NotEnclosedError):
        Surplus(balls).disc(region[0] - 2e-3, region[0] + 1e-4)


def test_given_discs_are_all_there_are(problem, balls):
    ends = problem.planned - 1e-3, problem.planned + 1e-3
    function = Surplus(balls, DIAGONAL, (ends,))
    assert function.on(*ends).kind is Kind.DECREASING
    with pytest.raises(NotEnclosedError):
        function.on(ends[0], ends[1] + 1e-4)
    with pytest.raises(NotEnclosedError):
        function.at(ends[1] + 1e-4)
    pieces = cut(function.on, ends[0], ends[1] + 1e-3, 1e-4, 100)
    assert [piece.kind for piece in pieces if piece.low >= ends[1]] == [Kind.UNDECIDED] * sum(
        piece.low >= ends[1] for piece in pieces
    )
