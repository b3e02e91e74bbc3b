"""TALOS, swept through space: every joint, footsteps on a bend."""

import pytest
from swept_walk import swept_walk

from frontal_biped.gait.file import load_gait
from frontal_biped.model import load_robot, models_dir
from frontal_biped.model.space.free_robot import FreeRobot


@pytest.fixture(scope="session")
def talos_biped():
    return load_robot("talos_full")


@pytest.fixture(scope="session")
def talos(talos_biped):
    return FreeRobot(talos_biped.robot)


@pytest.fixture(scope="session")
def talos_gait():
    return load_gait(models_dir() / "talos_full.gait.json")


@pytest.fixture(scope="session")
def straight(talos_biped, talos_gait):
    return swept_walk(talos_biped, talos_gait, steps=3, step_length=0.2)


@pytest.fixture(scope="session")
def bend(talos_biped, talos_gait):
    return swept_walk(talos_biped, talos_gait, steps=3, step_length=0.2, turn=0.2)
