"""Run files of walks in space: exact round trip, and refusals that name the file."""

import dataclasses

import numpy as np
import pytest
from small_runs import spatial_run

from frontal_biped.exceptions import TrajectoryFileError
from frontal_biped.simulation.space.run import load_spatial_run, save_spatial_run


@pytest.fixture
def run():
    return spatial_run()


def test_round_trip_is_exact(run, tmp_path):
    path = tmp_path / "run.npz"
    save_spatial_run(run, path)
    back = load_spatial_run(path)
    for field in dataclasses.fields(run):
        a, b = getattr(run, field.name), getattr(back, field.name)
        assert np.array_equal(a, b) if isinstance(a, np.ndarray) else a == b, field.name
    assert not back.fell
    assert back.events("REVERSAL").tolist() == [1]


def test_missing_and_cut_off_files_are_refused_in_one_line(run, tmp_path):
    path = tmp_path / "run.npz"
    with pytest.raises(TrajectoryFileError, match="no such run file"):
        load_spatial_run(path)
    save_spatial_run(run, path)
    path.write_bytes(path.read_bytes()[:-300])
    with pytest.raises(TrajectoryFileError, match=r"run\.npz.*walk") as error:
        load_spatial_run(path)
    assert "\n" not in str(error.value)


def test_a_run_in_the_plane_is_refused(tmp_path):
    path = tmp_path / "run.npz"
    np.savez(path, header=np.array('{"format": "frontal-biped-run", "version": 1}'))
    with pytest.raises(TrajectoryFileError, match=r"run\.npz: is a run in the plane, not a run in space"):
        load_spatial_run(path)


@pytest.mark.parametrize(
    ("change", "match"),
    [
        ({"joint_names": ("hip",)}, r"q is float64 of shape \(5, 9\), not numbers of shape \(5, 8\)"),
        ({"tau": np.zeros((4, 2))}, "tau"),
        ({"wrench": np.zeros((5, 12))}, "wrench"),
        ({"event_t": np.zeros(3)}, "event_t"),
        ({"outcome": 3}, "outcome"),
        ({"steps_completed": "many"}, "steps_completed"),
        ({"settings": []}, "settings"),
        ({"locked": (1, 2)}, "locked"),
    ],
)
def test_parts_that_do_not_go_together_are_refused_in_one_line(run, tmp_path, change, match):
    path = tmp_path / "run.npz"
    save_spatial_run(dataclasses.replace(run, **change), path)
    with pytest.raises(TrajectoryFileError, match=match) as error:
        load_spatial_run(path)
    assert "\n" not in str(error.value)
    assert str(path) in str(error.value)


def test_arrays_of_text_are_refused(run, tmp_path):
    path = tmp_path / "run.npz"
    save_spatial_run(run, path)
    with np.load(path) as archive:
        entries = dict(archive)
    np.savez(path, **entries | {"yaw": np.array(["a"] * 5)})
    with pytest.raises(TrajectoryFileError, match="yaw"):
        load_spatial_run(path)
