"""Files that appear whole or not at all."""

import json

import pytest

from frontal_biped.files.atomic import atomic_path, write_json, write_text


def test_the_file_appears_only_when_complete(tmp_path):
    target = tmp_path / "out.txt"
    with atomic_path(target) as temporary:
        temporary.write_text("half")
        assert not target.exists()
        assert temporary.parent == target.parent
    assert target.read_text() == "half"
    assert list(tmp_path.iterdir()) == [target]


def test_an_error_on_the_way_leaves_the_old_file_and_nothing_else(tmp_path):
    target = tmp_path / "out.txt"
    write_text(target, "old")
    with pytest.raises(RuntimeError, match="on the way"), atomic_path(target) as temporary:
        temporary.write_text("new")
        raise RuntimeError("on the way")
    assert target.read_text() == "old"
    assert list(tmp_path.iterdir()) == [target]


def test_numbers_that_json_cannot_say_become_null(tmp_path):
    target = tmp_path / "out.json"
    write_json(target, {"a": 0.1, "b": [float("nan"), {"c": float("inf")}]})
    assert json.loads(target.read_text()) == {"a": 0.1, "b": [None, {"c": None}]}
