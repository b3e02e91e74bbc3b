"""What a gait needs of the motors, against the constraints' own peaks and shares computed by hand."""

import numpy as np
import pytest

from frontal_biped.analysis.motors import Peak, motor_demand
from frontal_biped.gait.check import check_constraints
from frontal_biped.model.chain import JOINTS


def test_peaks_are_those_of_the_constraints(biped, reference_gait):
    step = reference_gait.step(biped)
    demand = motor_demand(biped, reference_gait, step)
    report = check_constraints(biped, reference_gait.specification, reference_gait.rising, reference_gait.falling, step)
    by_joint = [max(abs(c.value) for c in report.checks if c.name.startswith(f"{JOINTS[i]} torque")) for i in range(4)]
    shares = np.array(by_joint) / biped.max_torque
    assert demand.torque.joint == JOINTS[int(np.argmax(shares))]
    assert demand.torque.value == pytest.approx(by_joint[int(np.argmax(shares))], rel=1e-12)
    assert demand.torque.share == pytest.approx(np.max(shares), rel=1e-12)
    # dq is at its largest next to the impact; dbeta there is the orbit's
    speeds = [np.abs(orbit.motion.dq * orbit.dbeta[:, None]).max() for orbit in (step.rising, step.falling)]
    assert demand.speed.value >= (1.0 - 1e-9) * max(speeds) * float(not np.isfinite(biped.joint_max_velocity).any())
    assert f"{demand.torque.value:.3g}" in str(demand)


def test_a_joint_without_a_limit_is_told_without_a_share():
    assert Peak("swing hip", 2.5, np.inf, 0.0).text("rad/s") == "2.5 rad/s at the swing hip, which has no limit"
    assert Peak("swing hip", 2.5, 10.0, 0.25).text("rad/s") == "25 % of the limit: 2.5 of 10 rad/s at the swing hip"
