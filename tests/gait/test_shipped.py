"""The gaits and the specifications that come with the package."""

import pytest

from frontal_biped.exceptions import GaitFileError, SpecificationError
from frontal_biped.gait import GaitSpecification, gait_names, load_gait, load_specification, specification_names
from frontal_biped.model import models_dir, robot_names


def test_every_shipped_specification_can_be_read():
    assert "robust" in specification_names()
    for name in specification_names():
        assert isinstance(load_specification(name), GaitSpecification)


def test_a_file_is_read_as_before(tmp_path):
    (tmp_path / "mine.toml").write_text("degree = 6\n")
    assert load_specification(tmp_path / "mine.toml").degree == 6
    with pytest.raises(SpecificationError, match="no such file"):
        load_specification(tmp_path / "absent.toml")


def test_an_unknown_name_gets_a_suggestion():
    with pytest.raises(SpecificationError, match="did you mean 'robust'"):
        load_specification("robst")
    with pytest.raises(SpecificationError, match=r"known: .*robust"):
        load_specification("xyz")


def test_every_packaged_gait_loads_by_the_name_of_its_robot():
    assert {"g1", "talos_full", "romeo_bent"} <= set(gait_names()) <= set(robot_names())
    for name in gait_names():
        gait = load_gait(name)
        assert gait.robot.name == name
        assert gait.orbit == load_gait(models_dir() / f"{name}.gait.json").orbit
    assert load_gait("g1.gait.json").orbit == load_gait("g1").orbit


def test_a_file_of_that_name_goes_first(gait, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "g1").write_text("{", encoding="utf-8")
    with pytest.raises(GaitFileError, match="g1: not valid JSON"):
        load_gait("g1")


@pytest.mark.parametrize(
    ("name", "match"),
    [
        ("gg1", "no gait 'gg1'; did you mean 'g1'"),
        ("frontal_biped", "comes without one; design it with `frontal-biped design --robot frontal_biped`"),
        ("xyz", "or one of alexander, g1, "),
        ("xyz.json", "no such gait file"),
        ("nowhere/g1", "no such gait file"),
    ],
)
def test_a_gait_that_is_not_there(name, match):
    with pytest.raises(GaitFileError, match=match):
        load_gait(name)
