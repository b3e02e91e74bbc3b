"""Files that appear whole or not at all."""

import errno
import json
import os
import stat
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from frontal_biped.files.atomic import atomic_path, require_parent, write_json, write_text


def test_the_file_appears_only_when_complete(tmp_path):
    target = tmp_path / "out.txt"
    with atomic_path(target) as temporary:
        temporary.write_text("half")
        assert not target.exists()
        assert temporary.parent == target.parent
    assert target.read_text() == "half"
    assert list(tmp_path.iterdir()) == [target]


def test_an_error_on_the_way_leaves_the_old_file_and_nothing_else(tmp_path):
    target = tmp_path / "out.txt"
    write_text(target, "old")
    with pytest.raises(RuntimeError, match="on the way"), atomic_path(target) as temporary:
        temporary.write_text("new")
        raise RuntimeError("on the way")
    assert target.read_text() == "old"
    assert list(tmp_path.iterdir()) == [target]


def test_numbers_that_json_cannot_say_become_null(tmp_path):
    target = tmp_path / "out.json"
    write_json(target, {"a": 0.1, "b": [float("nan"), {"c": float("inf")}]})
    assert json.loads(target.read_text()) == {"a": 0.1, "b": [None, {"c": None}]}


def test_a_link_stays_one_and_what_it_names_is_replaced(tmp_path):
    (tmp_path / "elsewhere").mkdir()
    real = tmp_path / "elsewhere" / "real.txt"
    real.write_text("old")
    link = tmp_path / "link.txt"
    link.symlink_to(real)
    write_text(link, "new")
    assert link.is_symlink()
    assert real.read_text() == "new"


def test_a_link_to_nothing_yet_makes_the_file_that_it_names(tmp_path):
    link = tmp_path / "link.txt"
    link.symlink_to("made.txt")
    write_text(link, "new")
    assert link.is_symlink()
    assert (tmp_path / "made.txt").read_text() == "new"


def test_links_in_a_circle_are_an_error_that_names_the_target(tmp_path):
    (tmp_path / "a").symlink_to("b")
    (tmp_path / "b").symlink_to("a")
    for act in (lambda: write_text(tmp_path / "a", "x"), lambda: require_parent(tmp_path / "a")):
        with pytest.raises(OSError, match=r"symbolic links.*/a") as caught:
            act()
        assert caught.value.errno == errno.ELOOP
    assert (tmp_path / "a").is_symlink()


def test_a_device_stays_a_device():
    write_text(path := Path("/dev/null"), "into the void")
    assert stat.S_ISCHR(path.stat().st_mode)


def test_what_goes_into_a_full_device_is_told_with_its_name():
    with pytest.raises(OSError, match="/dev/full") as caught:
        write_text(Path("/dev/full"), "x" * 100_000)
    assert caught.value.errno == errno.ENOSPC


def test_a_pipe_is_written_into(tmp_path):
    pipe = tmp_path / "pipe.txt"
    os.mkfifo(pipe)
    read = []
    reader = threading.Thread(target=lambda: read.append(pipe.read_text()))
    reader.start()
    write_text(pipe, "through")
    reader.join(10.0)
    assert read == ["through"]
    assert stat.S_ISFIFO(pipe.stat().st_mode)
    assert list(tmp_path.iterdir()) == [pipe]


def test_a_pipe_that_nobody_reads_is_told_and_not_waited_for(tmp_path, monkeypatch):
    monkeypatch.setattr("frontal_biped.files.atomic.READER_PATIENCE", 0.1)
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(OSError, match="nobody reads"):
        write_text(tmp_path / "pipe", "x")


def test_permissions_are_those_of_the_file_that_is_replaced_and_of_the_umask_else(tmp_path):
    # in a process of its own: the umask belongs to all of its threads
    code = """
import os, sys
from pathlib import Path
from frontal_biped.files.atomic import write_text
os.umask(0o077)
folder = Path(sys.argv[1])
write_text(folder / "new", "x")
(folder / "old").write_text("x")
(folder / "old").chmod(0o640)
write_text(folder / "old", "y")
"""
    subprocess.run([sys.executable, "-c", code, tmp_path], check=True)
    modes = {name: stat.S_IMODE((tmp_path / name).stat().st_mode) for name in ("new", "old")}
    assert modes == {"new": 0o600, "old": 0o640}


def test_file_and_folder_reach_the_disk_before_and_after_the_name_changes(tmp_path, monkeypatch):
    synced = []
    fsync = os.fsync
    monkeypatch.setattr(
        "os.fsync", lambda handle: (synced.append(str(Path(f"/proc/self/fd/{handle}").readlink())), fsync(handle))
    )
    write_text(tmp_path / "out.txt", "x")
    assert len(synced) == 2
    assert synced[0].startswith(str(tmp_path / ".out."))
    assert synced[1] == str(tmp_path)


def test_the_longest_name_that_a_file_can_have(tmp_path):
    target = tmp_path / ("n" * 250 + ".json")
    write_text(target, "x")
    assert target.read_text() == "x"


def test_errors_of_other_files_keep_their_names(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"mesh\.stl"), atomic_path(tmp_path / "out.html"):
        (tmp_path / "mesh.stl").read_bytes()
