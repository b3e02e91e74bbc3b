"""The continuation of a gait's rising phase: found once for a robot and a gait, whoever asks."""

from dataclasses import replace

import numpy as np

from frontal_biped.control.stabilisers.transitions import ReanchoringTransitions
from frontal_biped.virtual_constraints.phase import Phase


def test_stabilisers_of_one_robot_and_gait_share_it_and_others_have_their_own(biped, reference_gait):
    first, second = (ReanchoringTransitions(biped, reference_gait, anticipate=by) for by in (True, False))
    assert first.planned_rising is second.planned_rising
    rising = reference_gait.rising
    moved = Phase(rising.beta_start, rising.beta_end, rising.joint_bezier, rising.fri_bezier + 1e-3)
    other = ReanchoringTransitions(biped, replace(reference_gait, rising=moved)).planned_rising
    assert other is not first.planned_rising
    np.testing.assert_array_equal(other.phase.fri_bezier, moved.fri_bezier)
