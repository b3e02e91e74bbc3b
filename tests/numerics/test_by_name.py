"""Columns by name: a mapping like any other, and one line about a name that is none."""

import numpy as np
import pytest

from frontal_biped.exceptions import FrontalBipedError
from frontal_biped.numerics.by_name import Columns


def test_columns_are_a_mapping_of_views():
    values = np.arange(6.0).reshape(3, 2)
    columns = Columns(("left_hip", "right_hip"), values)
    assert list(columns) == ["left_hip", "right_hip"] and len(columns) == 2
    np.testing.assert_array_equal(columns["right_hip"], [1.0, 3.0, 5.0])
    assert np.shares_memory(columns["left_hip"], values)
    assert "left_knee" not in columns and columns.get("left_knee") is None


@pytest.mark.parametrize("kind", [KeyError, FrontalBipedError])
def test_a_wrong_name_is_refused_in_plain_words(kind):
    columns = Columns(("left_hip", "right_hip"), np.zeros((1, 2)), "motor")
    with pytest.raises(kind, match=r"^no motor 'left_hop'; did you mean 'left_hip'\?") as error:
        columns["left_hop"]
    assert str(error.value)[0] == "n"  # a KeyError would put it into quotes
    with pytest.raises(kind, match=r"^no motor 'x'; known: left_hip, right_hip$"):
        columns["x"]


def test_other_names_are_asked_for_once_and_only_when_needed():
    asked = []

    def others():
        asked.append(1)
        return Columns(("l_hip",), np.ones((2, 1)))

    columns = Columns(("left_hip",), np.zeros((2, 1)), others=others)
    assert columns["left_hip"][0] == 0.0 and not asked
    assert columns["l_hip"][0] == 1.0 and "l_hip" in columns and len(columns) == 1
    with pytest.raises(KeyError, match="known: left_hip, l_hip"):
        columns["x"]
    assert len(asked) == 1
