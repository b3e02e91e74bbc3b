"""Landings wider and narrower than the gait's: poses of both feet flat, and the energy of the pendulum."""

import numpy as np
import pytest
from whole_robots import whole

from frontal_biped.control.landing_widths import LandingWidths, standing_pose
from frontal_biped.virtual_constraints.swayed import OtherEnd, SwayedPhase

FLAT = 2e-4
"""Between the widths that are tabulated, of a pose interpolated linearly [m, rad]."""

EXACT = 1e-9


@pytest.fixture(scope="module", params=["talos_full", "g1_bent", "romeo_bent"])
def robot(request):
    return whole(request.param)


@pytest.fixture(scope="module")
def widths(robot):
    return LandingWidths(robot.biped, robot.gait)


def planned(robot):
    return robot.gait.falling.motion(np.array([robot.gait.falling.beta_end])).q[0]


def test_the_planned_landing_is_among_them(robot, widths):
    assert widths.pose_error(0.0) == pytest.approx(np.zeros(3), abs=EXACT)
    assert widths.width == pytest.approx(robot.biped.joint_positions(planned(robot))[-1, 0])
    assert widths.narrowest < 0.0 < widths.widest


@pytest.mark.parametrize("share", [-0.9, -0.31, 0.27, 0.5])
def test_both_feet_are_flat_and_as_far_apart(robot, widths, share):
    """The body's three angles with the one stance angle that puts the swing foot on the ground."""
    change = share * min(-widths.narrowest, widths.widest)
    pose = planned(robot).copy()
    pose[1:] += widths.pose_error(change)
    # the foot's rotation is the sum of the angles: what is left of it is the stance ankle's
    pose[0] += planned(robot).sum() - pose.sum()
    inner, outer = robot.biped.swing_sole(pose)
    assert inner[1] == pytest.approx(outer[1], abs=FLAT)
    assert inner[1] == pytest.approx(robot.biped.swing_sole(planned(robot))[0][1], abs=FLAT)
    assert robot.biped.joint_positions(pose)[-1, 0] == pytest.approx(widths.width + change, abs=FLAT)
    assert robot.biped.com(pose)[0] == pytest.approx(robot.biped.com(planned(robot))[0] + 0.5 * change, abs=FLAT)


def test_widths_that_are_not_known_are_not_asked_for(widths):
    assert widths.within(10.0) == widths.widest
    assert widths.within(-10.0) == widths.narrowest


def test_a_phase_ends_in_the_other_pose(robot, widths):
    change = 0.3 * widths.widest
    phase = SwayedPhase(robot.biped, robot.gait.falling)
    end = OtherEnd(0.5 * change, widths.pose_error(change))
    pose = phase.begun_as_planned().at(phase.start).h_d
    begun = phase.begun(phase.start, pose, None, end)
    assert begun.at(phase.start).h_d == pytest.approx(pose, abs=EXACT)
    reached = begun.at(phase.end + 0.5 * change).h_d
    assert reached == pytest.approx(planned(robot)[1:] + end.error, abs=1e-6)
    for s in np.linspace(phase.start, phase.end + 0.5 * change, 7)[1:-1]:
        h = 1e-6
        slope = (begun.at(s + h).h_d - begun.at(s - h).h_d) / (2.0 * h)
        assert begun.at(s).h_d1 == pytest.approx(slope, rel=1e-4, abs=1e-4)


def test_the_standing_pose_is_midway(robot):
    pose = standing_pose(robot.biped, robot.gait)
    assert pose is not None
    width = robot.biped.joint_positions(planned(robot))[-1, 0]
    assert robot.biped.com(pose)[0] == pytest.approx(0.5 * width, abs=EXACT)
    assert robot.biped.joint_positions(pose)[-1, 0] == pytest.approx(width, abs=EXACT)
