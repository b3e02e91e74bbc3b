"""The controller keeps the limits that its gait was designed for."""

import dataclasses

import numpy as np
import pytest

from frontal_biped.control import ControllerSettings, QpController
from frontal_biped.exceptions import SimulationError
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.virtual_constraints import StepPhase


def test_defaults_come_from_the_specification(biped, level_gait):
    weak = {"friction": 0.2, "min_normal_force": 0.05, "max_torque": (20.0, 30.0, 30.0, 20.0)}
    specification = dataclasses.replace(level_gait.specification, **weak)
    controller = QpController(biped, dataclasses.replace(level_gait, specification=specification))
    for key, value in weak.items():
        assert getattr(controller.settings, key) == value
    q, dq = level_gait.state_after_impact()
    u = controller.command(StepPhase.RISING, q + 0.05, dq).u
    assert np.all(np.abs(u) <= np.array(weak["max_torque"]) + 1e-6)
    assert np.any(np.abs(u) >= np.array(weak["max_torque"]) - 1e-3)  # the limit is reached, not idle
    assert (
        ControllerSettings.for_gait(dataclasses.replace(level_gait, specification=GaitSpecification()))
        == ControllerSettings()
    )


@pytest.mark.parametrize(("key", "value", "known"), [("outputs", "pid", "clf"), ("solver", "osqp", "proxqp")])
def test_unknown_choices_are_named_with_those_that_are_known(key, value, known):
    with pytest.raises(SimulationError, match=f"{value}.*{known}"):
        ControllerSettings(**{key: value})
