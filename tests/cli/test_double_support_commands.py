"""The commands on a gait with a finite double support: what they can do, and the one line where they cannot."""

import json
from pathlib import Path

import pytest

from frontal_biped.cli import main

GAIT = str(Path(__file__).parents[1] / "data" / "support.gait.json")


def test_analyze(capsys):
    assert main(["analyze", GAIT]) == 0
    assert "certified" in capsys.readouterr().out
    assert main(["analyze", GAIT, "--json"]) == 0
    table = json.loads(capsys.readouterr().out)
    assert table["certified"] and table["impulse"] < 1e-12


@pytest.mark.slow
def test_simulate_view_and_plot_the_run(tmp_path, capsys):
    pytest.importorskip("mujoco")
    run = tmp_path / "run.npz"
    assert main(["simulate", GAIT, "--steps", "1", "--engine", "mujoco", "-o", str(run), "--json"]) == 0
    table = json.loads(capsys.readouterr().out)
    assert table["outcome"] == "completed" and 1 <= table["landings_to_rest"] <= 2
    assert abs(table["first_speed_error"]) < 0.05
    assert main(["view", str(run), "--html", str(tmp_path / "page.html")]) == 0
    assert main(["plot", str(run), "-o", str(tmp_path / "figures")]) == 0
    assert (tmp_path / "page.html").is_file() and list((tmp_path / "figures").iterdir()) != []


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["view", GAIT, "--html", "page.html"], "without double_support"),
        (["plot", GAIT, "-o", "figures"], "without double_support"),
        (["analyze", GAIT, "--robustness"], "leave it out"),
        (["analyze", GAIT, "--prove"], "leave it out"),
        (["simulate", GAIT, "--stabiliser", "step"], "--stabiliser: a gait with a finite double support"),
        (["simulate", GAIT, "--continuous"], "--continuous: a gait with a finite double support"),
        (["simulate", GAIT, "--rate", "500"], "--rate: a gait with a finite double support"),
        (["simulate", GAIT, "--encoder-noise", "0.001"], "--encoder-noise: a gait with a finite double support"),
    ],
)
def test_refused_in_one_line(arguments, words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(arguments) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and words in said
    assert list(tmp_path.iterdir()) == []


def test_design_refuses_what_it_does_not_have(tmp_path, capsys):
    spec = tmp_path / "spec.toml"
    spec.write_text("double_support = [0.1, 0.2]\n", encoding="utf-8")
    assert main(["design", "--spec", str(spec), "--attempts", "3", "-o", str(tmp_path / "gait.json")]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and "--attempts: a gait with a finite double support" in said


@pytest.mark.slow
def test_design(tmp_path, capsys):
    spec, gait = tmp_path / "spec.toml", tmp_path / "gait.json"
    spec.write_text("double_support = [0.1, 0.2]\nmin_phase_range = 0.04\n", encoding="utf-8")
    assert main(["design", "--spec", str(spec), "-o", str(gait), "--json"]) == 0
    table = json.loads(capsys.readouterr().out)
    assert table["success"] and table["certificate"]["certified"]
    assert 0.1 <= table["double_support"] <= 0.2
    assert main(["analyze", str(gait)]) == 0
