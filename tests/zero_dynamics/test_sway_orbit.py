"""Energy and time over the sway: on the orbit, off it in the full planar model, and beyond its ends."""

import numpy as np
import pytest
from whole_robots import whole

from frontal_biped.simulation.orbit import orbit_trajectory
from frontal_biped.simulation.walking import simulate
from frontal_biped.virtual_constraints.phase import StepPhase
from frontal_biped.zero_dynamics.sway_orbit import LONGEST, SwayOrbit

TABLE = 6e-3
"""Of a step's duration: what a table of the energy leaves, linear between points."""

FORESEEN = {0.0: 0.005, 0.01: 0.03, -0.01: 0.03, 0.05: 0.1, -0.05: 0.1}
"""By the relative error of the speed at the start: of a step's duration, root mean square over it."""

PENDULUM = 0.15
"""Of the largest energy of the orbit: by how much the energy error of a step changes from its start to the landing. Of
a point mass it is constant; legs turn, too."""


@pytest.fixture(scope="module", params=["talos_full", "romeo_bent"])
def robot(request):
    return whole(request.param)


@pytest.fixture(scope="module")
def orbit(robot):
    step = robot.gait.step(robot.biped)
    return SwayOrbit(robot.biped, step.rising, step.falling)


def seen(robot, run):
    """Phase, sway, its rate and the time of every sample."""
    for t, q, dq, phase in zip(run.t, run.q, run.dq, run.phase, strict=True):
        which = StepPhase.RISING if phase == run.phase[0] else StepPhase.FALLING
        yield which, float(robot.biped.com(q)[0]), float(robot.biped.com_velocity(q, dq)[0]), t


def test_on_the_orbit_it_is_the_rest_of_the_step(robot, orbit):
    run = orbit_trajectory(robot.biped, robot.gait, 1)
    assert orbit.duration == pytest.approx(run.t[-1], rel=1e-6)
    for which, s, ds, t in seen(robot, run):
        assert orbit.left(which, s, ds) == pytest.approx(run.t[-1] - t, abs=TABLE * orbit.duration)


def test_on_the_orbit_there_is_no_error(robot, orbit):
    run = orbit_trajectory(robot.biped, robot.gait, 1)
    largest = max(0.5 * ds**2 for _, _, ds, _ in seen(robot, run))
    for which, s, ds, _ in seen(robot, run):
        assert orbit.error(which, s, ds) == pytest.approx(0.0, abs=0.01 * largest)


@pytest.mark.parametrize("error", FORESEEN)
def test_what_is_foreseen_happens(robot, orbit, error):
    """The full planar model walks a step that begins too fast or too slow: the landing comes when it was said to."""
    run = simulate(robot.biped, robot.gait, steps=1, period=None, speed_error=error, stabiliser="re-anchored")
    missed = [orbit.left(which, s, ds) - (run.t[-1] - t) for which, s, ds, t in seen(robot, run)]
    assert np.sqrt(np.mean(np.square(missed))) < FORESEEN[error] * orbit.duration


@pytest.mark.parametrize("error", [0.05, -0.05])
def test_an_energy_error_stays_what_it_is(robot, orbit, error):
    run = simulate(robot.biped, robot.gait, steps=1, period=None, speed_error=error, stabiliser="re-anchored")
    samples = list(seen(robot, run))
    errors = [orbit.error(which, s, ds) for which, s, ds, _ in samples]
    largest = max(0.5 * ds**2 for _, _, ds, _ in samples)
    assert np.sign(errors[0]) == np.sign(error)
    assert max(errors) - min(errors) < PENDULUM * largest


def test_a_controller_takes_the_error_off(robot):
    """What dies out changes the landing less than what stays."""
    step = robot.gait.step(robot.biped)
    kept, led_back = (SwayOrbit(robot.biped, step.rising, step.falling, decay) for decay in (np.inf, 0.6))
    s = kept.half_way(StepPhase.FALLING)
    speed = float(np.sqrt(2.0 * kept.energy(StepPhase.FALLING, s)))
    for share in (0.7, 1.3):
        planned = kept.left(StepPhase.FALLING, s, speed)
        late = [each.left(StepPhase.FALLING, s, share * speed) - planned for each in (kept, led_back)]
        assert np.sign(late[0]) == np.sign(late[1]) == np.sign(1.0 - share)
        assert abs(late[1]) < abs(late[0])


def test_beyond_the_ends(robot, orbit):
    """Past the reversal and still rising; begun further inwards; landed late: never negative, never endless."""
    step = robot.gait.step(robot.biped)
    far = float(robot.biped.com(step.falling.motion.q[np.argmax(step.falling.tau)])[0])
    top = orbit.reversal
    fall = orbit.left(StepPhase.FALLING, top, 0.0)
    assert orbit.left(StepPhase.RISING, top - 0.01, -0.05) > orbit.left(StepPhase.RISING, top - 0.01, 0.0) > fall
    assert orbit.left(StepPhase.RISING, top, 0.0) == pytest.approx(fall, abs=TABLE * orbit.duration)
    assert orbit.left(StepPhase.FALLING, far + 0.01, 0.3) == 0.0
    assert 0.0 < orbit.left(StepPhase.FALLING, top - 0.2, 0.0) <= LONGEST * orbit.duration
    # a start further inwards takes more energy to the same reversal
    energies = [orbit.energy(StepPhase.RISING, s) for s in (far, far + 0.01, far + 0.02)]
    assert (np.diff(energies) > 0.0).all()
    assert orbit.energy(StepPhase.RISING, top - 0.01) < 0.0
