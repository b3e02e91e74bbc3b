"""Robots of example-robot-data, wherever it is installed, without its loaders."""

import importlib.metadata
import sys

import pytest

from frontal_biped.exceptions import RobotError
from frontal_biped.model import load_robot, models_dir
from frontal_biped.model.urdf import packages
from frontal_biped.model.urdf.packages import example_robot_data_dir, resolve_urdf


def not_installed(name):
    raise importlib.metadata.PackageNotFoundError(name)


def test_the_installed_data_are_found():
    folder = example_robot_data_dir()
    assert (folder / "talos_data").is_dir()
    assert "example_robot_data" not in sys.modules  # the loaders


def test_a_ros_or_conda_prefix_is_searched(tmp_path, monkeypatch):
    share = tmp_path / "prefix/share/example-robot-data/robots"
    (share / "mine").mkdir(parents=True)
    (share / "mine/mine.urdf").write_text("<robot/>")
    monkeypatch.setattr(packages, "distribution", not_installed)
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"{tmp_path / 'empty'}:{tmp_path / 'prefix'}")
    assert example_robot_data_dir() == share
    assert resolve_urdf("x", "example-robot-data:mine/mine.urdf", tmp_path) == share / "mine/mine.urdf"


def test_missing_data_are_named_with_the_remedy(tmp_path, monkeypatch):
    monkeypatch.setattr(packages, "distribution", not_installed)
    monkeypatch.delenv("AMENT_PREFIX_PATH", raising=False)
    monkeypatch.setattr(sys, "prefix", str(tmp_path))
    with pytest.raises(RobotError, match="pip install example-robot-data"):
        load_robot("talos_full")


def test_without_data_the_other_robots_are_listed(tmp_path, monkeypatch, capsys):
    from frontal_biped.cli import main

    monkeypatch.setattr(packages, "distribution", not_installed)
    monkeypatch.delenv("AMENT_PREFIX_PATH", raising=False)
    monkeypatch.setattr(sys, "prefix", str(tmp_path))
    assert main(["robots"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert any(line.startswith("frontal_biped ") and "60.70" in line for line in lines)
    assert any(line.startswith("g1 ") and "not available" in line and "pip install" in line for line in lines)


def test_no_packaged_description_names_a_folder_of_one_machine():
    for path in models_dir().glob("*.toml"):
        assert "/" not in path.read_text(encoding="utf-8").split('urdf = "')[1].split(":")[0], path
