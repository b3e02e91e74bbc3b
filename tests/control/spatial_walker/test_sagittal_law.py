"""The sagittal law on the linear inverted pendulum: reference, feedback and foothold against integrated motion."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from frontal_biped.control.spatial_walker.sagittal import SagittalLaw, SagittalSettings
from frontal_biped.model import Stance, load_robot
from frontal_biped.model.chain import GRAVITY
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.model.space.virtual_legs import SpaceState

INTEGRATED = 1e-9
"""Of an ODE solver at rtol 1e-12 [m]."""

LAW = SagittalLaw(omega=3.5, duration=0.7, p_ref=0.01, reach=(-0.06, 0.08), settings=SagittalSettings(rate=3.0))

LENGTHS = (0.0, 0.2, -0.15)  # of a step [m]


def walked(law, x, dx, length, until, cop=None):
    """(x, dx) of the pendulum ahead of the stance ankle after a time, under the law's centre of pressure."""

    def flow(t, state):
        xi = state[0] + state[1] / law.omega
        p = law.cop(xi, length, law.duration - t) if cop is None else cop
        return [state[1], law.omega**2 * (state[0] - p)]

    # in pieces: where the sole is at its end the centre of pressure has a kink
    return solve_ivp(flow, (0.0, until), [x, dx], rtol=1e-12, atol=1e-14, max_step=0.01).y[:, -1]


def xi_of(law, x, dx):
    return x + dx / law.omega


def on_the_walk(law, length):
    """(x, dx) at the start of a periodic step: half a step behind, symmetric about p_ref."""
    x = law.p_ref - 0.5 * length
    return x, law.omega * (law.begin(length) - x)


@pytest.mark.parametrize("length", LENGTHS)
def test_the_reference_is_a_motion_of_the_pendulum(length):
    """Undisturbed, the pressure stays at p_ref; after the step, from the next foot a step ahead, all is as before."""
    x, dx = on_the_walk(LAW, length)
    for share in (0.3, 0.7, 1.0):
        t = share * LAW.duration
        xi = xi_of(LAW, *walked(LAW, x, dx, length, t, cop=LAW.p_ref))
        assert xi == pytest.approx(LAW.reference(length, LAW.duration - t), abs=INTEGRATED)
        assert LAW.cop(xi, length, LAW.duration - t) == pytest.approx(LAW.p_ref, abs=10.0 * INTEGRATED)
    after, rate = walked(LAW, x, dx, length, LAW.duration, cop=LAW.p_ref)
    assert after - length == pytest.approx(x, abs=INTEGRATED)
    assert rate == pytest.approx(dx, abs=INTEGRATED)


@pytest.mark.parametrize("length", LENGTHS)
@pytest.mark.parametrize("error", [0.03, -0.03])
def test_an_error_dies_out_at_the_rate(length, error):
    x, dx = on_the_walk(LAW, length)
    dx += LAW.omega * error
    for t in (0.2, 0.5):
        left = LAW.duration - t
        assert LAW.cop(LAW.reference(length, left) + error, length, left) not in LAW.reach
        xi = xi_of(LAW, *walked(LAW, x, dx, length, t))
        expected = LAW.reference(length, left) + error * np.exp(-LAW.settings.rate * t)
        assert xi == pytest.approx(expected, abs=INTEGRATED)


@pytest.mark.parametrize("length", LENGTHS)
@pytest.mark.parametrize("error", [0.02, -0.03, 0.1, -0.12])
@pytest.mark.parametrize("left", [0.7, 0.4, 0.1])
@pytest.mark.parametrize("next_length", [0.0, 0.25])
def test_the_foothold_begins_the_next_step_on_its_reference(length, error, left, next_length):
    """The rest of the step integrated under the law, the two large errors with the sole at its end all the way."""
    gain = 1.0 + LAW.settings.rate / LAW.omega
    saturated = not LAW.reach[0] < LAW.p_ref + gain * error < LAW.reach[1]
    assert saturated == (abs(error) > 0.05)
    x = 0.02  # of it nothing depends
    xi = LAW.reference(length, left) + error
    foothold = LAW.foothold(xi, length, next_length, left)

    def flow(t, state):
        p = LAW.cop(state[0] + state[1] / LAW.omega, length, left - t)
        return [state[1], LAW.omega**2 * (state[0] - p)]

    start = [x, LAW.omega * (xi - x)]
    end = solve_ivp(flow, (0.0, left), start, rtol=1e-12, atol=1e-14, max_step=0.01).y[:, -1]
    assert xi_of(LAW, *end) - foothold == pytest.approx(LAW.begin(next_length), abs=INTEGRATED)


def test_undisturbed_the_foothold_is_a_step_ahead():
    for length in LENGTHS:
        for left in (0.7, 0.3, 0.0):
            ahead = LAW.foothold(LAW.reference(length, left), length, length, left)
            assert ahead == pytest.approx(length, abs=1e-15)


@pytest.mark.parametrize("name", ["talos_full", "g1_bent", "romeo_bent"])
def test_the_law_of_a_robot(name):
    """omega of its height; the undisturbed pressure below the centre of mass as far as its share of the sole goes."""
    free = FreeRobot(load_robot(name).robot)
    state, settings, sole = SpaceState(free), SagittalSettings(), free.soles.left
    law = SagittalLaw.of(state, 0.6, settings)
    assert law.omega**2 * state.com[2] == pytest.approx(GRAVITY, rel=1e-14)
    low, high = law.reach
    assert -sole.back < low < law.p_ref < high < sole.front
    assert high - low == pytest.approx(settings.cop_share * sole.length)
    ahead = state.com[0] - state.feet[Stance.LEFT].position[0]
    middle = 0.5 * (sole.front - sole.back)
    room = 0.5 * settings.undisturbed_share * sole.length
    assert law.p_ref == pytest.approx(np.clip(ahead, middle - room, middle + room))
