"""What stands in a header is what it is to be, or is told by key and value."""

import pytest

from frontal_biped.files.header_schema import COUNT, LINE, NAMES, TABLE, require_entries, words_among

SCHEMA = {"name": LINE, "joints": NAMES, "steps": COUNT, "more": TABLE, "kinds": words_among(frozenset({"A", "B"}))}
GOOD = {"name": "robot", "joints": ["a", "b"], "steps": 0, "more": {}, "kinds": ["B", "A", "B"]}


def test_others_are_left():
    assert require_entries({**GOOD, "unknown": 3}, SCHEMA) == GOOD


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("name", "", "a line of text"),
        ("name", "two\nlines", "a line of text"),
        ("joints", ["a", "a"], "a list of different names"),
        ("joints", "ab", "a list of different names"),
        ("steps", True, "a whole number of 0 or more"),
        ("steps", -1, "a whole number of 0 or more"),
        ("steps", 1.0, "a whole number of 0 or more"),
        ("more", [], "a JSON object"),
        ("kinds", ["C"], "a list of words among A, B"),
        ("kinds", [["A"]], "a list of words among A, B"),
    ],
)
def test_refused(key, value, words):
    with pytest.raises(ValueError, match=f"{key} = .* is not {words}"):
        require_entries(GOOD | {key: value}, SCHEMA)
    with pytest.raises(ValueError, match=f"header has no {key}"):
        require_entries({name: value for name, value in GOOD.items() if name != key}, SCHEMA)
