"""A stored gait, its periodic orbit, a short simulated walk, and a browser."""

import os
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from frontal_biped.gait import Gait, load_gait
from frontal_biped.model import FrontalBiped
from frontal_biped.simulation import Trajectory
from frontal_biped.visualisation import orbit_trajectory
from frontal_biped.visualisation.headless import CHROMIUM_OPTIONS
from frontal_biped.walking import simulate


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


@pytest.fixture(scope="session")
def chromium() -> str:
    """Where Chromium is."""
    executable = shutil.which("chromium")
    if executable is None:
        # continuous integration installs it: there its absence is a failure
        assert not os.environ.get("CI"), "no chromium on the PATH"
        pytest.skip("no chromium on the PATH")
    return executable


@pytest.fixture(scope="module")
def browser(chromium: str) -> Iterator[object]:
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=chromium, args=list(CHROMIUM_OPTIONS))
        yield opened
        opened.close()
