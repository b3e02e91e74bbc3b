"""What a file is, is told by what stands in it; one given for another is named as what it is."""

import shutil

import numpy as np
import pytest

from frontal_biped.exceptions import GaitFileError, TrajectoryFileError
from frontal_biped.files.kinds import named_kind
from frontal_biped.gait import load_gait, save_gait
from frontal_biped.model import models_dir
from frontal_biped.simulation import load_trajectory, save_trajectory


@pytest.fixture
def files(gait, walk, tmp_path):
    """A gait and a run under names that do not tell."""
    save_gait(gait, tmp_path / "gait.json")
    save_trajectory(walk, tmp_path / "run.npz")
    for name in ("gait.json", "run.npz"):
        shutil.copy(tmp_path / name, tmp_path / name.split(".")[0])
    return tmp_path


def test_words_for_each(files):
    np.savez(files / "other.npz", x=np.zeros(3))
    (files / "other.json").write_text("[1]", encoding="utf-8")
    assert [named_kind(files / name) for name in ("gait", "gait.json", "run", "run.npz")] == [
        "a gait", "a gait", "a run in the plane", "a run in the plane",
    ]  # fmt: skip
    assert named_kind(models_dir() / "frontal_biped.urdf") == "a URDF"
    assert [named_kind(files / name) for name in ("other.npz", "other.json", "absent", ".")] == [None] * 4


def test_one_given_for_the_other_is_named(files):
    for name in ("run", "run.npz"):
        with pytest.raises(GaitFileError, match=f"{name}: is a run in the plane, not a gait; "):
            load_gait(files / name)
    for name in ("gait", "gait.json"):
        with pytest.raises(TrajectoryFileError, match=f"{name}: is a gait, not a run in the plane; "):
            load_trajectory(files / name)
    with pytest.raises(GaitFileError, match="is a TOML file, not a gait"):
        load_gait(models_dir() / "g1.toml")
