"""Every command on spoilt files and with senseless options, and what must hold whatever it is given.

    python tests/fuzz_campaign.py --cases 10000 --seed 1 --jobs 2

A case is a folder with sound files, of which one is spoilt (`mutations`), and a command line. It runs in a process of
its own, forked from one that has imported everything, so that a hundred cases take a minute. It must end by itself,
with exit status 0, 1 or 2; without a traceback; with every line on standard error one of ours, and one complaint only;
within `MOST_SECONDS` of processor time and `MOST_MEMORY`; not with 0 where the file is certainly rubbish; and what it
writes must be whole: no temporary file, every file one that can be read.

``--only SEED:NUMBER`` runs a single case and shows everything.
"""

import argparse
import collections
import contextlib
import csv
import importlib
import io
import json
import os
import pkgutil
import random
import resource
import shutil
import signal
import sys
import tempfile
import time
import traceback
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

MOST_SECONDS = 20
"""Processor time of one case [s]."""

MOST_WALL = 120
"""Time of one case by the clock, on a machine that does other things too [s]."""

MOST_MEMORY = 3_000_000_000
"""Address space that a case may add to that of the process it was forked from [bytes]."""

DATA = Path(__file__).parent / "data"

SPECIFICATION = """\
friction = 0.6
step_duration = [0.4, 0.8]
step_width = [0.15, 0.35]
max_pelvis_roll = 0.1
max_torque = [150.0, 150.0, 150.0, 150.0]
degree = 5
"""

SWEEP = """\
robot = "frontal_biped"

[specification]
friction = 0.5
step_width = [0.3, 0.3]

[sweep]
max_pelvis_roll = [0.10, 0.14]
"""

SCENARIO = """\
name = "walk"
gait = "gait.json"
robot = "frontal_biped"
simulator = "ours"
steps = 2
seed = 1
repeat = 1
stance = "left"
speed_error = 0.01

[controller]
type = "qp"
stabiliser = "ankle+step"
period = 0.001
frequency = 100.0

[model]
mass = {within = 0.02}
com = {pelvis = [0.001, 0.0]}

[disturbances]
friction = {from = 0.5, to = 0.9}
torque_noise = 0.001
encoder_noise = 1e-5
ground = [0.0]

[[push]]
at = "30 % of the rising phase of step 1"
impulse = {within = 1.0}
duration = 0.1
profile = "half-sine"
height = 0.2

[expect]
steps = 2
torque = 1.0
step_duration = [0.3, 1.2]
"""

CONTROLLER_SCENARIO = """\
gait = "gait.json"
steps = 1
controller = "mine:make"
"""

CONTROLLERS = (
    "raise SystemExit(0)", "import sys; sys.exit('bye')", "1/0", "def make(*a): return 1",
    "def make(*a, **k): raise SystemExit(0)", "def make(*a, **k): raise GeneratorExit", "x = = 1", "\x00", "make = 3",
    "def make(*a, **k):\n    def c(*a, **k): return [float('nan')] * 4\n    return c",
    "def make(*a, **k):\n    def c(*a, **k): return 'abc'\n    return c",
    "def make(*a, **k):\n    def c(*a, **k): raise SystemExit(0)\n    return c",
    "def make(*a, **k):\n    def c(*a, **k): return None\n    return c",
    "def make(*a, **k):\n    return make(*a, **k)",
    "import not_there", "class E(BaseException): pass\nraise E('x\\ny')",
    "make = lambda *a, **k: (lambda *a: [0.0] * 3)",
)  # fmt: skip
"""Modules with controllers that cannot be used."""


class Case(NamedTuple):
    """What is run.

    Attributes:
        arguments: of the command.
        files: contents of files that are put over the sound ones.
        what: is wrong.
        rubbish: may exit status 0 not be?
        outputs: what it is told to write, files or folders.
    """

    arguments: list[str]
    files: dict[str, bytes]
    what: str
    rubbish: bool
    outputs: tuple[str, ...]


class Verdict(NamedTuple):
    """What a case did.

    Attributes:
        faults: each in words; none: it behaved.
        status: exit status; minus a signal.
        seconds: processor time [s].
        stderr: text.
    """

    faults: tuple[str, ...]
    status: int
    seconds: float
    stderr: str


# -- cases ---------------------------------------------------------------------------------------------------------


def make_files(folder: Path) -> None:
    """The sound files."""
    from frontal_biped.cli import main

    shutil.copy(DATA / "gait.json", folder)
    shutil.copy(DATA / "mini.urdf", folder)
    (folder / "spec.toml").write_text(SPECIFICATION)
    (folder / "sweep.toml").write_text(SWEEP)
    (folder / "walk.scenario.toml").write_text(SCENARIO)
    (folder / "mine.scenario.toml").write_text(CONTROLLER_SCENARIO)
    (folder / "mine.py").write_text("make = 1\n")
    with contextlib.chdir(folder), contextlib.redirect_stdout(io.StringIO()):
        assert main(["robots", "--describe", "mini.urdf", "-o", "mini.toml"]) == 0
        assert main(["simulate", "gait.json", "--steps", "2", "-o", "run.npz"]) == 0
        assert main(["walk", "simple_humanoid_bent", "--steps", "1", "-o", "space.npz"]) == 0
        assert main(["library", "sweep.toml", "-o", "library"]) == 0


TARGET = "out"

# what is spoilt, how, and the command lines that read it; {} stands for the output
_ON_GAIT = (
    ["analyze", "gait.json"],
    ["analyze", "gait.json", "--json", "-v"],
    ["simulate", "gait.json", "--steps", "1", "-o", "out.npz"],
    ["simulate", "gait.json", "--steps", "1", "--continuous"],
    ["simulate", "gait.json", "--steps", "1", "--engine", "mujoco"],
    ["export", "gait.json", "-o", "out.csv"],
    ["export", "gait.json", "-o", "out.npz", "--rate", "50"],
    ["export", "gait.json", "-o", "out.mcap"],
    ["view", "gait.json", "--html", "out.html"],
    ["design", "--quick", "--start", "gait.json", "--spec", "spec.toml", "-o", "out.json"],
)
_ON_RUN = (
    ["export", "run.npz", "-o", "out.csv"],
    ["export", "run.npz", "-o", "out.npz", "--rate", "50"],
    ["export", "run.npz", "-o", "out.mcap"],
    ["export", "run.npz", "-o", "out.html"],
    ["view", "run.npz", "--html", "out.html", "--ghost"],
    ["plot", "run.npz", "-o", "out", "--format", "svg"],
)
_ON_SPACE = (
    ["export", "space.npz", "-o", "out.csv"],
    ["export", "space.npz", "-o", "out.npz"],
    ["view", "space.npz", "--html", "out.html"],
)
_ON_SPECIFICATION = (
    ["design", "--quick", "--spec", "spec.toml", "-o", "out.json"],
    ["design", "--quick", "--robot", "mini.toml", "--spec", "spec.toml", "-o", "out.json"],
)
_ON_SWEEP = (["library", "sweep.toml", "-o", "out"],)
_ON_LIBRARY = (["library", "sweep.toml", "-o", "library"],)
_ON_SCENARIO = (["trial", "walk.scenario.toml"], ["trial", "walk.scenario.toml", "--junit", "out.xml", "--json"])
_ON_DESCRIPTION = (
    ["robots", "--posture", "mini.toml"],
    ["robots", "--bend", "mini.toml", "-o", "out.toml"],
    ["view", "mini.toml", "--html", "out.html"],
    ["analyze", "gait.json", "--robot", "mini.toml"],
    ["simulate", "gait.json", "--robot", "mini.toml", "--steps", "1"],
)
_ON_URDF = (
    ["robots", "--describe", "mini.urdf"],
    ["robots", "--describe", "mini.urdf", "-o", "out.toml"],
    ["robots", "--posture", "mini.toml"],
    ["view", "mini.urdf", "--html", "out.html"],
    ["simulate", "gait.json", "--robot", "mini.toml", "--steps", "1"],
)

_COMMANDS = (
    "design", "library", "analyze", "simulate", "walk", "trial", "view", "export", "plot", "studio", "robots", "demo",
)  # fmt: skip

_OPTIONS = (
    "--robot", "--spec", "--start", "--attempts", "--quick", "--budget", "-o", "-v", "--json", "--jobs", "--dask",
    "--robustness", "--steps", "--rate", "--continuous", "--speed-error", "--engine", "--stabiliser", "--controller",
    "--encoder-noise", "--torque-noise", "--seed", "--gait", "--speed", "--lateral", "--turn", "--push", "--delay",
    "--ground", "--friction", "--html", "--figures", "--repeat", "--only", "--junit", "--save", "--markdown", "--ghost",
    "--overlay", "--port", "--coordinates", "--time", "--fps", "--size", "--dark", "--format", "--describe",
    "--posture", "--bend", "--step-length", "--out", "--stabilizer", "--help", "--version", "--nonsense", "",
)  # fmt: skip

_VALUES = (
    "0", "-1", "1e308", "-1e308", "nan", "inf", "1e-320", "999999999999999999999", "9" * 5000, "", " ", "abc", "1,2,3",
    "0x0", "1x1", "99999x99999", "gait.json", "run.npz", "space.npz", "mini.urdf", "mini.toml", "spec.toml", ".", "..",
    "/", "/dev/null", "/dev/zero", "/dev/full", "/proc/self/mem", "/nowhere/x.json", "x" * 300, "a\nb", "ü", "--", "-",
    "walk.scenario.toml", "sweep.toml", "library", "frontal_biped", "g1", "robust", "*", "mine.py", "out.json", "٣",
    "out.csv", "out.gif.exe", "http://localhost/", "tcp://127.0.0.1:1",
)  # fmt: skip


def make_case(base: Path, rng: random.Random) -> Case:
    """A case at random."""
    import mutations

    def spoilt(name: str, by: Callable[..., mutations.Spoilt], lines: tuple[list[str], ...], *more: object) -> Case:
        result = by((base / name).read_bytes(), rng, *more)
        arguments = rng.choice(lines)
        outputs = tuple(word for word in arguments if word.startswith(TARGET))
        return Case(arguments, {name: result.content}, f"{name}: {result.what}", result.rubbish, outputs)

    kind = rng.choices(
        ("gait", "run", "space", "spec", "sweep", "library", "scenario", "module", "description", "urdf", "options"),
        (16, 14, 10, 6, 4, 4, 10, 3, 10, 13, 10),
    )[0]
    match kind:
        case "gait":
            return spoilt("gait.json", mutations.spoil_json, _ON_GAIT, ("provenance",))
        case "run":
            return spoilt("run.npz", mutations.spoil_archive, _ON_RUN)
        case "space":
            return spoilt("space.npz", mutations.spoil_archive, _ON_SPACE)
        case "spec":
            return spoilt("spec.toml", mutations.spoil_toml, _ON_SPECIFICATION)
        case "sweep":
            return spoilt("sweep.toml", mutations.spoil_toml, _ON_SWEEP)
        case "library":
            name = rng.choice(("library/sweep.json", "library/gaits/000000.json", "library/gaits/000001.json"))
            return spoilt(name, mutations.spoil_json, _ON_LIBRARY, ("provenance",))
        case "scenario":
            return spoilt("walk.scenario.toml", mutations.spoil_toml, _ON_SCENARIO)
        case "module":
            module = rng.choice(CONTROLLERS)
            return Case(["trial", "mine.scenario.toml"], {"mine.py": module.encode()}, f"mine.py: {module!r}", True, ())
        case "description":
            # [gait] is read by a design only
            return spoilt("mini.toml", mutations.spoil_toml, _ON_DESCRIPTION, ("gait",))
        case "urdf":
            return spoilt("mini.urdf", mutations.spoil_urdf, _ON_URDF)
        case _:
            return Case(_options(rng), {}, "options", False, ())


def _options(rng: random.Random) -> list[str]:
    """A command line of words at random; one that would serve a page or work for minutes is not asked for."""
    while True:
        command = rng.choice(_COMMANDS)
        sound = {"analyze": ["gait.json"], "simulate": ["gait.json", "--steps", "1"], "export": ["gait.json"],
                 "plot": ["run.npz"], "view": ["gait.json"], "trial": ["walk.scenario.toml"],
                 "library": ["sweep.toml"]}.get(command, [])  # fmt: skip
        words = [command, *(sound if rng.random() < 0.7 else [])]
        for _ in range(rng.choice((1, 1, 2, 3))):
            words.append(rng.choice(_OPTIONS))
            if rng.random() < 0.7:
                words.append(rng.choice(_VALUES))
        if command in ("studio", "demo", "walk", "view", "design") or "--robustness" in words:
            # only what is refused before the work: these serve until they are ended, or take minutes
            words += ["--nonsense"] if rng.random() < 0.5 else ["--robot", "no such robot"]
            if command == "walk":
                words += ["--robot", "x"]
        if command == "simulate":
            words += ["--steps", "1"]
        if not {"--out", "-o"} & set(words) and command in ("export", "library"):
            words += ["-o", rng.choice(("out.csv", "out.npz", "out"))]
        return words


# -- one case ------------------------------------------------------------------------------------------------------


def import_everything() -> None:
    """Import every module now, rather than in every case."""
    import frontal_biped

    for module in pkgutil.walk_packages(frontal_biped.__path__, "frontal_biped."):
        if not module.name.endswith("__main__"):
            importlib.import_module(module.name)
    for name in ("mujoco", "matplotlib.pyplot", "meshcat", "mcap_ros2", "pinocchio.visualize", "umsgpack"):
        with contextlib.suppress(ImportError):
            importlib.import_module(name)


def run_case(case: Case, base: Path) -> Verdict:
    """Run a case in a folder of its own, and judge it."""
    with tempfile.TemporaryDirectory(prefix="fuzz-") as name:
        folder = Path(name) / "work"
        shutil.copytree(base, folder)
        for place, content in case.files.items():
            (folder / place).write_bytes(content)
        before = {path.relative_to(folder) for path in folder.rglob("*")}
        stdout, stderr = Path(name) / "stdout", Path(name) / "stderr"
        child = os.fork()
        if child == 0:
            _run(case.arguments, folder, stdout, stderr)
        status, seconds, late = _wait(child)
        told = stderr.read_text(encoding="utf-8", errors="replace")
        faults = list(_faults(case, status, seconds, late, told))
        made = {path.relative_to(folder) for path in folder.rglob("*")} - before
        faults += _broken(folder, made, status)
        return Verdict(tuple(faults), status, seconds, told)


def _run(arguments: list[str], folder: Path, stdout: Path, stderr: Path) -> None:
    """The child: as the interpreter would, run the command and end."""
    status = 1
    try:
        os.setsid()
        for number, path in ((1, stdout), (2, stderr)):
            os.dup2(os.open(path, os.O_CREAT | os.O_WRONLY, 0o600), number)
        os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
        sys.stdin, sys.stdout, sys.stderr = (open(i, mode, closefd=False) for i, mode in enumerate("rww"))  # noqa: SIM115
        sys.path.insert(0, str(folder))
        os.chdir(folder)
        used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_CPU, (MOST_SECONDS, MOST_SECONDS + 1))
        resource.setrlimit(resource.RLIMIT_AS, (used + MOST_MEMORY, used + MOST_MEMORY))
        from frontal_biped.cli import main

        status = main(arguments)
    except SystemExit as stop:
        status = stop.code if isinstance(stop.code, int) else 1
    except BaseException:
        traceback.print_exc()
    with contextlib.suppress(BaseException):
        sys.stdout.flush()
        sys.stderr.flush()
    os._exit(status)


def _wait(child: int) -> tuple[int, float, bool]:
    """Exit status, processor time, and whether the clock ran out."""
    deadline, late = time.monotonic() + MOST_WALL, False
    while True:
        done, status, used = os.wait4(child, os.WNOHANG)
        if done:
            break
        if time.monotonic() > deadline:
            late = True
            os.killpg(child, signal.SIGKILL)
        time.sleep(0.01)
    with contextlib.suppress(ProcessLookupError):
        os.killpg(child, signal.SIGKILL)  # whatever it left
    return os.waitstatus_to_exitcode(status), used.ru_utime + used.ru_stime, late


def _faults(case: Case, status: int, seconds: float, late: bool, stderr: str) -> Iterator[str]:
    if late or status in (-signal.SIGXCPU, -signal.SIGKILL):
        yield f"hangs: {seconds:.0f} s"
    elif status not in (0, 1, 2):
        yield f"ends with {status}"
    if "Traceback" in stderr:
        yield "traceback"
    lines = stderr.splitlines()
    strange = [line for line in lines if not line.startswith("frontal-biped")]
    if strange and (status == 2 or case.arguments[0] != "robots"):  # which tells there what it found
        yield f"line that is not ours: {strange[0][:100]!r}"
    complaints = sum("error: " in line[:40] for line in lines)
    if status == 2 and complaints != 1:
        yield f"{complaints} complaints"
    if status != 2 and complaints:
        yield f"a complaint, and status {status}"
    if case.rubbish and status == 0:
        yield "0 on rubbish"


def _broken(folder: Path, made: set[Path], status: int) -> list[str]:
    """What was written and is not whole."""
    faults = []
    for path in sorted(made):
        if (folder / path).is_dir() or "__pycache__" in path.parts:
            continue
        if path.name.startswith("."):
            faults.append(f"left {path}")
        elif status == 2 and path.parts[0] not in (TARGET, "library"):
            faults.append(f"refused, yet wrote {path}")
        elif not _whole(folder / path):
            faults.append(f"half-written {path}")
    return faults


def _whole(path: Path) -> bool:
    content = path.read_bytes()
    try:
        match path.suffix:
            case ".json":
                json.loads(content)
            case ".npz":
                return zipfile.ZipFile(path).testzip() is None
            case ".html" | ".svg":
                return content.rstrip().endswith((b"</html>", b"</svg>"))
            case ".csv":
                return (
                    content.endswith(b"\n")
                    and len({len(row) for row in csv.reader(io.StringIO(content.decode()))}) == 1
                )
            case ".toml":
                import tomllib

                tomllib.loads(content.decode())
            case ".mcap":
                return content[:8] == content[-8:] == b"\x89MCAP0\r\n"
    except (ValueError, OSError, zipfile.BadZipFile):
        return False
    return bool(content)


# -- a campaign ----------------------------------------------------------------------------------------------------


def campaign(base: Path, seed: int, numbers: range, show: Callable[[str], None]) -> list[str]:
    """Run cases and tell the faults, one line each."""
    told = []
    kinds: collections.Counter[tuple[str, int]] = collections.Counter()
    seconds: collections.Counter[str] = collections.Counter()
    for number in numbers:
        case = make_case(base, random.Random(f"{seed}:{number}"))
        verdict = run_case(case, base)
        kinds[case.what.split(":")[0], verdict.status] += 1
        seconds[" ".join(case.arguments[:1])] += verdict.seconds
        if verdict.faults:
            words = " ".join(word if len(word) < 60 else f"{word[:57]}..." for word in case.arguments)
            told.append(f"{seed}:{number} [{case.what}] {words!r} -> {'; '.join(verdict.faults)}")
            show(told[-1])
    show(f"cases {numbers} of seed {seed}: {len(told)} faults; (spoilt, status): {dict(kinds)}; s: {dict(seconds)}")
    return told


def _main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--only", metavar="SEED:NUMBER")
    asked = parser.parse_args()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    import_everything()
    with tempfile.TemporaryDirectory(prefix="fuzz-base-") as name:
        base = Path(name)
        make_files(base)
        if asked.only:
            case = make_case(base, random.Random(asked.only))
            verdict = run_case(case, base)
            print(case.arguments, case.what, "rubbish" if case.rubbish else "", sep="\n")
            print(verdict.stderr, *verdict.faults, f"status {verdict.status}, {verdict.seconds:.1f} s", sep="\n")
            return bool(verdict.faults)
        children = []
        last = asked.first + asked.cases
        for j in range(asked.jobs):  # forked before a thread is started
            child = os.fork()
            if child == 0:
                faults = campaign(
                    base, asked.seed, range(asked.first + j, last, asked.jobs), lambda line: print(line, flush=True)
                )
                os._exit(bool(faults))
            children.append(child)
        return max(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) for child in children)


if __name__ == "__main__":
    sys.exit(_main())
