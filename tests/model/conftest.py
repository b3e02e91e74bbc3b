"""Copies of the packaged robot's files to break."""

import shutil
from pathlib import Path

import pytest

from frontal_biped.model import models_dir


@pytest.fixture
def model_files(tmp_path: Path) -> tuple[Path, Path]:
    """(URDF, description) of frontal_biped in a folder of the test's own."""
    for suffix in (".urdf", ".toml"):
        shutil.copy(models_dir() / f"frontal_biped{suffix}", tmp_path)
    return tmp_path / "frontal_biped.urdf", tmp_path / "frontal_biped.toml"
