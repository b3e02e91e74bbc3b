"""Poses on the ground as a group: motions compose, and are seen as they were made."""

import numpy as np
import pytest

from frontal_biped.control.path.pose import ORIGIN, Pose, unwrapped

ROUNDING = 1e-12


@pytest.fixture
def poses():
    return [Pose(*row) for row in np.random.default_rng(0).uniform(-3.0, 3.0, (20, 3)).tolist()]


def test_a_motion_is_seen_as_it_was_made(poses):
    for at in poses:
        for motion in poses:
            assert at.seen(at.moved(*motion)) == pytest.approx(motion, abs=ROUNDING)


def test_motions_compose(poses):
    for first in poses:
        for second in poses:
            assert ORIGIN.moved(*first).moved(*second) == pytest.approx(first.moved(*second), abs=ROUNDING)


def test_a_square():
    at = ORIGIN
    for _ in range(4):
        at = at.moved(1.0, 0.0, np.pi / 2.0)
    assert at == pytest.approx((0.0, 0.0, 2.0 * np.pi), abs=ROUNDING)


def test_yaws_are_told_near_another():
    for near in np.linspace(-20.0, 20.0, 41):
        yaw = unwrapped(1.0, near)
        assert abs(yaw - near) <= np.pi + ROUNDING
        assert np.cos(yaw - 1.0) == pytest.approx(1.0)
