"""A gait file finds its robot: where the two lie, and wherever they are moved together."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from frontal_biped.gait.file import load_gait, save_gait
from frontal_biped.gait.robot_path import (
    description_file,
    found_description,
    named_description,
    stored_description,
    with_found_description,
    with_stored_description,
)
from frontal_biped.model import models_dir
from frontal_biped.simulation import load_trajectory, save_trajectory


@pytest.fixture
def description(tmp_path):
    """Of a robot of one's own, in a folder of its own."""
    folder = tmp_path / "robots"
    folder.mkdir()
    return Path(shutil.copy(models_dir() / "frontal_biped.toml", folder / "mine.toml"))


@pytest.fixture
def mine(gait, description):
    """A gait of that robot."""
    return replace(gait, robot=replace(gait.robot, name="mine", description=named_description(description)))


def stored(path):
    return json.loads(path.read_text(encoding="utf-8"))["robot"]["description"]


@pytest.mark.parametrize("folder", ["robots", "robots/gaits", "gaits", "."])
def test_a_path_from_the_gait_file(mine, description, folder, tmp_path):
    path = tmp_path / folder / "gait.json"
    save_gait(mine, path)
    assert not Path(stored(path)).is_absolute()
    assert (path.parent / stored(path)).resolve() == description.resolve()
    assert load_gait(path).robot == mine.robot


def test_saved_elsewhere_it_still_names_its_robot(mine, description, tmp_path):
    save_gait(mine, tmp_path / "one" / "gait.json")
    save_gait(load_gait(tmp_path / "one" / "gait.json"), tmp_path / "two" / "deep" / "gait.json")
    assert stored(tmp_path / "two" / "deep" / "gait.json") == "../../robots/mine.toml"


@pytest.mark.parametrize("kept", ["robots", "gaits"])
def test_moved_with_its_robot(mine, description, kept, tmp_path):
    """The whole folder; or robot and gait, which lay apart, gathered in one."""
    save_gait(mine, tmp_path / kept / "gait.json")
    moved = tmp_path / "moved"
    moved.mkdir()
    shutil.move(tmp_path / kept / "gait.json", moved / "gait.json")
    shutil.move(description, moved / "mine.toml")
    assert description_file(load_gait(moved / "gait.json").robot.description) == moved.resolve() / "mine.toml"


def test_where_the_working_folder_is_does_not_matter(mine, description, tmp_path, monkeypatch):
    save_gait(mine, tmp_path / "robots" / "gait.json")
    monkeypatch.chdir(tmp_path / "robots")
    assert load_gait("gait.json").robot == mine.robot
    assert named_description(Path("mine.toml")) == mine.robot.description
    monkeypatch.chdir(tmp_path)
    assert load_gait("robots/gait.json").robot == mine.robot


def test_a_robot_that_is_gone_is_named_by_the_path_that_was_followed(mine, description, tmp_path):
    save_gait(mine, tmp_path / "gaits" / "gait.json")
    description.unlink()
    assert load_gait(tmp_path / "gaits" / "gait.json").robot.description == str(description.resolve())


@pytest.mark.parametrize("name", ["g1", "frontal_biped"])
def test_a_packaged_robot_keeps_its_bare_name(gait, name, tmp_path):
    file = named_description(models_dir() / f"{name}.toml")
    assert file == f"{name}.toml" == stored_description(file, tmp_path) == found_description(file, tmp_path)
    assert description_file(file) == models_dir() / file
    shipped = models_dir() / f"{name}.gait.json"
    if shipped.is_file():
        save_gait(load_gait(shipped), tmp_path / shipped.name)
        assert (tmp_path / shipped.name).read_bytes() == shipped.read_bytes()


def test_what_lies_beside_the_gait_goes_before_what_is_packaged(tmp_path):
    shutil.copy(models_dir() / "g1.toml", tmp_path)
    assert description_file(found_description("g1.toml", tmp_path)) == tmp_path.resolve() / "g1.toml"


def test_a_link_is_followed_by_name(tmp_path):
    """The URDF lies beside the link, not beside what it leads to."""
    (tmp_path / "store").mkdir()
    (tmp_path / "robot").mkdir()
    shutil.copy(models_dir() / "frontal_biped.toml", tmp_path / "store" / "abc")
    (tmp_path / "robot" / "mine.toml").symlink_to(tmp_path / "store" / "abc")
    assert named_description(tmp_path / "robot" / "mine.toml") == str((tmp_path / "robot").resolve() / "mine.toml")


def test_a_run_finds_it_too(walk, mine, description, tmp_path):
    content = {**walk.gait, "robot": {**walk.gait["robot"], "description": mine.robot.description}}
    save_trajectory(replace(walk, gait=content), tmp_path / "runs" / "run.npz")
    assert load_trajectory(tmp_path / "runs" / "run.npz").gait == content
    shutil.move(description, tmp_path / "runs" / "mine.toml")
    found = load_trajectory(tmp_path / "runs" / "run.npz").gait["robot"]["description"]
    assert found == str((tmp_path / "runs").resolve() / "mine.toml")


@pytest.mark.parametrize("content", [{}, {"robot": "mine"}, {"robot": {"description": 3}}, ["robot"], None])
def test_what_is_no_gait_is_left_as_it_is(content, tmp_path):
    assert with_stored_description(content, tmp_path) is content
    assert with_found_description(content, tmp_path) is content
