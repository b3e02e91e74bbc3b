"""The asked way of a run: its corners, and nothing of what is no way."""

from types import SimpleNamespace

import numpy as np
import pytest

from frontal_biped.simulation.space.asked_path import asked_corners


def of(path):
    return asked_corners(SimpleNamespace(settings={} if path is None else {"path": path}))


def test_places_where_the_robot_only_turns_or_stands_are_no_corners():
    corners = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0], [2.0, 1.0, 1.57], [2.0, 2.0, 1.57], [2.0, 2.0, 1.57]]
    expected = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [2.0, 2.0]]
    np.testing.assert_array_equal(of({"corners": corners}), expected)


@pytest.mark.parametrize("path", [
    None, "forward", {}, {"corners": None}, {"corners": []}, {"corners": [[0.0, 0.0, 0.0]]}, {"corners": [[1.0, 2.0]]},
    {"corners": [["a", "b", "c"]]}, {"corners": [[1.0, float("nan"), 0.0]]}, {"corners": [[1e300, 0.0, 0.0]]},
    {"corners": [[1.0, 0.0, 0.0], [1.0]]},
])  # fmt: skip
def test_what_is_no_way_is_none(path):
    assert of(path).shape == (0, 2)
