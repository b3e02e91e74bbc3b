"""What the README says is what happens."""

import re
import subprocess
import sys
from dataclasses import fields
from pathlib import Path

import pytest

from frontal_biped.cli import main
from frontal_biped.gait import GaitSpecification, read_specification
from frontal_biped.model import load_robot, models_dir

ROOT = Path(__file__).resolve().parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")


def marked(name: str) -> str:
    block = re.search(rf"<!-- {name} -->\n```\n(.*?)\n```\n<!-- end -->", README, re.DOTALL)
    assert block is not None
    return block[1]


def code(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", README, re.DOTALL)


def test_commands_are_single_lines():
    for name in ("demo-command", "test-command"):
        assert "\n" not in marked(name)
    assert marked("demo-command").endswith("frontal-biped demo")
    assert marked("test-command").endswith("pytest")


def test_continuous_integration_runs_the_readme_command():
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    assert "<!-- test-command -->" in script and "README.md" in script


def test_every_command_of_the_table_exists(capsys):
    named = set(re.findall(r"^\| `frontal-biped (\w+)", README, re.MULTILINE))
    assert named >= {"demo", "design", "library", "analyze", "simulate", "view", "studio", "export", "plot", "robots"}
    for command in named:
        assert main([command, "--help"]) == 0
    text = capsys.readouterr().out
    for option in re.findall(r"\[(--?[\w-]+)", "\n".join(re.findall(r"^\| `frontal-biped.*$", README, re.MULTILINE))):
        assert option in text, option


@pytest.mark.slow
def test_quick_start_prints_what_it_says():
    script, printed = re.search(r"```python\n(.*?)```\n\n((?:    [^\n]*\n)+)", README, re.DOTALL).groups()
    out = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout
    assert out == re.sub(r"^    ", "", printed, flags=re.MULTILINE)


def test_specification_block_names_every_key(tmp_path):
    block = next(text for text in code("toml") if "swing_clearance" in text)
    path = tmp_path / "spec.toml"
    path.write_text(block, encoding="utf-8")
    specification = read_specification(path)
    assert all(f"{field.name} = " in block for field in fields(GaitSpecification))
    # all but those that have no default are shown with their default
    default = GaitSpecification(
        max_pelvis_roll=0.1, max_foot_rotation=0.3, max_torque=(150.0,) * 4,
        max_multiplier=0.75, min_energy_margin=1.0, max_reversal_shift=0.003,
    )  # fmt: skip
    assert specification == default


def test_description_block_loads(tmp_path):
    block = next(text for text in code("toml") if "[joints]" in text)
    (tmp_path / "my_biped.toml").write_text(block, encoding="utf-8")
    (tmp_path / "my_biped.urdf").write_text((models_dir() / "frontal_biped.urdf").read_text(), encoding="utf-8")
    assert load_robot(tmp_path / "my_biped.toml").name == "my_biped"


def test_links_and_pictures_exist():
    headings = {title.strip().lower().replace(" ", "-") for title in re.findall(r"^#+ (.*)$", README, re.MULTILINE)}
    for target in re.findall(r"\]\((?!https?:)([^)]+)\)", README):
        assert (ROOT / target).is_file() or target.removeprefix("#") in headings, target
