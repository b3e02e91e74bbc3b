"""The paper's sensitivity experiment, and the bound on adaptive transitions."""

import numpy as np
import pytest

from frontal_biped.analysis.sensitivity import SHIFTS, reversal_sensitivity

INVARIANCE = 1e-6  # [rad] bound of the design, for errors up to 1e-2 rad


def loss(experiment, name):
    return {run.shift: run.worst_output_error for run in experiment.of(name)}


def test_loss_of_the_fixed_transition_is_quadratic_and_the_adaptive_one_loses_nothing(biped, level_gait):
    """Pose and slope agree at the planned reversal, so the mismatch of the fixed transition is of second order."""
    experiment = reversal_sensitivity(biped, level_gait, shifts=(-1e-3, -1e-4, 1e-4))
    fixed, adaptive = loss(experiment, "fixed"), loss(experiment, "adaptive")
    assert np.log10(fixed[-1e-3] / fixed[-1e-4]) == pytest.approx(2.0, abs=0.1)
    assert max(adaptive.values()) < INVARIANCE
    assert fixed[1e-4] > 1e3 * adaptive[1e-4]
    for run in experiment.of("adaptive"):
        assert run.actual == pytest.approx(run.shift, rel=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["level", "robust"])
def test_adaptive_transitions_keep_invariance_up_to_a_hundredth_of_a_radian(biped, request, name):
    gait = request.getfixturevalue(f"{name}_gait")
    experiment = reversal_sensitivity(biped, gait, stabilisers=("adaptive",))
    assert [run.shift for run in experiment.runs] == list(SHIFTS)
    for run in experiment.runs:
        assert run.outcome == "completed"
        assert run.worst_output_error < INVARIANCE
        assert run.actual == pytest.approx(run.shift, abs=1e-9 + 1e-4 * abs(run.shift))
