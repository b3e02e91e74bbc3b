"""Torques in double support: as asked where soles and motors allow it, the nearest that they allow elsewhere."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from frontal_biped.control.support_torques import ACCELERATION, SupportProgram
from frontal_biped.virtual_constraints.double_support import DoubleSupportFamily
from frontal_biped.zero_dynamics.support_dynamics import SupportLimits, SupportPoint

WIDTH, P_FRI = 0.28, 0.005

KEPT = 1e-5
"""By how much a row may be overstepped, over the weight [-, m]: the accuracy of the program is 1e-7 in its units."""

leans = st.floats(-0.1, 0.1)
speeds = st.floats(-0.5, 0.5)


def point_of(robot, lean):
    family = DoubleSupportFamily(robot, WIDTH)
    return SupportPoint.of(family, family.half_way() + lean)


def program_of(robot):
    return SupportProgram(SupportLimits(0.6, 0.005, robot.max_torque), P_FRI)


@given(lean=leans, speed=speeds, share=st.floats(0.1, 0.9))
def test_what_is_allowed_is_done(robot, lean, speed, share):
    point, program = point_of(robot, lean), program_of(robot)
    acceleration = point.acceleration(P_FRI + share * (WIDTH - 2.0 * P_FRI), speed**2)
    answer = program.solve(point, speed, acceleration)
    done, forces = point.under(answer.u, speed**2)
    assert done == pytest.approx(acceleration, abs=1e-5)
    if answer.allowed:
        load = forces.swing[1] / (forces.swing[1] + forces.stance[1])
        assert load == pytest.approx(share, abs=1e-6)


@given(lean=leans, speed=speeds, acceleration=st.floats(-12.0, 12.0))
def test_limits_are_kept_and_the_motion_is_the_nearest(robot, lean, speed, acceleration):
    point, program = point_of(robot, lean), program_of(robot)
    answer = program.solve(point, speed, acceleration)
    assert answer.solved
    C, c = point.rows(program.limits, speed**2)
    x = np.array([answer.acceleration, *answer.forces.swing])
    assert ((C @ x - c) / robot.weight).min() > -KEPT
    low, high = point.acceleration_range(program.limits, speed**2)
    nearest = min(max(acceleration, low), high)
    # a compromise with the share of the load, worth `ACCELERATION` where all of the weight is on the wrong foot
    assert answer.acceleration == pytest.approx(nearest, abs=10.0 * ACCELERATION)


@pytest.mark.parametrize("lean", [-0.05, 0.0, 0.05])
def test_standing_still(robot, lean):
    """At rest the torques balance the weight: no acceleration, and each foot carries its share by the lever."""
    point, program = point_of(robot, lean), program_of(robot)
    answer = program.solve(point, 0.0, 0.0)
    done, forces = point.under(answer.u, 0.0)
    assert done == pytest.approx(0.0, abs=1e-9)
    assert forces.stance[1] + forces.swing[1] == pytest.approx(robot.weight, rel=1e-9)
    moment = forces.stance[2] + forces.swing[2] + WIDTH * forces.swing[1]
    assert moment / robot.weight == pytest.approx(robot.com(point.at.q)[0], abs=1e-9)
