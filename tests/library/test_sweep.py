"""Sweep files: the grid they mean, and what is refused."""

import datetime
import time

import pytest

from frontal_biped.exceptions import SpecificationError
from frontal_biped.library import read_sweep
from frontal_biped.library.sweep import sweep_from_dict

TEXT = """
robot = ["frontal_biped", "frontal_biped_low_torso"]
batch = 3
[specification]
friction = 0.5
[sweep]
step_width = [[0.25, 0.25], [0.30, 0.32]]
max_pelvis_roll = {from = 0.1, to = 0.2, count = 5}
"""


@pytest.fixture
def sweep(tmp_path):
    path = tmp_path / "sweep.toml"
    path.write_text(TEXT)
    return read_sweep(path)


def test_grid(sweep):
    points = sweep.points()
    assert len(points) == 2 * 2 * 5
    assert [point.number for point in points] == list(range(20))
    assert [point.swept["max_pelvis_roll"] for point in points[:5]] == [0.1, 0.125, 0.15, 0.175, 0.2]
    assert points[7].specification.step_width == (0.30, 0.32)
    assert points[7].specification.max_pelvis_roll == 0.15
    assert all(point.specification.friction == 0.5 for point in points)
    assert points[9].robot != points[10].robot


def test_batches_are_runs_of_neighbours(sweep):
    """They cover the grid once, in order, and never cross from one line of the last axis to the next."""
    batches = sweep.batches()
    assert [len(batch) for batch in batches] == [3, 2] * 4
    assert [point.number for batch in batches for point in batch] == list(range(20))
    for batch in batches:
        assert len({(point.robot, point.specification.step_width) for point in batch}) == 1


def test_there_and_back(sweep):
    assert sweep_from_dict(sweep.as_dict(), "again").points() == sweep.points()


def test_no_axis_is_one_gait():
    sweep = sweep_from_dict({}, "empty")
    assert len(sweep.points()) == 1
    assert sweep.batches() == (sweep.points(),)


@pytest.mark.parametrize(
    ("table", "word"),
    [
        ({"sweeps": {}}, "did you mean 'sweep'"),
        ({"robot": 3}, "robot = 3"),
        ({"robot": []}, "robot = []"),
        ({"batch": 0}, "batch = 0"),
        ({"batch": True}, "batch = True"),
        ({"sweep": []}, "write [sweep]"),
        ({"sweep": {"frictions": [0.5]}}, "did you mean 'friction'"),
        ({"sweep": {"friction": []}}, "sweep.friction"),
        ({"sweep": {"friction": 0.5}}, "sweep.friction"),
        ({"sweep": {"friction": {"from": 0.1, "to": 0.2}}}, "'count' is missing"),
        ({"sweep": {"friction": {"from": 0.1, "to": 0.2, "count": 0}}}, "count = 0"),
        ({"sweep": {"friction": {"from": 0.1, "to": "x", "count": 2}}}, "'x'"),
        ({"sweep": {"friction": {"from": 0.1, "to": 0.2, "number": 2}}}, "unknown key 'number'"),
        ({"sweep": {"friction": [0.5, -1.0]}}, "friction = -1"),
        ({"sweep": {"friction": [0.5]}, "specification": {"friction": 0.5}}, "keep one of them"),
        ({"specification": {"friction": "high"}}, "high"),
        ({"sweep": {"friction": {"from": 0.1, "to": 0.2, "count": 2_000_000}}}, "split the sweep"),
        ({"sweep": {"friction": {"from": 0.1, "to": 0.2, "count": 10**9}}}, "split the sweep"),
        ({"sweep": {"friction": {"from": 0.1, "to": 0.2, "count": 16**6000}}}, "split the sweep"),
        ({"sweep": {"friction": {"from": -1e308, "to": 1e308, "count": 3}}}, "friction"),
        ({"sweep": {"friction": {"from": 0.1, "to": 0.2, "count": True}}}, "count = True"),
        ({"sweep": {"friction": [datetime.date(1979, 5, 27)]}}, "1979"),
        ({"sweep": {"friction": [0.1] * 1000, "fri_margin": [0.01] * 101}}, "the grid has 101000 points"),
        ({"batch": 10**6}, "batch = 1000000"),
        ({"robot": ["g1", "romeo", "g1"]}, "'g1' stands twice"),
        ({"sweep": {"step_width": [[0.2, 0.3], [0.3, 0.3], [0.2, 0.3]]}}, "[0.2, 0.3] stands twice"),
        ({"sweep": {"travel": [0.02, 0.04]}}, "sweep.travel: a library holds gaits of equal steps"),
        ({"specification": {"double_support": [0.1, 0.2]}}, "design such gaits one by one"),
        ({"robot": ["a\0"]}, "neither a name nor a list of names"),
        ({"robot": "\x1b[2J"}, "neither a name nor a list of names"),
        ({"specification": {"friction": 1e308}}, "friction = 1e+308 is above"),
    ],
)
def test_refused(table, word):
    with pytest.raises(SpecificationError) as caught:
        sweep_from_dict(table, "S.toml")
    message = str(caught.value)
    assert message.startswith("S.toml")
    assert word in message
    assert "\n" not in message


def test_missing_file(tmp_path):
    with pytest.raises(SpecificationError, match="no such file"):
        read_sweep(tmp_path / "sweep.toml")


@pytest.mark.slow
@pytest.mark.parametrize(
    "axes",
    [
        {"friction": {"from": 0.1, "to": 0.9, "count": 100_000}},
        {"friction": {"from": 0.1, "to": 0.9, "count": 1000}, "fri_margin": {"from": 0.001, "to": 0.01, "count": 100}},
    ],
)
def test_the_largest_grid_is_read_and_divided_in_seconds(axes):
    began = time.process_time()
    sweep = sweep_from_dict({"sweep": axes}, "S.toml")
    assert len(sweep.points()) == 100_000
    assert sum(map(len, sweep.batches())) == 100_000
    assert time.process_time() - began < 5.0
    assert sweep.points()[-1].specification.friction == 0.9


def test_no_grid_is_built_before_it_is_counted():
    began = time.process_time()
    axis = {"from": 0.1, "to": 0.2, "count": 100_000}
    with pytest.raises(SpecificationError, match="the grid has 1000000000000000 points"):
        sweep_from_dict({"sweep": {"friction": axis, "fri_margin": axis, "touchdown_speed": axis}}, "S.toml")
    assert time.process_time() - began < 0.5
