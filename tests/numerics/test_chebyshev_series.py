"""Series on an interval: what is read off them in three ways is one number, and their integrals are known ones."""

import numpy as np
import pytest
from numpy.polynomial.chebyshev import chebval

from frontal_biped.numerics.chebyshev_series import DEGREE, PLACES, Series, integral

ROUNDING = 1e-14


@pytest.fixture(params=[(0.3, 1.1), (1.1, 0.3)], ids=["upwards", "downwards"])
def ends(request):
    return request.param


def places(a, b):
    return 0.5 * (a + b) + 0.5 * (b - a) * PLACES


def test_integral_of_a_smooth_function(ends):
    """Of cosine it is sine, from either end."""
    a, b = ends
    series = integral(np.cos(places(a, b)), a, b)
    x = np.linspace(a, b, 7)
    assert series(x) == pytest.approx(np.sin(x) - np.sin(a), abs=ROUNDING)


def test_values_where_it_was_sampled(ends):
    """In the order of the samples, whichever way they went."""
    a, b = ends
    series = integral(np.exp(places(a, b)), a, b)
    assert series.at_places(b - a) == pytest.approx(np.exp(places(a, b)) - np.exp(a), abs=10.0 * ROUNDING)


def test_one_value_at_a_time():
    """NumPy's sum, bit for bit; outside of the interval as well."""
    series = Series(np.random.default_rng(1).normal(size=DEGREE + 2), 0.7, 0.4)
    for x in np.linspace(0.2, 1.2, 11).tolist():
        assert series.at(x) == chebval((x - series.middle) / series.half, series.coefficients)
