"""Libraries: the same bytes on every executor and after every interruption."""

import csv
import filecmp
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from frontal_biped.exceptions import LibraryError, RobotError
from frontal_biped.gait import check_constraints
from frontal_biped.gait.file import load_gait
from frontal_biped.library import LibraryStore, build_library, dask_executor, worker_processes
from frontal_biped.library.sweep import sweep_from_dict

RESIDUAL = 1e-9


def files(folder: Path) -> list[str]:
    return sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())


def assert_same(one: Path, other: Path) -> None:
    assert files(one) == files(other)
    _, differing, unreadable = filecmp.cmpfiles(one, other, files(one), shallow=False)
    assert differing == [] and unreadable == []


def test_every_point_has_a_verified_gait(biped, sweep, built):
    folder, report = built
    assert (report.points, report.gaits, report.failures, report.found) == (6, 6, 0, 0)
    for point in sweep.points():
        gait = load_gait(LibraryStore(folder).gait_path(point.number))
        step = gait.step(biped)
        assert max(gait.residuals(biped, step).values()) < RESIDUAL
        assert check_constraints(biped, point.specification, gait.rising, gait.falling, step).satisfied
        assert gait.specification == point.specification


def test_index(sweep, built):
    folder, report = built
    with report.index.open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [int(row["point"]) for row in rows] == list(range(6))
    for row, point in zip(rows, sweep.points(), strict=True):
        assert row["status"] == "gait"
        assert float(row["max_pelvis_roll"]) == point.specification.max_pelvis_roll
        assert float(row["cost"]) == load_gait(folder / row["file"]).orbit.cost


@pytest.mark.slow
def test_processes_give_the_same_bytes(sweep, built, tmp_path):
    with worker_processes(2) as executor:
        build_library(sweep, tmp_path / "processes", executor)
    assert_same(built[0], tmp_path / "processes")


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")  # Dask's own
def test_dask_cluster_gives_the_same_bytes(sweep, built, tmp_path):
    distributed = pytest.importorskip("distributed")
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        dask_executor(cluster.scheduler_address) as executor,
    ):
        build_library(sweep, tmp_path / "dask", executor)
    assert_same(built[0], tmp_path / "dask")


def test_finished_gaits_are_not_repeated(sweep, built):
    folder, _ = built
    store = LibraryStore(folder)
    stamps = [store.gait_path(point.number).stat().st_mtime_ns for point in sweep.points()]
    report = build_library(sweep, folder)
    assert report.found == 6
    assert stamps == [store.gait_path(point.number).stat().st_mtime_ns for point in sweep.points()]


def test_a_gait_that_was_lost_comes_back_the_same(sweep, built, tmp_path):
    """Every state that an interruption can leave: some gaits there, some not, one half-written."""
    import shutil

    copy = tmp_path / "copy"
    shutil.copytree(built[0], copy)
    store = LibraryStore(copy)
    store.gait_path(1).unlink()
    store.gait_path(5).unlink()
    (copy / "index.csv").unlink()
    (copy / "gaits" / ".000001.json.x.json").write_text('{"format": "fron')
    report = build_library(sweep, copy)
    assert report.found == 4
    assert_same(built[0], copy)


@pytest.mark.slow
def test_killed_and_taken_up_again(built, tmp_path):
    """Killed three times without warning, with two worker processes; none of them outlives its parent."""
    file, folder = tmp_path / "sweep.toml", tmp_path / "killed"
    file.write_text(
        "batch = 2\n[specification]\nswing_clearance = 0.012\n[sweep]\n"
        "step_width = [[0.28, 0.28], [0.32, 0.32]]\nmax_pelvis_roll = [0.16, 0.14, 0.12]\n"
    )
    command = [sys.executable, "-m", "frontal_biped", "library", str(file), "-o", str(folder), "--jobs", "2"]
    for already in range(3):
        run = subprocess.Popen(command, start_new_session=True, stdout=subprocess.DEVNULL)
        deadline = time.monotonic() + 120.0
        while len(list((folder / "gaits").glob("0*.json"))) <= already and time.monotonic() < deadline:
            time.sleep(0.02)
        os.kill(run.pid, signal.SIGKILL)
        run.wait()
    last = subprocess.run(command, capture_output=True, text=True, timeout=300, check=True)
    assert "by an earlier run" in last.stdout
    assert_same(built[0], folder)


def test_a_point_without_a_gait_is_told(tmp_path):
    """Feet three metres apart: the other point is designed all the same, and the index says why."""
    sweep = sweep_from_dict({"sweep": {"step_width": [[3.0, 3.1], [0.3, 0.3]]}}, "sweep")
    report = build_library(sweep, tmp_path)
    assert (report.gaits, report.failures) == (1, 1)
    with report.index.open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [row["status"] for row in rows] == ["none", "gait"]
    assert "step_width" in rows[0]["message"]


def test_progress(sweep, built):
    seen = []
    build_library(sweep, built[0], on_progress=lambda *row: seen.append(row))
    assert seen[0][:2] == (6, 6)


def test_another_sweep_in_the_same_folder_is_refused(built):
    other = sweep_from_dict({"sweep": {"friction": [0.5]}}, "sweep")
    with pytest.raises(LibraryError, match="another sweep"):
        build_library(other, built[0])


def test_unknown_robot_is_refused_before_anything_is_written(tmp_path):
    sweep = sweep_from_dict({"robot": "no_such_robot"}, "sweep")
    with pytest.raises(RobotError):
        build_library(sweep, tmp_path / "library")
    assert not (tmp_path / "library").exists()


def test_no_scheduler(monkeypatch):
    import distributed

    def refuse(*_args, **_kwargs):
        raise OSError("timed out")

    monkeypatch.setattr(distributed, "Client", refuse)
    with pytest.raises(LibraryError, match="no Dask scheduler answers"), dask_executor("tcp://127.0.0.1:1"):
        pass
