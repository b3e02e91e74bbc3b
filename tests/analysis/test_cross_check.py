"""Two engines, one walker: what is reported, and that it is right where it is known."""

import json

import pytest

from frontal_biped.analysis.cross_check import cross_check
from frontal_biped.cli import main
from frontal_biped.design import optimise_gait
from frontal_biped.gait import load_specification
from frontal_biped.gait.file import save_gait
from frontal_biped.simulation import Disturbances, Push, load_trajectory

pytest.importorskip("mujoco")


@pytest.fixture(scope="module")
def rough(biped):
    return optimise_gait(biped, load_specification("rough")).gait


@pytest.fixture(scope="module")
def checked(biped, rough):
    return cross_check(biped, rough, steps=4)


def test_engines_agree(checked, rough):
    check, runs = checked
    mujoco, ours = check.reports
    assert (mujoco.engine, ours.engine) == tuple(runs) == ("mujoco", "ours")
    assert check.walked
    assert abs(check.step_time_difference) < 0.02
    for report in check.reports:
        assert report.steps == 4
        assert report.step_time == pytest.approx(rough.orbit.step_duration, rel=0.02)
        assert abs(report.speed_error) <= report.largest_speed_error < 0.03
        assert report.cost == pytest.approx(rough.orbit.cost, rel=0.05)
        assert report.unsolved == 0
    assert mujoco.work == pytest.approx(ours.work, rel=0.05)
    assert ours.foot_slip == ours.foot_rotation == ours.double_support == 0.0  # our feet are rigid and stick
    assert 0.0 < mujoco.foot_slip < 1e-3
    assert 0.0 < mujoco.double_support < 0.01


def test_table_has_a_column_for_each(checked):
    text = str(checked[0])
    header, *rows = text.splitlines()
    assert header.split() == ["frontal_biped", "mujoco", "ours", "gait"]
    assert all(len(row) <= len(header) for row in rows)
    assert "FELL" not in text


def test_a_fall_is_told(biped, rough):
    disturbances = Disturbances(pushes=(Push(0.1, 0.05, 200.0),))
    check, _ = cross_check(biped, rough, engines=("mujoco",), steps=3, disturbances=disturbances)
    assert not check.walked
    assert "mujoco: FELL after" in str(check)


def test_command_line_writes_both_runs(rough, tmp_path, capsys):
    save_gait(rough, tmp_path / "gait.json")
    output = tmp_path / "run.npz"
    code = main(
        ["simulate", str(tmp_path / "gait.json"), "--engine", "both", "--steps", "2", "-o", str(output), "--json"]
    )
    table = json.loads(capsys.readouterr().out)
    assert code == 0
    assert table["output"] == [str(tmp_path / f"run.{engine}.npz") for engine in ("mujoco", "ours")]
    assert [report["engine"] for report in table["cross_check"]["reports"]] == ["mujoco", "ours"]
    assert not output.exists()
    for path in table["output"]:
        assert load_trajectory(path).steps_completed == 2
