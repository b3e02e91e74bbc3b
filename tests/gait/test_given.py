"""A gait as it is given to a function, and a specification by name."""

from types import SimpleNamespace

import pytest

from frontal_biped.exceptions import DesignFailedError, GaitFileError, SpecificationError
from frontal_biped.gait import GaitSpecification, load_gait, load_specification, read_specification
from frontal_biped.gait.given import gait_of
from frontal_biped.gait.shipped import gait_path, specifications_dir


def test_a_gait_is_taken_as_itself_as_a_result_by_name_and_by_path():
    gait = load_gait("g1")
    assert gait_of(gait) is gait
    assert gait_of(SimpleNamespace(gait=gait, message="")) is gait
    for given in ("g1", "g1.gait.json", gait_path("g1"), str(gait_path("g1"))):
        assert gait_of(given).orbit == gait.orbit


def test_a_design_without_a_gait_says_why():
    with pytest.raises(DesignFailedError, match="found no gait: step_width too small"):
        gait_of(SimpleNamespace(gait=None, message="step_width too small"))


@pytest.mark.parametrize("nothing", [None, 3, object(), SimpleNamespace(gait="g1")])
def test_what_is_no_gait_is_refused(nothing):
    with pytest.raises(GaitFileError, match="no gait; give one"):
        gait_of(nothing)


def test_a_specification_by_name_by_the_name_of_its_file_and_by_path(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    packaged = load_specification("rough")
    assert packaged != GaitSpecification()
    path = specifications_dir() / "rough.toml"
    assert load_specification("rough.toml") == read_specification(str(path)) == read_specification(path) == packaged
    (tmp_path / "rough.toml").write_text("friction = 0.3\n", encoding="utf-8")
    assert load_specification("rough.toml").friction == 0.3  # a file that is there comes first
    with pytest.raises(SpecificationError, match="no such file"):
        load_specification("smooth.toml")
