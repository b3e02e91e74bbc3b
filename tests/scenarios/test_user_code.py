"""Whatever a user's module, factory or controller does, `trial` ends in one line, and never as if all were well."""

import json
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from frontal_biped.cli import main
from frontal_biped.control.interface import WalkerCommand
from frontal_biped.control.walker.walker import Walker
from frontal_biped.exceptions import ControllerError, Interruption, ScenarioError
from frontal_biped.scenarios import load_scenario, run_scenario
from frontal_biped.scenarios.user_code import guarded, users_own

MODULE = """
import os, sys
from frontal_biped.control.walker.walker import Walker

class Theirs(BaseException): pass
class Stop(KeyboardInterrupt): pass
class Unprintable(Exception):
    def __str__(self): raise RuntimeError

class Failing(Walker):
    error, on = None, "tick"
    def tick(self, reading):
        if self.on == "tick": raise self.error
        return super().tick(reading)
    def reset(self, *start):
        if self.on == "reset": raise self.error
        super().reset(*start)

def failing(error, on="tick"):
    def make(robot, gait, period):
        walker = Failing(robot, gait, period=period)
        walker.error, walker.on = error, on
        return walker
    return make

leaves, theirs, stops = failing(SystemExit(0)), failing(Theirs("two\\nlines")), failing(Stop(), "reset")
closes, fails, hidden = failing(GeneratorExit()), failing(ValueError("no")), failing(Unprintable())
def leaving(robot, gait, period): sys.exit(0)
def refusing(robot): raise AssertionError
def wandering(robot, gait, period):
    print("hello"); os.chdir("/")
    return Walker(robot, gait, period=period)
"""


@pytest.fixture
def scenario(tmp_path, monkeypatch):
    """Writes a scenario with a controller of a fresh module of the user's."""
    monkeypatch.setattr(sys, "path", list(sys.path))
    number = len([name for name in sys.modules if name.startswith("users_own_")])

    def write(factory: str, text: str = MODULE):
        name = f"users_own_{number}"
        (tmp_path / f"{name}.py").write_text(text)
        path = tmp_path / "t.scenario.toml"
        path.write_text(f'gait = "robust"\nsteps = 1\ncontroller = "{name}:{factory}"\n')
        return path

    return write


@pytest.mark.parametrize(
    ("factory", "words"),
    [
        ("leaves", "its tick fails, SystemExit: 0 in line"),
        ("theirs", "its tick fails, Theirs: two lines in line"),
        ("stops", "its reset fails, Stop: "),
        ("closes", "its tick fails, GeneratorExit: "),
        ("fails", "its tick fails, ValueError: no in line"),
        ("hidden", "its tick fails, Unprintable: an error that cannot be shown"),
        ("leaving", "the factory fails, SystemExit: 0 in line"),
        ("refusing", "the factory refused, "),
    ],
)
def test_whatever_is_raised(factory, words, scenario, capsys):
    path = scenario(factory)
    assert main(["trial", str(path), "--json"]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1 and words in err
    assert f"{path}: controller = 'users_own_" in err
    with pytest.raises(ScenarioError):
        run_scenario(load_scenario(path))


@pytest.mark.parametrize("text", ["import sys; sys.exit(0)", "raise KeyboardInterrupt.__mro__[1]('x')", "1 / 0", "def"])
def test_a_module_that_cannot_be_imported(text, scenario, capsys):
    assert main(["trial", str(scenario("make", text))]) == 2
    err = capsys.readouterr().err
    assert err.count("\n") == 1 and "importing it fails" in err and "mend the module" in err


def test_ctrl_c_passes():
    for error in (KeyboardInterrupt(), Interruption(15)):
        with pytest.raises(type(error)), users_own("t.toml", "importing it", "mend it"):
            raise error


def test_what_it_prints_is_no_part_of_the_report_and_its_folder_is_its_own(scenario, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    path = scenario("wandering")
    assert main(["trial", path.name, "--json", "--save", "runs"]) == 0
    out, err = capsys.readouterr()
    assert json.loads(out)["passed"]
    assert "hello" in err
    assert Path.cwd() == tmp_path
    assert (tmp_path / "runs" / "t-0.npz").exists()


def test_a_guarded_controller_is_the_controller_by_name():
    walker = guarded(SimpleNamespace(tick=lambda reading: reading, reset=None, counters=dict), "t.toml")
    assert type(walker).__name__ == "SimpleNamespace"
    assert walker.tick(3) == 3 and walker.counters() == {}
    assert not hasattr(walker, "begin")


class Answering(Walker):
    """Answers as `Walker`, one thing changed."""

    change: dict = {}  # noqa: RUF012

    def tick(self, reading):
        command = super().tick(reading)
        fields = {name: getattr(command, name) for name in WalkerCommand._fields}
        fields |= self.change
        return SimpleNamespace(**{name: value for name, value in fields.items() if value is not Answering})


class Evil:
    def __array__(self, *_, **__):
        raise RuntimeError("evil")

    def __repr__(self):
        raise RuntimeError("evil")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"joint_torques": ["1", "2", "3", "4"]}, "4 finite numbers"),
        ({"joint_torques": [1 + 0j] * 4}, "4 finite numbers"),
        ({"joint_torques": [True] * 4}, "4 finite numbers"),
        ({"joint_torques": [10**400] * 4}, "4 finite numbers"),
        ({"joint_torques": [[1.0]] * 4}, "4 finite numbers"),
        ({"joint_torques": Evil()}, "with joint_torques = Evil; return"),
        ({"event": "landing"}, "with event = 'landing'; give it a member of PhaseEvent or None"),
        ({"stance": "left"}, "with stance = 'left'; give it a member of Stance"),
        ({"phase": 3}, "with phase = 3; give it a member of StepPhase"),
        ({"y": [0.0]}, "with y = .0.0.; give it 3 numbers"),
        ({"q": None}, "with q = None; give it 4 numbers"),
        ({"p_fri_target": Answering}, "without p_fri_target"),
        ({"event": Answering}, "without event"),
    ],
)
def test_whatever_is_answered(change, words, tmp_path, recwarn):
    path = tmp_path / "t.scenario.toml"
    path.write_text('gait = "robust"\nsteps = 1\n')
    made = type("Own", (Answering,), {"change": change})
    with pytest.raises(ControllerError, match=words) as caught:
        run_scenario(load_scenario(path), controller=made)
    assert str(caught.value).startswith(f"{path}: the controller given: the controller's tick at t = 0.0000 s")
    assert "\n" not in str(caught.value)
    assert not recwarn.list
