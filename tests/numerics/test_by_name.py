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
