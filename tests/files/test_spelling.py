"""British and American words are the same words."""

import pytest

from frontal_biped.exceptions import RobotError, ScenarioError
from frontal_biped.files.spelling import respelt
from frontal_biped.files.table import Table
from frontal_biped.files.toml import respelt_keys
from frontal_biped.model.urdf.description import read_description


@pytest.mark.parametrize(
    ("british", "american"),
    [
        ("stabiliser", "stabilizer"),
        ("quantisation", "quantization"),
        ("symmetrise", "symmetrize"),
        ("colour", "color"),
        ("analyse", "analyze"),
        ("centre", "center"),
        ("--stabiliser", "--stabilizer"),
    ],
)
def test_either_finds_the_other(british, american):
    assert respelt(american, ["steps", british]) == british
    assert respelt(british, ["steps", american]) == american
    assert respelt(british, [american, british]) == british


@pytest.mark.parametrize("word", ["size", "horizon", "step", "stabilise", ""])
def test_other_words_are_left(word):
    assert respelt(word, ["stabiliser", "sizes", "colour"]) == word


def test_keys_of_a_table():
    assert respelt_keys({"stabilizer": 1, "torque": 2}, ("stabiliser",)) == {"stabiliser": 1, "torque": 2}
    both = {"stabilizer": 1, "stabiliser": 2}
    assert respelt_keys(both, ("stabiliser",)) == both  # neither is dropped: the unknown one is told


def test_keys_of_a_scenario():
    assert "quantisation" in Table("s.toml:", {"quantization": 0.1}, ("quantisation",))
    with pytest.raises(ScenarioError, match="unknown key 'quantization'"):
        Table("s.toml:", {"quantization": 0.1, "quantisation": 0.2}, ("quantisation",))


def test_keys_of_a_description(tmp_path):
    text = (
        'name = "a"\nurdf = "a.urdf"\nsymmetrize = {}\n[joints]\nleft_ankle = "a"\nleft_hip = "b"\nright_hip = "c"\n'
        'right_ankle = "d"\n[sole]\ninner = 0.05\nouter = 0.05\n'
    )
    (tmp_path / "a.urdf").touch()
    (tmp_path / "a.toml").write_text(text.format("true"), encoding="utf-8")
    assert read_description(tmp_path / "a.toml").symmetrise
    (tmp_path / "a.toml").write_text(text.format('"yes"'), encoding="utf-8")
    with pytest.raises(RobotError, match="symmetrise"):
        read_description(tmp_path / "a.toml")
