"""A library knows its robots, and every file its point; one process at a time builds it; a lost worker is one line."""

import json
import os
import shutil
import signal
import subprocess
import sys
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path

import pytest

from frontal_biped.exceptions import LibraryError, SpecificationError
from frontal_biped.library import GaitLibrary, LibraryStore, build_library, worker_processes
from frontal_biped.library.lock import LOCK, locked
from frontal_biped.library.sweep import sweep_from_dict
from frontal_biped.model import load_robot, models_dir

DATA = Path(__file__).parents[1] / "data"


@pytest.fixture
def copy(built, tmp_path):
    return Path(shutil.copytree(built[0], tmp_path / "copy"))


@pytest.fixture
def failures(tmp_path):
    """A library of one point without a gait, and its sweep."""
    sweep = sweep_from_dict({"sweep": {"step_width": [[3.0, 3.1]]}}, "sweep")
    build_library(sweep, tmp_path / "none")
    return sweep, tmp_path / "none"


def edit(path: Path, change) -> None:
    table = json.loads(path.read_text())
    change(table)
    path.write_text(json.dumps(table, indent=1) + "\n")


def refusal(work, *arguments) -> str:
    with pytest.raises(LibraryError) as caught:
        work(*arguments)
    assert "\n" not in str(caught.value)
    return str(caught.value)


class TestRobots:
    @pytest.fixture
    def own(self, tmp_path):
        """A robot of the user's, and a sweep of two points of it."""
        for suffix in ("toml", "urdf"):
            shutil.copy(models_dir() / f"frontal_biped.{suffix}", tmp_path / f"own.{suffix}")
        description = tmp_path / "own.toml"
        description.write_text(description.read_text().replace("frontal_biped.urdf", "own.urdf"))
        return description, sweep_from_dict({"robot": str(description), "sweep": {"friction": [0.5, 0.6]}}, "sweep")

    def test_another_mass_is_another_robot(self, own, tmp_path):
        """In one process too, where the robot had been loaded before."""
        description, sweep = own
        folder = tmp_path / "library"
        build_library(sweep, folder)
        (folder / "gaits" / "000001.json").unlink()
        urdf = description.with_suffix(".urdf")
        before = urdf.read_text()
        urdf.write_text(before.replace('mass value="36.0"', 'mass value="30.0"'))
        message = refusal(build_library, sweep, folder)
        assert "sweep.json" in message and "another URDF or description" in message and "choose a new folder" in message
        assert not (folder / "gaits" / "000001.json").exists()
        with pytest.raises(SpecificationError, match="designed for another URDF or description"):
            GaitLibrary(folder).blend(load_robot(description), {"friction": 0.5})
        urdf.write_text(before)
        assert build_library(sweep, folder).found == 1

    def test_an_older_library_is_adopted_by_the_robot_of_its_gaits(self, copy, sweep, built):
        edit(copy / "sweep.json", lambda table: table.pop("fingerprints"))
        assert len(GaitLibrary(copy)) == 6
        build_library(sweep, copy)
        assert (copy / "sweep.json").read_bytes() == (built[0] / "sweep.json").read_bytes()

    def test_an_older_library_of_another_robot_is_not(self, copy, sweep):
        edit(copy / "sweep.json", lambda table: table.pop("fingerprints"))
        edit(copy / "gaits" / "000004.json", lambda table: table["robot"].__setitem__("fingerprint", "0" * 64))
        before = (copy / "sweep.json").read_bytes()
        message = refusal(build_library, sweep, copy)
        assert "000004.json: holds a gait of 'frontal_biped' with another URDF or description" in message
        assert (copy / "sweep.json").read_bytes() == before


class TestPoints:
    def test_a_gait_of_another_point_is_refused(self, copy, sweep):
        shutil.copy(copy / "gaits" / "000000.json", copy / "gaits" / "000002.json")
        message = refusal(build_library, sweep, copy)
        assert "000002.json: is of max_pelvis_roll = 0.16, point 2 of 0.12; delete it" in message
        assert refusal(GaitLibrary(copy).gait, 2) == message
        (copy / "gaits" / "000002.json").unlink()
        assert build_library(sweep, copy).found == 5

    def test_a_gait_of_another_robot_is_refused(self, copy, sweep):
        edit(copy / "gaits" / "000003.json", lambda table: table["robot"].__setitem__("fingerprint", "0" * 64))
        assert "000003.json: holds a gait of 'frontal_biped' with another" in refusal(build_library, sweep, copy)
        assert "delete it" in refusal(GaitLibrary(copy).gait, 3)

    @pytest.mark.parametrize("content", ["", "{", "[]", '{"format": 1}'])
    def test_a_gait_that_is_none(self, content, copy, sweep):
        (copy / "gaits" / "000001.json").write_text(content)
        message = refusal(build_library, sweep, copy)
        assert "000001.json" in message and "delete it and run" in message

    @pytest.mark.parametrize(
        ("change", "words"),
        [
            (lambda path: path.write_bytes(path.read_bytes()[:40]), "not valid JSON"),
            (lambda path: path.write_text("[]"), "does not say why"),
            (lambda path: edit(path, lambda t: t.pop("message")), "does not say why"),
            (lambda path: edit(path, lambda t: t.__setitem__("robot", "g1")), "another robot"),
            (lambda path: edit(path, lambda t: t.__setitem__("fingerprint", "0")), "another robot"),
            (lambda path: edit(path, lambda t: t.__setitem__("specification", 3)), "specification = 3 is not a table"),
            (
                lambda path: edit(path, lambda t: t["specification"].__setitem__("friction", 0.1)),
                "is of friction = 0.1",
            ),
        ],
    )
    def test_a_failure_that_is_not_of_its_point(self, change, words, failures):
        sweep, folder = failures
        path = folder / "failures" / "000000.json"
        change(path)
        message = refusal(build_library, sweep, folder)
        assert "000000.json" in message and words in message and "delete it and run" in message
        path.unlink()
        assert build_library(sweep, folder).failures == 1

    def test_an_older_failure_knows_no_fingerprint(self, failures):
        sweep, folder = failures
        edit(folder / "failures" / "000000.json", lambda table: table.pop("fingerprint"))
        assert build_library(sweep, folder).found == 1


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("", "not valid JSON"),
        ('{"robot": ["fro', "not valid JSON"),
        ("[]", "not the content of a sweep file"),
        ('{"fingerprints": 3}', "fingerprints = 3 is not a table"),
        ('{"sweep": {"friction": []}}', "sweep.friction"),
    ],
)
def test_a_sweep_that_cannot_be_read(content, words, copy, sweep):
    (copy / "sweep.json").write_text(content)
    message = refusal(GaitLibrary, copy)
    assert "sweep.json" in message and words in message
    if "friction" not in words:
        assert "delete it and run the same sweep again" in refusal(build_library, sweep, copy)
    (copy / "sweep.json").unlink()
    assert build_library(sweep, copy).found == 6


class TestLock:
    def test_two_processes(self, copy, sweep):
        code = (
            "import sys, time; from pathlib import Path; from frontal_biped.library.lock import locked\n"
            "with locked(Path(sys.argv[1])): print('held', flush=True); time.sleep(60)"
        )
        other = subprocess.Popen([sys.executable, "-c", code, copy], stdout=subprocess.PIPE, text=True)
        leftover = copy / "gaits" / ".000001.01234567.json"
        leftover.write_text("being written")
        try:
            assert other.stdout.readline() == "held\n"
            message = refusal(build_library, sweep, copy)
            assert f"process {other.pid} on" in message and "is building this library; wait for it" in message
            assert leftover.exists()
        finally:
            other.kill()
            other.communicate()
        assert (copy / LOCK).exists()
        assert build_library(sweep, copy).found == 6
        assert not leftover.exists() and not (copy / LOCK).exists()

    def test_a_lock_that_was_removed_meanwhile_is_taken_anew(self, tmp_path, monkeypatch):
        import fcntl

        plain = fcntl.flock
        removed = []

        def slow(handle, how):
            if not removed:
                removed.append((tmp_path / LOCK).unlink())
            plain(handle, how)

        monkeypatch.setattr(fcntl, "flock", slow)
        with locked(tmp_path):
            assert (tmp_path / LOCK).exists()

    def test_only_what_the_library_writes_is_removed(self, copy, sweep):
        kept = [copy / ".git", copy / "gaits" / ".hidden", copy / "gaits" / ".notes.json", copy / ".sweep.json"]
        for path in kept:
            path.write_text("mine")
        gone = [
            copy / ".sweep.0123abcd.json",
            copy / ".index.0123abcd.csv",
            copy / "failures" / ".000001.0123abcd.json",
        ]
        (copy / "failures").mkdir(exist_ok=True)
        for path in gone:
            path.write_text("{")
        build_library(sweep, copy)
        assert all(path.exists() for path in kept)
        assert not any(path.exists() for path in gone)


class TestLostWorkers:
    def test_one_line_that_says_that_it_resumes(self, tmp_path):
        class Broken:
            def submit(self, *_):
                future = Future()
                future.set_exception(BrokenProcessPool("a process ended"))
                return future

        sweep = sweep_from_dict({"sweep": {"friction": [0.5, 0.6]}}, "sweep")
        message = refusal(build_library, sweep, tmp_path / "library", Broken())
        assert "a worker ended before its work" in message and "run it again: what is finished is kept" in message

    @pytest.mark.slow
    def test_a_worker_that_is_killed(self):
        with pytest.raises(BrokenProcessPool), worker_processes(1) as executor:
            executor.submit(os.kill, executor.submit(os.getpid).result(), signal.SIGKILL).result()

    @pytest.mark.slow
    def test_an_error_in_the_block_stops_the_workers_at_once(self, tmp_path):
        import time

        began = time.monotonic()
        with pytest.raises(ZeroDivisionError), worker_processes(1) as executor:
            worker = executor.submit(os.getpid).result()
            executor.submit(time.sleep, 600.0)
            time.sleep(0.5)
            _ = 1 / 0
        assert time.monotonic() - began < 60.0
        with pytest.raises(ProcessLookupError):
            os.kill(worker, 0)

    def test_errors_come_back_whole(self):
        import pickle

        from frontal_biped.exceptions import HypothesisError, Interruption

        error = pickle.loads(pickle.dumps(HypothesisError("HR3", "unequal legs")))
        assert (str(error), error.hypothesis) == ("unequal legs (HR3)", "HR3")
        assert pickle.loads(pickle.dumps(Interruption(15))).exit_status == 143


def test_a_store_reads_what_it_saves(built, sweep):
    store = LibraryStore(built[0])
    assert set(store.fingerprints()) == set(sweep.robots)
    for point in sweep.points():
        assert store.read(point, store.fingerprints()).specification == point.specification
