"""Smoke test of an installed wheel, run from a folder that has nothing to do with the project.

Beside it lie `robot_laws.py`, `README.md` and `examples/`. Every packaged robot is loaded, every command that the
README names is run, with the options it names checked against its help, and so is every numbered example.
"""

import re
import signal
import subprocess
import sys
import time
from pathlib import Path

from robot_laws import LAWS

import frontal_biped as fb
from frontal_biped.files.atomic import write_text
from frontal_biped.model import models_dir

assert "site-packages" in str(models_dir()), f"robots come from {models_dir()}, not from the wheel"
names = fb.robot_names()
assert "frontal_biped" in names, names
for name in names:
    robot = fb.load_robot(name)
    for law in LAWS:
        law(robot)
    print(f"{name}: {robot.mass:.2f} kg, {len(LAWS)} laws hold")

PROGRAM = Path(sys.executable).with_name("frontal-biped")
G1 = str(fb.load_robot("g1").description.urdf)
SWEEP = 'robot = "frontal_biped"\n[sweep]\nmax_pelvis_roll = [0.1, 0.12]\n'
SCENARIO = 'robot = "frontal_biped"\nsteps = 3\n'

# command: runs of it, each with what it must leave behind; in an order in which each finds what it reads
RUNS = {
    "design": [
        (["-o", "gait.json"], "gait.json"),
        (["--spec", "robust", "-o", "robust.json"], "robust.json"),
        (["--robot", "talos_full", "-o", "talos_full.json"], "talos_full.json"),
    ],
    "library": [(["sweep.toml", "-o", "gaits", "--jobs", "2"], "gaits/index.csv")],
    "analyze": [(["gait.json", "--prove", "proof.json"], "proof.json")],
    "verify": [(["proof.json", "--gait", "gait.json"], None)],
    "simulate": [
        (["gait.json", "--steps", "2", "-o", "run.npz"], "run.npz"),
        (["gait.json", "--steps", "2", "--engine", "mujoco", "-o", "mujoco.npz"], "mujoco.npz"),
    ],
    "walk": [
        (["talos_full", "--speed", "0.1", "--steps", "3", "--html", "space.html", "-o", "space.npz"], "space.html"),
    ],
    "trial": [(["walk.scenario.toml"], None)],
    "view": [
        (["run.npz", "--html", "page.html"], "page.html"),
        (["run.npz", "gait.json", "--ghost", "--html", "two.html"], "two.html"),
        (["talos_full.json", "--html", "talos.html"], "talos.html"),
    ],
    "export": [(["run.npz", "-o", "run.csv"], "run.csv"), (["space.npz", "-o", "space.csv"], "space.csv")],
    "plot": [(["run.npz", "-o", "figures"], "figures/joint_angles.svg")],
    "robots": [(["--json"], None), (["--describe", G1, "-o", "my_g1.toml"], "my_g1.toml")],
    "demo": [(["--out", "demo"], "demo/report.html")],
}
SERVED = {"studio": ["--no-open"], "view": ["run.npz", "--no-open"]}
"""Commands that serve until they are told to end."""


def run(command: str, arguments: list[str], leaves: str | None = None) -> None:
    """A command that ends by itself."""
    began = time.monotonic()
    subprocess.run([PROGRAM, command, *arguments], check=True, stdout=subprocess.DEVNULL)
    assert leaves is None or Path(leaves).stat().st_size > 0, leaves
    print(f"frontal-biped {command} {' '.join(arguments)}: {time.monotonic() - began:.0f} s", flush=True)


def serve(command: str, arguments: list[str]) -> None:
    """A command that prints an address and ends on SIGTERM."""
    process = subprocess.Popen([PROGRAM, command, *arguments], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    line = process.stdout.readline()
    process.send_signal(signal.SIGTERM)
    assert process.wait(60) == 0 and "http://127.0.0.1:" in line, line
    print(f"frontal-biped {command} {' '.join(arguments)}: {line.strip()}", flush=True)


def check_options(command: str, text: str) -> None:
    """Every option that the README names with a command is in its help."""
    shown = subprocess.run([PROGRAM, command, "--help"], capture_output=True, text=True, check=True).stdout
    for option in re.findall(r"(?<![\w-])--?[a-z][\w-]*", text):
        assert re.search(rf"(?<![\w-]){re.escape(option)}(?![\w-])", shown), f"{command} {option}"


quoted = re.findall(r"(?:`|^ *|&& \S*|/)frontal-biped (\w+)([^`\n]*)", Path("README.md").read_text(), re.MULTILINE)
commands = {command for command, _ in quoted}
assert {"demo", "design", "studio"} <= commands, commands
assert commands <= {*RUNS, *SERVED}, f"the README names commands that are not run here: {commands - {*RUNS, *SERVED}}"
for command, text in quoted:
    check_options(command, text)
print(f"{len(quoted)} quotations of {len(commands)} commands, their options known")

write_text(Path("sweep.toml"), SWEEP)
write_text(Path("walk.scenario.toml"), SCENARIO)
for command, runs in RUNS.items():
    if command in commands:
        for arguments, leaves in runs:
            run(command, arguments, leaves)
for command, arguments in SERVED.items():
    serve(command, arguments)

examples = sorted(Path("examples").glob("[0-9][0-9]_*.py"))
assert len(examples) >= 10, examples
for example in examples:
    if example.name != "11_design_studies.py":  # some thirty designs; run by the tests
        subprocess.run([sys.executable, example], check=True, stdout=subprocess.DEVNULL)
        print(example, flush=True)
print("the installed wheel works")
