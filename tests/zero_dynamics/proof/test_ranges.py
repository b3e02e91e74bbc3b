"""Least values of polynomials by Bernstein's basis, against values and extrema that are known."""

from math import comb

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from frontal_biped.zero_dynamics.proof.balls import ORDER, arb, working
from frontal_biped.zero_dynamics.proof.ranges import controls, least

ACCURACY = 1e-9
NUMBERS = st.lists(st.floats(-2.0, 2.0), min_size=ORDER, max_size=ORDER)


def value(coefficients, x):
    """Of a polynomial in Bernstein's basis."""
    degree = len(coefficients) - 1
    x = arb(x)
    return sum((a * comb(degree, k) * x**k * (1 - x) ** (degree - k) for k, a in enumerate(coefficients)), arb(0))


@given(NUMBERS)
def test_bernstein_coefficients_are_those_of_the_taylor_polynomial(numbers):
    h = 0.75
    with working():
        found = controls([*(arb(a) for a in numbers), arb(0)], arb(h))
        for x in (0.0, 0.3, 1.0):
            t = arb(h) * (2 * arb(x) - 1)
            assert value(found, x).overlaps(sum((a * t**k for k, a in enumerate(numbers)), arb(0)))


@given(NUMBERS)
def test_the_least_value_is_below_all_and_near_one(numbers):
    with working():
        panel = controls([*(arb(a) for a in numbers), arb(0)], arb(1))
        found = least([panel], ACCURACY)
        values = np.polynomial.polynomial.polyval(np.linspace(-1.0, 1.0, 2001), numbers)
        assert float(found.low) <= values.min() + 1e-12  # rounding of the values
        assert float(found.high) >= float(found.low)
        assert float(found.high - found.low) <= 2 * ACCURACY
        assert values.min() - float(found.low) < 1e-3  # a slope of at most 110, halves of 1/1000 at a minimum


def test_the_remainder_is_counted():
    """A function known only to lie within a ball may be as low as the ball is."""
    with working():
        h = arb(0.5)
        panel = controls([arb(1), *([arb(0)] * (ORDER - 1)), arb(0, 1024)], h)
        found = least([panel], ACCURACY)
        assert found.low <= 0.0  # 1 - 1024 / 2^10
        assert found.high >= 2.0


def test_the_least_of_several_panels():
    with working():
        panels = [controls([arb(a), *([arb(0)] * ORDER)], arb(1)) for a in (3.0, -1.0, 2.0)]
        found = least(panels, ACCURACY)
        assert found.low <= -1.0 <= found.high
        assert float(found.high - found.low) < 1e-15
