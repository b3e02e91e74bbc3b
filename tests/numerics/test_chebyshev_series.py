"""Series on an interval: what is read off them in three ways is one number, and their integrals are known ones."""

import numpy as np
import pytest
from numpy.polynomial.chebyshev import chebval

from frontal_biped.numerics.chebyshev_series import DEGREE, PLACES, Series, at_places, integrals

ROUNDING = 1e-14


LENGTHS = np.array([0.8, 0.3])
"""Of two intervals that begin at `FROM`."""

FROM = 0.3


@pytest.mark.parametrize("sense", [1.0, -1.0], ids=["upwards", "downwards"])
def test_integrals_of_a_smooth_function(sense):
    """Of cosine it is sine, from either end, and of each interval its own; where it was sampled, and in between."""
    ends = FROM + sense * LENGTHS
    places = 0.5 * (FROM + ends)[:, None] + 0.5 * sense * LENGTHS[:, None] * PLACES
    found = 0.5 * LENGTHS[:, None] * integrals(np.cos(places), sense > 0.0)
    assert at_places(found, sense > 0.0) == pytest.approx(np.sin(places) - np.sin(FROM), abs=ROUNDING)
    for series, end in zip(found, ends, strict=True):
        x = np.linspace(FROM, end, 7)
        on = Series(series, 0.5 * (FROM + end), 0.5 * abs(end - FROM))
        assert on(x) == pytest.approx(np.sin(x) - np.sin(FROM), abs=ROUNDING)


def test_one_value_at_a_time():
    """NumPy's sum, bit for bit; outside of the interval as well."""
    series = Series(np.random.default_rng(1).normal(size=DEGREE + 2), 0.7, 0.4)
    for x in np.linspace(0.2, 1.2, 11).tolist():
        assert series.at(x) == chebval((x - series.middle) / series.half, series.coefficients)
