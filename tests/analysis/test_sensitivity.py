"""The paper's sensitivity experiment, and the bound on re-anchored transitions."""

import numpy as np
import pytest

from frontal_biped.analysis.sensitivity import SHIFTS, reversal_sensitivity
from frontal_biped.control import STABILISERS, ReanchoringTransitions, make_stabiliser
from frontal_biped.control.stabilisers.ankle_law import AnkleLaw

INVARIANCE = 1e-6  # [rad] bound of the design, for errors up to 1e-2 rad
AS_ASKED = 1e-4  # relative error of a simulated reversal: speed in closed form, walked at rtol 1e-9


def loss(experiment, name):
    return {run.shift: run.worst_output_error for run in experiment.of(name)}


def test_loss_of_the_fixed_transition_is_quadratic_and_the_re_anchored_one_loses_nothing(biped, level_gait):
    """Pose and slope agree at the planned reversal, so the mismatch of the fixed transition is of second order."""
    experiment = reversal_sensitivity(biped, level_gait, shifts=(-1e-3, -1e-4, 1e-4))
    fixed, anchored = loss(experiment, "fixed"), loss(experiment, "re-anchored")
    assert np.log10(fixed[-1e-3] / fixed[-1e-4]) == pytest.approx(2.0, abs=0.1)
    assert max(anchored.values()) < INVARIANCE
    assert fixed[1e-4] > 1e3 * anchored[1e-4]
    for run in experiment.of("re-anchored"):
        assert run.actual == pytest.approx(run.shift, rel=AS_ASKED)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["level", "robust"])
def test_re_anchored_transitions_keep_invariance_up_to_a_hundredth_of_a_radian(biped, request, name):
    gait = request.getfixturevalue(f"{name}_gait")
    experiment = reversal_sensitivity(biped, gait, stabilisers=("re-anchored",))
    assert [run.shift for run in experiment.runs] == list(SHIFTS)
    for run in experiment.runs:
        assert run.outcome == "completed"
        assert run.worst_output_error < INVARIANCE
        assert run.actual == pytest.approx(run.shift, abs=1e-9 + AS_ASKED * abs(run.shift))


def test_a_stabiliser_is_what_its_name_says(biped, level_gait):
    """Re-anchored as it comes, the reversal is where the speed was chosen to put it; looking ahead moves it."""
    experiment = reversal_sensitivity(biped, level_gait, shifts=(-1e-2,), stabilisers=("re-anchored", "adaptive"))
    anchored, adaptive = experiment.runs
    assert (anchored.stabiliser, adaptive.stabiliser) == ("re-anchored", "adaptive")
    assert anchored.actual == pytest.approx(anchored.shift, rel=AS_ASKED)
    assert adaptive.actual != pytest.approx(adaptive.shift, rel=10.0 * AS_ASKED)


def test_names_are_those_of_the_objects(biped, level_gait):
    """A run's header tells the stabiliser's own name."""
    for name in ("fixed", "re-anchored", "adaptive", "ankle"):
        assert make_stabiliser(name, biped, level_gait).name == name
    for variant in ({"anticipate": True}, {"anticipate": False, "rejoin": False}):
        assert ReanchoringTransitions(biped, level_gait, **variant).name not in STABILISERS
    assert AnkleLaw(biped, level_gait, inner=make_stabiliser("adaptive", biped, level_gait)).name == "ankle + adaptive"
