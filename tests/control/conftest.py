"""Controllers that the tests of the quadratic program share."""

from dataclasses import replace
from functools import cache

import pytest

from frontal_biped.control import QpController
from frontal_biped.gait.file import load_gait
from frontal_biped.model import load_robot


@pytest.fixture(scope="session")
def solvers(biped, reference_gait):
    """For a robot by name and settings, the controller that solves exactly and the one that asks ProxQP every time."""

    @cache
    def pair(name, settings):
        robot = biped if name == "frontal_biped" else load_robot(name)
        gait = reference_gait if robot is biped else load_gait(robot.path.with_name(f"{name}.gait.json"))
        return tuple(QpController(robot, gait, replace(settings, solver=solver)) for solver in ("exact", "proxqp"))

    return pair
