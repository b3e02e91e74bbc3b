"""What the docstrings say of files is what is read and written: every key, every default, every example."""

import json
import re
import tomllib
from dataclasses import fields, replace
from types import ModuleType

import numpy as np
import pytest

import frontal_biped.gait.file
import frontal_biped.gait.specification
import frontal_biped.library.sweep
import frontal_biped.model.urdf.description
import frontal_biped.scenarios.file
import frontal_biped.scenarios.space_file
import frontal_biped.simulation.csv_table
import frontal_biped.simulation.trajectory
from frontal_biped.gait import GaitSpecification, read_specification, save_gait
from frontal_biped.library.sweep import read_sweep
from frontal_biped.model import load_robot, models_dir
from frontal_biped.model.urdf.description import KEYS, Sole, read_description
from frontal_biped.scenarios import Expectations, load_scenario, run_trials
from frontal_biped.simulation import Disturbances, save_trajectory
from frontal_biped.simulation.csv_table import COORDINATES, run_table


def blocks(module: ModuleType) -> list[str]:
    """The indented parts of a module's docstring; empty lines inside one belong to it."""
    found = re.findall(r"(?:^    .*\n(?:\n(?=    ))?)+", f"{module.__doc__}\n", re.MULTILINE)
    return [re.sub(r"^    ", "", block, flags=re.MULTILINE) for block in found]


def test_blocks_are_what_is_indented():
    module = ModuleType("module", "Title.\n\n    a = 1\n\n    [b]\n\nProse.\n\n    c = 2\n")
    assert blocks(module) == ["a = 1\n\n[b]\n", "c = 2\n"]


class TestSpecification:
    (block,) = blocks(frontal_biped.gait.specification)

    def test_every_key_is_named(self):
        assert set(tomllib.loads(self.block)) == {field.name for field in fields(GaitSpecification)}

    def test_what_has_a_default_is_shown_with_it(self, tmp_path):
        path = tmp_path / "spec.toml"
        shown = {}
        for apart in ("travel", "double_support"):  # do not go together
            path.write_text(re.sub(rf"^{apart} = .*\n", "", self.block, flags=re.MULTILINE), encoding="utf-8")
            shown[apart] = read_specification(path)
        assert shown["travel"].double_support == (0.1, 0.2)
        assert replace(shown["travel"], double_support=None, travel=0.1) == shown["double_support"]
        assert shown["double_support"] == GaitSpecification(
            max_pelvis_roll=0.1, max_foot_rotation=0.3, max_torque=(150.0,) * 4,
            max_multiplier=0.75, min_energy_margin=1.0, max_reversal_shift=0.003, cop_margin_x=0.02, yaw_friction=0.6,
            travel=0.1,
        )  # fmt: skip
        left_out = re.findall(r"^(\w+) = .*leave out", self.block, re.MULTILINE)
        assert len(left_out) == 10 and all(key not in GaitSpecification().as_dict() for key in left_out)


class TestDescription:
    needed, more = blocks(frontal_biped.model.urdf.description)

    def test_what_must_be_there_loads(self, tmp_path):
        (tmp_path / "my_biped.urdf").write_text((models_dir() / "frontal_biped.urdf").read_text(), encoding="utf-8")
        least = re.sub(r"^ankle_height.*\n", "", self.needed, flags=re.MULTILINE)
        loaded = []
        for text in (self.needed, least):
            (tmp_path / "my_biped.toml").write_text(text, encoding="utf-8")
            loaded.append(load_robot(tmp_path / "my_biped.toml"))
        assert [robot.name for robot in loaded] == ["my_biped"] * 2
        assert loaded[0].ankle_height == loaded[1].ankle_height == 0.0

    def test_every_key_is_named_and_read(self, tmp_path):
        assert set(tomllib.loads(self.needed)) | set(tomllib.loads(self.more)) == set(KEYS)
        text = frontal_biped.model.urdf.description.__doc__
        assert all(re.search(rf"\b{field.name}\b", text) for field in fields(Sole))
        head, _, rest = self.needed.partition("[joints]")
        (tmp_path / "my_biped.toml").write_text(f"{head}{self.more}[joints]{rest}", encoding="utf-8")
        (tmp_path / "my_biped.urdf").touch()
        description = read_description(tmp_path / "my_biped.toml")
        assert description.symmetrise and description.posture == {"left_knee": 0.3}
        assert (description.ankle_torque, description.hip_torque) == (150.0, 150.0)
        assert description.gait == {"friction": 0.6}


class TestScenario:
    (block,) = blocks(frontal_biped.scenarios.file)
    space_block, path_block = blocks(frontal_biped.scenarios.space_file)

    def test_every_key_is_named(self):
        table, space, path = map(tomllib.loads, (self.block, self.space_block, self.path_block))
        assert set(table) | set(space) | set(path) == set(frontal_biped.scenarios.file.KEYS)
        assert set(table["disturbances"]) == {field.name for field in fields(Disturbances)} - {"pushes", "seed"}
        assert not set(space["disturbances"]) - set(table["disturbances"]) - {"velocity_noise"}
        said = set(re.findall(r"``(\w+)`` \[\w+\]", frontal_biped.scenarios.file.__doc__))
        expected = set(table["expect"]) | set(space["expect"]) | set(path["expect"])
        assert expected | said == {f.name for f in fields(Expectations)} | {"delay"}

    def test_what_only_space_has_loads(self, tmp_path):
        path = tmp_path / "space.scenario.toml"
        path.write_text(self.space_block, encoding="utf-8")
        scenario = load_scenario(path)
        assert scenario.space is not None and len(scenario.space.pushes) == 1
        assert [command.speed for command in scenario.space.commands] == [0.2, 0.3]
        path.write_text(self.path_block, encoding="utf-8")
        scenario = load_scenario(path)
        assert scenario.space is not None and scenario.space.path == "stand 1; forward 2; turn 90; stop"
        assert scenario.expect.path_distance == 0.1

    @pytest.mark.slow
    def test_is_as_expected(self, tmp_path):
        path = tmp_path / "push.scenario.toml"
        path.write_text(self.block, encoding="utf-8")
        (result,) = run_trials([load_scenario(path)])
        assert result.passed, str(result.results)


def test_sweep(tmp_path):
    (block,) = blocks(frontal_biped.library.sweep)
    path = tmp_path / "sweep.toml"
    path.write_text(block, encoding="utf-8")
    sweep = read_sweep(path)
    assert set(tomllib.loads(block)) == {"robot", "batch", "specification", "sweep"} == set(sweep.as_dict())
    assert len(sweep.points()) == 14 and sweep.batch == frontal_biped.library.sweep.DEFAULT_BATCH
    rolls = [point.specification.max_pelvis_roll for point in sweep.points()[:7]]
    assert rolls == pytest.approx(np.linspace(0.08, 0.2, 7))


def test_gait_file(gait, tmp_path):
    text = frontal_biped.gait.file.__doc__
    save_gait(gait, tmp_path / "gait.json")
    content = json.loads((tmp_path / "gait.json").read_text(encoding="utf-8"))
    (step,) = content["steps"]
    named = [*content, *content["robot"], *step, *step["rising"], *step["orbit"]]
    assert [key for key in named if not re.search(rf"\b{key}\b", text)] == []
    assert f'"{content["format"]}", version {content["version"]}' in text


def test_run_file(walk, tmp_path):
    text = frontal_biped.simulation.trajectory.__doc__
    save_trajectory(walk, tmp_path / "run.npz")
    with np.load(tmp_path / "run.npz") as archive:
        header = json.loads(str(archive["header"]))
        arrays = [name for name in archive.files if name != "header"]
    listed = re.search(r"\(t, q,(.*?)\)", text, re.DOTALL)[0]
    assert re.findall(r"\w+", listed) == arrays
    assert [key for key in header if not re.search(rf"\b{key}\b", text)] == []
    assert f'("{header["format"]}"), version ({header["version"]})' in text


def test_table_of_a_run(biped, walk):
    text = frontal_biped.simulation.csv_table.__doc__
    header, _ = run_table(biped, walk)
    for kind in ("position", "desired position", "velocity", "torque"):
        assert kind in text
        assert [name for name in header if re.match(rf"\w+ {kind} \[", name)] != []
    assert all(f"``{name}``" in text or f"coordinates {name}``" in text for name in COORDINATES if name != "urdf")
