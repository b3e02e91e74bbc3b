"""Errors of a robot in space, body by body."""

import numpy as np
import pytest

from frontal_biped.exceptions import RobotError
from frontal_biped.model.space.errors import SpatialErrors


def test_draws_stay_within_their_bounds_and_do_not_depend_on_each_other():
    errors = SpatialErrors.draw(np.random.default_rng(3), 200, mass=0.1, com=0.02, inertia=0.3)
    for values, size in ((errors.mass - 1.0, 0.1), (errors.com, 0.02), (errors.inertia - 1.0, 0.3)):
        assert np.abs(values).max() <= size
        assert np.abs(values).max() > 0.9 * size
    masses_only = SpatialErrors.draw(np.random.default_rng(3), 200, mass=0.1)
    assert np.array_equal(masses_only.mass, errors.mass)
    assert not masses_only.com.any()
    assert masses_only.any


def test_none_is_none():
    assert not SpatialErrors.none(5).any


def test_round_trip():
    errors = SpatialErrors.draw(np.random.default_rng(1), 4, mass=0.1, com=0.1, inertia=0.1)
    back = SpatialErrors.from_dict(errors.as_dict())
    assert all(np.array_equal(getattr(back, key), getattr(errors, key)) for key in ("mass", "com", "inertia"))


@pytest.mark.parametrize(
    "wrong", [{"mass": np.zeros(3)}, {"com": np.zeros((3, 2))}, {"inertia": np.ones(4)}, {"mass": [1.0, np.nan, 1.0]}]
)
def test_what_makes_no_errors_is_refused(wrong):
    with pytest.raises(RobotError, match=next(iter(wrong))):
        SpatialErrors(**{"mass": np.ones(3), "com": np.zeros((3, 3)), "inertia": np.ones(3)} | wrong)
