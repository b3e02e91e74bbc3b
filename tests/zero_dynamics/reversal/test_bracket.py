"""Where a reversal point can lie: beta_r^max."""

import numpy as np
import pytest

from frontal_biped.exceptions import ReversalError
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.virtual_constraints import Phase
from frontal_biped.zero_dynamics.reversal.bracket import beta_maximum


@pytest.fixture(params=["reference", "level"])
def gait(request, reference_gait, level_gait):
    return reference_gait if request.param == "reference" else level_gait


def test_centre_of_mass_is_over_the_fri_at_beta_maximum(biped, gait):
    beta_max = beta_maximum(biped, gait.rising)
    end = gait.rising.motion(np.array([gait.rising.beta_end]))
    frozen = end.q[0].copy()
    frozen[0] = beta_max
    assert biped.com(frozen)[0] == pytest.approx(end.p_fri[0], abs=1e-12)
    assert beta_max > gait.beta_reversal


def test_centre_of_mass_outside_the_target_is_refused(biped: FrontalBiped, reference_gait):
    rising = reference_gait.rising
    shifted = Phase(rising.beta_start, rising.beta_end, rising.joint_bezier, rising.fri_bezier + 1.0)
    with pytest.raises(ReversalError, match="centre of mass"):
        beta_maximum(biped, shifted)
