"""A command in bad surroundings: exit status and one line on standard error that names the file and the remedy."""

import contextlib
import os
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from ordinary_user import as_ordinary_user

DATA = Path(__file__).parents[1] / "data"
PROGRAM = [sys.executable, "-m", "frontal_biped"]
ROOT = Path(__file__).parents[2]


def run(line: str, folder: Path, before: str = "", **environment: str | None) -> subprocess.CompletedProcess[str]:
    """Run a command line by a shell, in a folder, with what the shell does before; None unsets a variable.

    In the line, > and < are the shell's.
    """
    words, redirected, where = line.partition(" >")
    command = f"{before} exec {shlex.join(PROGRAM)} {words} {redirected}{where}"
    return subprocess.run(
        ["bash", "-c", command],
        cwd=folder,
        env={k: v for k, v in {**os.environ, "PYTHONPATH": str(ROOT), **environment}.items() if v is not None},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )


def refused(done: subprocess.CompletedProcess[str], *words: str) -> None:
    assert done.returncode == 2, done
    assert done.stderr.count("\n") == 1, done.stderr
    assert done.stderr.startswith("frontal-biped: error: ")
    for word in words:
        assert word in done.stderr


@pytest.fixture
def here(tmp_path):
    shutil.copy(DATA / "gait.json", tmp_path)
    return tmp_path


@pytest.fixture
def small_disk(tmp_path):
    """A disk of 16 kB."""
    place = tmp_path / "small"
    place.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=16k", "tmpfs", str(place)]
    if not shutil.which("mount") or subprocess.run(mount, capture_output=True, check=False).returncode:
        pytest.skip("no disk can be mounted here")
    try:
        yield place
    finally:
        subprocess.run(["umount", str(place)], check=True)


class TestStandardStreams:
    @pytest.mark.parametrize("line", ["robots >/dev/full", "--help >/dev/full", "--version >/dev/full", ">/dev/full"])
    def test_full(self, line, here):
        refused(run(f" {line}", here), "standard output: No space left on device; make room")

    def test_closed_output_is_told_before_the_work(self, here):
        refused(run("export gait.json -o out.csv >&-", here), "standard output: is closed; send it to a file")
        assert not (here / "out.csv").exists()

    @pytest.mark.slow
    def test_closed_errors_and_input(self, here):
        done = run("export gait.json -o out.csv >log 2>&- <&-", here)
        assert done.returncode == 0
        assert (here / "log").read_text().startswith("out.csv: ")
        assert (here / "out.csv").read_bytes().startswith(b"t")
        assert run("export absent.json -o out.csv 2>&-", here).returncode == 2

    @pytest.mark.slow
    def test_nobody_reads(self, here):
        for unbuffered in (None, "1"):
            line = "export gait.json -o out.csv > >(true); sleep 0"
            done = run(line, here, "trap '' PIPE;", PYTHONUNBUFFERED=unbuffered)
            assert done.stderr == ""

    @pytest.mark.slow
    def test_names_that_the_terminal_cannot_show(self, here):
        done = run("export gait.json -o é.csv", here, PYTHONIOENCODING="ascii")
        assert (done.returncode, done.stderr) == (0, "")
        assert done.stdout.startswith("\\xe9.csv: ")
        assert (here / "é.csv").exists()
        refused(run("export absent.json -o é.csv", here, LC_ALL="C"), "absent.json")


@pytest.mark.slow
def test_full_disk(here, small_disk):
    refused(run("export gait.json -o small/out.csv", here), "small/out.csv: No space left on device; make room")
    refused(run("simulate gait.json --steps 1 --rate 500 -o small/out.npz", here), "small/out.npz: No space left")
    assert list(small_disk.iterdir()) == []
    (small_disk / "filler").write_bytes(bytes(4096))
    with contextlib.suppress(OSError):
        (small_disk / "more").write_bytes(bytes(16384))
    refused(run("robots >small/log", here), "standard output: No space left")


@pytest.mark.slow
def test_folder_that_may_not_be_written(here):
    (here / "locked").mkdir(mode=0o555)
    (here / "sweep.toml").write_text("[sweep]\nfriction = [0.5]\n")
    for line in (
        "export gait.json -o locked/out.csv",
        "library sweep.toml -o locked/gaits",
        "plot gait.json -o locked/figures",
        "simulate gait.json -o locked/run.npz",
    ):
        done = subprocess.run(
            [*as_ordinary_user(), *PROGRAM, *line.split()],
            cwd=here,
            env={**os.environ, "PYTHONPATH": str(ROOT)},
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )
        refused(done, "locked", "the folder is not writable; choose another path")


def test_current_folder_is_gone(here):
    gone = here / "gone"
    gone.mkdir()
    refused(run("export gait.json -o out.csv", here, "cd gone; rmdir ../gone;"), "the current folder: is not there")


@pytest.mark.slow
def test_too_few_open_files(here):
    (here / "sweep.toml").write_text("batch = 1\n[sweep]\nfriction = [0.5, 0.6]\n")
    refused(run("library sweep.toml -o gaits --jobs 2", here, "ulimit -n 10;"), "Too many open files; allow more open")


@pytest.mark.slow
def test_no_home(here):
    """Where Matplotlib cannot keep its cache there either, nothing is said about it."""
    for home in (None, "/proc"):
        done = run("plot gait.json -o figures --format svg", here, HOME=home, MPLCONFIGDIR=None, XDG_CACHE_HOME=None)
        assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.slow
def test_no_room_for_temporary_files(here):
    done = run("export gait.json -o out.csv", here, TMPDIR="/nonexistent")
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.slow
@pytest.mark.parametrize("width", ["0", "1", "many"])
def test_odd_terminals(width, here):
    done = run("simulate --help", here, COLUMNS=width, TERM="dumb")
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.slow
def test_pictures_without_a_browser(here):
    pytest.importorskip("playwright")
    done = subprocess.run(
        [*PROGRAM, "export", "gait.json", "-o", "out.png"],
        cwd=here,
        env={**os.environ, "PYTHONPATH": str(ROOT), "PATH": "/none", "PLAYWRIGHT_BROWSERS_PATH": "/none"},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    refused(done, "pictures need Chromium, and no Chromium was found; `apt install chromium`")
    assert not (here / "out.png").exists()


class TestErrorsOfThisProcess:
    @pytest.mark.parametrize(
        ("error", "words"),
        [
            (MemoryError(), "the memory is used up; free some"),
            (MemoryError("Unable to allocate 9 GiB"), "Unable to allocate 9 GiB; free some"),
            (RecursionError("maximum recursion depth exceeded"), "maximum recursion depth exceeded; name a file"),
            (ImportError("libblas: cannot map"), "libblas: cannot map; install frontal-biped again"),
            (OSError(28, "No space left on device", "x.npz"), "x.npz: No space left on device; make room there"),
            (OSError(13, "Permission denied", b"x.npz"), "x.npz: Permission denied; choose another path"),
            (OSError(24, "Too many open files"), "the operating system: Too many open files; allow more"),
            (FileNotFoundError(2, "No usable temporary directory found in ['/x']"), "TMPDIR: No usable temporary"),
        ],
    )
    def test_one_line(self, error, words, capsys, monkeypatch):
        from frontal_biped.cli import main, robots

        def fail(_):
            raise error

        monkeypatch.setattr(robots, "run", fail)
        assert main(["robots", "--json"]) == 2
        out, err = capsys.readouterr()
        assert out == ""
        assert err.count("\n") == 1 and words in err
        with pytest.raises(type(error)):
            main(["robots", "--debug"])

    def test_usage_error_names_its_own_command(self, capsys):
        from frontal_biped.cli import main

        assert main(["design", "--nope", "more"]) == 2
        err = capsys.readouterr().err
        assert err == (
            "frontal-biped design: error: unrecognized arguments: --nope more; see `frontal-biped design --help`\n"
        )


LITTLE_MEMORY = """
import resource, sys, numpy, scipy.linalg, frontal_biped.cli, fuzz_campaign
fuzz_campaign.import_everything()
for linalg in (numpy.linalg, scipy.linalg):
    linalg.solve(numpy.eye(300), numpy.eye(300)) @ numpy.eye(300)
used = int(open("/proc/self/statm").read().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (used + int(sys.argv[1]) * 1_000_000,) * 2)
sys.exit(frontal_biped.cli.main(sys.argv[2:]))
"""
"""A command that may take some megabytes more than what its libraries take once they are loaded and have worked. With
less, the libraries end the process themselves ("OpenBLAS error: Memory allocation still failed"), or try for ever."""


@pytest.mark.slow
@pytest.mark.parametrize("line", ["export gait.json -o out.csv --rate 200000", "view gait.json --html out.html"])
def test_too_little_memory(line, here):
    """Whatever is left, a command ends well or says what it was about; it leaves nothing half-written."""
    outcomes = set()
    for megabytes in (2, 32, 2048):
        done = subprocess.run(
            [sys.executable, "-c", LITTLE_MEMORY, str(megabytes), *line.split()],
            cwd=here,
            env={**os.environ, "PYTHONPATH": f"{ROOT}:{ROOT / 'tests'}", "OPENBLAS_NUM_THREADS": "1"},
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )
        outcomes.add(done.returncode)
        if done.returncode:
            refused(done, "gait.json", "out.", "ulimit -v")
            assert {path.name for path in here.iterdir()} == {"gait.json"}
        else:
            (here / line.split()[line.split().index("-o" if "-o" in line else "--html") + 1]).unlink()
    assert outcomes == {0, 2}
