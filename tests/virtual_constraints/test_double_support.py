"""The double-support family: slope and curvature against differences, and the view from the other foot."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from frontal_biped.exceptions import UnreachablePoseError
from frontal_biped.model.stance_map import relabel
from frontal_biped.virtual_constraints.double_support import DoubleSupportFamily

STEP, DIFFERENCE = 1e-5, 1e-8
"""Of central differences [rad], and what is left of them: STEP^2 and rounding over STEP."""

ROUNDING = 1e-11
"""Of angles of about 1 rad through two triangles."""

leans = st.floats(-0.15, 0.15)
widths = st.floats(0.18, 0.4)


@given(lean=leans, width=widths)
def test_slope_and_curvature_are_derivatives_of_the_pose(robot, lean, width):
    family = DoubleSupportFamily(robot, width)
    beta = family.half_way() + lean
    before, at, after = (family.at(beta + k * STEP) for k in (-1.0, 0.0, 1.0))
    assert (after.q - before.q) / (2.0 * STEP) == pytest.approx(at.dq, abs=DIFFERENCE)
    assert (after.dq - before.dq) / (2.0 * STEP) == pytest.approx(at.ddq, abs=DIFFERENCE)


@given(lean=leans, width=widths)
def test_along_the_family_the_swing_foot_is_at_rest(robot, lean, width):
    family = DoubleSupportFamily(robot, width)
    at = family.at(family.half_way() + lean)
    assert np.abs(robot.swing_sole_jacobian(at.q) @ at.dq).max() < ROUNDING
    assert at.dq.sum() == pytest.approx(0.0, abs=ROUNDING)


@given(lean=leans, width=widths)
def test_the_family_is_the_same_from_either_foot(robot, lean, width):
    family = DoubleSupportFamily(robot, width)
    at = family.at(family.half_way() + lean)
    mirrored = family.at(family.from_other_foot(at.q[0]))
    assert mirrored.q == pytest.approx(relabel(at.q), abs=ROUNDING)
    assert mirrored.dq == pytest.approx(relabel(at.dq) / at.dq[3], abs=1e-10)


@pytest.mark.parametrize("width", [0.2, 0.3, 0.4])
def test_half_way_the_robot_is_its_own_mirror_image(robot, width):
    family = DoubleSupportFamily(robot, width)
    at = family.at(family.half_way())
    assert at.q == pytest.approx(relabel(at.q), abs=ROUNDING)
    assert robot.com(at.q)[0] == pytest.approx(0.5 * width, abs=1e-3)  # asymmetric robots are averaged, within 1 mm


def test_feet_too_far_apart(robot):
    with pytest.raises(UnreachablePoseError, match="width"):
        DoubleSupportFamily(robot, 3.0).half_way()
