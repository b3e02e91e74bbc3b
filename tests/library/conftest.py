"""A small library, designed once."""

from pathlib import Path

import pytest

from frontal_biped.library import LibraryReport, Sweep, build_library
from frontal_biped.library.sweep import sweep_from_dict


@pytest.fixture(scope="session")
def sweep() -> Sweep:
    """Two widths, three bounds of the pelvis; the last bound cannot be met together with the clearance."""
    return sweep_from_dict(
        {
            "batch": 2,
            "specification": {"swing_clearance": 0.012},
            "sweep": {"step_width": [[0.28, 0.28], [0.32, 0.32]], "max_pelvis_roll": [0.16, 0.14, 0.12]},
        },
        "sweep",
    )


@pytest.fixture(scope="session")
def built(sweep: Sweep, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, LibraryReport]:
    """Folder and report of the library, designed one gait after another."""
    folder = tmp_path_factory.mktemp("library") / "gaits"
    return folder, build_library(sweep, folder)
