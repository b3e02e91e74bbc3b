"""The search for the stretch that spends the energy of a landing."""

import numpy as np
import pytest

from frontal_biped.zero_dynamics.half_steps import first_not_positive

PLACES = np.arange(41.0)


def looked_at(row):
    """Place of the first value that is not positive, and how many were looked at for it."""
    seen = set()

    def value(place):
        seen.add(place)
        return float(row[place])

    return first_not_positive([lambda place=place: value(place) for place in range(len(row))]), len(seen)


def expected(row):
    below = np.flatnonzero(row <= 0.0)
    return int(below[0]) if len(below) else None


@pytest.mark.parametrize("root", [0.5, 1.0, 1.7, 2.3, 9.99, 23.4, 39.5, 41.5])
@pytest.mark.parametrize("third", [0.0, 1e-4, -1e-4])
def test_all_but_parabolas_are_not_searched_from_end_to_end(root, third):
    """Their second root is beyond the row, or comes back into it."""
    for other in (root + 12.0, 90.0):
        row = (1.0 - PLACES / root) * (1.0 - PLACES / other) + third * np.minimum(PLACES / root, 1.0) ** 3
        place, looks = looked_at(row)
        assert place == expected(row)
        assert looks <= 7 or place is None


def test_a_parabola_that_stays_positive_is_soon_known_to():
    assert looked_at(0.2 + (1.0 - PLACES / 25.0) ** 2) == (None, 4)


@pytest.mark.parametrize("seed", range(20))
def test_any_other_row_is_searched_from_end_to_end(seed):
    """Straight, bent the other way, a jump; of no shape at all, where any place not positive may be found."""
    rng = np.random.default_rng(seed)
    line, noise = 1.0 - PLACES / rng.uniform(0.3, 60.0), rng.uniform(-0.3, 1.0, len(PLACES))
    noise[0] = 1.0
    for row in (line, line * (1.0 + PLACES / 50.0), noise, 1e4 * np.sign(line)):
        place, _ = looked_at(row)
        assert place is None or row[place] <= 0.0
        if row is not noise:
            assert place == expected(row)
