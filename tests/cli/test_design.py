"""What `design` says of a gait beside its verdict."""

import numpy as np

from frontal_biped.cli.design import _needs
from frontal_biped.gait.check import check_constraints
from frontal_biped.model.chain import JOINTS


def test_the_motor_that_works_hardest_is_named(biped, reference_gait):
    step, (rising, falling) = reference_gait.step(biped), (reference_gait.rising, reference_gait.falling)
    _, motors = _needs(check_constraints(biped, reference_gait.specification, rising, falling, step))
    torques = [orbit.generalized_forces[-4:] for orbit in (step.rising, step.falling)]
    shares = np.abs(np.concatenate(torques, axis=1)).max(axis=1) / biped.max_torque
    joint = JOINTS[int(np.argmax(shares))]
    assert motors.startswith(f"motors    torque of the {joint} ")
    assert f"N m, {100.0 * shares.max():.0f} %" in motors
