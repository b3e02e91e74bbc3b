"""Speeds from which fixed transitions return: where the search ends, and with how few walks."""

import numpy as np
import pytest

from frontal_biped.analysis.fixed_basin import (
    FIXED_ERRORS,
    SPEED_RESOLUTION,
    fixed_basin,
    growth_to,
    largest_error,
)
from frontal_biped.analysis.push_recovery import RECOVERED, STEPS_TO_DECIDE
from frontal_biped.analysis.return_map import RestrictedMap
from frontal_biped.control import make_stabiliser

WALKS_FROM_ONE_SIDE = 4
"""Enough where errors go down by a law: the first, and two or three around the edge."""


def walked(error, rho, c):
    """Errors of a walk of which each is rho e^(c e) times the one before it, e."""
    errors = [error]
    while len(errors) <= STEPS_TO_DECIDE:
        errors.append(errors[-1] * rho * np.exp(c * errors[-1]))
    return errors


@pytest.mark.slow
def test_fixed_transitions_return_from_less_than_the_ankle_law(biped, robust_gait):
    fixed = fixed_basin(biped, robust_gait)
    ankle = RestrictedMap(biped, robust_gait, make_stabiliser("ankle", biped, robust_gait))
    assert ankle.follow(fixed.low).returned
    assert ankle.follow(fixed.high).returned
    assert 0.8 < fixed.low < 1.0 < fixed.high < 1.2


@pytest.mark.parametrize("falls", [True, False])
def test_largest_error_is_within_its_resolution_of_where_returns_end(falls):
    """Of walks that leave a little less than a share of an error, and of walks that fall."""
    rng = np.random.default_rng(3)
    for edge in rng.uniform(0.0, FIXED_ERRORS[-1], 100):
        tried = []

        def walk(error, edge=edge, tried=tried):
            tried.append(error)
            errors = walked(error, (RECOVERED / edge) ** (1.0 / STEPS_TO_DECIDE), 0.0)
            if error <= edge:
                return "", errors
            return ("fell", ()) if falls else ("not back", errors)

        error, why = largest_error(walk)
        assert error <= edge <= error + SPEED_RESOLUTION
        assert why == ("fell" if falls else "not back")
        assert len(set(tried)) == len(tried)


@pytest.mark.parametrize("c", [-0.2, 0.0, 0.3, 0.6])
@pytest.mark.parametrize("rho", [0.78, 0.8, 0.85])
def test_a_walk_says_where_a_remainder_is_left(rho, c):
    """Of the gaits' own rho and c, and more; the formula is of first order in c."""
    errors = walked(0.1, rho, c)
    at_edge = walked(errors[0] * growth_to(RECOVERED, errors), rho, c)
    assert at_edge[-1] == pytest.approx(RECOVERED, rel=0.05)
    tried = []

    def walk(error):
        tried.append(error)
        left = walked(error, rho, c)
        return "" if left[-1] <= RECOVERED else "not back", left

    largest_error(walk)
    assert len(tried) <= WALKS_FROM_ONE_SIDE


@pytest.mark.parametrize("errors", [(0.1, 0.05, 0.0, 0.0), (0.1, 0.05, 0.06, 0.07)])
def test_of_errors_that_obey_no_law_the_remainder_is_proportional(errors):
    assert growth_to(RECOVERED, errors) == pytest.approx(RECOVERED / max(errors[-1], 1e-12))


def test_largest_error_ends_with_the_search():
    def walk(error):
        return "", walked(error, 0.5, 0.0)

    assert largest_error(walk) == (FIXED_ERRORS[-1], "nothing up to the end of the search")
