"""Laws of mechanics at random states: the pinned dynamics, momentum, the ground reaction and the FRI."""

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from random_states import (
    DIFFERENCE_TOLERANCE,
    UPRIGHT,
    accelerations,
    angles,
    assert_close,
    difference,
    rates,
    vectors,
)

ROUNDING = 1e-11
"""Relative error of identities between numbers that come from the same few hundred operations."""


def along(q, dq, ddq):
    """The motion with constant acceleration through a state, as t -> (q, dq)."""
    return lambda t: (q + dq * t + 0.5 * ddq * t**2, dq + ddq * t)


@given(q=angles)
def test_mass_matrix_is_symmetric_positive_definite(robot, q):
    D = robot.D(q)
    assert np.array_equal(D, D.T)
    assert np.linalg.eigvalsh(D)[0] > 0.0


@given(q=angles, dq=rates)
def test_mass_matrix_is_twice_the_kinetic_energy(robot, q, dq):
    kinetic = robot.energy(q, dq) - robot.energy(q, np.zeros(4))
    # a difference of energies of about 500 J
    assert 0.5 * dq @ robot.D(q) @ dq == pytest.approx(kinetic, rel=ROUNDING, abs=ROUNDING * 500.0)


@given(q=angles)
def test_mass_matrix_does_not_depend_on_the_stance_ankle(robot, q):
    turned = q + 0.3 * np.eye(4)[0]
    assert_close(robot.D(turned), robot.D(q), ROUNDING)


@given(q=angles, dq=rates)
def test_mass_matrix_rate_minus_twice_coriolis_is_skew(robot, q, dq):
    S = difference(lambda t: robot.D(q + t * dq)) - 2.0 * robot.C(q, dq)
    assert_close(S + S.T, np.zeros((4, 4)), DIFFERENCE_TOLERANCE, floor=np.abs(robot.D(q)).max())


@given(q=angles)
def test_gravity_is_the_gradient_of_the_energy(robot, q):
    rest = np.zeros(4)
    gradient = [difference(lambda t, e=e: robot.energy(q + t * e, rest)) for e in np.eye(4)]
    assert_close(gradient, robot.G(q), DIFFERENCE_TOLERANCE, floor=100.0)


@given(q=angles, dq=rates, ddq=accelerations)
def test_power_balance(robot, q, dq, ddq):
    """Energy grows at the rate of the joint torques' power; the ground does no work."""
    u = robot.D(q) @ ddq + robot.C(q, dq) @ dq + robot.G(q)
    motion = along(q, dq, ddq)
    rate = difference(lambda t: robot.energy(*motion(t)))
    assert_close(rate, dq @ u, DIFFERENCE_TOLERANCE, floor=1000.0)


@given(q=angles, dq=rates, ddq=accelerations)
def test_forward_and_inverse_dynamics_agree(robot, q, dq, ddq):
    u = robot.inverse_dynamics(q, dq, ddq)[3:]
    # the light foot (0.03 kg m^2) amplifies rounding of torques of 1000 N m
    assert_close(robot.forward_dynamics(q, dq, u), ddq, 1e-9, floor=10.0)


@given(q=angles, dq=rates)
def test_momentum_is_mass_times_velocity_of_the_centre_of_mass(robot, q, dq):
    assert_close(robot.com_velocity(q, dq), difference(lambda t: robot.com(q + t * dq)), DIFFERENCE_TOLERANCE, 1.0)


@given(q=angles, dq=rates, ddq=accelerations)
def test_ground_reaction_changes_the_momentum(robot, q, dq, ddq):
    motion = along(q, dq, ddq)
    rate = robot.mass * difference(lambda t: robot.com_velocity(*motion(t)))
    force = robot.ground_reaction(q, dq, ddq)
    assert_close(rate, force - [0.0, robot.weight], DIFFERENCE_TOLERANCE, floor=1000.0)


@given(q=angles, dq=rates, ddq=accelerations, p=vectors(-0.2, 0.2, 1))
def test_moments_change_the_angular_momentum_about_a_ground_point(robot, q, dq, ddq, p):
    """d sigma_P/dt = (p_FRI - p) F_v - (p_cm - p) m g about any fixed point of the ground."""
    p = float(p[0])
    motion = along(q, dq, ddq)
    rate = difference(lambda t: robot.sigma(*motion(t), p))
    F_v = robot.ground_reaction(q, dq, ddq)[1]
    N_0 = robot.inverse_dynamics(q, dq, ddq)[2]
    moments = (N_0 - p * F_v) - (robot.com(q)[0] - p) * robot.weight
    assert_close(rate, moments, DIFFERENCE_TOLERANCE, floor=1000.0)


@given(q=angles, dq=rates, p=vectors(-0.2, 0.2, 1))
def test_angular_momentum_transfer(robot, q, dq, p):
    """sigma_P = sigma_0 - p m dp_cm_v."""
    transferred = robot.sigma(q, dq) - p[0] * robot.mass * robot.com_velocity(q, dq)[1]
    assert_close(robot.sigma(q, dq, float(p[0])), transferred, ROUNDING, floor=100.0)


@given(q=angles, dq=rates, ddq=accelerations)
def test_fri_and_ankle_torque_there_and_back(robot, q, dq, ddq):
    F_h, F_v, N_0, u_1, *_ = robot.inverse_dynamics(q, dq, ddq)
    force = np.array([F_h, F_v])
    if abs(F_v) < 1.0:  # no ground reaction, no FRI
        return
    p_fri = robot.fri_from_torque(u_1, force)
    # the moment of the ground reaction, from the floating model, knows nothing of the foot's equilibrium
    assert p_fri * F_v == pytest.approx(N_0, rel=ROUNDING, abs=ROUNDING * 1000.0)
    assert robot.fri(q, dq, ddq) == pytest.approx(N_0 / F_v, rel=ROUNDING)
    assert robot.torque_from_fri(p_fri, force) == pytest.approx(u_1, rel=ROUNDING, abs=ROUNDING * 1000.0)


@given(q=angles, dq=rates, ddq=accelerations)
def test_ankle_torque_of_table_1_is_fri_times_normal_force(biped, q, dq, ddq):
    _, F_v, N_0, u_1, *_ = biped.inverse_dynamics(q, dq, ddq)
    assert u_1 == pytest.approx(N_0, rel=ROUNDING, abs=ROUNDING * 1000.0)
    assert u_1 == pytest.approx(biped.fri(q, dq, ddq) * F_v, rel=ROUNDING, abs=ROUNDING * 1000.0)


@given(q=angles, dq=rates, ddq=accelerations)
def test_foot_at_rest_is_in_equilibrium(raised_ankle, independent, q, dq, ddq):
    """u_1 = p_FRI F_v + h_a F_h - m_f g c_f the foot's centre of mass c_f towards the other foot."""
    p = independent["raised_ankle"]["parameters"]
    F_h, _, N_0, u_1, *_ = raised_ankle.inverse_dynamics(q, dq, ddq)
    expected = N_0 + p["ha"] * F_h - p["mf"] * p["g"] * p["fx"]
    assert u_1 == pytest.approx(expected, rel=ROUNDING, abs=ROUNDING * 1000.0)


@given(q=angles)
def test_swing_sole_jacobian(robot, q):
    J = np.stack([difference(lambda t, e=e: robot.swing_sole(q + t * e)) for e in np.eye(4)], axis=-1)
    assert_close(robot.swing_sole_jacobian(q), J, DIFFERENCE_TOLERANCE)


@given(q=angles)
def test_links_keep_their_lengths(robot, q):
    ankle, hip, other_hip, other_ankle = robot.joint_positions(q)
    assert np.linalg.norm(hip - ankle) == pytest.approx(robot.leg_length, rel=ROUNDING)
    assert np.linalg.norm(other_hip - hip) == pytest.approx(robot.hip_width, rel=ROUNDING)
    assert np.linalg.norm(other_ankle - other_hip) == pytest.approx(robot.leg_length, rel=ROUNDING)
    inner, outer = robot.swing_sole(q)
    foot = outer - inner
    assert np.arctan2(foot[1], foot[0]) == pytest.approx(float(robot.swing_foot_rotation(q)), abs=ROUNDING)
    hips = other_hip - hip
    assert np.arctan2(hips[1], hips[0]) == pytest.approx(float(robot.pelvis_roll(q)), abs=ROUNDING)


def test_links_point_as_in_the_paper(biped):
    """Link i points along -(cos theta_i, sin theta_i), theta_i = q_1 + ... + q_i."""
    q = UPRIGHT + np.array([-0.2, 0.15, 0.1, 0.05])
    theta = np.cumsum(q)
    lengths = (biped.leg_length, biped.hip_width, biped.leg_length)
    positions = biped.joint_positions(q)
    for i, length in enumerate(lengths):
        direction = -np.array([np.cos(theta[i]), np.sin(theta[i])])
        assert_close(positions[i + 1] - positions[i], length * direction, ROUNDING)


@given(q=angles, dq=rates)
def test_floating_model_with_the_foot_held_is_the_pinned_model(robot, q, dq):
    M = robot.floating_mass_matrix(q)
    assert_close(M[3:, 3:], robot.D(q), ROUNDING)
    assert_close(M[:, 3:], robot.momentum_map(q), ROUNDING)
    assert M[0, 0] == pytest.approx(robot.mass, rel=ROUNDING)
    held = pin.rnea(
        robot.floating,
        robot.floating.createData(),
        np.r_[np.zeros(3), q],
        np.r_[np.zeros(3), dq],
        np.zeros(7),
    )
    assert_close(held[3:], robot.bias(q, dq), ROUNDING, floor=10.0)


def test_pickled_robot_has_the_same_dynamics(robot):
    import pickle

    twin = pickle.loads(pickle.dumps(robot))
    q = UPRIGHT + np.array([0.1, -0.2, 0.3, 0.05])
    assert np.array_equal(twin.D(q), robot.D(q))
    assert twin.fingerprint == robot.fingerprint
