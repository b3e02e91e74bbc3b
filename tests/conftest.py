"""Robots, independently computed numbers and designed gaits that the tests share."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import settings
from robot_files import write_robot

from frontal_biped.design import DesignResult, design_gait
from frontal_biped.gait import Gait, GaitSpecification, load_gait, load_specification
from frontal_biped.model import FrontalBiped, load_robot
from frontal_biped.simulation import Trajectory, orbit_trajectory, simulate

# Fixtures are expensive and read-only; a slow machine is no failure; the same examples in every run.
settings.register_profile("physics", max_examples=25, deadline=None, derandomize=True)
settings.load_profile("physics")

ROBOTS = ("table1", "table1_low_torso", "raised_ankle")
"""Robots of data/independent_values.json: Table I, its literal torso, one with raised and offset feet."""

_INDEPENDENT = json.loads((Path(__file__).parent / "data" / "independent_values.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="session")
def independent() -> Mapping[str, Any]:
    """Numbers of a separately written symbolic model, by robot."""
    return _INDEPENDENT["robots"]


@pytest.fixture(scope="session")
def biped() -> FrontalBiped:
    return load_robot("frontal_biped")


@pytest.fixture(scope="session")
def low_torso() -> FrontalBiped:
    return load_robot("frontal_biped_low_torso")


@pytest.fixture(scope="session")
def raised_ankle(tmp_path_factory: pytest.TempPathFactory, independent: Mapping[str, Any]) -> FrontalBiped:
    folder = tmp_path_factory.mktemp("raised_ankle")
    return load_robot(write_robot(folder, "raised_ankle", independent["raised_ankle"]["parameters"]))


@pytest.fixture(scope="session")
def robots(biped: FrontalBiped, low_torso: FrontalBiped, raised_ankle: FrontalBiped) -> Mapping[str, FrontalBiped]:
    """The three robots under the names of the independent numbers."""
    return dict(zip(ROBOTS, (biped, low_torso, raised_ankle), strict=True))


@pytest.fixture(scope="session", params=ROBOTS)
def robot_name(request: pytest.FixtureRequest) -> str:
    """Runs a test once for each robot."""
    return str(request.param)


@pytest.fixture(scope="session")
def robot(robots: Mapping[str, FrontalBiped], robot_name: str) -> FrontalBiped:
    return robots[robot_name]


@pytest.fixture(scope="session")
def reference_design(biped: FrontalBiped) -> DesignResult:
    """Gait design with every specification at its default."""
    return design_gait(biped, GaitSpecification())


@pytest.fixture(scope="session")
def level_design(biped: FrontalBiped) -> DesignResult:
    """The same with the pelvis level to five degrees."""
    return design_gait(biped, GaitSpecification(max_pelvis_roll=float(np.radians(5.0))))


@pytest.fixture(scope="session")
def reference_gait(reference_design: DesignResult) -> Gait:
    assert reference_design.gait is not None, reference_design.message
    return reference_design.gait


@pytest.fixture(scope="session")
def level_gait(level_design: DesignResult) -> Gait:
    assert level_design.gait is not None, level_design.message
    return level_design.gait


@pytest.fixture(scope="session")
def robust_gait(biped: FrontalBiped) -> Gait:
    """The gait of the shipped specification `robust`."""
    result = design_gait(biped, load_specification("robust"))
    assert result.gait is not None, result.message
    return result.gait


# ---------------------------------------------------------------------- a run to draw
@pytest.fixture(scope="session")
def gait() -> Gait:
    """Stored, so that these tests wait for no optimiser; nothing here depends on its quality."""
    return load_gait(Path(__file__).parent / "data" / "gait.json")


@pytest.fixture(scope="session")
def orbit(biped: FrontalBiped, gait: Gait) -> Trajectory:
    return orbit_trajectory(biped, gait)


@pytest.fixture(scope="session")
def walk(biped: FrontalBiped, gait: Gait) -> Trajectory:
    run = simulate(biped, gait, steps=4)
    assert not run.fell
    return run


@pytest.fixture(scope="session", params=["orbit", "walk"])
def trajectory(request: pytest.FixtureRequest, orbit: Trajectory, walk: Trajectory) -> Trajectory:
    """The orbit in closed form, then the simulated walk."""
    return {"orbit": orbit, "walk": walk}[request.param]
