"""Double support and hybrid invariance for random free parameters."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from random_states import UPRIGHT, assert_close, vectors

from frontal_biped.exceptions import UnreachablePoseError
from frontal_biped.model import impact, relabel
from frontal_biped.virtual_constraints import (
    FreeParameters,
    complete,
    double_support_pose,
    invariance_residuals,
)

FLAT = 1e-12
"""Sole heights and widths of a closed-form pose [m]: rounding of lengths of about 1 m."""

INVARIANT = 1e-9
"""Residuals of invariance: rounding, magnified by slopes of about 100."""

betas = st.floats(-1.75, -1.55)
widths = st.floats(0.12, 0.45)


@given(beta=betas, width=widths)
def test_double_support_pose_puts_both_feet_flat(robot, beta, width):
    q = double_support_pose(robot, beta, width)
    assert q[0] == beta
    inner, outer = robot.swing_sole(q)
    sole_inner, sole_outer = robot.chain.sole_inner, robot.chain.sole_outer
    assert_close(inner, [width - sole_inner, 0.0], FLAT, floor=1.0)
    assert_close(outer, [width + sole_outer, 0.0], FLAT, floor=1.0)
    assert float(robot.swing_foot_rotation(q)) == pytest.approx(0.0, abs=FLAT)


@given(beta=betas, width=widths)
def test_double_support_pose_is_the_upright_one_of_two(robot, beta, width):
    """Neither knees nor hips turn over: every joint stays within a radian of upright."""
    assert np.all(np.abs(double_support_pose(robot, beta, width) - UPRIGHT) < 1.0)


def test_standing_upright_is_a_double_support_pose(robot):
    assert_close(double_support_pose(robot, UPRIGHT, robot.hip_width), np.full(4, UPRIGHT), FLAT)


@given(beta=betas, width=widths)
def test_double_support_seen_from_the_other_foot(robot, beta, width):
    """Relabelled, the pose is the double support pose at its own stance ankle angle."""
    q = relabel(double_support_pose(robot, beta, width))
    assert_close(double_support_pose(robot, float(q[0]), width), q, 1e-10)


@pytest.mark.parametrize("width", [2.5, 10.0, 1e6])
def test_feet_too_far_apart(robot, width):
    with pytest.raises(UnreachablePoseError, match="step_width") as caught:
        double_support_pose(robot, -1.65, width)
    assert "\n" not in str(caught.value)
    assert f"{width:.4g} m" in str(caught.value)


@st.composite
def free_parameters(draw, degree=5, fri_degree=3):
    """Random free parameters around a step, far from anything optimal."""
    impact_beta = draw(st.floats(-1.70, -1.60))
    return FreeParameters(
        beta_reversal=draw(st.floats(-1.56, -1.45)),
        beta_impact=impact_beta,
        step_width=draw(st.floats(0.15, 0.35)),
        rising_columns=UPRIGHT + draw(vectors(-0.2, 0.2, 3 * (degree - 1))).reshape(3, -1),
        falling_columns=UPRIGHT + draw(vectors(-0.2, 0.2, 3 * (degree - 2))).reshape(3, -1),
        rising_fri=draw(vectors(-0.05, 0.05, fri_degree + 1)),
        falling_fri=draw(vectors(-0.05, 0.05, fri_degree)),
    )


def completed(robot, free):
    """Rising and falling phase; draws whose stance ankle all but stops at impact have no slope behind it."""
    q_minus = double_support_pose(robot, free.beta_impact, free.step_width)
    rate = 5.0 / (free.beta_impact - free.beta_reversal)
    slope = np.concatenate([[1.0], rate * (q_minus[1:] - free.falling_columns[:, -1])])
    assume(abs(impact(robot, q_minus, slope).speed_ratio) > 0.05)
    return complete(robot, free)


@given(free=free_parameters())
def test_completed_phases_are_invariant(robot, free):
    rising, falling = completed(robot, free)
    residuals = invariance_residuals(robot, rising, falling, free.step_width)
    assert set(residuals) == {
        "final_pose", "impact_pose", "impact_slope", "reversal_pose", "reversal_slope", "reversal_fri",
    }  # fmt: skip
    assert max(residuals.values()) < INVARIANT, residuals


@given(free=free_parameters(), speed=st.floats(-2.0, -0.1))
def test_state_on_the_constraints_stays_on_them_through_the_impact(robot, free, speed):
    """The claim itself, with the full impact map: position and velocity errors after the impact are zero."""
    rising, falling = completed(robot, free)
    end = falling.motion(np.array([falling.beta_end]))
    landing = impact(robot, end.q[0], end.dq[0] * speed)
    h_d, h_d1, *_ = rising.desired(float(landing.q_plus[0]))
    assert_close(landing.q_plus[1:], h_d, INVARIANT)
    assert_close(landing.dq_plus[1:], h_d1 * landing.dq_plus[0], INVARIANT, floor=1.0)


@given(free=free_parameters())
def test_phases_meet_smoothly_at_the_reversal(robot, free):
    rising, falling = completed(robot, free)
    assert rising.beta_end == falling.beta_start == free.beta_reversal
    assert falling.beta_end == free.beta_impact
    before, after = rising.desired(free.beta_reversal), falling.desired(free.beta_reversal)
    assert_close(after[0], before[0], INVARIANT)
    assert_close(after[1], before[1], INVARIANT, floor=1.0)
    assert after[3] == pytest.approx(before[3], abs=INVARIANT)


@given(free=free_parameters())
def test_free_columns_are_left_alone(biped, free):
    rising, falling = completed(biped, free)
    assert np.array_equal(rising.joint_bezier[:, 2:], free.rising_columns)
    assert np.array_equal(falling.joint_bezier[:, 2:-1], free.falling_columns)
    assert np.array_equal(rising.fri_bezier, free.rising_fri)
    assert np.array_equal(falling.fri_bezier[1:], free.falling_fri)


@given(free=free_parameters(), column=st.integers(0, 5), joint=st.integers(0, 2))
def test_residuals_see_a_broken_constraint(biped, free, column, joint):
    """Moving a column that invariance determines shows in a residual; a free one in the middle does not."""
    rising, falling = completed(biped, free)
    moved = falling.joint_bezier.copy()
    moved[joint, column] += 1e-3
    broken = type(falling)(falling.beta_start, falling.beta_end, moved, falling.fri_bezier)
    worst = max(invariance_residuals(biped, rising, broken, free.step_width).values())
    free_column = column in (2, 3)
    assert (worst < INVARIANT) if free_column else (worst > 1e-6)


def test_unreachable_width_is_reported_by_complete(biped):
    free = FreeParameters(
        -1.5, -1.65, 5.0, np.full((3, 4), UPRIGHT), np.full((3, 3), UPRIGHT), np.zeros(4), np.zeros(3)
    )
    with pytest.raises(UnreachablePoseError):
        complete(biped, free)
