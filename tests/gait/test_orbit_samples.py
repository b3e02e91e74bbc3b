"""The orbit of a gait as samples; a file whose numbers make no orbit is told so."""

from dataclasses import replace

import numpy as np
import pytest

from frontal_biped.exceptions import ReversalError
from frontal_biped.simulation.orbit import orbit_trajectory

TOLD = 1e-6
"""A microsecond: finer than any page, table or figure tells a time [s]."""


@pytest.mark.slow
@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("column", [2, 3])
@pytest.mark.parametrize("phase", ["rising", "falling"])
def test_a_gait_whose_robot_stops_on_its_way_has_no_orbit(biped, reference_gait, phase, column):
    part = getattr(reference_gait, phase)
    joints = part.joint_bezier.copy()
    joints[0, column] = 100.0
    spoilt = replace(reference_gait, **{phase: replace(part, joint_bezier=joints)})
    with pytest.raises(ReversalError, match="no periodic orbit") as caught:
        orbit_trajectory(biped, spoilt)
    assert "\n" not in str(caught.value)


def test_the_time_of_a_step_is_that_of_the_orbit(biped, reference_gait):
    run = orbit_trajectory(biped, reference_gait, 1)
    assert run.t[-1] == pytest.approx(reference_gait.orbit.step_duration, abs=TOLD)
    assert np.all(np.diff(run.t) >= 0.0)
