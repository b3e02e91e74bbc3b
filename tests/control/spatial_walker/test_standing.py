"""Into the first step: the pendulum under the planned centre of pressure, against an ODE solver."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from whole_robots import whole

from frontal_biped.control.spatial_walker.sagittal import SagittalLaw, SagittalSettings
from frontal_biped.control.spatial_walker.standing import StandingLaw, StandingSettings, Start
from frontal_biped.exceptions import SimulationError
from frontal_biped.model.space.virtual_legs import SpaceState
from frontal_biped.model.stance_map import Stance

OMEGA, Q, RAMP = 3.3, 0.15, 0.1  # [1/s], [m], [s]

PLACE, SPEED = 0.002, 0.36  # [m], [m/s]

ODE = 1e-8
"""Of the solver, at tolerances of 1e-11 [m, m/s]."""


@pytest.fixture(scope="module")
def start():
    return Start(OMEGA, Q, RAMP, 0.0, PLACE, SPEED, Stance.LEFT)


def test_it_is_the_motion_of_a_pendulum(start):
    def fall(t, x):
        return [x[1], OMEGA**2 * (x[0] - start.at(t)[2])]

    times = np.linspace(0.0, start.duration, 50)
    solved = solve_ivp(fall, (0.0, start.duration), [0.0, 0.0], t_eval=times, rtol=1e-11, atol=1e-11, max_step=1e-3)
    told = np.array([start.at(t)[:2] for t in times]).T
    assert np.abs(solved.y - told).max() < ODE


def test_it_ends_where_the_first_step_begins(start):
    assert start.at(0.0)[:2] == pytest.approx((0.0, 0.0), abs=ODE)
    assert start.at(start.duration)[:2] == pytest.approx((PLACE, SPEED), abs=ODE)


def test_the_centre_of_pressure_does_not_jump(start):
    p = np.array([start.at(t)[2] for t in np.arange(0.0, start.duration, 1e-4)])
    assert np.abs(np.diff(p)).max() < 2.5e-4 * 2.0 * Q / RAMP
    assert p.max() < 1.3 * Q
    assert p.min() == pytest.approx(-Q)


def test_it_falls_away_first(start):
    c = np.array([start.at(t)[0] for t in np.linspace(0.0, start.duration, 100)])
    assert c.min() < -0.02
    assert np.argmin(c) > 10


def test_the_right_foot_mirrors_it(start):
    other = Start(OMEGA, Q, RAMP, 0.0, PLACE, SPEED, Stance.RIGHT)
    for t in np.linspace(0.0, 1.1 * start.duration, 20):
        assert other.at(t) == pytest.approx([-value for value in start.at(t)])


def test_after_its_end_it_goes_on_over_the_last_place(start):
    c, dc, p = start.at(start.duration)
    later = start.at(start.duration + 0.05)
    assert later[2] == pytest.approx(p)
    conserved = [v**2 - OMEGA**2 * (x - p) ** 2 for x, v, p in ((c, dc, p), later)]
    assert conserved[0] == pytest.approx(conserved[1])


def test_more_way_than_the_feet_can_give_is_refused():
    with pytest.raises(SimulationError, match=r"cannot gather as much way .*; shorten ramp or raise reach$"):
        Start(OMEGA, 0.05, RAMP, 0.0, PLACE, SPEED, Stance.LEFT)


# ---------------------------------------------------------------------- at rest
def test_from_a_landing_to_rest():
    """The pendulum under the law: xi - xi_ref dies out at the rate k, and the mass comes to rest in the middle."""
    robot = whole("talos_full")
    state = SpaceState(robot.free)
    law = SagittalLaw.of(state, 0.7, SagittalSettings())
    settings = StandingSettings()
    standing = StandingLaw(law, settings)
    feet = {side: state.feet[side].position[1] for side in Stance}
    middle = 0.5 * sum(feet.values())
    c, dc, h, xis = middle, 0.1, 1e-3, []
    for _ in range(4000):
        state.com[:2] = law.p_ref, c
        state.com_velocity[:2] = 0.0, dc
        acceleration = standing.at(state).acceleration[1]
        xis.append(c + dc / law.omega - middle)
        c, dc = c + h * dc + 0.5 * h**2 * acceleration, dc + h * acceleration
    decays = [np.log(late / early) / (late_t - early_t) for (early_t, early), (late_t, late) in pairwise(
        (h * i, xis[i]) for i in range(300, 1500, 300)
    )]  # fmt: skip
    assert decays == pytest.approx([-settings.rate] * len(decays), rel=0.01)
    assert (c - middle, dc) == pytest.approx((0.0, 0.0), abs=1e-3)
