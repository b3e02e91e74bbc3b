"""A reading in stance coordinates: those of the stance map, but for the stance leg, whose angle the pelvis tells."""

import numpy as np
import pytest
from hypothesis import given
from random_states import vectors

from frontal_biped.control.interface import Reading
from frontal_biped.control.walker.measured_state import measured_state
from frontal_biped.model.chain import UPRIGHT
from frontal_biped.model.stance_map import Stance, StanceMap

# senses and zeros as no robot has them all
CROOKED = StanceMap(np.array([1.0, -1.0, -1.0, 1.0]), np.array([0.1, -0.2, 0.3, -0.4]), ("a", "b", "c", "d"))


@given(angles=vectors(-1.0, 1.0, 4), rates=vectors(-3.0, 3.0, 4))
@pytest.mark.parametrize("stance", list(Stance))
def test_a_reading_in_stance_coordinates(stance, angles, rates):
    roll, roll_rate, outwards = 0.05, -0.3, -stance.sign
    q, dq = measured_state(CROOKED, Reading(0.0, angles, rates, roll, roll_rate, (True, False)), stance)
    expected, expected_rates = CROOKED.positions_to_stance(angles, stance), CROOKED.velocities_to_stance(rates, stance)
    np.testing.assert_array_equal(q[1:], expected[1:])
    np.testing.assert_array_equal(dq[1:], expected_rates[1:])
    # the pelvis: q_1 + q_2 - 2 UPRIGHT, outwards
    assert q[0] + q[1] - 2.0 * UPRIGHT == pytest.approx(outwards * roll, abs=1e-15)
    assert dq[0] + dq[1] == pytest.approx(outwards * roll_rate, abs=1e-15)


def test_without_rates_there_are_none():
    q, dq = measured_state(CROOKED, Reading(0.0, np.zeros(4), None, 0.0, 0.0, (True, False)), Stance.LEFT)
    assert q.shape == (4,)
    assert dq is None
