"""The example of every command's help runs as it is printed, in a folder with the inputs that it names."""

import re
import shlex
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from frontal_biped.analysis.proof import prove
from frontal_biped.cli.main import COMMANDS, main
from frontal_biped.gait import save_gait
from frontal_biped.model import models_dir
from frontal_biped.simulation import save_trajectory

SCENARIOS = Path(__file__).parents[2] / "examples" / "scenarios"
QUICK = {"export", "robots"}
"""The others take seconds to a minute."""

SERVED = {"studio": "viser"}
"""Stay until they are ended; and the extra that they need."""

NEEDED = {"walk": "mujoco", "plot": "matplotlib", "demo": "matplotlib", "verify": "flint"}

NAMES = [command.__name__.rpartition(".")[2] for command in COMMANDS]
EXAMPLES = dict(zip(NAMES, (command.EXAMPLE for command in COMMANDS), strict=True))


@pytest.fixture
def folder(gait, walk, tmp_path, monkeypatch):
    """What the examples read: a gait, a proof, a run, a sweep, a URDF, scenarios."""
    save_gait(gait, tmp_path / "gait.json")
    save_trajectory(walk, tmp_path / "run.npz")
    (tmp_path / "sweep.toml").write_text('robot = "frontal_biped"\n[sweep]\nmax_pelvis_roll = [0.1, 0.12]\n')
    shutil.copy(models_dir() / "frontal_biped.urdf", tmp_path / "my.urdf")
    shutil.copytree(SCENARIOS, tmp_path / "examples" / "scenarios")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def proof(folder):
    """A certificate of the gait."""
    prove("frontal_biped", folder / "gait.json").save(folder / "gait.proof.json")


def printed(command, capsys):
    assert main([command, "--help"]) == 0
    program, *words = shlex.split(capsys.readouterr().out.partition("\nexample: ")[2])
    assert (program, words[0], shlex.join([program, *words])) == ("frontal-biped", command, EXAMPLES[command])
    return words


def test_names_of_what_is_special_are_commands():
    assert QUICK | set(SERVED) | set(NEEDED) <= set(NAMES)


@pytest.mark.parametrize(
    "command", [name if name in QUICK else pytest.param(name, marks=pytest.mark.slow) for name in EXAMPLES]
)
def test_runs_as_printed(command, folder, request, capsys):
    if command in NEEDED:
        pytest.importorskip(NEEDED[command])
    if command == "verify":
        request.getfixturevalue("proof")
    words = printed(command, capsys)
    if command in SERVED:
        pytest.importorskip(SERVED[command])
        ends_when_told([*words, "--no-open"])
        return
    made = re.findall(r"(?:-o|--out|--html|--save) (\S+)", EXAMPLES[command])
    for name in made:
        (folder / name).unlink(missing_ok=True)  # what another example reads
    assert main(words) == 0
    out = capsys.readouterr().out
    assert out.strip()
    assert all((folder / name).exists() for name in made)
    if command in ("design", "simulate", "walk"):  # say what they wrote
        assert all(name in out for name in made if name.endswith((".json", ".npz", ".html")))


def ends_when_told(words):
    process = subprocess.Popen([sys.executable, "-m", "frontal_biped", *words], stdout=subprocess.PIPE, text=True)
    try:
        assert "http://127.0.0.1:" in process.stdout.readline()
        process.send_signal(signal.SIGTERM)
        assert process.wait(60) == 0
    finally:
        process.kill()
