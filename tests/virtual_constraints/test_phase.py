"""One phase: the vectorised motion, the control tick's evaluation, and derivatives with respect to beta."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from random_states import assert_close, difference, vectors

from frontal_biped.virtual_constraints import Phase

ROUNDING = 1e-11
"""Relative error between two evaluations of the same polynomial."""

BETA_STEP = 1e-6
"""Step of differences in beta [rad]: a phase spans about 0.05 rad."""

DIFFERENCE_ACCURACY = 1e-6
"""Relative accuracy of differences over that step."""

s_values = st.floats(-0.1, 1.2)


@st.composite
def phases(draw):
    """Random phases, rising and falling, of random degrees."""
    start = draw(st.floats(-1.75, -1.55))
    span = draw(st.sampled_from([1.0, -1.0])) * draw(st.floats(0.02, 0.2))
    joint_degree, fri_degree = draw(st.integers(3, 7)), draw(st.integers(1, 8))
    joints = -0.5 * np.pi + draw(vectors(-0.3, 0.3, 3 * (joint_degree + 1))).reshape(3, -1)
    return Phase(start, start + span, joints, draw(vectors(-0.05, 0.05, fri_degree + 1)))


@given(phase=phases(), s=s_values)
def test_control_tick_sees_the_same_motion(phase, s):
    beta = phase.beta_start + s * phase.range
    h_d, h_d1, h_d2, p_fri = phase.desired(beta)
    motion = phase.motion(np.array([beta]))
    assert_close(h_d, motion.q[0, 1:], ROUNDING)
    assert_close(h_d1, motion.dq[0, 1:], ROUNDING, floor=10.0)
    assert_close(h_d2, motion.ddq[0, 1:], ROUNDING, floor=1000.0)
    assert p_fri == pytest.approx(motion.p_fri[0], rel=ROUNDING, abs=ROUNDING)


@given(phase=phases(), s=s_values)
def test_motion_follows_beta(phase, s):
    beta = phase.beta_start + s * phase.range
    motion = phase.motion(np.array([beta]))
    assert motion.q[0, 0] == beta
    assert motion.dq[0, 0] == 1.0
    assert motion.ddq[0, 0] == 0.0


@given(phase=phases(), s=s_values)
def test_derivatives_against_differences(phase, s):
    beta = phase.beta_start + s * phase.range
    motion = phase.motion(np.array([beta]))
    at = {
        name: difference(lambda b, name=name: getattr(phase.motion(np.array([b])), name)[0], beta, BETA_STEP)
        for name in ("q", "dq", "p_fri")
    }
    # the smallest range, 0.02 rad, magnifies each derivative by 50 times the degree
    scale = 8.0 / abs(phase.range)
    assert_close(at["q"], motion.dq[0], DIFFERENCE_ACCURACY, floor=scale)
    assert_close(at["dq"], motion.ddq[0], DIFFERENCE_ACCURACY, floor=scale**2)
    assert_close(at["p_fri"], motion.dp_fri[0], DIFFERENCE_ACCURACY, floor=scale)


@given(phase=phases())
def test_ends_are_the_outer_coefficients(phase):
    motion = phase.motion(np.array([phase.beta_start, phase.beta_end]))
    assert_close(motion.q[:, 1:], phase.joint_bezier[:, [0, -1]].T, ROUNDING)
    assert_close(motion.p_fri, phase.fri_bezier[[0, -1]], ROUNDING, floor=0.01)


@given(phase=phases())
def test_phase_value_runs_from_zero_to_one_in_time(phase):
    assert float(phase.s(phase.beta_start)) == 0.0
    assert float(phase.s(phase.beta_end)) == pytest.approx(1.0)
    assert phase.degree == phase.joint_bezier.shape[1] - 1
    assert phase.fri_degree == len(phase.fri_bezier) - 1
