"""Run files of walks in space on the command line: viewed, plotted, exported; refused in one line."""

import csv
from dataclasses import replace

import numpy as np
import pytest
from swept_walk import swept_walk

from frontal_biped.cli import main
from frontal_biped.simulation.space.run import load_spatial_run, save_spatial_run


@pytest.fixture(scope="module")
def spatial_file(biped, gait, tmp_path_factory):
    path = tmp_path_factory.mktemp("space") / "walk.npz"
    save_spatial_run(swept_walk(biped, gait, steps=2, step_length=0.0), path)
    return path


def test_view_writes_a_page(spatial_file, tmp_path, capsys):
    page = tmp_path / "page.html"
    assert main(["view", str(spatial_file), "--html", str(page)]) == 0
    assert "Frontal phase portrait" in page.read_text(encoding="utf-8")
    assert "offline" in capsys.readouterr().out


def test_plot_writes_figures(spatial_file, tmp_path):
    assert main(["plot", str(spatial_file), "-o", str(tmp_path), "--format", "svg"]) == 0
    assert {path.stem for path in tmp_path.iterdir()} == {
        "footsteps", "pressure", "frontal_state", "speed", "joint_limits",
    }  # fmt: skip


def test_export_writes_table_and_arrays(spatial_file, tmp_path):
    table, arrays = tmp_path / "run.csv", tmp_path / "run.npz"
    assert main(["export", str(spatial_file), "-o", str(table), "--steps", "1", "--rate", "100"]) == 0
    header, *rows = list(csv.reader(table.open(encoding="utf-8")))
    run = load_spatial_run(spatial_file)
    assert all(f"{name} torque [N m]" in header for name in run.joint_names)
    assert {row[1] for row in rows} == {"1"}
    assert main(["export", str(spatial_file), "-o", str(arrays)]) == 0
    with np.load(arrays, allow_pickle=False) as content:
        np.testing.assert_array_equal(content["pinocchio_q"], run.q)
        np.testing.assert_array_equal(content["mujoco_qpos"][:, 3], run.q[:, 6])
    assert main(["export", str(spatial_file), "-o", str(arrays), "--rate", "50"]) == 0
    with np.load(arrays, allow_pickle=False) as content:
        np.testing.assert_allclose(np.diff(content["t"]), 0.02)


def test_a_run_without_its_gait_is_viewed(spatial_file, tmp_path):
    bare = tmp_path / "bare.npz"
    save_spatial_run(replace(load_spatial_run(spatial_file), gait={}, settings={}), bare)
    assert main(["view", str(bare), "--html", str(tmp_path / "page.html")]) == 0


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (["view", "RUN", "RUN", "--html", "OUT.html"], "shown alone"),
        (["view", "RUN", "--ghost", "--html", "OUT.html"], "--ghost"),
        (["view", "RUN", "--robot", "g1", "--html", "OUT.html"], "g1"),
        (["export", "RUN", "-o", "OUT.xyz"], ".npz"),
    ],
)
def test_refused_in_one_line(arguments, word, spatial_file, tmp_path, capsys):
    out = tmp_path / "out"
    words = [text.replace("RUN", str(spatial_file)).replace("OUT", str(out)) for text in arguments]
    assert main(words) == 2
    error = [line for line in capsys.readouterr().err.splitlines() if "warning" not in line]
    assert len(error) == 1 and word in error[0]
    assert list(tmp_path.iterdir()) == []
