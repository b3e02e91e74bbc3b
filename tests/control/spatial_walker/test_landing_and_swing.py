"""Time to landing against the orbit and the full planar model; the swing sole's path to its foothold."""

import numpy as np
import pytest
from whole_robots import whole

from frontal_biped.control.spatial_walker.landing_time import LandingTime
from frontal_biped.control.spatial_walker.swing_path import FROZEN, SwingPath
from frontal_biped.simulation.orbit import orbit_trajectory
from frontal_biped.simulation.walking import simulate
from frontal_biped.virtual_constraints.phase import StepPhase

TABLE = 6e-3
"""Of a step's duration: what a table of the energy leaves, linear between points; talos' is steep at the reversal."""

FORESEEN = {0.0: 0.005, 0.01: 0.03, -0.01: 0.03, 0.05: 0.1, -0.05: 0.1}
"""By the relative error of the speed at the start: of a step's duration, root mean square over it. Large ones are more
than is believed of a single reading."""

PERIOD = 1e-3


@pytest.fixture(scope="module", params=["talos_full", "romeo_bent"])
def robot(request):
    return whole(request.param)


@pytest.fixture(scope="module")
def time(robot):
    return LandingTime(robot.biped, robot.gait)


# ---------------------------------------------------------------------- time to landing
def test_on_the_orbit_it_is_the_rest_of_the_step(robot, time):
    orbit = orbit_trajectory(robot.biped, robot.gait, 1)
    assert time.duration == pytest.approx(orbit.t[-1], rel=1e-6)
    for t, q, dq, phase in zip(orbit.t, orbit.q, orbit.dq, orbit.phase, strict=True):
        which = StepPhase.RISING if phase == orbit.phase[0] else StepPhase.FALLING
        assert time.left(which, q[0], dq[0]) == pytest.approx(orbit.t[-1] - t, abs=TABLE * time.duration)


@pytest.mark.parametrize("error", FORESEEN)
def test_what_is_foreseen_happens(robot, time, error):
    """The full planar model walks a step that begins too fast or too slow: the landing comes when it was said to.

    The reversal and the falling phase are others than the orbit's then.
    """
    run = simulate(robot.biped, robot.gait, steps=1, speed_error=error, stabiliser="re-anchored")
    rising = run.phase == run.phase[0]
    missed = [
        time.left(StepPhase.RISING if up else StepPhase.FALLING, q[0], dq[0]) - (run.t[-1] - t)
        for t, q, dq, up in zip(run.t, run.q, run.dq, rising, strict=True)
    ]
    assert np.sqrt(np.mean(np.square(missed))) < FORESEEN[error] * time.duration


def test_beyond_the_ends(time, robot):
    """Past the reversal of the orbit and still rising; landed late: never negative, never endless."""
    falling = robot.gait.step(robot.biped).falling
    top, ground = float(falling.beta.max()), float(falling.beta.min())
    fall = time.left(StepPhase.FALLING, top, 0.0)
    assert time.left(StepPhase.RISING, top + 0.01, 0.1) > time.left(StepPhase.RISING, top + 0.01, 0.0)
    assert time.left(StepPhase.RISING, top + 0.01, 0.0) == pytest.approx(fall, abs=TABLE * time.duration)
    assert time.left(StepPhase.FALLING, ground - 0.01, -1.0) == 0.0
    assert np.isfinite(time.left(StepPhase.FALLING, top + 0.02, 0.0))


# ---------------------------------------------------------------------- swing path
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
