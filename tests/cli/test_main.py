"""The command line: every command works, and every bad input gets one line and leaves nothing behind."""

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

from frontal_biped.cli import main
from frontal_biped.cli.main import make_parser
from frontal_biped.gait.file import load_gait, save_gait
from frontal_biped.model import models_dir

COMMANDS = (
    "demo", "design", "library", "analyze", "verify", "simulate", "walk", "trial", "view", "export", "plot", "studio",
    "robots",
)  # fmt: skip


@pytest.fixture(scope="module")
def gait_file(level_gait, tmp_path_factory):
    path = tmp_path_factory.mktemp("gait") / "gait.json"
    save_gait(level_gait, path)
    return path


@pytest.fixture(scope="module")
def run_file(gait_file):
    path = gait_file.with_name("run.npz")
    assert main(["simulate", str(gait_file), "--steps", "2", "--rate", "500", "-o", str(path)]) == 0
    return path


def robot_copy(folder: Path, edit=None, **replacements) -> Path:
    """A copy of the Table I robot with text replaced in its URDF or description; returns the description."""
    for suffix in (".toml", ".urdf"):
        text = (models_dir() / f"frontal_biped{suffix}").read_text()
        for old, new in replacements.get(suffix[1:], ()):
            assert old in text
            text = text.replace(old, new)
        (folder / f"frontal_biped{suffix}").write_text(text)
    return folder / "frontal_biped.toml"


class TestGoodInput:
    def test_commands_are_those_of_the_help(self, capsys):
        assert main(["--help"]) == 0
        assert tuple(re.findall(r"^    (\w+) ", capsys.readouterr().out, re.MULTILINE)) == COMMANDS

    @pytest.mark.parametrize("command", COMMANDS)
    def test_example_of_the_help_parses_as_printed(self, command, capsys):
        assert main([command, "--help"]) == 0
        program, *example = shlex.split(capsys.readouterr().out.partition("\nexample: ")[2])
        assert program == "frontal-biped"
        assert make_parser().parse_args(example).command == command

    def test_defaults_are_those_that_the_help_tells(self, capsys):
        assert main(["simulate", "--help"]) == 0
        shown = " ".join(capsys.readouterr().out.partition("options:")[2].split())
        parsed = make_parser().parse_args(["simulate", "gait.json"])
        for option, default in (
            ("steps", 20),
            ("rate", 1000.0),
            ("speed-error", 0.0),
            ("torque-noise", 0.0),
            ("seed", 0),
        ):
            told = re.search(rf" --{option} [A-Z]+ [^;]*; default: (\S+)", shown)[1]
            value = getattr(parsed, option.replace("-", "_"))
            assert (type(value), value, float(told)) == (type(default), default, default)

    def test_help_does_not_wait_for_pinocchio(self):
        code = (
            "import sys; from frontal_biped.cli import main\n"
            f"for command in {COMMANDS}: main([command, '--help'])\n"
            "main(['--help']); main([]); print({'numpy', 'pinocchio', 'matplotlib', 'meshcat'} & set(sys.modules))"
        )
        out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
        assert out.endswith("\nset()\n")

    def test_version_names_the_solvers(self, capsys):
        assert main(["--version"]) == 0
        out = capsys.readouterr().out
        for package in ("frontal-biped", "pin", "numpy", "scipy", "proxsuite"):
            assert package in out

    def test_no_command_prints_help(self, capsys):
        assert main([]) == 2
        assert "COMMAND" in capsys.readouterr().out

    def test_robots(self, capsys):
        assert main(["robots", "--json"]) == 0
        robots = {row["name"]: row for row in json.loads(capsys.readouterr().out)["robots"]}
        assert robots["frontal_biped"]["mass"] == pytest.approx(60.7)
        assert set(robots) >= {"frontal_biped", "frontal_biped_low_torso"}

    @pytest.mark.parametrize("robot", ["frontal_biped", "frontal_biped_low_torso"])
    def test_design_analyze_simulate(self, robot, tmp_path, capsys):
        gait = tmp_path / "deep" / "gait.json"
        assert main(["design", "--quick", "--robot", robot, "-o", str(gait), "--json"]) == 0
        assert json.loads(capsys.readouterr().out)["success"]
        assert load_gait(gait).robot.name == robot
        assert main(["analyze", str(gait)]) == 0
        out = capsys.readouterr().out
        assert "certificate                yes" in out
        assert [line.split()[0] for line in out.splitlines()] == ["certificate", "tightest", "motors"]
        assert main(["analyze", str(gait), "-v"]) == 0
        tables = capsys.readouterr().out
        assert tables.startswith(out.rstrip())
        assert all(f"C0{i}" in tables for i in range(1, 10))
        assert main(["simulate", str(gait), "--steps", "2", "--continuous", "--json"]) == 0
        assert json.loads(capsys.readouterr().out)["steps_completed"] == 2

    @pytest.mark.slow
    def test_a_design_walks_and_the_file_says_so(self, tmp_path, capsys):
        gait = tmp_path / "gait.json"
        assert main(["design", "-o", str(gait)]) == 0
        assert "walks 20 steps" in capsys.readouterr().out
        assert load_gait(gait).provenance["walk"]["engines"]["ours"]["steps"] == 20
        assert main(["design", "--quick", "-o", str(gait)]) == 0
        assert load_gait(gait).provenance["walk"] == "left out (quick)"
        assert main(["design", "--budget", "-1"]) == 2

    @pytest.mark.slow
    def test_robust_gait_walks_in_noise_from_a_wrong_speed(self, tmp_path, capsys):
        gait = tmp_path / "robust.json"
        assert main(["design", "--quick", "--spec", "robust", "-o", str(gait)]) == 0
        assert load_gait(gait).specification.fri_margin == 0.03
        noise = ["--encoder-noise", "1e-4", "--torque-noise", "0.01", "--seed", "3"]
        walk = ["simulate", str(gait), "--steps", "2", "--speed-error", "0.5", "--stabiliser", "ankle", *noise]
        capsys.readouterr()
        assert main([*walk, "--json"]) == 0
        settings = json.loads(capsys.readouterr().out)["settings"]
        assert settings["disturbances"]["encoder_noise"] == 1e-4
        assert settings["disturbances"]["seed"] == 3
        assert settings["controller"]["stabiliser"] == "ankle"

    def test_bad_stabilisers_and_noise_get_one_line(self, capsys):
        assert main(["simulate", "g1", "--stabiliser", "magic"]) == 2
        assert "no stabiliser 'magic'; known: fixed, re-anchored, adaptive" in one_line(capsys)
        assert main(["simulate", "g1", "--continuous", "--encoder-noise", "1e-4"]) == 2
        assert "give a control period" in one_line(capsys)
        assert main(["design", "--quick", "--spec", "robst"]) == 2
        assert "did you mean 'robust'" in one_line(capsys)

    @pytest.mark.slow
    def test_design_without_an_output_writes_beside_the_description(self, tmp_path, capsys, monkeypatch):
        """Nothing is written over: a second gait takes the next name."""
        (tmp_path / "here").mkdir()
        monkeypatch.chdir(tmp_path / "here")
        description = robot_copy(tmp_path)
        for name in ("gait.json", "gait-2.json"):
            assert main(["design", "--quick", "--robot", str(description)]) == 0
            assert f"written to {tmp_path / name}" in capsys.readouterr().out
        assert main(["design", "--quick", "--json"]) == 0  # a packaged robot
        assert json.loads(capsys.readouterr().out)["output"] == "gait.json"
        assert [path.name for path in Path().iterdir()] == ["gait.json"]
        stored = [json.loads(path.read_text())["robot"]["description"] for path in tmp_path.rglob("gait*.json")]
        assert stored == ["frontal_biped.toml"] * 3

    @pytest.mark.slow
    def test_design_follows_the_specification(self, tmp_path, capsys):
        spec = tmp_path / "spec.toml"
        spec.write_text("max_pelvis_roll = 0.05\nstep_width = [0.2, 0.3]\n")
        gait = tmp_path / "gait.json"
        assert main(["design", "--quick", "--spec", str(spec), "-o", str(gait)]) == 0
        told = capsys.readouterr().out.splitlines()
        stored = load_gait(gait)
        assert stored.specification.max_pelvis_roll == 0.05
        assert 0.2 <= stored.step_width <= 0.3
        assert main(["analyze", str(gait)]) == 0
        analyzed = capsys.readouterr().out.splitlines()
        assert told[-2:] == analyzed[-2:]  # the same words for what the gait needs
        assert [line.split()[0] for line in told[-2:]] == ["tightest", "motors"]

    @pytest.mark.slow
    def test_design_from_a_gait_and_from_several_starts(self, gait_file, tmp_path, capsys):
        specification = tmp_path / "spec.toml"
        specification.write_text("max_pelvis_roll = 0.09\n")
        found = []
        for extra in (["--start", str(gait_file)], ["--attempts", "2"]):
            out = tmp_path / "gait.json"
            assert main(["design", "--quick", "--spec", str(specification), "-o", str(out), *extra]) == 0
            found.append(load_gait(out).orbit.cost)
        assert found[0] == pytest.approx(found[1], rel=1e-4)
        assert "written to" in capsys.readouterr().out

    def test_library(self, tmp_path, capsys):
        sweep = tmp_path / "sweep.toml"
        sweep.write_text("[sweep]\nfriction = [0.5, 0.6]\n")
        folder = tmp_path / "library"
        assert main(["library", str(sweep), "-o", str(folder), "--json"]) == 0
        report = json.loads(capsys.readouterr().out)
        assert (report["points"], report["gaits"], report["found"]) == (2, 2, 0)
        assert main(["library", str(sweep), "-o", str(folder)]) == 0
        assert "2 points, 2 of them by an earlier run: 2 gaits" in capsys.readouterr().out
        assert len((folder / "index.csv").read_text().splitlines()) == 3

    @pytest.mark.parametrize(
        ("text", "word"),
        [
            ("[sweep]\nfrictions = [0.5]\n", "did you mean 'friction'"),
            ("robot = 'nobody'\n", "nobody"),
            ("[sweep", "not valid TOML"),
            ("[sweep]\ndegree = [5, 2]\n", "degree = 2"),
        ],
    )
    def test_bad_sweep_is_refused_in_one_line(self, text, word, tmp_path, capsys):
        sweep, folder = tmp_path / "sweep.toml", tmp_path / "library"
        sweep.write_text(text)
        assert main(["library", str(sweep), "-o", str(folder)]) == 2
        error = capsys.readouterr().err
        assert word in error and error.count("\n") == 1
        assert not folder.exists()

    @pytest.mark.slow
    def test_view_and_plot_of_both_models(self, gait_file, run_file, tmp_path, capsys):
        page = tmp_path / "page.html"
        assert main(["view", str(run_file), "--html", str(page)]) == 0
        assert page.stat().st_size > 100_000
        both = tmp_path / "both.html"
        assert main(["view", str(run_file), str(gait_file), "--overlay", "--ghost", "--html", str(both)]) == 0
        assert both.stat().st_size > page.stat().st_size
        assert main(["view", str(run_file), "--overlay", "--html", str(tmp_path / "none.html")]) == 2
        assert "name a second file" in capsys.readouterr().err
        assert not (tmp_path / "none.html").exists()
        assert main(["plot", str(run_file), "-o", str(tmp_path / "figures")]) == 0
        names = {path.stem for path in (tmp_path / "figures").glob("*.svg")}
        assert {"joint_angles", "snapshots", "phase_portrait", "energy", "torques", "ground_reaction"} <= names

    def test_a_run_without_its_gait_is_viewed_and_plotted(self, run_file, tmp_path):
        """As another simulator may write it."""
        from dataclasses import replace

        from frontal_biped.simulation import load_trajectory, save_trajectory

        bare = tmp_path / "bare.npz"
        save_trajectory(replace(load_trajectory(run_file), gait={}, settings={}), bare)
        assert main(["view", str(bare), "--html", str(tmp_path / "page.html")]) == 0
        assert main(["export", str(bare), "-o", str(tmp_path / "run.csv")]) == 0
        assert main(["plot", str(bare), "-o", str(tmp_path / "figures"), "--format", "pdf"]) == 0
        assert {path.suffix for path in (tmp_path / "figures").iterdir()} == {".pdf"}

    def test_a_fall_is_exit_status_one(self, gait_file, capsys):
        assert main(["simulate", str(gait_file), "--steps", "2", "--speed-error", "5"]) == 1
        assert "FELL" in capsys.readouterr().out

    def test_gait_for_another_robot_is_warned_about(self, gait_file, capsys):
        main(["simulate", str(gait_file), "--robot", "frontal_biped_low_torso", "--steps", "1"])
        assert "warning" in capsys.readouterr().err

    def test_module_runs(self):
        out = subprocess.run(
            [sys.executable, "-m", "frontal_biped", "robots"], capture_output=True, text=True, check=True
        ).stdout
        assert "frontal_biped_low_torso" in out


def one_line(capsys) -> str:
    err = capsys.readouterr().err
    lines = err.strip().splitlines()
    assert len(lines) == 1, err
    assert "Traceback" not in err
    return lines[0]


BAD_ROBOTS = {
    "missing URDF": ({"toml": [('"frontal_biped.urdf"', '"absent.urdf"')]}, "absent.urdf.*no such URDF"),
    "broken XML": ({"urdf": [("</robot>", "")]}, "not well-formed XML"),
    "absent joint": ({"toml": [('= "left_hip"', '= "left_hop"')]}, "no movable joint 'left_hop'.*'left_hip'"),
    "non-planar axis": ({"urdf": [('<axis xyz="1 0 0"/>', '<axis xyz="0 1 0"/>')]}, "90 degrees off world X.*HR2"),
    "tilted axis": ({"urdf": [('<axis xyz="1 0 0"/>', '<axis xyz="1 0.02 0"/>')]}, "degrees off world X.*HR2"),
    "unequal legs": (
        {"urdf": [('name="right_leg">\n    <inertial>\n      <origin xyz="0 0 -0.16"',
                   'name="right_leg">\n    <inertial>\n      <origin xyz="0 0 -0.20"')]},
        "not mirror images.*HR3",
    ),
    "swapped sides": (
        {"toml": [('left_hip = "left_hip"', 'left_hip = "right_hip"'),
                  ('right_hip = "right_hip"', 'right_hip = "left_hip"'),
                  ('left_ankle = "left_ankle"', 'left_ankle = "right_ankle"'),
                  ('right_ankle = "right_ankle"', 'right_ankle = "left_ankle"')]},
        "swap the joint names.*HR3",
    ),
    "continuous joint without limits": (
        {"urdf": [('type="revolute"', 'type="continuous"'),
                  ('<limit lower="-1.0" upper="1.0" effort="150" velocity="10"/>', "")]},
        "not an ideal revolute joint.*HR1",
    ),
    "no actuator": ({"urdf": [('effort="150"', 'effort="0"')]}, "no effort limit.*HR4"),
    "no sole": ({"toml": [("inner = 0.05", "")]}, "inner is missing.*HR5"),
    "unknown key": ({"toml": [("[sole]", "[sole]\nouther = 0.05")]}, "unknown key 'outher'.*'outer'"),
    "wrong type": ({"toml": [("inner = 0.05", 'inner = "wide"')]}, "'wide' is not a finite number"),
    "NaN": ({"toml": [("inner = 0.05", "inner = nan")]}, "nan is not a finite number"),
    "NaN mass": ({"urdf": [('mass value="36.0"', 'mass value="nan"')]}, "'nan' is not a finite number"),
    "negative mass": ({"urdf": [('mass value="36.0"', 'mass value="-36.0"')]}, "mass -36 kg is negative"),
    "broken TOML": ({"toml": [("[sole]", "[sole")]}, "not valid TOML"),
}  # fmt: skip


class TestBadRobots:
    @pytest.mark.parametrize("case", BAD_ROBOTS)
    def test_refused_in_one_line(self, case, tmp_path, capsys):
        replacements, pattern = BAD_ROBOTS[case]
        description = robot_copy(tmp_path, **replacements)
        output = tmp_path / "out" / "gait.json"
        assert main(["design", "--quick", "--robot", str(description), "-o", str(output)]) == 2
        line = one_line(capsys)
        assert re.search(pattern, line), line
        assert not output.parent.exists()

    @pytest.mark.parametrize(
        ("robot", "pattern"),
        [
            ("frontal_bipet", "did you mean 'frontal_biped'"),
            ("absent.toml", "no such file"),
            ("absent.urdf", "no such URDF file"),
            ("/", "neither a description"),
        ],
    )
    def test_unknown_robots(self, robot, pattern, capsys):
        assert main(["design", "--quick", "--robot", robot]) == 2
        assert pattern in one_line(capsys)

    def test_urdf_without_description(self, tmp_path, capsys):
        shutil.copy(models_dir() / "frontal_biped.urdf", tmp_path / "mine.urdf")
        assert main(["design", "--quick", "--robot", str(tmp_path / "mine.urdf")]) == 2
        assert "needs a description mine.toml beside it" in one_line(capsys)


BAD_SPECIFICATIONS = {
    "unknown key": ("frictoin = 0.5", "unknown key 'frictoin'.*'friction'"),
    "wrong type": ('friction = "high"', "friction: 'high' is not a finite number"),
    "NaN": ("swing_clearance = nan", "swing_clearance: nan is not a finite number"),
    "boolean": ("friction = true", "True is not a finite number"),
    "negative": ("touchdown_speed = -0.1", "touchdown_speed = -0.1 must not be negative"),
    "reversed range": ("step_width = [0.3, 0.2]", r"step_width = \[0.3, 0.2\] is not a range"),
    "wrong length": ("max_torque = [1.0, 2.0]", "max_torque.*list of 4 numbers"),
    "fractional degree": ("degree = 5.5", "degree = 5.5 is not a whole number"),
    "degrees for radians": ("max_pelvis_roll = 5", "max_pelvis_roll = 5 rad is not in"),
    "broken TOML": ("degree = = 5", "not valid TOML"),
}


class TestBadSpecifications:
    @pytest.mark.parametrize("case", BAD_SPECIFICATIONS)
    def test_refused_in_one_line(self, case, tmp_path, capsys):
        text, pattern = BAD_SPECIFICATIONS[case]
        spec, output = tmp_path / "spec.toml", tmp_path / "gait.json"
        spec.write_text(text + "\n")
        assert main(["design", "--quick", "--spec", str(spec), "-o", str(output)]) == 2
        line = one_line(capsys)
        assert re.search(pattern, line), line
        assert "spec.toml" in line
        assert not output.exists()

    def test_missing_file(self, capsys):
        assert main(["design", "--quick", "--spec", "absent.toml"]) == 2
        assert "absent.toml: no such file" in one_line(capsys)

    @pytest.mark.slow
    def test_infeasible_says_what_is_in_the_way(self, tmp_path, capsys):
        spec, output = tmp_path / "spec.toml", tmp_path / "out" / "gait.json"
        spec.write_text("max_pelvis_roll = 0.001\nswing_clearance = 0.05\n")
        assert main(["design", "--quick", "--spec", str(spec), "-o", str(output)]) == 1
        line = one_line(capsys)
        assert "max_pelvis_roll" in line
        assert "relax" in line
        assert not output.parent.exists()

    def test_unreachable_step_width(self, tmp_path, capsys):
        spec = tmp_path / "spec.toml"
        spec.write_text("step_width = [2.5, 2.6]\n")
        assert main(["design", "--quick", "--spec", str(spec)]) in (1, 2)
        assert "step_width" in one_line(capsys)


def _edited(gait_file: Path, folder: Path, edit) -> Path:
    table = json.loads(gait_file.read_text())
    edit(table)
    path = folder / "bad.json"
    path.write_text(json.dumps(table))
    return path


BAD_GAITS = {
    "wrong Bezier shape": (
        lambda g: g["steps"][0]["rising"]["joint_bezier"].pop(),
        r"rising.joint_bezier has shape \(2, 6\)",
    ),
    "ragged Bezier": (
        lambda g: g["steps"][0]["rising"]["joint_bezier"][0].pop(),
        "rising.joint_bezier is not an array",
    ),
    "NaN": (
        lambda g: g["steps"][0]["falling"]["fri_bezier"].__setitem__(0, float("nan")),
        "fri_bezier holds nan.*not a finite number",
    ),
    "text for number": (
        lambda g: g["steps"][0].__setitem__("step_width", "wide"),
        "step_width = 'wide' is not a finite number",
    ),
    "unknown field": (lambda g: g.__setitem__("stepwidth", 0.3), "unknown field 'stepwidth'"),
    "missing field": (lambda g: g["steps"][0].pop("orbit"), r"orbit' is missing"),
    "other format": (lambda g: g.__setitem__("format", "x"), "not a gait file"),
    "other version": (lambda g: g.__setitem__("version", 99), '"version" is 99'),
    "rising downwards": (
        lambda g: g["steps"][0]["rising"].__setitem__("beta_end", -2.0),
        "beta_start must be below beta_end",
    ),
}


class TestBadFiles:
    @pytest.mark.parametrize("command", ["analyze", "simulate", "view", "plot"])
    @pytest.mark.parametrize("case", BAD_GAITS)
    def test_gait_refused_in_one_line(self, case, command, gait_file, tmp_path, capsys):
        edit, pattern = BAD_GAITS[case]
        path = _edited(gait_file, tmp_path, edit)
        arguments = {"view": ["--html", str(tmp_path / "page.html")], "plot": ["-o", str(tmp_path / "figures")]}
        assert main([command, str(path), *arguments.get(command, [])]) == 2
        line = one_line(capsys)
        assert re.search(pattern, line), line
        assert "bad.json" in line
        assert [p.name for p in tmp_path.iterdir()] == ["bad.json"]

    @pytest.mark.parametrize("keep", [0, 1, 100, 1500])
    def test_truncated_gait(self, keep, gait_file, tmp_path, capsys):
        path = tmp_path / "cut.json"
        path.write_bytes(gait_file.read_bytes()[:keep])
        assert main(["analyze", str(path)]) == 2
        assert "not valid JSON" in one_line(capsys)

    def test_missing_files(self, tmp_path, capsys):
        for arguments in (["analyze", "absent.json"], ["simulate", "absent.json"], ["plot", "absent.npz"]):
            assert main(arguments) == 2
            assert "absent" in one_line(capsys)

    def test_unknown_robot_in_gait(self, gait_file, tmp_path, capsys):
        path = _edited(gait_file, tmp_path, lambda g: g["robot"].__setitem__("description", "other_biped.toml"))
        assert main(["analyze", str(path)]) == 2
        line = one_line(capsys)
        assert "name it with --robot" in line
        assert str(tmp_path / "other_biped.toml") in line and "bad.json" in line

    def test_output_that_cannot_be_written_is_refused_before_the_work(self, gait_file, tmp_path, capsys):
        blocker = tmp_path / "file"
        blocker.write_text("")
        for arguments in (
            ["design", "-o", str(blocker / "gait.json")],
            ["simulate", str(gait_file), "-o", str(blocker / "run.npz")],
            ["design", "-o", str(tmp_path)],
            ["demo", "--out", str(blocker)],
        ):
            began = time.perf_counter()
            assert main(arguments) == 2
            assert str(tmp_path) in one_line(capsys)
            assert time.perf_counter() - began < 1.0
        assert [p.name for p in tmp_path.iterdir()] == ["file"]

    @pytest.mark.parametrize(
        "arguments",
        [
            ["simulate", "g.json", "--steps", "0"],
            ["simulate", "g.json", "--rate", "nan"],
            ["dance"],
            ["design", "--nope"],
            ["design", "a\nb"],
            ["dance\nslowly"],
        ],
    )
    def test_usage_errors(self, arguments, capsys):
        assert main(arguments) == 2
        assert "error" in one_line(capsys)

    def test_debug_shows_the_traceback(self):
        from frontal_biped.exceptions import GaitFileError

        with pytest.raises(GaitFileError):
            main(["analyze", "absent.json", "--debug"])

    @pytest.mark.parametrize("unbuffered", ["", "1"])
    def test_reader_that_goes_away_is_left_quietly(self, unbuffered):
        read, write = os.pipe()
        os.close(read)
        process = subprocess.run(
            [sys.executable, "-m", "frontal_biped", "robots"],
            stdout=write,
            stderr=subprocess.PIPE,
            env={**os.environ, "PYTHONUNBUFFERED": unbuffered},
            text=True,
            check=False,
        )
        os.close(write)
        assert (process.returncode, process.stderr) == (1, "")


def test_robots_lists_every_robot_with_its_asymmetry(capsys):
    assert main(["robots", "--json"]) == 0
    rows = {row["name"]: row for row in json.loads(capsys.readouterr().out)["robots"]}
    assert rows["talos_full"]["mass"] == pytest.approx(93.336, abs=1e-3)
    assert rows["romeo"]["asymmetry"]["differences"] == []
    (worst, *_) = rows["icub"]["asymmetry"]["differences"]
    assert worst["what"] == "the inertia of the leg"
    assert rows["icub"]["asymmetry"]["mass_matrix"] == pytest.approx(1.7e-3, rel=0.1)
    for row in rows.values():
        assert {"leg_length", "hip_width", "sole", "ankle_height", "ankle_torque", "hip_torque"} <= set(row)


def test_describe_and_posture_are_two_tasks(capsys):
    assert main(["robots", "--describe", "a.urdf", "--posture", "b.toml"]) == 2
    assert "not allowed with" in capsys.readouterr().err


def test_posture_of_a_packaged_robot_as_json(capsys):
    assert main(["robots", "--posture", "g1", "--json"]) == 0
    table = json.loads(capsys.readouterr().out)
    assert table["undecided"] == []
    assert "waist_pitch_joint" in table["description"]


def test_help_names_every_stabiliser(capsys):
    from frontal_biped.control import STABILISERS

    assert main(["simulate", "--help"]) == 0
    text = " ".join(capsys.readouterr().out.split())
    listed = text[text.index("--stabiliser NAME ") :].removeprefix("--stabiliser NAME ").split(";")[0]
    assert listed.replace(" or ", ", ").split(", ") == list(STABILISERS)
