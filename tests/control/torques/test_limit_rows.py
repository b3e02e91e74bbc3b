"""Limits as rows of forces and accelerations: those of the program that ProxQP is asked."""

import numpy as np
import pytest
from hypothesis import given
from random_states import assert_close, vectors

from frontal_biped.control import ControllerSettings, QpController
from frontal_biped.control.torques.limit_rows import AMPLE, LimitRows
from frontal_biped.control.torques.linearisation import StanceModel
from frontal_biped.control.torques.walking_qp import OUTPUT_ACCELERATION, VARIABLES
from frontal_biped.model.biped import BASE
from frontal_biped.model.state import State
from frontal_biped.numerics.quadratic_program import UNBOUNDED
from frontal_biped.virtual_constraints import StepPhase


@pytest.mark.parametrize("joint_rate", [None, 60.0])
@given(q=vectors(-1.8, -1.3, 4), dq=vectors(-1.0, 1.0, 4), r=vectors(-3.0, 3.0, 4))
def test_they_are_those_of_the_program(biped, reference_gait, joint_rate, q, dq, r):
    """Room by room, at a motion that misses its targets by r."""
    controller = QpController(biped, reference_gait, ControllerSettings(joint_rate=joint_rate))
    qp, state = controller.program.qp, State(q, dq)
    dynamics, targets = StanceModel(biped).at(state), controller.targets(StepPhase.RISING, state)[0]
    origin = dynamics.linearising(targets)
    motion = dynamics.by_residuals(targets, OUTPUT_ACCELERATION, qp.torque_unit)
    forces = dynamics.M[:, BASE:] @ motion
    forces[:, -1] = origin.forces
    rows, at = LimitRows(qp), np.append(r, 1.0)
    room = at @ rows.at(state, motion, forces)
    program = controller.program.pose(state, targets).program
    w = forces @ at
    value = program.C[:, :VARIABLES] @ (np.concatenate([motion @ at, w[BASE:], w[:2]]) / qp.scale)
    below, above = value - program.l, program.u - value
    fixed = slice(0, qp.rows.torque.stop)
    expected = [below[fixed][program.l[fixed] > -UNBOUNDED], above[fixed][program.u[fixed] < UNBOUNDED]]
    if joint_rate is not None:
        joint = np.arange(qp.rows.joint.start, qp.rows.joint.stop)[qp.limits.joints.limited]
        expected += [below[joint], above[joint]]
    expected = np.concatenate(expected)
    bounded = np.minimum(expected, room) < 0.1 * AMPLE  # of a side without a limit both have more room than is needed
    assert_close(room[bounded], expected[bounded], 1e-11, floor=1.0 + np.max(np.abs(value)))
    assert len(rows.weight) == len(room)
