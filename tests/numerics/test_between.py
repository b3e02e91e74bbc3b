"""A number kept inside a range, as min and max keep it."""

import math

import pytest

from frontal_biped.numerics.between import between


@pytest.mark.parametrize("number", [-math.inf, -2.0, -1.0, 0.3, 1.0, 5.0, math.inf])
def test_as_min_and_max(number):
    assert between(-1.0, number, 1.0) == min(max(number, -1.0), 1.0)


def test_what_is_no_number_stays_so():
    assert math.isnan(between(-1.0, math.nan, 1.0))
