"""Gaits with a finite double support: no impact, a step that retraces itself, what is certified of them."""

from dataclasses import replace

import numpy as np
import pytest
from support_gaits import designed

from frontal_biped.design.walking_gait import design_gait
from frontal_biped.exceptions import GaitFileError, SpecificationError
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.gait.support_certificate import certify_support_gait, slope_without_dead_beat
from frontal_biped.gait.support_gait import SupportSpecification
from frontal_biped.model import load_robot
from frontal_biped.model.impact import impact
from frontal_biped.virtual_constraints.phase import StepPhase
from frontal_biped.zero_dynamics.orbit import phase_orbit

ROUNDING = 1e-11
"""Poses and slopes of a closed form, divided by a range of 0.04 rad."""

AT_REST = 1e-12
"""Impulse of the landing over the robot's momentum."""

NEUTRAL = 2e-4
"""Slope of the return map without dead beat, off one: what the polynomial from one foot lacks to its mirror image is of
third order in the range of beta, 0.04^3, times some ten for the inverse of lengths in it."""


@pytest.fixture(scope="module")
def design():
    return designed("frontal_biped")


@pytest.fixture(scope="module")
def gait(design):
    return design.gait


def test_the_curve_begins_on_the_family_with_its_slope(biped, gait):
    start = gait.rising.motion(np.array([gait.rising.beta_start]))
    at = gait.family(biped).at(gait.rising.beta_start)
    assert start.q[0] == pytest.approx(at.q, abs=ROUNDING)
    assert start.dq[0] == pytest.approx(at.dq, abs=ROUNDING)


def test_the_swing_foot_leaves_the_ground_upwards(biped, gait):
    beta = gait.rising.beta_start + gait.rising.range * np.linspace(0.0, 1.0, 400)[1:]
    heights = np.array([biped.swing_sole(q)[:, 1] for q in gait.rising.motion(beta).q])
    assert heights.min() > 0.0
    assert heights[-1].min() > 0.99 * gait.specification.swing_clearance


def test_a_rigid_landing_takes_nothing(biped, gait):
    end = gait.falling.motion(np.array([gait.falling.beta_end]))
    landing = impact(biped, end.q[0], -gait.speed * end.dq[0])
    momentum = biped.mass * np.linalg.norm(biped.com_velocity(end.q[0], gait.speed * end.dq[0]))
    assert np.linalg.norm(landing.impulse[:2]) < AT_REST * momentum
    assert np.abs(landing.touchdown).max() < AT_REST
    assert landing.dq_plus == pytest.approx(-gait.speed * end.dq[0][::-1], abs=ROUNDING)


def test_it_lands_as_fast_as_it_lifts_off(biped, gait):
    rise, fall = (
        phase_orbit(biped, phase, kind, 40)
        for phase, kind in ((gait.rising, StepPhase.RISING), (gait.falling, StepPhase.FALLING))
    )
    assert rise.dbeta[-1] == pytest.approx(gait.speed, rel=1e-6)
    assert fall.dbeta[-1] == pytest.approx(-gait.speed, rel=1e-6)
    assert fall.duration == pytest.approx(rise.duration, rel=1e-9)


@pytest.mark.parametrize("share", [0.6, 0.8])
def test_wherever_it_reverses(biped, gait, share):
    """An earlier reversal is one of a slower lift-off; the landing is slower alike."""
    reversal = gait.rising.beta_start + share * gait.rising.range
    rise = phase_orbit(biped, gait.rising, StepPhase.RISING, 40, reversal)
    fall = phase_orbit(biped, gait.falling, StepPhase.FALLING, 40, reversal)
    assert rise.z[-1] > 0.0
    assert fall.z[-1] == pytest.approx(rise.z[-1], rel=1e-9)
    assert rise.dbeta[-1] < gait.speed


def test_certificate(biped, gait):
    found = certify_support_gait(biped, gait)
    assert found.holds
    assert found.impulse < AT_REST
    assert found.slope == pytest.approx(1.0, abs=NEUTRAL)
    low, high = found.arrivals
    assert low < 0.9 and high > 1.1


def test_a_gait_that_is_too_fast_does_not_hold(biped, gait):
    """Set off within half of the time, the pressure point would have to leave the feet."""
    assert not certify_support_gait(biped, replace(gait, setting_off=0.5 * gait.setting_off)).holds


def test_slope_without_dead_beat_by_the_map_itself(biped, gait):
    """Two solutions of the scalar dynamics with the same pressure point over beta: zeta's difference keeps its size."""
    from scipy.integrate import solve_ivp
    from scipy.interpolate import CubicSpline

    from frontal_biped.zero_dynamics.support_dynamics import SupportPoint

    over = gait.hand_over(biped)
    plan = over.plan()
    t = np.linspace(0.0, plan.duration, 201)
    states = [plan.at(x) for x in t.tolist()]
    beta = np.array([at.x for at in states])
    points = [SupportPoint.of(over.family, at.x).pressure_point(at.ddx, at.dx**2) for at in states]
    p = CubicSpline(beta, points)

    def energy(speed):
        def slope(b, square):
            return [2.0 * SupportPoint.of(over.family, float(b)).acceleration(float(p(b)), float(square[0]))]

        found = solve_ivp(slope, (beta[0], beta[-1]), [speed**2], rtol=1e-10, atol=1e-12)
        return float(found.y[0, -1])

    def inertia(b):
        point = SupportPoint.of(over.family, b)
        return float(point.A[2] - p(b) * point.A[1])

    slow, fast = 0.95 * gait.speed, 1.05 * gait.speed
    after = (energy(fast) - energy(slow)) * inertia(beta[-1]) ** 2
    before = (fast**2 - slow**2) * inertia(beta[0]) ** 2
    assert after / before == pytest.approx(slope_without_dead_beat(plan), rel=1e-5)


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"pressure_margin": -0.01}, "pressure_margin"),
    ],
)
def test_senseless_bounds(change, named):
    with pytest.raises(SpecificationError, match=named) as caught:
        SupportSpecification(**change)
    assert "\n" not in str(caught.value)


def test_how_long_both_feet_stand_is_said_in_one_place():
    assert SupportSpecification().bounds.double_support == SupportSpecification().double_support == (0.1, 0.2)
    bounds = GaitSpecification(double_support=(0.15, 0.15))
    assert SupportSpecification(bounds).double_support == (0.15, 0.15)
    with pytest.raises(SpecificationError, match="leave one of them out"):
        SupportSpecification(GaitSpecification(travel=0.1))


def test_designed_by_its_own_function(biped):
    with pytest.raises(SpecificationError, match="use `design_support_gait`"):
        design_gait(biped, GaitSpecification(double_support=(0.1, 0.2)))


def test_of_another_robot(gait):
    with pytest.raises(GaitFileError, match="same robot"):
        gait.family(load_robot("g1"))
