"""Reports as JSON: what JSON does not know becomes what it does, at any depth."""

import json
from enum import Enum

from frontal_biped.files.json_values import for_json


class Colour(Enum):
    RED = "red"


def test_every_value_becomes_one_that_json_has():
    table = {
        "a": (1, 2.5, float("nan")),
        "b": {"c": [float("inf"), -float("inf"), {"d": (Colour.RED,)}]},
        "e": "text",
        "f": None,
        "g": True,
    }
    plain = for_json(table)
    assert json.loads(json.dumps(plain, allow_nan=False)) == plain
    assert plain == {"a": [1, 2.5, None], "b": {"c": [None, None, {"d": ["red"]}]}, "e": "text", "f": None, "g": True}
