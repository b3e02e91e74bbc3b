"""The simulated step that stands between a candidate and a gait."""

from dataclasses import replace

import numpy as np

from frontal_biped.design import verify
from frontal_biped.design.verification import RETURN_TOLERANCE


def test_designed_gaits_pass(biped, reference_design, level_design):
    for result in (reference_design, level_design):
        assert result.verification.passed
        assert result.verification.return_error < RETURN_TOLERANCE
        assert abs(result.verification.duration_error) < RETURN_TOLERANCE
        assert result.gait.provenance["simulated_step"]["outcome"] == "completed"


def test_a_gait_that_is_none_is_caught(biped, reference_gait):
    """Columns that break the invariance, or an orbit of another speed: the step does not return."""
    columns = reference_gait.falling.joint_bezier.copy()
    columns[1, 2] += 0.01
    bent = replace(reference_gait, falling=replace(reference_gait.falling, joint_bezier=columns))
    faster = replace(
        reference_gait,
        orbit=replace(reference_gait.orbit, beta_dot_after_impact=1.001 * reference_gait.orbit.beta_dot_after_impact),
    )
    for gait in (bent, faster):
        verification = verify(biped, gait)
        assert not verification.passed
        assert verification.return_error > RETURN_TOLERANCE or not np.isfinite(verification.return_error)
