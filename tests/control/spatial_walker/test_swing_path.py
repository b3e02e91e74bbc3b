"""Minimum-jerk motions: the swing sole's path to its foothold, and a goal that is reached at a speed."""

import numpy as np
import pytest

from frontal_biped.control.spatial_walker.swing_path import FROZEN, MinimumJerk, SwingPath

PERIOD = 1e-3


def swung(goals, duration, start=(0.0, 0.0)):
    """(ticks, 3) x, dx, ddx of a path to goals that may change from tick to tick."""
    path = SwingPath()
    path.start(*start)
    ticks, rows = round(duration / PERIOD), []
    for k in range(ticks):
        path.advance(goals(k / ticks), duration - k * PERIOD, duration, PERIOD)
        rows.append((path.x, path.dx, path.ddx))
    return np.array(rows)


def test_from_rest_it_is_the_minimum_jerk_path():
    duration, way = 0.7, 0.4
    x, dx, ddx = swung(lambda share: way, duration).T
    s = np.arange(1, len(x) + 1) * PERIOD / duration
    last = s < 1.0 - 3.0 * PERIOD / duration  # the last two periods coast
    expected = way * s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
    np.testing.assert_allclose(x[last], expected[last], atol=1e-9 * way)
    rate = way * 30.0 * s**2 * (1.0 - s) ** 2 / duration
    np.testing.assert_allclose(dx[last], rate[last], atol=1e-9 * way / duration)
    change = way * 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / duration**2
    np.testing.assert_allclose(ddx[last], change[last], atol=1e-8 * way / duration**2)


@pytest.mark.parametrize("start", [(0.0, 0.0), (-0.1, 0.5), (0.05, -0.3)])
@pytest.mark.parametrize("moved", [0.0, 0.5, 0.7])
def test_it_arrives_at_rest(start, moved):
    """Wherever it starts, and where its goal moves by a decimetre while it may."""
    x, dx, ddx = swung(lambda share: 0.3 if share < moved else 0.4, 0.7, start)[-1]
    assert x == pytest.approx(0.4, abs=1e-5)
    assert abs(dx) < 1e-3  # the last of the way is coasted
    assert abs(ddx) < 100.0


def test_no_change_is_taken_in_the_last_quarter():
    kept, late = swung(lambda share: 0.3, 0.7), swung(lambda share: 0.3 if share < 1.0 - FROZEN + 0.01 else 0.9, 0.7)
    assert np.array_equal(kept, late)
    early = swung(lambda share: 0.3 if share < 1.0 - FROZEN - 0.01 else 0.9, 0.7)
    assert early[-1, 0] == pytest.approx(0.9, abs=1e-3)


def test_a_landing_that_does_not_come_is_waited_for():
    path = SwingPath()
    path.start(0.0, 0.0)
    for k in range(1000):
        path.advance(0.2, max(0.5 - k * PERIOD, 0.0), 0.5, PERIOD)
    assert path.x == pytest.approx(0.2, abs=1e-5)
    assert path.dx == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("speed", [0.05, -0.2])
def test_a_goal_is_reached_at_a_speed(speed):
    path = MinimumJerk()
    path.start(-0.02, 0.0)
    ticks = 300
    for k in range(ticks - 2):
        path.towards(0.0, (ticks - k) * PERIOD, PERIOD, speed)
    assert path.x == pytest.approx(-2.0 * PERIOD * speed, abs=1e-6)
    assert path.dx == pytest.approx(speed, abs=1e-3)
    path.coast(speed, PERIOD)
    assert path.x == pytest.approx(-PERIOD * speed, abs=2e-6)
