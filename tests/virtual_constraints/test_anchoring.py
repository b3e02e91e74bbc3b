"""Anchored phases: smooth past s = 1, continuous at every reversal, and the planned ones where nothing is disturbed."""

import numpy as np
import pytest

from frontal_biped.virtual_constraints import Phase
from frontal_biped.virtual_constraints.anchoring import (
    anchored_falling,
    anchored_rising,
    continued,
    rescaled_falling,
    with_ends,
)

ROUNDING = 1e-9  # slopes of the gaits are of the order of 100, curvatures of 1e4


@pytest.fixture
def rising(level_gait):
    return continued(level_gait.rising, 0.007, 0.002, 0.004)


def row(phase, beta):
    at = phase.motion(np.array([beta]))
    return np.concatenate([at.q[0, 1:], at.p_fri]), np.concatenate([at.dq[0, 1:], at.dp_fri]), at.ddq[0, 1:]


def test_continuation_meets_value_slope_and_curvature(rising, level_gait):
    end = rising.beta_end
    for a, b in zip(row(level_gait.rising, end), row(rising, end + 1e-13), strict=True):
        assert b == pytest.approx(a, rel=1e-7, abs=1e-7)


@pytest.mark.parametrize("beta_past", [1e-4, 2e-3, 1e-2, 0.1])
def test_derivatives_of_the_continuation(rising, beta_past):
    beta, h = rising.beta_end + beta_past, 1e-7
    _, slope, curvature = row(rising, beta)
    above, below = row(rising, beta + h), row(rising, beta - h)
    assert slope == pytest.approx((above[0] - below[0]) / (2.0 * h), rel=1e-5, abs=1e-5)
    assert curvature == pytest.approx((above[1] - below[1])[:3] / (2.0 * h), rel=1e-5, abs=1e-2)


def test_joints_come_to_rest_far_past_the_end(rising):
    _, slope, curvature = row(rising, rising.beta_end + 0.3)
    assert np.max(np.abs(slope)) < 1e-12
    assert np.max(np.abs(curvature)) < 1e-9


@pytest.mark.parametrize("offset", [-0.015, -0.004, -1e-5, 1e-5, 0.004, 0.03])
def test_falling_starts_where_rising_ended(rising, level_gait, offset):
    """Pose, slope and FRI target are those of the rising phase at every reversal; the end is the planned one."""
    reversal = rising.beta_end + offset
    falling = anchored_falling(level_gait.falling, rising, reversal)
    (value, slope, _), (begin, begin_slope, _) = row(rising, reversal), row(falling, reversal)
    assert begin == pytest.approx(value, abs=ROUNDING)
    assert begin_slope[:3] == pytest.approx(slope[:3], abs=1e-7 * np.max(np.abs(slope)))
    end = level_gait.falling.beta_end
    for a, b in zip(row(falling, end), row(level_gait.falling, end), strict=True):
        assert a == pytest.approx(b, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("offset", [-0.015, -0.004, -1e-5])
def test_rescaled_falling_keeps_both_ends(rising, level_gait, offset):
    """Pose, slope and FRI target of the rising phase at the reversal; pose and slope of the plan at the impact."""
    reversal = rising.beta_end + offset
    falling = rescaled_falling(level_gait.falling, rising, reversal)
    (value, slope, _), (begin, begin_slope, _) = row(rising, reversal), row(falling, reversal)
    assert (falling.beta_start, falling.beta_end) == (reversal, level_gait.falling.beta_end)
    assert begin == pytest.approx(value, abs=ROUNDING)
    assert begin_slope[:3] == pytest.approx(slope[:3], abs=1e-7 * np.max(np.abs(slope)))
    (value, slope, _), (end, end_slope, _) = row(level_gait.falling, falling.beta_end), row(falling, falling.beta_end)
    assert end == pytest.approx(value, abs=ROUNDING)
    assert end_slope[:3] == pytest.approx(slope[:3], abs=1e-7 * np.max(np.abs(slope)))


@pytest.mark.parametrize("offset", [-0.01, -1e-3, 1e-3, 0.02])
def test_anchored_falling_phase_is_differentiable_everywhere(rising, level_gait, offset):
    falling = anchored_falling(level_gait.falling, rising, rising.beta_end + offset)
    h = 1e-8
    for beta in np.linspace(falling.beta_end, rising.beta_end + offset, 41)[1:-1]:
        above, below = row(falling, beta + h)[0], row(falling, beta - h)[0]
        _, slope, curvature = row(falling, beta)
        # one-sided curvatures differ where the phases meet, so the difference errs by h times their jump
        tolerance = 1e-5 + 2.0 * h * (np.max(np.abs(curvature)) + 2e4)
        assert slope == pytest.approx((above - below) / (2.0 * h), abs=tolerance)


def test_one_value_is_the_motion_at_it(rising, level_gait):
    """What a control tick asks and what the quadrature asks is one function."""
    falling = [anchored_falling(level_gait.falling, rising, rising.beta_end + offset) for offset in (-0.006, 0.006)]
    for phase in (rising, *falling):
        for beta in np.linspace(phase.beta_end - 0.01, phase.beta_end + 0.02, 13):
            h_d, h_d1, h_d2, p_fri = phase.desired(float(beta))
            at = phase.motion(np.array([beta]))
            assert h_d == pytest.approx(at.q[0, 1:], abs=1e-9)
            assert h_d1 == pytest.approx(at.dq[0, 1:], abs=1e-7)
            assert h_d2 == pytest.approx(at.ddq[0, 1:], rel=1e-8, abs=1e-4)
            assert p_fri == pytest.approx(at.p_fri[0], abs=1e-12)


def test_undisturbed_phases_are_the_planned_ones(rising, level_gait):
    assert anchored_falling(level_gait.falling, rising, rising.beta_end) is level_gait.falling
    start = row(rising, rising.beta_start)
    same = anchored_rising(rising, rising.beta_start, start[0][:3], start[1][:3])
    assert same.phase.joint_bezier == pytest.approx(rising.phase.joint_bezier, abs=1e-12)


def test_disturbed_landing_keeps_the_end(rising):
    rng = np.random.default_rng(0)
    pose, slope, _ = row(rising, rising.beta_start)
    moved, steeper = pose[:3] + 0.01 * rng.normal(size=3), slope[:3] + rng.normal(size=3)
    phase = anchored_rising(rising, rising.beta_start + 0.003, moved, steeper)
    value, found, _ = row(phase, rising.beta_start + 0.003)
    assert value[:3] == pytest.approx(moved)
    assert found[:3] == pytest.approx(steeper)
    for a, b in zip(row(phase, phase.beta_end)[:2], row(rising, rising.beta_end)[:2], strict=True):
        assert a[:3] == pytest.approx(b[:3], rel=1e-9)


@pytest.mark.parametrize("share", [0.0, 0.2, 0.7])
def test_begun_on_its_way_without_error_a_phase_goes_on_unchanged(rising, share):
    start = rising.beta_start + share * rising.range
    value, slope, _ = row(rising, start)
    phase = anchored_rising(rising, start, value[:3], slope[:3])
    assert phase.beta_start == start
    for beta in np.linspace(start, rising.beta_end + 0.01, 15):
        for a, b in zip(row(rising, beta), row(phase, beta), strict=True):
            assert b == pytest.approx(a, rel=1e-9, abs=1e-6)


def test_stretched_phase_keeps_start_and_final_pose(rising):
    longer = rising.stretched(rising.beta_end + 0.01)
    for a, b in zip(row(longer, rising.beta_start)[:2], row(rising, rising.beta_start)[:2], strict=True):
        assert a[:3] == pytest.approx(b[:3], rel=1e-9)
    assert row(longer, longer.beta_end)[0] == pytest.approx(row(rising, rising.beta_end)[0])


def test_other_ends(level_gait):
    falling: Phase = level_gait.falling
    start, end = row(falling, falling.beta_start), row(falling, falling.beta_end)
    pose = end[0][:3] + np.array([0.01, -0.02, 0.015])
    moved = with_ends(falling, falling.beta_start, start[0][:3], start[1][:3], falling.beta_end - 0.004, pose)
    assert row(moved, moved.beta_end)[0][:3] == pytest.approx(pose)
    assert row(moved, moved.beta_end)[1][:3] == pytest.approx(end[1][:3], rel=1e-9)
    assert row(moved, moved.beta_start)[1][:3] == pytest.approx(start[1][:3], rel=1e-9)


def test_shifted_target_moves_everywhere(rising, level_gait):
    for reversal in (rising.beta_end + 0.01, rising.beta_end - 0.01):
        falling = anchored_falling(level_gait.falling, rising, reversal)
        beta = np.linspace(falling.beta_end, reversal, 21)
        assert falling.shifted(0.01).motion(beta).p_fri == pytest.approx(falling.motion(beta).p_fri + 0.01)


def test_shift_of_a_rising_phase_is_taken_back(rising):
    """Also what several shifts, and a stretch between them, have added."""
    longer = rising.stretched(rising.beta_end + 0.01)
    beta = np.linspace(rising.beta_start, longer.beta_end + 0.02, 21)
    back = rising.shifted(0.01).stretched(longer.beta_end).shifted(-0.003).unshifted()
    assert back.motion(beta).p_fri == pytest.approx(longer.motion(beta).p_fri, abs=1e-15)
    assert longer.unshifted() is longer


def test_form_changes_at_the_breaks_and_nowhere_else(rising, level_gait):
    """Third derivatives jump there: panels of the closed form end there, or they would not converge."""

    def kink(phase, beta, h=1e-6):
        left, right = (phase.motion(beta + side * h * np.array([1.0, 2.0])).ddq for side in (-1.0, 1.0))
        slopes = [(left[0] - left[1]) / h, (right[1] - right[0]) / h]
        return np.max(np.abs(slopes[1] - slopes[0])) / np.max(np.abs(slopes))

    reversals = (rising.beta_end - 0.006, rising.beta_end + 0.006)
    falling = [anchored_falling(level_gait.falling, rising, reversal) for reversal in reversals]
    for phase, begin in ((rising, rising.beta_end + 0.006), *zip(falling, reversals, strict=True)):
        (at,) = phase.breaks
        assert kink(phase, at) > 0.1
        assert kink(phase, 0.5 * (at + begin)) < 1e-2
        assert kink(phase, at - 0.002) < 1e-2
    assert level_gait.rising.breaks == ()
