"""E at fixed parameters and S with invariance imposed, in numbers of fifty digits: a second route to proofs' numbers.

What `zero_dynamics.proof` encloses by Taylor polynomials with remainders is integrated here by Gauss-Legendre
collocation, without any bound. The balls of FLINT serve as long decimal numbers: their radii are rounding alone.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from itertools import pairwise

from flint import arb, arb_mat

from frontal_biped.zero_dynamics.proof.ball_gait import BallGait, BallStep
from frontal_biped.zero_dynamics.proof.balls import working, working_precision
from frontal_biped.zero_dynamics.proof.half_step import HalfStep

BITS = 170
"""Fifty digits and one."""

NODES = 16
"""Of a cell."""

CELLS = 12
"""Of a half step, up to where a scan begins: fifty digits need more, but a scan tells signs."""


@contextmanager
def fifty_digits() -> Iterator[None]:
    """Numbers of fifty digits."""
    with working(), working_precision(BITS):
        yield


@cache
def _gauss() -> tuple[list[arb], list[list[arb]]]:
    """Nodes on [0, 1], and the weights of the integrals from 0 to each of them, and to 1."""
    with working_precision(3 * BITS):
        nodes = [(arb.legendre_p_root(NODES, k) + 1) / 2 for k in range(NODES)][::-1]
        powers = arb_mat([[node**j for node in nodes] for j in range(NODES)])
        ends = [*nodes, arb(1)]
        integrals = arb_mat([[end ** (j + 1) / (j + 1) for end in ends] for j in range(NODES)])
        weights = powers.solve(integrals)
        return nodes, [[weights[j, i].mid() for j in range(NODES)] for i in range(NODES + 1)]


class _Along:
    """W and K of a half step up to a point that moves on."""

    def __init__(self, half: HalfStep) -> None:
        self._half = half
        self.W = self.K = arb(0)

    def move(self, a: arb, b: arb) -> None:
        """From share a of the half step to share b."""
        nodes, weights = _gauss()
        points = [self._half.at(a + (b - a) * node) for node in nodes]
        h = (b - a) * self._half.span
        rates = [point.rate for point in points]
        K = [self.K + h * sum((w * r for w, r in zip(row, rates, strict=True)), arb(0)) for row in weights]
        density = [(-k).exp() * point.drive for k, point in zip(K, points, strict=False)]
        self.W -= h * sum((w * d for w, d in zip(weights[-1], density, strict=True)), arb(0))
        self.K = K[-1]


def _shares(low: arb, high: arb, count: int) -> list[arb]:
    return [low + (high - low) * k / count for k in range(count + 1)]


def scan_fixed(gait: BallGait, region: tuple[float, float], count: int) -> list[tuple[float, arb]]:
    """E at points of a region of reversals, parameters imposed at the planned one.

    Args:
        gait: the parameters.
        region: its ends [rad].
        count: of the points, less one.

    Returns:
        (beta, E) from left to right.
    """
    with fifty_digits():
        step = gait.imposed(arb(gait.free.beta_reversal))
        jump = step.jump()
        betas = _shares(*(arb(end) for end in region), count)
        halves = []
        for half, begin in ((step.rising, gait.begin), (step.falling, gait.end)):
            along, shares = _Along(half), [(beta - begin) / half.span for beta in betas]
            for a, b in pairwise(_shares(arb(0), shares[0], CELLS)):
                along.move(a, b)
            works = [along.W]
            for a, b in pairwise(shares):
                along.move(a, b)
                works.append(along.W)
            halves.append(works)
        return [(float(b), jump * fall - rise) for b, rise, fall in zip(betas, *halves, strict=True)]


def surplus(gait: BallGait, beta: float | arb) -> arb:
    """S at a reversal [rad], invariance imposed there."""
    with fifty_digits():
        step: BallStep = gait.imposed(arb(beta))
        works = []
        for half in (step.rising, step.falling):
            along = _Along(half)
            for a, b in pairwise(_shares(arb(0), arb(1), 2 * CELLS)):
                along.move(a, b)
            works.append(along.W)
        return step.jump() * works[1] - works[0]


def sign_changes(values: list[tuple[float, arb]]) -> list[tuple[float, float]]:
    """Between which neighbours the sign changes."""
    return [(a, b) for (a, x), (b, y) in pairwise(values) if (x > 0) != (y > 0)]
