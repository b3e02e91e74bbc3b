"""Dynamics of one instant: the residuals of a motion are what their name says, and a value stays what it is."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from random_states import angles, assert_close, rates, vectors

from frontal_biped.control import QpController
from frontal_biped.control.settings import ControllerSettings
from frontal_biped.control.torques.linearisation import StanceModel, Targets
from frontal_biped.control.torques.torque_program import Source, TorqueProgram
from frontal_biped.model.biped import BASE
from frontal_biped.model.state import State
from frontal_biped.numerics.quadratic_program import ProxQpSolver
from frontal_biped.virtual_constraints import StepPhase


@given(q=vectors(-1.9, -1.2, 4), dq=vectors(-1.0, 1.0, 4), r=vectors(-5.0, 5.0, 4), p_fri=st.floats(-0.04, 0.04))
def test_residuals_are_what_their_name_says(biped, reference_gait, q, dq, r, p_fri):
    """A motion moved along r misses its targets by r, and inverse dynamics finds the forces it claims."""
    a_0, T_0 = 10.0, 0.1 * biped.weight
    dynamics = StanceModel(biped).at(State(q, dq))
    targets = QpController(biped, reference_gait).targets(StepPhase.RISING, State(q, dq))[0]._replace(p_fri=p_fri)
    motion = dynamics.linearising(targets)
    by_residuals = dynamics.by_residuals(targets, a_0, T_0)
    along, linearising = by_residuals[:, :-1], by_residuals[:, -1]
    forces_along = dynamics.M[:, BASE:] @ along
    k = along[0]
    assume(np.max(np.abs(k)) < 1e4)  # elsewhere I_P vanishes, and rounding grows as 1 / I_P
    assert_close(linearising, motion.ddq, 1e-11, floor=1.0 + np.max(np.abs(motion.ddq)))
    ddq, forces = motion.ddq + along @ r, motion.forces + forces_along @ r
    size = 1.0 + np.max(np.abs(ddq)) * np.max(np.abs(dynamics.M))
    assert_close(biped.inverse_dynamics(q, dq, ddq), forces, 1e-10, floor=size)
    ddy = ddq[1:] - targets.h_d1 * ddq[0] - targets.h_d2_dbeta2
    assert_close(ddy - targets.ddy, a_0 * r[:3], 1e-9, floor=1.0 + np.max(np.abs(ddq)))
    assert forces[2] - p_fri * forces[1] == pytest.approx(T_0 * r[3], abs=1e-10 * size)


def test_no_residuals_where_the_decoupling_matrix_is_singular(biped, reference_gait):
    """C03: the accelerations by them are infinite, or so large that no digits are left."""
    state = reference_gait.state_after_impact()
    dynamics = StanceModel(biped).at(State(*state))
    targets = QpController(biped, reference_gait).targets(StepPhase.RISING, State(*state))[0]
    momentum = dynamics.M[:, BASE:] @ np.concatenate([[1.0], targets.h_d1])
    singular = momentum[2] / momentum[1]
    for nearly in (0.0, 1e-14, -1e-14):
        assert dynamics.by_residuals(targets._replace(p_fri=singular + nearly), 10.0, 20.0) is None
    assert dynamics.by_residuals(targets, 10.0, 20.0) is not None


@given(q=angles, dq=rates, other_q=angles, other_dq=rates)
def test_a_state_is_evaluated_once_and_for_all(biped, reference_gait, q, dq, other_q, other_dq):
    """What is asked of one state does not depend on what is asked of others, before or in between."""
    controller, model = QpController(biped, reference_gait), StanceModel(biped)
    state, other = State(q, dq), State(other_q, other_dq)
    targets, theirs = (controller.targets(StepPhase.RISING, at)[0] for at in (state, other))

    def everything(dynamics):
        motion = dynamics.linearising(targets)
        assume(motion is not None)
        return dynamics.M, dynamics.bias, *motion, dynamics.by_residuals(targets, 10.0, 20.0)

    alone = everything(StanceModel(biped).at(state))
    first = model.at(state)
    kept = [part.copy() for part in everything(first)]
    second = model.at(other)
    second.linearising(theirs)
    second.by_residuals(theirs, 10.0, 20.0)
    for part, again, fresh in zip(kept, everything(first), alone, strict=True):
        assert np.array_equal(part, again)
        assert np.array_equal(part, fresh)


@given(q=angles, dq=rates)
def test_the_sway_is_that_of_the_centre_of_mass(biped, q, dq):
    """Read off the momentum; its value and rate as the kinematics has them."""
    sway = StanceModel(biped).at(State(q, dq)).sway(biped.mass)
    assert sway.value == pytest.approx(float(biped.com(q)[0]), abs=1e-12)
    assert sway.rate == pytest.approx(float(biped.com_velocity(q, dq)[0]), abs=1e-12 * (1.0 + np.abs(dq).max()))


@given(q=vectors(-1.9, -1.2, 4), dq=vectors(-1.0, 1.0, 4), r=vectors(-5.0, 5.0, 4), p_fri=st.floats(-0.04, 0.04))
def test_residuals_over_the_sway(biped, q, dq, r, p_fri):
    """The same law for outputs that are functions of the sway, whose acceleration is taken from the ground's force."""
    a_0, T_0 = 10.0, 0.1 * biped.weight
    dynamics = StanceModel(biped).at(State(q, dq))
    sway = dynamics.sway(biped.mass)
    slope, curve = np.array([2.0, -3.0, 1.0]), np.array([0.5, -0.2, 0.1])
    targets = Targets(slope, curve * sway.rate**2, np.array([1.0, -2.0, 0.5]), p_fri, sway=sway)
    motion = dynamics.linearising(targets)
    by_residuals = dynamics.by_residuals(targets, a_0, T_0)
    along, linearising = by_residuals[:, :-1], by_residuals[:, -1]
    forces_along = dynamics.M[:, BASE:] @ along
    assume(np.max(np.abs(along)) < 1e4)
    assert_close(linearising, motion.ddq, 1e-11, floor=1.0 + np.max(np.abs(motion.ddq)))
    ddq, forces = motion.ddq + along @ r, motion.forces + forces_along @ r
    size = 1.0 + np.max(np.abs(ddq)) * np.max(np.abs(dynamics.M))
    assert_close(biped.inverse_dynamics(q, dq, ddq), forces, 1e-10, floor=size)
    dds = forces[0] / biped.mass
    ddy = ddq[1:] - slope * dds - curve * sway.rate**2
    assert_close(ddy - targets.ddy, a_0 * r[:3], 1e-9, floor=1.0 + np.max(np.abs(ddq)))
    assert forces[2] - p_fri * forces[1] == pytest.approx(T_0 * r[3], abs=1e-10 * size)


@given(q=vectors(-1.8, -1.3, 4), dq=vectors(-1.0, 1.0, 4), ddy=vectors(-40.0, 40.0, 3), p_fri=st.floats(-0.04, 0.04))
def test_program_over_the_sway_by_another_solver(biped, q, dq, ddy, p_fri):
    """Limits active or not: the exact solution has the cost of ProxQP's."""
    program = TorqueProgram(biped, ControllerSettings())
    state = State(q, dq)
    sway = StanceModel(biped).at(state).sway(biped.mass)
    targets = Targets(np.array([1.0, -1.5, 0.5]), np.zeros(3), ddy, p_fri, sway=sway)
    answer = program.solve(state, targets)
    posed, _ = program.pose(state, targets)
    other = ProxQpSolver(1e-9, 200).solve(posed, warm=False)
    assume(answer is not None and answer.source is not Source.RELAXED and other.solved)
    x = np.concatenate([answer.ddq, answer.u, answer.force]) / program.qp.scale
    cost, theirs = (0.5 * z @ posed.H @ z + posed.g @ z for z in (x, other.x))
    assert cost == pytest.approx(theirs, abs=1e-6)
