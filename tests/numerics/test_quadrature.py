"""Quadrature from the reversal: exact for polynomials, exact at the ends, spectral for smooth functions."""

from itertools import pairwise

import numpy as np
import pytest

from frontal_biped.numerics.quadrature import reversal_quadrature

ROUNDING = 1e-13
"""Absolute error of integrals of order one: a few dozen additions."""

sizes = pytest.mark.parametrize("size", [2, 3, 8, 16, 24, 40, 64, 128])


@sizes
def test_nodes_run_from_the_reversal_to_the_impact(size):
    rule = reversal_quadrature(size)
    assert rule.size == size == len(rule.tau)
    assert rule.tau[0] == 0.0
    assert rule.tau[-1] == 1.0
    assert np.all(np.diff(rule.tau) > 0.0)
    assert np.allclose(rule.tau, 1.0 - rule.tau[::-1], rtol=0.0, atol=ROUNDING)


@sizes
def test_weights_are_exact_for_polynomials(size):
    rule = reversal_quadrature(size)
    assert np.all(rule.weights > 0.0)
    for power in range(2 * size - 2):  # Gauss-Lobatto: degree 2 n - 3
        assert rule.weights @ rule.tau**power == pytest.approx(1.0 / (power + 1), abs=ROUNDING)


@sizes
def test_operator_is_exact_for_polynomials(size):
    """(Q tau^k)(tau) = tau^k / (k + 2)."""
    rule = reversal_quadrature(size)
    for power in range(size):
        exact = rule.tau**power / (power + 2)
        assert np.allclose(rule.Q @ rule.tau**power, exact, rtol=0.0, atol=10.0 * ROUNDING)


@sizes
def test_operator_at_the_reversal(size):
    """At tau = 0 the integral is g(0)/2, whatever g does elsewhere."""
    g = np.random.default_rng(0).normal(size=size)
    assert (reversal_quadrature(size).Q @ g)[0] == pytest.approx(0.5 * g[0], abs=10.0 * ROUNDING)


def test_operator_converges_spectrally():
    """int_0^tau r exp(3 r) dr = (exp(3 tau)(3 tau - 1) + 1)/9: every two nodes gain more than an order."""

    def error(size):
        rule = reversal_quadrature(size)
        t = rule.tau[1:]
        exact = (np.exp(3.0 * t) * (3.0 * t - 1.0) + 1.0) / 9.0
        return np.max(np.abs(t**2 * (rule.Q @ np.exp(3.0 * rule.tau))[1:] - exact))

    errors = [error(size) for size in (4, 6, 8, 10, 12)]
    assert all(fine < 0.1 * coarse for coarse, fine in pairwise(errors))
    assert error(20) < 10.0 * ROUNDING


def test_rules_are_computed_once():
    assert reversal_quadrature(24) is reversal_quadrature(24)
