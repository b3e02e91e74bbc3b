"""A step in ball arithmetic against the quadrature of the zero dynamics: two routes to E, S, m and their slopes."""

from itertools import pairwise

import numpy as np
import pytest

from frontal_biped.zero_dynamics.proof.ball_gait import BallGait
from frontal_biped.zero_dynamics.proof.balls import Jet, arb, as_text, exp, from_text, sin_cos, working
from frontal_biped.zero_dynamics.proof.chain import BallChain
from frontal_biped.zero_dynamics.proof.functions import Fixed, Imposed

QUADRATURE = 1e-7
"""Relative error of an energy from the quadrature, with margin; its nodes are those of the measured certificate."""


@pytest.fixture
def balls(problem):
    with working():
        yield BallGait.of(BallChain.of(problem.biped.chain), problem.free)


def test_invariance_is_imposed_alike(problem, balls):
    rising, falling = problem.phases(problem.planned)
    step = balls.imposed(arb(problem.planned))
    for half, phase in ((step.rising, rising), (step.falling, falling)):
        angles = np.array([[float(b.mid()) for b in curve.columns] for curve in half.angles])
        joints = np.diff(angles, axis=0) - 0.5 * np.pi
        own = phase.joint_bezier if phase is rising else phase.joint_bezier[:, ::-1]
        assert joints == pytest.approx(own, abs=1e-9)  # columns follow from an impact, conditioned like it


@pytest.mark.parametrize("off", [0.0, -1e-3, 5e-4])
def test_surplus_with_invariance_imposed(problem, balls, off):
    beta = problem.planned + off
    scale = abs(problem.balance(problem.planned).required)
    assert float(Imposed(balls).at(beta).mid()) == pytest.approx(problem.S(beta), abs=QUADRATURE * scale)


def test_multiplier(problem, balls):
    step, rising, falling = Imposed(balls).halves(arb(problem.planned))
    m = step.jump() * exp(rising.K - falling.K)
    assert float(m.mid()) == pytest.approx(problem.balance(problem.planned).multiplier, rel=QUADRATURE)
    assert m.rad() < 1e-9


def test_an_interval_contains_its_points(problem, balls):
    """S at points of an interval, and its difference quotients, which are slopes somewhere between."""
    function, h = Imposed(balls), 1e-5
    known = function.on(problem.planned - h, problem.planned + h)
    values = [function.at(problem.planned + share * h) for share in (-1.0, -0.3, 0.4, 1.0)]
    for value in values:
        assert known.value.contains(value)
    assert known.slope.contains((values[-1] - values[0]) / (2 * arb(h)))


def test_partial_slopes_add_up_on_the_diagonal(problem, balls):
    """S' = E_beta + E_x, where beta and x are the same; E_beta is that of the quadrature."""
    function, h = Imposed(balls), 1e-8
    steep, moved = function.partials(problem.planned - h, problem.planned + h)
    slope = function.on(problem.planned - h, problem.planned + h).slope
    assert (steep + moved).overlaps(slope)
    assert (steep + moved - slope).rad() < 0.1 * abs(float(slope.mid()))  # or overlapping would say nothing
    assert float(steep.mid()) == pytest.approx(problem.balance(problem.planned).slope, rel=1e-3)


def test_fixed_parameters_along_the_region(problem, balls):
    """E from left to right in pieces is E by the quadrature at each of their ends."""
    fixed = problem.at_fixed_parameters()
    ends = np.linspace(problem.planned - 2e-3, problem.planned + 2e-4, 40)
    function = Fixed(balls, ends[0])
    scale = abs(problem.balance(problem.planned).required)
    for low, high in pairwise(ends):
        known = function.on(low, high)
        point = fixed(float(high), problem.nodes)
        assert known.value.contains(function.at(high))
        assert float(function.at(high).mid()) == pytest.approx(point.surplus, abs=QUADRATURE * scale)
        assert known.slope.overlaps(arb(point.slope, QUADRATURE * abs(point.slope)))


class TestJets:
    """Derivatives by a parameter against those of known functions."""

    def test_of_sine_exponential_and_quotient(self):
        with working():
            x = Jet([arb("0.3"), arb(1), arb(0)])
            sin, cos = sin_cos(x)
            s, c = arb("0.3").sin(), arb("0.3").cos()
            for jet, parts in ((sin, [s, c, -s / 2]), (cos, [c, -s, -c / 2]), (exp(x), [x.parts[0].exp()] * 2)):
                for part, known in zip(jet.parts, parts, strict=False):
                    assert part.overlaps(known)
                    assert part.rad() < 1e-20
            for part, known in zip((sin / cos * cos).parts, sin.parts, strict=True):
                assert part.overlaps(known)
            for part, known in zip((1 / (1 / x)).parts, x.parts, strict=True):
                assert part.overlaps(known)


def test_balls_on_file_are_exact():
    with working():
        for ball in (arb("0.1"), arb(3, 1e-20), arb(0), arb(-7)):
            again = from_text(as_text(ball))
            assert again.contains(ball)
            assert again.mid() == ball.mid()
            assert again.rad() <= ball.rad() * (1 + arb(2) ** -25)
