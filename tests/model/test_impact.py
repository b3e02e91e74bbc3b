"""The rigid impact: balances of momentum, energy, and a separate dense solution."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from random_states import angles, assert_close, rates

from frontal_biped.model import impact, relabel
from frontal_biped.virtual_constraints import double_support_pose

KKT_TOLERANCE = 1e-10
"""Relative; the dense system has a condition number of about 1e4."""

ROUNDING = 1e-11
"""Relative error of identities between numbers of a few hundred operations."""

flat_poses = st.tuples(st.floats(-1.75, -1.55), st.floats(0.12, 0.4))
"""beta [rad] and step width [m] of a pose with both feet flat."""


def dense_impact(robot, q, dq):
    """(v+, L) of the floating robot by a dense solve, with a Jacobian written out by hand."""
    ankle = robot.joint_positions(q)
    landing = ankle[3]
    J = np.zeros((3, 7))
    J[:2, :2] = np.eye(2)
    for column, centre in [(2, np.zeros(2)), *((3 + i, ankle[i]) for i in range(4))]:
        lever = landing - centre
        J[:, column] = -lever[1], lever[0], 1.0
    M = robot.floating_mass_matrix(q)
    v_minus = np.concatenate([np.zeros(3), dq])
    kkt = np.block([[M, -J.T], [J, np.zeros((3, 3))]])
    solution = np.linalg.solve(kkt, np.concatenate([M @ v_minus, np.zeros(3)]))
    return solution[:7], solution[7:], J


@given(q=angles, dq=rates)
def test_against_a_dense_solution(robot, q, dq):
    v_plus, L, _ = dense_impact(robot, q, dq)
    outer, inner = robot.sole
    landing = impact(robot, q, dq)
    assert_close(landing.dq_plus, v_plus[3:][::-1], KKT_TOLERANCE, floor=1.0)
    at_sole = L - [0.0, 0.0, robot.ankle_height * L[0]]  # the force acts h_a below the ankle
    assert_close(landing.impulse, at_sole, KKT_TOLERANCE, floor=1.0)
    lift_off = [v_plus[1] + inner * v_plus[2], v_plus[1] + outer * v_plus[2]]
    assert_close(landing.lift_off, lift_off, KKT_TOLERANCE, floor=1.0)


@given(q=angles, dq=rates)
def test_landing_foot_is_at_rest_afterwards(robot, q, dq):
    """Lift-off speeds give the velocity of the old stance foot; the landing foot must then not move."""
    landing = impact(robot, q, dq)
    outer, inner = robot.sole
    turning = (landing.lift_off[0] - landing.lift_off[1]) / (inner - outer)
    rising = landing.lift_off[0] - inner * turning
    _, _, J = dense_impact(robot, q, dq)
    v_plus = np.concatenate([[0.0, rising, turning], relabel(landing.dq_plus)])
    assert_close(J[1:] @ v_plus, np.zeros(2), KKT_TOLERANCE, floor=10.0)


@given(pose=flat_poses, dq=rates)
def test_impulse_balances_the_momentum(robot, pose, dq):
    """Linear momentum and angular momentum about the landing point, old foot held before, new foot after."""
    q = double_support_pose(robot, *pose)
    landing = impact(robot, q, dq)
    before, after = (robot.momentum_map(p)[:3] @ v for p, v in ((q, dq), (landing.q_plus, landing.dq_plus)))
    # after relabelling h points the other way, which also turns the sense of rotation
    h_after, v_after, sigma_after = -after[0], after[1], -after[2]
    sigma_before = before[2] - pose[1] * before[1]  # about the ground point below the landing ankle
    change = [h_after - before[0], v_after - before[1], sigma_after - sigma_before]
    assert_close(change, landing.impulse, KKT_TOLERANCE, floor=100.0)


@given(pose=flat_poses, dq=rates)
def test_angular_momentum_about_the_landing_ankle_is_conserved(robot, pose, dq):
    """The ankle passes on no sudden moment: all but the landing foot keeps its momentum about it."""
    q = double_support_pose(robot, *pose)
    landing = impact(robot, q, dq)
    ankle_height, foot = robot.ankle_height, robot.chain.bodies[4]

    def about(state_q, state_dq, p):  # the ground point below an ankle -> the ankle
        h, v, sigma = robot.momentum_map(state_q)[:3] @ state_dq
        return sigma - p * v + ankle_height * h

    # velocity of the landing foot's centre of mass before, by hand
    levers = robot.joint_positions(q)[3] - robot.joint_positions(q)
    ankle_velocity = np.array([-levers[:, 1] @ dq, levers[:, 0] @ dq])
    offset = foot.com - robot.chain.joints[3]
    rate = dq.sum()
    velocity = ankle_velocity + rate * np.array([-offset[1], offset[0]])
    of_the_foot = foot.inertia * rate + foot.mass * (offset[0] * velocity[1] - offset[1] * velocity[0])
    before = about(q, dq, pose[1]) - of_the_foot
    after = -about(landing.q_plus, landing.dq_plus, 0.0)
    assert after == pytest.approx(before, rel=KKT_TOLERANCE, abs=KKT_TOLERANCE * 100.0)


@given(q=angles, dq=rates)
def test_kinetic_energy_never_grows(robot, q, dq):
    landing = impact(robot, q, dq)
    before = 0.5 * dq @ robot.D(q) @ dq
    after = 0.5 * landing.dq_plus @ robot.D(landing.q_plus) @ landing.dq_plus
    assert after <= before * (1.0 + ROUNDING) + ROUNDING


@given(q=angles, dq=rates)
def test_what_is_lost_is_the_energy_of_the_change(robot, q, dq):
    """A plastic impact loses exactly 1/2 (v+ - v-)' M (v+ - v-): v+ is the M-orthogonal projection of v-."""
    v_plus, _, _ = dense_impact(robot, q, dq)
    change = v_plus - np.concatenate([np.zeros(3), dq])
    lost = 0.5 * change @ robot.floating_mass_matrix(q) @ change
    landing = impact(robot, q, dq)
    before = 0.5 * dq @ robot.D(q) @ dq
    after = 0.5 * landing.dq_plus @ robot.D(landing.q_plus) @ landing.dq_plus
    assert before - after == pytest.approx(lost, rel=KKT_TOLERANCE, abs=KKT_TOLERANCE * 100.0)


@given(q=angles, dq=rates, other=rates, factor=st.floats(-2.0, 2.0))
def test_linear_in_the_velocities(robot, q, dq, other, factor):
    together = impact(robot, q, dq + factor * other)
    a, b = impact(robot, q, dq), impact(robot, q, other)
    for part in ("dq_plus", "impulse", "lift_off"):
        expected = getattr(a, part) + factor * getattr(b, part)
        assert_close(getattr(together, part), expected, KKT_TOLERANCE, floor=10.0)


@given(q=angles, dq=rates)
def test_a_foot_already_at_rest_lands_without_impulse(robot, q, dq):
    """Velocities that leave the landing foot at rest pass through unchanged."""
    J = dense_impact(robot, q, dq)[2][:, 3:]
    null = np.linalg.svd(J)[2][3]  # one freedom of the double support remains
    landing = impact(robot, q, null)
    assert_close(landing.dq_plus, null[::-1], KKT_TOLERANCE)
    assert_close(landing.impulse, np.zeros(3), KKT_TOLERANCE, floor=10.0)


@given(q=angles)
def test_relabelling_twice_changes_nothing(q):
    assert np.array_equal(relabel(relabel(q)), q)
    assert np.array_equal(relabel(q), q[[3, 2, 1, 0]])


@given(dq=rates)
def test_inputs_are_left_alone(biped, dq):
    q = double_support_pose(biped, -1.65, 0.25)
    q_before, dq_before = q.copy(), dq.copy()
    landing = impact(biped, q, dq)
    landing.q_plus.sum()
    assert np.array_equal(q, q_before) and np.array_equal(dq, dq_before)


@given(pose=flat_poses, dq=rates)
def test_centre_of_pressure(robot, pose, dq):
    landing = impact(robot, double_support_pose(robot, *pose), dq)
    if abs(landing.impulse[1]) > 1e-6:
        assert landing.center_of_pressure * landing.impulse[1] == pytest.approx(landing.impulse[2], rel=ROUNDING)
