"""The table of what looking ahead answers: what it says between its ends, and what a gait file may hold of it."""

import json
from dataclasses import replace

import numpy as np
import pytest

from frontal_biped.exceptions import GaitFileError
from frontal_biped.gait import gait_from_dict, gait_to_dict, load_gait, save_gait
from frontal_biped.gait.look_ahead_table import AROUND, Choice, Descent, LookAheadTable, Way, table_to_dict

PLAIN, REJOINED, BACK = Descent(Way.ANCHORED), Descent(Way.ANCHORED, 2), Descent(Way.RETRACED)


@pytest.fixture
def table():
    """Slow, as planned, fast, and so fast that the phase is stretched no more."""
    choices = (Choice(0.5, Descent(Way.RESCALED)), Choice(0.0, REJOINED), Choice(0.25, BACK), Choice(0.0, PLAIN))
    reversals = np.array([[-1.62, -1.61], [-1.60, -1.58], [-1.50, -1.48], [-1.45, -1.44]])
    ends = np.array([0.9, 0.98, 1.01, 1.1, 1.2])
    return LookAheadTable("digest", ends[:-1], ends[1:], choices, reversals)


@pytest.fixture
def tabled(gait, table):
    return replace(gait, look_ahead=table)


def test_stretch_is_that_of_the_interval(table):
    asked = (0.9, 0.95, 0.98, 1.0, 1.05, 1.15, 1.2)
    assert [table.stretch(ratio) for ratio in asked] == [0.5, 0.5, 0.0, 0.0, 0.25, 0.0, 0.0]
    assert table.stretch(0.899) is None
    assert table.stretch(1.201) is None


def test_descent_is_that_of_the_nearest_reversal_of_its_stretch(table):
    assert table.descent(0.0, -1.59) == REJOINED
    assert table.descent(1e-12, -1.57) == REJOINED  # a stretch read off a phase has its rounding
    assert table.descent(0.0, -1.446) == PLAIN
    assert table.descent(0.25, -1.51) == BACK
    assert table.descent(0.25, -1.50 - 1.1 * AROUND) is None
    assert table.descent(0.75, -1.5) is None


def test_file_gives_back_every_bit(tabled, tmp_path):
    save_gait(tabled, tmp_path / "gait.json")
    again = load_gait(tmp_path / "gait.json").look_ahead
    assert again.choices == tabled.look_ahead.choices
    assert again.made_for == "digest"
    for key in ("low", "high", "reversals"):
        assert np.array_equal(getattr(again, key), getattr(tabled.look_ahead, key))
    save_gait(replace(tabled, look_ahead=again), tmp_path / "again.json")
    assert (tmp_path / "again.json").read_bytes() == (tmp_path / "gait.json").read_bytes()


def test_file_without_a_table_is_as_ever(gait):
    assert "look_ahead" not in gait_to_dict(gait)
    assert gait.look_ahead is None


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"low": None}, "list of 1 to"),
        ({"way": ["anchored"]}, "unequal lengths"),
        ({"made_for": 3}, "made_for is not text"),
        ({"stretch": [0.0, 0.0, 0.0, "0.5"]}, "stretch holds '0.5'"),
        ({"reversal_low": [0.0, 0.0, 0.0, True]}, "reversal_low holds True"),
        ({"way": ["anchored", "sideways", "anchored", "anchored"]}, "way holds 'sideways'; known: anchored"),
        ({"rejoin": [None, 5, None, None]}, "rejoin holds 5, not null or 0 to 4"),
        ({"rejoin": [None, True, None, None]}, "rejoin holds True"),
        ({"high": [0.98, 1.02, 1.1, 1.2]}, "not intervals one after the other"),
        ({"more": []}, "not a table as it is written"),
    ],
)
def test_what_is_no_table_is_refused_in_one_line(tabled, table, change, told):
    content = json.loads(json.dumps(gait_to_dict(tabled)))
    content["look_ahead"] = {**table_to_dict(table), **change}
    with pytest.raises(GaitFileError, match=told) as refused:
        gait_from_dict(content, "file.json")
    assert str(refused.value).startswith("file.json: ")
    assert "\n" not in str(refused.value)


def test_two_steps_have_no_table(tabled):
    content = json.loads(json.dumps(gait_to_dict(tabled)))
    content["steps"] *= 2
    with pytest.raises(GaitFileError, match="beside two steps"):
        gait_from_dict(content, "file.json")
