"""Files are read whole, or refused in one line."""

import os
from pathlib import Path

import pytest

from frontal_biped.exceptions import GaitFileError
from frontal_biped.files.reading import load_json, read_bytes


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ('{"a": 1, "a": 2}', "'a' is there twice"),
        ('{"a": NaN}', "NaN is no number"),
        ('{"a": -Infinity}', "-Infinity is no number"),
        ('{"a": ' + "9" * 5000 + "}", "a number of 5000 digits"),
        ('{"a": "\\ud800"}', "surrogates not allowed"),
        ("[" * 100_000, "nested too deep"),
        ('{"a": 1', "delimiter"),
        ("", "Expecting value"),
    ],
)
def test_what_is_no_json_is_refused_in_one_line(tmp_path, text, complaint):
    path = tmp_path / "a.json"
    path.write_text(text)
    with pytest.raises(GaitFileError, match=complaint) as caught:
        load_json(path, GaitFileError, "mend it")
    assert str(caught.value).startswith(str(path))
    assert str(caught.value).endswith("mend it")
    assert "\n" not in str(caught.value)


def test_bytes_that_are_no_text_are_refused(tmp_path):
    (tmp_path / "a.json").write_bytes(b"\xff\xfe")
    with pytest.raises(GaitFileError, match="not valid JSON"):
        load_json(tmp_path / "a.json", GaitFileError, "mend it")


@pytest.mark.parametrize("path", ["/dev/zero", "/dev/null"])
def test_a_device_is_not_read(path):
    with pytest.raises(GaitFileError, match="a device or a pipe"):
        read_bytes(Path(path), 10, GaitFileError, ".json file")


def test_a_pipe_is_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "pipe.json")
    with pytest.raises(GaitFileError, match="a device or a pipe"):
        read_bytes(tmp_path / "pipe.json", 10, GaitFileError, ".json file")


def test_a_folder_and_a_large_file_are_refused(tmp_path):
    with pytest.raises(GaitFileError, match="a directory"):
        read_bytes(tmp_path, 10, GaitFileError, ".json file")
    (tmp_path / "a.json").write_text("12345678901")
    with pytest.raises(GaitFileError, match="larger than 10 bytes"):
        read_bytes(tmp_path / "a.json", 10, GaitFileError, ".json file")
    assert read_bytes(tmp_path / "a.json", 11, GaitFileError, ".json file") == b"12345678901"
