"""TOML files are read whole or refused in one short line, whatever is in them."""

import os
import time

import pytest

from frontal_biped.exceptions import RobotError
from frontal_biped.files.quoted import listed, quoted
from frontal_biped.files.toml import finite_number, load_toml, reject_unknown_keys, respelt_keys


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("a = " + "9" * 5000, "a whole number has thousands of digits"),
        ("a = " + "[" * 100_000, "nested too deep"),
        ("a" + ".a" * 400_000 + " = 1", "a key has more than 50 dots"),
        ("[" + '"a" . ' * 60 + "a]", "a key has more than 50 dots"),
        ("a = 1\na = 2", "overwrite"),
        ("a = 1979-13-45", "line 1"),
        ('a = "\\ud800"', "scalar value"),
        ("a = 'x\0'", "invalid character"),
        ("a = \udce9", "utf-8"),
    ],
)
def test_what_is_no_toml_is_refused_at_once(tmp_path, text, complaint):
    path = tmp_path / "a.toml"
    path.write_bytes(text.encode("utf-8", errors="surrogateescape"))
    began = time.process_time()
    with pytest.raises(RobotError, match=complaint) as caught:
        load_toml(path, RobotError)
    assert time.process_time() - began < 5.0
    assert str(caught.value).startswith(str(path))
    assert str(caught.value).isprintable()
    assert len(str(caught.value)) < 300


def test_a_byte_order_mark_is_passed_over(tmp_path):
    (tmp_path / "a.toml").write_bytes(b"\xef\xbb\xbfa = 1\r\n")
    assert load_toml(tmp_path / "a.toml", RobotError) == {"a": 1}


def test_devices_pipes_folders_and_large_files_are_not_read(tmp_path):
    from pathlib import Path

    os.mkfifo(tmp_path / "pipe.toml")
    (tmp_path / "large.toml").write_text("#" * 1_000_001)
    for path in (Path("/dev/zero"), tmp_path / "pipe.toml", tmp_path, tmp_path / "large.toml"):
        with pytest.raises(RobotError, match=r"device or a pipe|directory|larger than"):
            load_toml(path, RobotError)


@pytest.mark.parametrize("text", ["0x" + "f" * 6000, "1e400", "nan", "-inf", "1979-05-27", "07:32:00", "true", "'1'"])
def test_what_is_no_finite_number(tmp_path, text):
    """A hexadecimal number may be so long that Python does not print it."""
    (tmp_path / "a.toml").write_text(f"a = {text}")
    with pytest.raises(RobotError, match="is not a finite number") as caught:
        finite_number("a", load_toml(tmp_path / "a.toml", RobotError)["a"], RobotError)
    assert len(str(caught.value)) < 150


def test_unknown_keys_are_told_short_and_in_one_line():
    for key in ("a\nb", "\x1b[2J", "x" * 100_000, ""):
        with pytest.raises(RobotError, match="unknown key") as caught:
            reject_unknown_keys("f", {key: 1}, ("colour",), RobotError)
        assert str(caught.value).isprintable() and len(str(caught.value)) < 200


def test_many_keys_are_not_respelt_one_by_one():
    began = time.process_time()
    respelt_keys({f"color{i}": i for i in range(100_000)} | {"x" * 1_000_000: 1}, [f"key{i}" for i in range(20)])
    assert time.process_time() - began < 1.0
    assert respelt_keys({"color": 1}, ("colour",)) == {"colour": 1}


def test_values_are_quoted_short():
    assert quoted("a\nb") == "'a\\nb'"
    assert quoted(3) == "3"
    for value in ("x" * 10**7, [1] * 10**6, {"a": list(range(1000))}, 10**4000, 16**6000, "\ud800" * 100):
        assert quoted(value).isprintable() and len(quoted(value)) <= 60
    assert listed(["a", "b"]) == "a, b"
    assert listed(["x" * 1000] * 30).endswith("... and 10 more")
