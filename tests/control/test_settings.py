"""The controller keeps the limits that its gait was designed for."""

import dataclasses

from frontal_biped.control import ControllerSettings, QpController


def test_defaults_come_from_the_specification(biped, level_gait):
    slippery = dataclasses.replace(level_gait, specification={**level_gait.specification, "friction": 0.2})
    assert QpController(biped, slippery).settings.friction == 0.2
    assert ControllerSettings.for_gait(dataclasses.replace(level_gait, specification={})) == ControllerSettings()
