"""Commands that are killed while they write: at a moment that is seen to lie inside the writing of a file.

    python tests/kill_campaign.py [--kills 200] [--seed 0] [--jobs 2]

A process, and every worker it starts, runs with `SLOW_DISK` as its sitecustomize: the file operations of the standard
library announce the chosen moment of the chosen write with a marker file, and pause there. Only when the marker is seen
is the signal sent, so that every kill hits. The package knows nothing of it.
"""

import argparse
import collections
import contextlib
import itertools
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import zipfile
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

from frontal_biped.gait.file import load_gait

ROOT = Path(__file__).parents[1]
DATA = ROOT / "tests" / "data"

SLOW_DISK = """
import io, os, pathlib, time

MOMENT, STEM, MARKER = os.environ["KILL_MOMENT"], os.environ["KILL_STEM"], os.environ["KILL_MARKER"]


def is_temporary(path):
    return os.path.basename(os.fspath(path)).startswith(f".{STEM}.")


def pause(moment):
    if moment != MOMENT:
        return
    try:
        os.close(plain_open(MARKER, os.O_CREAT | os.O_EXCL))
    except FileExistsError:  # it has been announced
        return
    until = time.monotonic() + 30.0
    while time.monotonic() < until:
        time.sleep(0.01)


plain_open, plain_replace, plain_path_open = os.open, os.replace, pathlib.Path.open


def slow_open(path, flags, *rest, **named):
    handle = plain_open(path, flags, *rest, **named)
    if flags & os.O_CREAT and is_temporary(path):
        pause("created")
    return handle


def slow_replace(source, target, **named):
    if is_temporary(source):
        pause("written")
    plain_replace(source, target, **named)
    if is_temporary(source):
        pause("replaced")


class SlowFile(io.FileIO):
    def write(self, content):
        half = super().write(content[: max(1, len(content) // 2)])
        pause("half")
        return half


def slow_path_open(self, mode="r", *rest, **named):
    if "w" not in mode or not is_temporary(self):
        return plain_path_open(self, mode, *rest, **named)
    stream = io.BufferedWriter(SlowFile(self, "w"))
    return stream if "b" in mode else io.TextIOWrapper(stream, encoding="utf-8", write_through=True)


os.open, os.replace, pathlib.Path.open = slow_open, slow_replace, slow_path_open
"""

MOMENTS = ("created", "half", "written", "replaced")
"""Of a write: the temporary file is there and empty, holds half, holds all; the target is there."""

SIGNALS = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT)

SWEEP = "batch = 1\n[specification]\nswing_clearance = 0.012\n[sweep]\nmax_pelvis_roll = [0.16, 0.14]\n"
SCENARIO = 'gait = "gait.json"\nsteps = 1\ncontroller = {type = "qp", stabiliser = "adaptive"}\n'

PATIENCE = 120.0
"""For a moment to be reached, and for a process to end [s]."""


class Case(NamedTuple):
    """A command, which of its files is hit, at which moment of its writing, with what."""

    command: str
    stem: str
    moment: str
    signal: signal.Signals
    everybody: bool  # the whole process group, as a terminal does, or the command's process alone


# command line, stems of the files it writes, files that are there before
COMMANDS = {
    "design": ("design --quick -o out.json", ("out",), ("out.json",)),
    "simulate": ("simulate gait.json --steps 1 --rate 500 -o out.npz", ("out",), ("out.npz",)),
    "export csv": ("export gait.json -o out.csv", ("out",), ("out.csv",)),
    "export npz": ("export gait.json -o out.npz", ("out",), ()),
    "trial": ("trial t.scenario.toml --save runs --junit out.xml", ("t-0", "out"), ("out.xml",)),
    "library": ("library sweep.toml -o gaits", ("sweep", "000000", "000001", "index"), ()),
    "library, 2 processes": ("library sweep.toml -o gaits --jobs 2", ("sweep", "000000", "000001", "index"), ()),
}

OLD = b"what was there before\n"


def cases() -> Iterator[Case]:
    """All of them, in a fixed order."""
    for name, (_, stems, _) in COMMANDS.items():
        for hit in itertools.product(stems, MOMENTS, SIGNALS, (False, True)):
            yield Case(name, *hit)


def kill(case: Case, folder: Path, reference: Path) -> str:
    """Kill a command in a new folder; returns what was wrong afterwards, "" for nothing.

    Args:
        case: what, where and how.
        folder: empty.
        reference: folder of the library that nobody disturbed.
    """
    line, _, before = COMMANDS[case.command]
    for name in before:
        (folder / name).write_bytes(OLD)
    shutil.copy(DATA / "gait.json", folder)
    (folder / "sweep.toml").write_text(SWEEP)
    (folder / "t.scenario.toml").write_text(SCENARIO)
    with tempfile.TemporaryDirectory() as hooks:
        Path(hooks, "sitecustomize.py").write_text(SLOW_DISK)
        marker = Path(hooks, "marker")
        environment = {
            **os.environ,
            "PYTHONPATH": os.pathsep.join([hooks, str(ROOT)]),
            "KILL_MOMENT": case.moment,
            "KILL_STEM": case.stem,
            "KILL_MARKER": str(marker),
        }
        process = subprocess.Popen(
            [sys.executable, "-m", "frontal_biped", *line.split()],
            cwd=folder,
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )
        try:
            if not _seen(lambda: marker.exists() or process.poll() is not None) or process.poll() is not None:
                return f"the moment did not come: {process.communicate()[1]}"
            (os.killpg if case.everybody else os.kill)(process.pid, case.signal)
            _, errors = process.communicate(timeout=PATIENCE)
            if not _seen(lambda: not _alive(process.pid)):
                return "a process stays"
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()
    return _verdict(case, folder, reference, process.returncode, errors)


def _seen(what: Callable[[], bool]) -> bool:
    until = time.monotonic() + PATIENCE
    while time.monotonic() < until:
        if what():
            return True
        time.sleep(0.005)
    return False


def _alive(group: int) -> bool:
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True


def _verdict(case: Case, folder: Path, reference: Path, status: int, errors: str) -> str:
    killed = case.signal is signal.SIGKILL
    if status != (-signal.SIGKILL if killed else 128 + case.signal):
        return f"status {status}: {errors}"
    if not killed and errors.count("\n") != 1:
        return f"not one line: {errors}"
    hidden = [path.name for path in folder.rglob(".*")]
    if hidden and not killed:
        return f"left behind: {hidden}"
    for path in folder.rglob("*"):
        if path.is_file() and not path.name.startswith(".") and (wrong := _wrong(path)):
            return f"{path.name}: {wrong}"
    for name in COMMANDS[case.command][2]:
        hit = case.moment == "replaced" and name.startswith(f"{case.stem}.")
        if ((folder / name).read_bytes() == OLD) is hit:
            return f"{name}: {'the new file is not there' if hit else 'the old file is lost'}"
    return "" if not case.command.startswith("library") else _resumed(folder, reference)


def _wrong(path: Path) -> str:
    """What is wrong in a file that is either of before or whole."""
    content = path.read_bytes()
    try:
        if content == OLD or path.suffix in (".toml", ".xml"):
            return "" if content == OLD or content.endswith(b"\n") else "half-written"
        if path.suffix == ".json" and path.parent.name == "gaits" and path.name != "sweep.json":
            load_gait(path)
        elif path.suffix == ".json":
            json.loads(content)
        elif path.suffix == ".npz":
            return zipfile.ZipFile(path).testzip() or ""
        elif not content.endswith(b"\n"):
            return "half-written"
    except Exception as error:
        return str(error)
    return ""


def _resumed(folder: Path, reference: Path) -> str:
    again = subprocess.run(
        [sys.executable, "-m", "frontal_biped", "library", "sweep.toml", "-o", "gaits"],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=False,
    )
    if again.returncode:
        return f"does not resume: {again.stderr}"
    here, there = (
        {path.relative_to(top): path.read_bytes() for path in top.rglob("*") if path.is_file()}
        for top in (folder / "gaits", reference)
    )
    return "" if here == there else f"not as undisturbed: {sorted(map(str, set(here) ^ set(there)))}"


def undisturbed(folder: Path) -> Path:
    """The library that every one that was killed must come to."""
    (folder / "sweep.toml").write_text(SWEEP)
    subprocess.run(
        [sys.executable, "-m", "frontal_biped", "library", "sweep.toml", "-o", "gaits"],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdout=subprocess.DEVNULL,
        check=True,
    )
    return folder / "gaits"


def campaign(kills: int, seed: int, jobs: int) -> int:
    """Kill so often, tell the counts; returns how often something was wrong."""
    drawn = list(cases())
    random.Random(seed).shuffle(drawn)
    drawn = list(itertools.islice(itertools.cycle(drawn), kills))
    with tempfile.TemporaryDirectory() as top, ThreadPoolExecutor(jobs) as pool:
        Path(top, "reference").mkdir()
        reference = undisturbed(Path(top, "reference"))

        def one(numbered: tuple[int, Case]) -> tuple[Case, str]:
            folder = Path(top, str(numbered[0]))
            folder.mkdir()
            wrong = kill(numbered[1], folder, reference)
            if wrong:
                print(f"{numbered[1]}: {wrong}", flush=True)
            shutil.rmtree(folder)
            return numbered[1], wrong

        results = list(pool.map(one, enumerate(drawn)))
    table = collections.Counter((case.command, case.signal.name, bool(wrong)) for case, wrong in results)
    print(f"{'command':22}" + "".join(f"{number.name:>16}" for number in SIGNALS))
    for name in COMMANDS:
        counts = [(table[name, number.name, False], table[name, number.name, True]) for number in SIGNALS]
        print(f"{name:22}" + "".join(f"{good:>9} ok {bad:>2} no" for good, bad in counts))
    moments = collections.Counter(case.moment for case, _ in results)
    print(f"{len(results)} kills; by moment: {dict(moments)}")
    return sum(bool(wrong) for _, wrong in results)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--kills", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=2)
    given = parser.parse_args()
    sys.exit(min(campaign(given.kills, given.seed, given.jobs), 1))
