"""The specifications that come with the package."""

import pytest

from frontal_biped.exceptions import SpecificationError
from frontal_biped.gait import GaitSpecification, load_specification, specification_names


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
