"""The swing leg is drawn up and put down; the stance leg takes its length back."""

import numpy as np
import pytest
from whole_robots import whole

from frontal_biped.control.spatial_walker.leg_lengths import LegLengths, LengthSettings
from frontal_biped.control.whole_body.targets import LegLength
from frontal_biped.model import Stance
from frontal_biped.model.space.virtual_legs import SpaceState

PERIOD, DURATION = 1e-3, 0.7


def along(lengths, late=0.0):
    """(ticks, 2, 3) stance and swing leg along a step, and for a time after the landing that does not come [s]."""
    rows = []
    for k in range(round((DURATION + late) / PERIOD)):
        lengths.advance(max(DURATION - k * PERIOD, 0.0), PERIOD)
        rows.append((lengths.stance, lengths.swing))
    return np.array(rows)


@pytest.fixture
def lengths():
    return LegLengths(SpaceState(whole("talos_bent").free), DURATION, LengthSettings())


def test_the_swing_leg_is_drawn_up_and_put_down(lengths):
    settings, leg = LengthSettings(), SpaceState(whole("talos_bent").free).lengths[Stance.LEFT]
    assert lengths.lift == pytest.approx(settings.lift * leg)
    offset, rate, _ = along(lengths)[:, 1].T
    assert offset.min() == pytest.approx(-lengths.lift, rel=0.01)
    assert np.argmin(offset) * PERIOD == pytest.approx(settings.highest * DURATION, abs=0.05 * DURATION)
    assert offset[-1] == pytest.approx(0.0, abs=2e-4)
    assert rate[-1] == pytest.approx(settings.touchdown, rel=0.02)


def test_rates_and_accelerations_belong_to_the_lengths(lengths):
    lengths.start(LegLength(0.008, -0.1), LegLength(-0.004, 0.05))
    x, dx, ddx = np.moveaxis(along(lengths), 2, 0)
    inside = slice(2, -5)
    np.testing.assert_allclose(np.gradient(x, PERIOD, axis=0)[inside], dx[inside], atol=2e-3)
    np.testing.assert_allclose(np.gradient(dx, PERIOD, axis=0)[inside], ddx[inside], atol=0.2)


@pytest.mark.parametrize("offset", [0.01, -0.01])
def test_the_stance_leg_takes_its_length_back(lengths, offset):
    lengths.start(LegLength(offset, 0.05), LegLength())
    stance = along(lengths)[:, 0, 0]
    recovered = round(LengthSettings().recovery * DURATION / PERIOD)
    assert abs(stance[recovered // 4]) > 0.2 * abs(offset)
    np.testing.assert_allclose(stance[recovered:], 0.0, atol=1e-5)


def test_ground_that_does_not_come_is_sought(lengths):
    """At the speed of the touchdown, so far and no further."""
    leg = SpaceState(whole("talos_bent").free).lengths[Stance.LEFT]
    settings = LengthSettings()
    swing = along(lengths, late=1.0)[:, 1, 0]
    assert swing[round((DURATION + 0.1) / PERIOD)] == pytest.approx(0.1 * settings.touchdown, rel=0.1)
    assert swing.max() == pytest.approx(settings.longest * leg, rel=0.02)


def test_legs_that_cannot_are_left_as_they_are():
    """The toy's ankle has no room to bend: its legs keep their length."""
    toy = LegLengths(SpaceState(whole("simple_humanoid_bent").free), DURATION, LengthSettings())
    talos = LegLengths(SpaceState(whole("talos_bent").free), DURATION, LengthSettings(lift=0.0))
    assert toy.lift < 2e-4
    assert talos.lift == 0.0
    assert np.array_equal(along(talos), np.zeros((round(DURATION / PERIOD), 2, 3)))
