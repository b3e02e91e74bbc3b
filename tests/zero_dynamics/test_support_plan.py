"""Motions along the family: dead beat, the duration of a hand-over, setting off and coming to rest."""

import numpy as np
import pytest
from scipy.integrate import quad

from frontal_biped.exceptions import ReversalError
from frontal_biped.numerics.quintic import Kinematics
from frontal_biped.virtual_constraints.double_support import DoubleSupportFamily
from frontal_biped.zero_dynamics.support_dynamics import SupportPoint
from frontal_biped.zero_dynamics.support_plan import HandOver, SingleSupportEnd, natural_duration, rest_to_rest

SPEED, P_FRI, LEAN = 0.3, -0.004, 0.018
"""Of a hand-over like that of a gait of the Table I robot [rad/s], [m], [rad]."""

EXACT = 1e-10
"""Ends of a closed form."""


@pytest.fixture
def family(biped):
    return DoubleSupportFamily(biped, 0.24)


@pytest.fixture
def over(family):
    return HandOver.mirrored(family, SingleSupportEnd(family.half_way() + LEAN, P_FRI), SPEED)


@pytest.mark.parametrize("arrival", [0.8, 0.9, 1.0, 1.1, 1.2])
def test_the_lift_off_does_not_depend_on_the_arrival(over, arrival):
    plan = over.plan(arrival * SPEED)
    start, end = plan.at(0.0), plan.at(plan.duration)
    assert start[:2] == pytest.approx((over.landing.beta, arrival * SPEED), abs=EXACT)
    assert end == pytest.approx(over.lift_off.kinematics(over.family, SPEED), abs=EXACT)


@pytest.mark.parametrize("arrival", [0.9, 1.1])
def test_the_load_goes_from_all_on_one_foot_to_all_on_the_other(over, biped, arrival):
    plan = over.plan(arrival * SPEED)
    for t, loaded in ((0.0, 0), (plan.duration, 1)):
        beta, speed, acceleration = plan.at(t)
        point = SupportPoint.of(over.family, beta)
        forces = point.forces(acceleration, speed**2, point.shared(acceleration, speed**2, P_FRI))
        empty = (forces.stance, forces.swing)[loaded]
        assert empty == pytest.approx(np.zeros(3), abs=1e-8 * biped.weight)


def test_duration_by_numerical_integration():
    start, end = Kinematics(-1.61, 0.27, 1.6), Kinematics(-1.57, 0.31, -1.7)
    Delta = end.x - start.x
    c = (end.dx**2 - start.dx**2) / (2.0 * Delta) - 0.5 * (start.ddx + end.ddx)

    def acceleration(s):
        return (1.0 - s) * start.ddx + s * end.ddx + 6.0 * c * s * (1.0 - s)

    def pace(s):
        return Delta / np.sqrt(start.dx**2 + 2.0 * Delta * quad(acceleration, 0.0, s)[0])

    assert natural_duration(start, end) == pytest.approx(quad(pace, 0.0, 1.0)[0], rel=1e-9)
    # the parabola brings the speed to that of the lift-off
    assert end.dx**2 - start.dx**2 == pytest.approx(2.0 * Delta * quad(acceleration, 0.0, 1.0)[0], rel=1e-9)


def test_constant_speed():
    start, end = Kinematics(-1.61, 0.3, 0.0), Kinematics(-1.57, 0.3, 0.0)
    assert natural_duration(start, end) == pytest.approx(0.04 / 0.3, rel=1e-12)


@pytest.mark.parametrize("arrival", [0.0, -0.1])
def test_a_robot_that_lands_without_speed_cannot_hand_over(over, arrival):
    with pytest.raises(ReversalError, match="must land faster"):
        over.plan(arrival)


def test_a_landing_past_the_lift_off(over):
    with pytest.raises(ReversalError, match="not before the lift-off"):
        over.plan(SPEED, over.lift_off.beta + 0.01)


def test_setting_off_leans_back_first_and_gains_all_of_the_speed(over, family):
    half_way = family.half_way()
    plan = over.setting_off(half_way, 0.9)
    beta = np.array([plan.at(t).x for t in np.linspace(0.0, 0.9, 91).tolist()])
    assert plan.at(0.0) == pytest.approx((half_way, 0.0, 0.0), abs=EXACT)
    assert plan.at(0.9) == pytest.approx(over.lift_off.kinematics(family, SPEED), abs=1e-9)
    assert beta.min() < half_way - 0.02  # away from the foot that takes the weight


def test_coming_to_rest_is_setting_off_backwards_seen_from_the_other_foot(over, family):
    T = 0.9
    off, stop = over.setting_off(family.half_way(), T), over.coming_to_rest(family.half_way(), T)
    for t in np.linspace(0.0, T, 10).tolist():
        mirrored = family.from_other_foot(off.at(T - t).x)
        assert stop.at(t).x == pytest.approx(mirrored, abs=1e-3)  # a polynomial from one foot is not one from the other


def test_energy_of_setting_off_is_the_work_of_the_torques(over, biped, family):
    plan = over.setting_off(family.half_way(), 0.9)

    def power(t):
        beta, speed, acceleration = plan.at(t)
        point = SupportPoint.of(family, beta)
        u = point.forces(acceleration, speed**2, point.shared(acceleration, speed**2, P_FRI)).u
        return speed * point.at.dq @ u

    def energy(t):
        beta, speed, _ = plan.at(t)
        at = family.at(beta)
        return biped.energy(at.q, speed * at.dq)

    work = quad(power, 0.0, 0.9, epsabs=1e-9)[0]
    assert work == pytest.approx(energy(0.9) - energy(0.0), abs=1e-7)


def test_from_rest_to_rest(family, biped):
    start, end = family.half_way(), family.half_way() + 0.05
    plan = rest_to_rest(family, start, end, 2.0)
    assert plan.at(0.0) == pytest.approx((start, 0.0, 0.0), abs=EXACT)
    assert plan.at(2.0) == pytest.approx((end, 0.0, 0.0), abs=EXACT)
    # slowly, the pressure point is below the centre of mass
    at = plan.at(1.0)
    point = SupportPoint.of(family, at.x)
    assert point.pressure_point(0.0, 0.0) == pytest.approx(biped.com(point.at.q)[0], abs=1e-12)
    assert plan.pressure_margin() > 0.1
