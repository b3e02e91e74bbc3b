"""One table says what arrays are to be; what is not is told by name, place and value."""

import numpy as np
import pytest

from frontal_biped.files.array_schema import FREELY, MOST_BYTES, ArraySchema, require_shapes, require_values
from frontal_biped.files.npz import Head

SCHEMA = {
    "t": ArraySchema(ordered=True),
    "q": ArraySchema((2,), least=-3.0, most=3.0, posture=True),
    "p": ArraySchema(gaps=True),
    "sign": ArraySchema(among=(-1.0, 1.0)),
    "event": ArraySchema(rows=2, whole=True, least=0.0),
}


def arrays(**changes):
    good = {
        "t": np.arange(3.0), "q": np.ones((3, 2)), "p": np.ones(3), "sign": np.array([1.0, -1.0, 1.0]),
        "event": np.array([0.0, 1.0]),
    }  # fmt: skip
    return good | {name: np.array(value, dtype=float) for name, value in changes.items()}


def heads(**changes):
    shapes = {name: array.shape for name, array in arrays().items()} | changes
    return {name: Head("<f8", shape, False, 128) for name, shape in shapes.items()}


def test_what_is_right_passes():
    require_shapes(heads(), SCHEMA, 1000)
    require_values(arrays(), SCHEMA)
    require_values(arrays(p=[np.nan] * 3), SCHEMA)


@pytest.mark.parametrize(
    ("changes", "match"),
    [
        ({"t": [0.0, 2.0, 1.0]}, r"t\[2\] = 1 is less than the one before it"),
        ({"t": [0.0, np.nan, 1.0]}, r"t\[1\] = nan is no number"),
        ({"p": [0.0, np.nan, np.inf]}, r"p\[2\] = inf is not from"),
        ({"q": [[0, 0], [0, 4], [0, 0]]}, r"q\[1, 1\] = 4 is not from -3 to 3"),
        ({"q": [[0, 4], [0, 4], [0, 4]]}, r"q\[0, 1\] = 4"),
        ({"sign": [1.0, 0.0, 1.0]}, r"sign\[1\] = 0 is none of -1, 1"),
        ({"event": [0.0, 0.5]}, r"event\[1\] = 0.5 is no whole number"),
        ({"event": [-1.0, 0.0]}, r"event\[0\] = -1 is not from 0"),
    ],
)
def test_values(changes, match):
    with pytest.raises(ValueError, match=match):
        require_values(arrays(**changes), SCHEMA)


def test_nothing_is_asked_of_rows_behind_a_divergence_but_order():
    gone = {"q": [[0, 0], [0, 0], [9, np.nan]], "p": [0.0, 0.0, np.inf]}
    require_values(arrays(**gone), SCHEMA)
    with pytest.raises(ValueError, match="sign"):
        require_values(arrays(**gone, sign=[1.0, 1.0, 0.0]), SCHEMA)


@pytest.mark.parametrize(
    ("changes", "match"),
    [
        ({"q": (3, 3)}, r"q is float64 of shape \(3, 3\), not numbers of shape \(3, 2\)"),
        ({"t": ()}, r"t is float64 of shape \(\), not numbers of shape \(1,\)"),
        ({"event": (3,)}, r"event .* not numbers of shape \(2,\)"),
        ({"t": (0,), "q": (0, 2), "p": (0,), "sign": (0,)}, "not one sample"),
    ],
)
def test_shapes(changes, match):
    with pytest.raises(ValueError, match=match):
        require_shapes(heads(**changes), SCHEMA, 1000)


@pytest.mark.parametrize(("size", "most"), [(1000, FREELY), (10**9, MOST_BYTES)])
def test_sizes(size, most):
    """Of five numbers a sample, and two more."""
    rows = most // 8 // 5

    def all_of(count):
        return heads(t=(count,), q=(count, 2), p=(count,), sign=(count,))

    require_shapes(all_of(rows - 1), SCHEMA, size)
    with pytest.raises(ValueError, match="samples are"):
        require_shapes(all_of(rows), SCHEMA, size)
