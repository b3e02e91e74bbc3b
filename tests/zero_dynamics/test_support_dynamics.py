"""Dynamics along the family: against the constrained dynamics of all seven coordinates, and what bounds them."""

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import linprog

from frontal_biped.model.impact import landing_jacobian
from frontal_biped.virtual_constraints.double_support import DoubleSupportFamily
from frontal_biped.zero_dynamics.support_dynamics import SupportLimits, SupportPoint

RELATIVE = 1e-9
"""Two ways to the same forces; both solve linear systems of condition some thousands."""

WIDTH = 0.28

leans = st.floats(-0.12, 0.12)
speeds = st.floats(-0.6, 0.6)
torques = st.lists(st.floats(-60.0, 60.0), min_size=4, max_size=4).map(np.array)


def point_of(robot, lean):
    family = DoubleSupportFamily(robot, WIDTH)
    return SupportPoint.of(family, family.half_way() + lean)


def limits_of(robot):
    return SupportLimits(0.6, 0.005, robot.max_torque)


def seven_coordinates(robot, q, dq, u):
    """Accelerations (7,), wrenches of stance and swing ankle (3,) each, of the floating robot with both feet held."""
    model, data = robot.floating, robot.floating.createData()
    at, rate = np.concatenate([np.zeros(3), q]), np.concatenate([np.zeros(3), dq])
    J = np.vstack([np.eye(3, 7), landing_jacobian(robot, at)])
    pin.forwardKinematics(model, data, at, rate, np.zeros(7))
    drift = pin.getClassicalAcceleration(model, data, model.njoints - 1, pin.LOCAL_WORLD_ALIGNED)
    bias = np.concatenate([np.zeros(3), drift.linear[:2], [drift.angular[2]]])
    force = np.concatenate([np.zeros(3), u]) - pin.rnea(model, data, at, rate, np.zeros(7))
    M = robot.floating_mass_matrix(q)
    KKT = np.block([[M, -J.T], [J, np.zeros((6, 6))]])
    answer = np.linalg.solve(KKT, np.concatenate([force, -bias]))
    return answer[:7], answer[7:10], answer[10:]


@given(lean=leans, speed=speeds, u=torques)
def test_torques_decide_motion_and_both_wrenches(robot, lean, speed, u):
    point = point_of(robot, lean)
    acceleration, forces = point.under(u, speed**2)
    ddq, stance, swing = seven_coordinates(robot, point.at.q, speed * point.at.dq, u)
    expected = point.at.dq * acceleration + point.at.ddq * speed**2
    assert ddq[3:] == pytest.approx(expected, abs=RELATIVE * (1.0 + np.abs(expected).max()))
    swing[2] -= robot.ankle_height * swing[0]  # about the ground point below the ankle
    size = robot.weight + np.abs(u).sum()
    assert forces.stance == pytest.approx(stance, abs=RELATIVE * size)
    assert forces.swing == pytest.approx(swing, abs=RELATIVE * size)


@given(lean=leans, speed=speeds, acceleration=st.floats(-3.0, 3.0), share=st.floats(-0.5, 1.5))
def test_every_choice_is_what_its_torques_do(robot, lean, speed, acceleration, share):
    point = point_of(robot, lean)
    swing = np.array([0.1, 1.0, 0.02]) * share * robot.weight
    forces = point.forces(acceleration, speed**2, swing)
    back, same = point.under(forces.u, speed**2)
    assert back == pytest.approx(acceleration, abs=1e-9)
    assert same.swing == pytest.approx(swing, abs=RELATIVE * robot.weight)


@given(lean=leans, speed=speeds, p=st.floats(-0.05, WIDTH + 0.05))
def test_pressure_point_and_acceleration_are_inverse(robot, lean, speed, p):
    point = point_of(robot, lean)
    acceleration = point.acceleration(p, speed**2)
    assert point.pressure_point(acceleration, speed**2) == pytest.approx(p, abs=1e-10)


@given(lean=leans, speed=speeds, p_fri=st.floats(-0.03, 0.03))
def test_the_share_of_the_load_ends_with_single_support(robot, lean, speed, p_fri):
    """With the pressure point on one foot's FRI that foot has all of the weight, and the other one nothing."""
    point = point_of(robot, lean)
    for p, loaded in ((p_fri, 0.0), (WIDTH - p_fri, 1.0)):
        acceleration = point.acceleration(p, speed**2)
        swing = point.shared(acceleration, speed**2, p_fri)
        other = point.forces(acceleration, speed**2, swing).stance
        empty = other if loaded else swing
        assert empty == pytest.approx(np.zeros(3), abs=RELATIVE * robot.weight)


@given(lean=leans, speed=speeds)
def test_power_of_the_torques_is_the_rate_of_the_energy(robot, lean, speed):
    point = point_of(robot, lean)
    u = np.array([5.0, 30.0, -20.0, 8.0])
    acceleration, _ = point.under(u, speed**2)
    h = 1e-4
    family = DoubleSupportFamily(robot, WIDTH)

    def energy(t):
        beta = float(point.at.q[0]) + speed * t + 0.5 * acceleration * t**2
        at = family.at(beta)
        return robot.energy(at.q, at.dq * (speed + acceleration * t))

    rate = (energy(h) - energy(-h)) / (2.0 * h)
    armature = robot.chain.armature @ (point.at.dq * (point.at.dq * acceleration + point.at.ddq * speed**2)) * speed
    # `energy` counts the bodies only; reflected rotor inertia takes its share of the power
    assert rate + armature == pytest.approx(speed * point.at.dq @ u, abs=1e-4)


@pytest.mark.parametrize("lean", [-0.1, 0.0, 0.06])
@pytest.mark.parametrize("speed", [0.0, 0.3])
def test_the_ends_of_the_range_use_up_a_limit(robot, lean, speed):
    """There is a wrench for the ends themselves, none a little beyond: a linear program of its own for each."""
    point, limits = point_of(robot, lean), limits_of(robot)
    low, high = point.acceleration_range(limits, speed**2)
    assert low < 0.0 < high
    C, c = point.rows(limits, speed**2)

    def possible(acceleration):
        scale = robot.weight
        right = (c - C[:, 0] * acceleration) / scale
        found = linprog(np.zeros(3), A_ub=-C[:, 1:], b_ub=-right, bounds=(None, None))
        return bool(found.success)

    inside, outside = 1e-5, 1e-2
    assert possible(low + inside) and possible(high - inside)
    assert not possible(low - outside) and not possible(high + outside)


def test_no_motion_without_friction(biped):
    """Straight legs that lean need friction to push along the ground: on ice nothing accelerates sideways."""
    family = DoubleSupportFamily(biped, WIDTH)
    point = SupportPoint.of(family, family.half_way() + 0.05)
    rough, ice = (point.acceleration_range(SupportLimits(mu, 0.0, biped.max_torque), 0.0) for mu in (0.6, 1e-3))
    assert rough is not None
    assert ice is None or ice[1] - ice[0] < 0.05 * (rough[1] - rough[0])
