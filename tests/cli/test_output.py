"""What a command writes never replaces what it reads, whatever the command, the option and the way to the file."""

import os
import shutil
from pathlib import Path

import pytest

from frontal_biped.cli import main
from frontal_biped.cli.output import require_output
from frontal_biped.gait.shipped import specifications_dir
from frontal_biped.model.urdf.proposal import propose_description

DATA = Path(__file__).parents[1] / "data"


@pytest.fixture(scope="module")
def proposed(tmp_path_factory):
    """Text of the robot's description."""
    folder = tmp_path_factory.mktemp("proposed")
    shutil.copy(DATA / "mini.urdf", folder)
    return propose_description(folder / "mini.urdf").text


@pytest.fixture
def files(tmp_path, monkeypatch, proposed):
    """A robot, its description, a gait, a specification, a scenario and links to them, in the current folder."""
    monkeypatch.chdir(tmp_path)
    shutil.copy(DATA / "mini.urdf", "mini.urdf")
    shutil.copy(DATA / "gait.json", "gait.json")
    shutil.copy(specifications_dir() / "robust.toml", "spec.toml")
    Path("mini.toml").write_text(proposed, encoding="utf-8")
    Path("still.scenario.toml").write_text('about = "a walk"\ngait = "gait.json"\n', encoding="utf-8")
    for name in ("mini.urdf", "mini.toml", "gait.json"):
        Path(f"soft_{name}").symlink_to(name)
        os.link(name, f"hard_{name}")
    return tmp_path


# command line without its output, option, files that it must not replace
COMMANDS = [
    ("robots --describe mini.urdf", "-o", ("mini.urdf", "soft_mini.urdf", "hard_mini.urdf", "./mini.urdf")),
    ("robots --describe soft_mini.urdf", "-o", ("mini.urdf", "hard_mini.urdf")),
    ("robots --describe mini.urdf", "-o", ("gait.json", "spec.toml", "still.scenario.toml")),
    ("robots --posture mini.toml", "-o", ("mini.toml", "mini.urdf", "soft_mini.toml", "hard_mini.urdf")),
    ("robots --bend mini.toml", "-o", ("mini.toml", "mini.urdf", "soft_mini.toml", "hard_mini.urdf")),
    ("design --robot mini.toml", "-o", ("mini.toml", "mini.urdf", "soft_mini.urdf")),
    ("design --robot mini.urdf", "-o", ("mini.toml", "mini.urdf", "hard_mini.toml")),
    ("design --spec spec.toml --start gait.json", "-o", ("spec.toml", "gait.json", "soft_gait.json")),
    ("simulate gait.json --robot mini.toml", "-o", ("gait.json", "mini.toml", "mini.urdf", "hard_gait.json")),
    ("view gait.json --robot mini.toml", "--html", ("gait.json", "mini.toml", "mini.urdf", "soft_gait.json")),
    ("view spec.toml gait.json", "--html", ("gait.json",)),
    ("walk mini.toml --gait gait.json", "-o", ("gait.json", "mini.toml", "mini.urdf")),
    ("walk mini.urdf --gait gait.json", "--html", ("gait.json", "mini.toml", "mini.urdf")),
]


def with_ending(name, command, option):
    """A name of the same file that ends as the command asks of what it writes; that is asked first."""
    ending = {"design": ".json", "robots": ".toml", "trial": ".xml"}.get(command, ".npz" if option == "-o" else ".html")
    if command == "robots" or name.endswith(ending):
        return name
    Path(f"{name}{ending}").symlink_to(name)
    return f"{name}{ending}"


@pytest.mark.parametrize(("line", "option", "targets"), COMMANDS)
def test_inputs_are_never_replaced(line, option, targets, files, capsys):
    for named in targets:
        target = with_ending(named, line.split()[0], option)
        before = {path.name: (path.is_symlink(), path.read_bytes()) for path in files.iterdir()}
        capsys.readouterr()
        assert main([*line.split(), option, target]) == 2, target
        message = capsys.readouterr().err
        assert message.count("\n") == 1
        assert Path(target).name in message
        assert "choose another path" in message
        assert {path.name: (path.is_symlink(), path.read_bytes()) for path in files.iterdir()} == before


def test_an_archive_is_not_exported_onto_itself(tmp_path, capsys):
    run = tmp_path / "run.npz"
    run.write_bytes(b"a run")
    assert main(["export", str(run), "-o", str(run)]) == 2
    assert "reads or writes as well" in capsys.readouterr().err
    assert run.read_bytes() == b"a run"


def test_one_file_cannot_be_run_and_page(files, capsys):
    assert main(["walk", "mini.urdf", "-o", "new.npz", "--html", "new.npz"]) == 2
    assert "'new.npz' does not end in .html" in capsys.readouterr().err
    assert not Path("new.npz").exists()


def test_a_scenario_is_not_its_own_report(files, capsys):
    for named in ("still.scenario.toml", "gait.json", "hard_gait.json"):
        target = with_ending(named, "trial", "--junit")
        before = Path(target).read_bytes()
        assert main(["trial", "still.scenario.toml", "--junit", target]) == 2
        assert f"{target}: is a file that the command reads or writes as well" in capsys.readouterr().err
        assert Path(target).read_bytes() == before


def test_names_of_what_is_packaged_are_no_files(tmp_path, monkeypatch):
    """A file may be called as a packaged robot or specification is."""
    monkeypatch.chdir(tmp_path)
    require_output(Path("romeo"), "robust", None, robot="romeo")
    require_output(Path("robust"), "robust", robot="romeo")
    require_output(None, "robust")


def test_a_description_may_be_written_anew(files):
    assert main(["robots", "--describe", "mini.urdf", "-o", "mini.toml"]) == 0


def test_names_that_are_not_utf8_are_refused_wherever_they_stand(files, capsys):
    odd = "r\udce9"
    for line in (["design", "--robot", odd], ["view", f"{odd}.npz"], ["design", "-o", f"{odd}.json"]):
        assert main(line) == 2
        message = capsys.readouterr().err
        assert "is not UTF-8; rename it" in message
        assert message.count("\n") == 1
