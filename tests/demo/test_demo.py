"""The demonstration, once, end to end: what a newcomer gets from the first command."""

import json

import pytest

from frontal_biped.analysis.proof import verify
from frontal_biped.cli import main
from frontal_biped.gait.file import load_gait
from frontal_biped.simulation import load_trajectory
from frontal_biped.zero_dynamics.proof.theorems import Proof

FILES = {"gait.json", "gait.proof.json", "run.npz", "report.json", "report.html", "figures"}
FIGURES = {
    "barrier",
    "joint_angles",
    "snapshots",
    "phase_portrait",
    "energy",
    "torques",
    "ground_reaction",
    "swing_foot_height",
    "sensitivity",
    "return_map",
}

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("demo") / "new" / "demo"
    assert main(["demo", "--prove", "--out", str(path)]) == 0
    return path


@pytest.fixture(scope="module")
def report(folder):
    return json.loads((folder / "report.json").read_text())


def test_files(folder):
    assert {path.name for path in folder.iterdir()} == FILES
    for suffix in (".svg", ".png"):
        assert {path.stem for path in (folder / "figures").glob(f"*{suffix}")} == FIGURES
    assert folder.stat().st_mode & 0o055 == 0o055  # readable by others, as folders are


def test_certificate_and_cost(report):
    assert report["success"]
    assert report["analysis"]["certified"]
    assert report["analysis"]["cost"] <= 210.5
    assert max(report["analysis"]["residuals"].values()) <= 1e-9


def test_both_verdicts_are_told(report, folder):
    """What measurement says of the gait, and what the proof says."""
    found = {entry["statement"]: (entry["measured"], entry["proved"]) for entry in report["statements"]}
    assert found["0 < multiplier < 1"] == ("certified", "proved")
    assert found["b fixed: it has one at most"] == ("refuted", "refuted")
    assert verify(folder / "gait.proof.json", gait=folder / "gait.json").proof.zero.proved is Proof.PROVED
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert '<section id="statements">' in page and "C01 to C09, 49 bounds" in page


def test_constraints_are_all_listed_with_value_bound_and_margin(report):
    checks = report["analysis"]["constraints"]["checks"]
    assert {check["code"] for check in checks} >= {f"C0{i}" for i in range(1, 10)}
    for check in checks:
        assert check["satisfied"]
        assert {"value", "bound", "margin", "unit"} <= set(check)


def test_full_model(report):
    simulation = report["simulation"]
    assert simulation["steps"] == 20
    assert simulation["continuous_post_impact_state_error"] <= 1e-7
    assert simulation["sampled"]["steps_completed"] == 20
    assert simulation["multiplier"] == pytest.approx(report["analysis"]["multiplier"], rel=1e-4)
    assert 0.8 < simulation["sampling_order"] < 1.3
    errors = [run["worst_output_error"] for run in simulation["sampling_periods"]]
    assert errors == sorted(errors, reverse=True)  # falls with the period


def test_sensitivity_is_told(report, folder):
    assert [row["speed_error"] for row in report["speed_errors"]] == [0.001, -0.001]
    page = (folder / "report.html").read_text()
    assert "error in the post-impact speed" in page
    assert "rad of invariance" in page


def test_gait_and_run_load(folder):
    assert load_gait(folder / "gait.json").robot.name == "frontal_biped"
    run = load_trajectory(folder / "run.npz")
    assert run.steps_completed == 20


def test_it_can_be_repeated_into_the_same_folder_and_keeps_other_files(folder, monkeypatch):
    """A failure half-way leaves the folder as it was."""
    before = {path: path.stat().st_mtime_ns for path in folder.rglob("*")}

    def broken(*_, **__):
        raise OSError(28, "No space left on device", "figures")

    monkeypatch.setattr("frontal_biped.demo.demo._draw", broken)
    monkeypatch.setattr("frontal_biped.demo.demo.STEPS", 1)
    for slow_part in ("SHOWN_STABILISERS", "SHOWN_PUSHES", "REVERSAL_ERRORS"):
        monkeypatch.setattr(f"frontal_biped.demo.demo.{slow_part}", ())
    assert main(["demo", "--out", str(folder)]) == 2
    assert {path: path.stat().st_mtime_ns for path in folder.rglob("*")} == before


def test_robustness_is_reported(report, folder):
    assert {run["stabiliser"] for run in report["sensitivity"]["runs"]} == {"fixed", "re-anchored"}
    card = report["robustness"]["robust"]
    assert card["basins"]["ankle"]["low"] <= 0.4
    assert card["basins"]["ankle"]["high"] >= 1.8
    page = (folder / "report.html").read_text()
    assert "<h2>Robustness</h2>" in page
    assert "speeds that return, ankle" in page
