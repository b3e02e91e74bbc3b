"""`frontal-biped walk`: what is asked for is what is walked, and what it came to is told."""

import json
from dataclasses import replace

import pytest

from frontal_biped.cli import main
from frontal_biped.simulation.disturbances import Disturbances
from frontal_biped.simulation.mujoco.spec import ContactSettings
from frontal_biped.simulation.space import walk_path as path_module
from frontal_biped.simulation.space import walk_spatial as module
from frontal_biped.simulation.space.run import load_spatial_run

pytest.importorskip("mujoco")

STEPS = 2


@pytest.fixture(scope="module")
def walked(tmp_path_factory):
    """Romeo, two steps, with everything written."""
    folder = tmp_path_factory.mktemp("walk")
    files = ("-o", str(folder / "run.npz"), "--html", str(folder / "page.html"))
    assert main(["walk", "romeo", "--steps", str(STEPS), "--speed", "0.1", "--push=2,0,0.1", *files]) == 0
    return folder


@pytest.fixture
def stub(walked, monkeypatch):
    """The walk is not walked again, but what is asked of it is kept."""
    asked = {}
    run = load_spatial_run(walked / "run.npz")

    def walk(biped, gait, **options):
        asked.update(options, biped=biped, gait=gait)
        return asked.get("run", run)

    monkeypatch.setattr(module, "walk_spatial", walk)
    asked["walked"] = run
    return asked


def test_a_walk_is_kept_and_shown(walked):
    run = load_spatial_run(walked / "run.npz")
    assert (run.robot, run.steps_completed, run.fell) == ("romeo_bent", STEPS, False)
    assert run.gait["robot"]["name"] == "romeo_bent"
    assert run.settings["pushes"][0]["impulse"] == [2.0, 0.0, 0.0]
    assert run.settings["pushes"][0]["start"] == 0.1
    assert (walked / "page.html").read_text().startswith("<!DOCTYPE html>")
    assert sorted(path.name for path in walked.iterdir()) == ["page.html", "run.npz"]  # nothing had to be made


def test_the_run_is_taken_by_the_other_commands(walked, tmp_path):
    assert main(["export", str(walked / "run.npz"), "-o", str(tmp_path / "run.csv")]) == 0
    assert (tmp_path / "run.csv").stat().st_size > 0


def test_options_are_passed_on(stub, capsys):
    noise = ["--encoder-noise", "1e-4", "--imu-noise", "2e-3", "--gyro-noise", "3e-3", "--torque-noise", "0.02"]
    ground = ["--delay", "0.003", "--ground", "0.005", "--friction", "0.4", "--seed", "7"]
    pushes = ["--push=-5,10", "--push", "1,2,0.5"]
    assert main(["walk", "romeo", "--steps", "50", "--speed=-0.1", *noise, *ground, *pushes]) == 0
    disturbances = stub["disturbances"]
    for key, value in {
        "encoder_noise": 1e-4, "imu_noise": 2e-3, "gyro_noise": 3e-3, "torque_noise": 0.02, "delay": 0.003,
        "ground_height": 0.005, "friction": 0.4, "seed": 7,
    }.items():  # fmt: skip
        assert getattr(disturbances, key) == value
    assert (stub["steps"], stub["speed"]) == (50, -0.1)
    first, second = stub["pushes"]
    assert first.impulse == (-5.0, 10.0, 0.0)
    assert first.start == pytest.approx(4.5 * stub["gait"].orbit.step_duration)  # half-way through the fifth step
    assert (second.impulse, second.start) == ((1.0, 2.0, 0.0), 0.5)
    assert "romeo walks as romeo_bent" in capsys.readouterr().err


def test_nothing_is_asked_for_that_was_not(stub):
    assert main(["walk", "romeo"]) == 0
    assert (stub["speed"], stub["steps"], stub["pushes"]) == (0.0, 20, ())
    assert (stub["lateral"], stub["turn"]) == (0.0, 0.0)
    assert stub["disturbances"] == Disturbances(friction=ContactSettings().friction)


def test_what_it_came_to(stub, capsys):
    assert main(["walk", "romeo", "--json"]) == 0
    table = json.loads(capsys.readouterr().out)
    run = stub["walked"]
    assert (table["robot"], table["outcome"], table["steps_completed"]) == ("romeo_bent", "completed", STEPS)
    assert table["distance"] == pytest.approx(run.com[-1, 0] - run.com[0, 0])
    assert table["torque_share"]["joint"] in run.joint_names
    assert table["written"] == []


def test_a_fall_is_a_failure(stub, capsys):
    run = stub["walked"]
    settings = {**run.settings, "remedy": "walk slower than 0.1 m/s"}
    stub["run"] = replace(run, outcome="the pelvis tilted by more than 60 degrees", settings=settings)
    assert main(["walk", "romeo"]) == 1
    head = capsys.readouterr().out.splitlines()[0]
    assert "romeo_bent: FELL (the pelvis tilted by more than 60 degrees) after 2 steps" in head
    assert head.endswith("; walk slower than 0.1 m/s")


def test_figures(stub, tmp_path, capsys):
    assert main(["walk", "romeo", "--figures", str(tmp_path / "figures")]) == 0
    assert list((tmp_path / "figures").glob("*.svg"))
    assert "written: " in capsys.readouterr().out


def test_a_path_is_walked_and_its_end_told(stub, monkeypatch, capsys):
    """The walk is another one; what it is asked and what is said of it are the path's."""
    told = {"words": "forward 1", "asked": [1.0, 0.0, 0.0], "odometry": [1.0, 0.004, 0.0], "ended": [0.97, 0.04, 0.1],
            "corners": [[1.0, 0.0, 0.0]], "arrived": True}  # fmt: skip

    def walk(biped, gait, words, **options):
        stub.update(options, words=words)
        return replace(stub["walked"], settings={**stub["walked"].settings, "path": told})

    monkeypatch.setattr(path_module, "walk_path", walk)
    assert main(["walk", "romeo", "--path", "forward 1", "--delay", "0.002", "--push=1,2,0.5", "--json"]) == 0
    assert (stub["words"], stub["disturbances"].delay, len(stub["pushes"])) == ("forward 1", 0.002, 1)
    found = json.loads(capsys.readouterr().out)
    assert found["path"]["arrived"]
    assert found["missed"] == pytest.approx(0.05)
    assert found["missed_by_odometry"] == pytest.approx(0.004)
    assert main(["walk", "romeo", "--path", "forward 1"]) == 0
    told = capsys.readouterr().out.splitlines()[0]
    assert told.endswith("50 mm and 5.73 degrees from its end, by odometry 4 mm and 0.00 degrees")


@pytest.mark.parametrize(("arguments", "words"), [
    (["romeo", "--push", "1"], "'1' is no push; write X,Y or X,Y,T"),
    (["romeo", "--push", "1,2,-1"], "negative"),
    (["romeo", "--push", "1,nan"], "not a finite number"),
    (["romeo", "--steps", "0"], "not a positive whole number"),
    (["rome"], "did you mean 'romeo'"),
    (["nowhere.urdf"], "no such URDF file"),
    (["romeo", "--gait", "nowhere.json"], "nowhere.json"),
    (["romeo", "--steps", "1", "--lateral", "9"], "lateral = 9: the legs do not reach as far; at most"),
    (["romeo", "--steps", "1", "--turn", "9"], "turn = 9: too much for a step; at most"),
    (["romeo", "--path", "forward 2 ft"], "'ft' is not the unit; it is m"),
    (["romeo", "--path", "forward 2", "--turn", "0.1"], "turn = 0.1 beside a path: write it there"),
    (["romeo", "-o", "."], "is a directory"),
])  # fmt: skip
def test_bad_input_is_one_line(arguments, words, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["walk", *arguments]) == 2
    lines = [line for line in capsys.readouterr().err.splitlines() if "error" in line]
    assert len(lines) == 1
    assert words in lines[0]
    assert list(tmp_path.iterdir()) == []
