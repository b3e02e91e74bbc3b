"""Runs that are odd, each in a way that a file may be: every command ends in a file or in one line, nothing between."""

import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from small_runs import planar_run
from swept_walk import swept_walk

from frontal_biped.cli import main
from frontal_biped.exceptions import TrajectoryFileError
from frontal_biped.figures.write import figure_makers
from frontal_biped.gait import load_gait
from frontal_biped.model import load_robot
from frontal_biped.simulation import load_spatial_run, load_trajectory, save_spatial_run, save_trajectory
from frontal_biped.simulation.csv_table import run_table
from frontal_biped.simulation.trajectory import FARTHEST, SAMPLED

OLD = Path(__file__).parents[1] / "data" / "version_0_1_0"


@pytest.fixture(scope="module")
def planar():
    return load_trajectory(OLD / "run.npz")


@pytest.fixture(scope="module")
def spatial():
    return swept_walk(load_robot(OLD / "walker.toml"), load_gait(OLD / "gait.json"), steps=1, step_length=0.0)


def outcome(run, folder, capsys, *words):
    """Exit status and complaints of a command, with warnings as errors; what fails writes nothing."""
    path, out = folder / "odd.npz", folder / "out"
    out.mkdir(exist_ok=True)
    save = save_trajectory if hasattr(run, "stance_y") else save_spatial_run
    save(run, path)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", category=DeprecationWarning)  # of other packages, as they are imported
        status = main(
            [str(path) if word == "RUN" else str(out / word) if word[:4] == "out." else word for word in words]
        )
    told = [line for line in capsys.readouterr().err.splitlines() if "warning: the gait was designed" not in line]
    assert (status, len(told), len(list(out.iterdir()))) in {(0, 0, 1), (2, 1, 0)}, told
    return told[0] if told else ""


def stretched(run, factor):
    return replace(run, t=run.t * factor, event_t=run.event_t * factor)


def head_of(run, count):
    return replace(run, **{name: getattr(run, name)[:count] for name in SAMPLED}, steps_completed=0)


CSV, NPZ = ("export", "RUN", "-o", "out.csv"), ("export", "RUN", "-o", "out.npz")


class TestRates:
    @pytest.mark.parametrize("rate", ["1e308", "1e9", "1e-320", "1e-3", "nan", "inf", "0", "-5"])
    @pytest.mark.parametrize("ending", ["csv", "npz", "mcap"])
    def test_judged_before_anything_is_computed(self, planar, tmp_path, capsys, rate, ending):
        assert "--rate" in outcome(planar, tmp_path, capsys, "export", "RUN", "-o", f"out.{ending}", f"--rate={rate}")

    def test_what_is_advised_is_taken(self, planar, tmp_path, capsys):
        least = outcome(planar, tmp_path, capsys, *CSV, "--rate", "1e-3").rsplit(" ", 1)[1]
        assert outcome(planar, tmp_path, capsys, *CSV, "--rate", least) == ""

    @pytest.mark.parametrize("fps", ["1e-320", "1e9", "51", "0.1", "nan"])
    def test_pictures(self, planar, tmp_path, capsys, fps):
        assert "--fps" in outcome(planar, tmp_path, capsys, "export", "RUN", "-o", "out.gif", f"--fps={fps}")

    def test_too_many_pictures(self, planar, tmp_path, capsys):
        words = ("export", "RUN", "-o", "out.gif", "--fps", "50")
        assert "pictures" in outcome(stretched(planar, 1000.0), tmp_path, capsys, *words)

    def test_one_instant_is_no_animation(self, planar, tmp_path, capsys):
        assert "write a .png" in outcome(head_of(planar, 1), tmp_path, capsys, "export", "RUN", "-o", "out.gif")

    def test_in_space(self, spatial, tmp_path, capsys):
        assert "--rate" in outcome(spatial, tmp_path, capsys, *NPZ, "--rate", "1e9")


class TestSamples:
    @pytest.mark.parametrize("count", [1, 2])
    def test_few(self, planar, tmp_path, capsys, count):
        run = head_of(planar, count)
        for words in (CSV, NPZ, (*CSV, "--rate", "2000"), ("view", "RUN", "--html", "out.html")):
            assert outcome(run, tmp_path, capsys, *words) == "" or count == 2
            for path in (tmp_path / "out").iterdir():
                path.unlink()

    def test_all_at_one_time(self, planar, tmp_path, capsys):
        assert outcome(stretched(planar, 0.0), tmp_path, capsys, *CSV) == ""

    def test_times_nearer_than_times_are(self, planar, tmp_path, capsys):
        for factor in (1e-320, 1e-100):
            assert "apart" in outcome(stretched(planar, factor), tmp_path, capsys, *CSV, "--rate", "100")

    def test_steps_that_are_not_there(self, planar, spatial, tmp_path, capsys):
        for run in (planar, spatial):
            late = replace(run, step=run.step + 5.0)
            assert "begins with step 6; choose --steps 6" in outcome(late, tmp_path, capsys, *CSV, "--steps", "1")

    def test_a_robot_that_diverges(self, planar, spatial, tmp_path, capsys):
        """Drawn, written and plotted until then, whether it ends in NaN or in numbers without bounds."""
        for run in (planar, spatial):
            for value in (np.nan, np.inf, 1e300, 2.0 * FARTHEST):
                q = run.q.copy()
                q[-3:] = value
                for words in (CSV, ("view", "RUN", "--html", "out.html")):
                    assert outcome(replace(run, q=q), tmp_path, capsys, *words) == ""
                    for path in (tmp_path / "out").iterdir():
                        path.unlink()
        q = planar.q.copy()
        q[-3:] = 1e300
        _, rows = run_table(load_robot(OLD / "walker.toml"), replace(planar, q=q))
        assert len(rows) == len(planar.t) - 3

    def test_figures(self, planar):
        """With an FRI that nobody knows, and with a robot that diverges."""
        biped = load_robot(OLD / "walker.toml")
        q = planar.q.copy()
        q[3:] = np.inf
        unknown = np.full_like(planar.p_fri, np.nan)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            for run in (replace(planar, p_fri=unknown), replace(planar, q=q), head_of(planar, 1)):
                for make in figure_makers(biped, None, run).values():
                    make()


PUSH = {"start": 0.1, "duration": 0.1, "impulse": 1.0}


@pytest.mark.parametrize(
    "push",
    [
        3, [], "push", {}, {**PUSH, "start": float("inf")}, {**PUSH, "start": 10**400}, {**PUSH, "start": 10**399},
        {**PUSH, "duration": float("nan")}, {**PUSH, "impulse": 1e308}, {**PUSH, "impulse": [1e308] * 3},
        {**PUSH, "impulse": {}}, {**PUSH, "point": [float("nan")] * 3}, {**PUSH, "step": []}, {**PUSH, "step": "a"},
        {**PUSH, "step": 1.5}, {**PUSH, "step": 10**300, "phase": []},
    ],
    ids=lambda push: repr(push)[:40],
)  # fmt: skip
def test_pushes_that_are_none_are_passed_over(planar, spatial, tmp_path, capsys, push):
    for run in (
        replace(planar, settings={"disturbances": {"pushes": [push]}}), replace(spatial, settings={"pushes": [push]}),
    ):  # fmt: skip
        assert outcome(run, tmp_path, capsys, "view", "RUN", "--html", "out.html") == ""
        (tmp_path / "out" / "out.html").unlink()


@pytest.mark.parametrize("robot", ["nobody", "/dev/zero", "/", "..", " ", "x" * 900, "../../../etc/passwd"])
def test_robots_that_are_none(tmp_path, capsys, robot):
    assert robot.strip()[:20] in outcome(replace(planar_run(), robot=robot), tmp_path, capsys, *CSV)


def test_the_robot_of_another_run(spatial, tmp_path, capsys):
    run = replace(spatial, gait={}, robot="g1")
    assert "4 joints, g1 moves" in outcome(run, tmp_path, capsys, *CSV)


@pytest.mark.parametrize("key", ["version", "robot", "steps", "specification"])
def test_a_gait_that_is_none_is_complained_of_under_the_name_of_the_run(planar, tmp_path, capsys, key):
    for value in (None, [], "x", {"a": 1}):
        run = replace(planar, gait={**planar.gait, key: value})
        assert f"{tmp_path / 'odd.npz'}: gait" in outcome(run, tmp_path, capsys, *CSV)


def test_names_that_are_too_long_are_not_there(planar, tmp_path):
    gait = {**planar.gait, "robot": {**planar.gait["robot"], "description": "x" * 300}}
    save_trajectory(replace(planar, gait=gait), tmp_path / "run.npz")
    assert load_trajectory(tmp_path / "run.npz").gait["robot"]["description"].endswith("x" * 300)


def test_a_page_of_another_kind(planar, tmp_path):
    with pytest.raises(TrajectoryFileError, match="is a run in the plane, not a run in space"):
        save_trajectory(planar, tmp_path / "run.npz")
        load_spatial_run(tmp_path / "run.npz")
