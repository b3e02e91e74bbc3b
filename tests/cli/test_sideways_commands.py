"""The commands on a gait of two steps: what they can do, and the one line where they cannot."""

import json
from pathlib import Path

import pytest

from frontal_biped.cli import main

GAIT = str(Path(__file__).parents[1] / "data" / "sideways.gait.json")


@pytest.mark.slow
def test_analyze(capsys):
    assert main(["analyze", GAIT]) == 0
    said = capsys.readouterr().out
    assert "certified" in said and "0.1 m sideways in two steps" in said
    assert main(["analyze", GAIT, "--json"]) == 0
    table = json.loads(capsys.readouterr().out)
    assert table["certified"] and table["travel"] == pytest.approx(0.1)
    assert table["multiplier"] == pytest.approx(table["rho_a"]["m"] * table["rho_b"]["m"])
    assert table["constraints"]["satisfied"]


def test_simulate_view_and_plot_the_run(tmp_path, capsys):
    run = tmp_path / "run.npz"
    assert main(["simulate", GAIT, "--steps", "2", "--continuous", "-o", str(run), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["steps_completed"] == 2
    assert main(["view", str(run), "--html", str(tmp_path / "page.html")]) == 0
    assert main(["plot", str(run), "-o", str(tmp_path / "figures")]) == 0
    assert (tmp_path / "page.html").is_file() and list((tmp_path / "figures").iterdir()) != []


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["view", GAIT, "--html", "page.html"], "without travel"),
        (["plot", GAIT, "-o", "figures"], "without travel"),
        (["analyze", GAIT, "--robustness"], "leave it out"),
        (["analyze", GAIT, "--prove"], "leave it out"),
        (["simulate", GAIT, "--stabiliser", "step"], "known: fixed, re-anchored"),
    ],
)
def test_refused_in_one_line(arguments, words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(arguments) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and words in said
    assert list(tmp_path.iterdir()) == []


def test_design_with_travel(tmp_path, capsys):
    spec, gait = tmp_path / "spec.toml", tmp_path / "gait.json"
    spec.write_text("travel = 0.02\n", encoding="utf-8")
    assert main(["design", "--quick", "--spec", str(spec), "-o", str(gait), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["success"]
    assert len(json.loads(gait.read_text(encoding="utf-8"))["steps"]) == 2
    assert main(["design", "--look-ahead", "--spec", str(spec), "-o", str(gait)]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and "--look-ahead" in said
    spec.write_text("travel = 0.3\n", encoding="utf-8")
    assert main(["design", "--quick", "--spec", str(spec)]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and "travel = 0.3 m in two steps is not in [0, 0.2]" in said
