"""A missing package is told with the command that brings it, for the interpreter that runs."""

import re
import shlex
import sys
import tomllib
from pathlib import Path

import frontal_biped
from frontal_biped.files.extras import missing_extra, pip_install

PACKAGE = Path(frontal_biped.__file__).parent
PROJECT = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def test_command_is_one_that_a_shell_takes_apart_as_meant():
    words = shlex.split(pip_install("frontal-biped[mujoco]"))
    assert words == [sys.executable, "-m", "pip", "install", "frontal-biped[mujoco]"]
    assert str(missing_extra("the engine is MuJoCo", "mujoco")).startswith("the engine is MuJoCo: ")


def test_every_place_says_it_this_way_and_names_an_extra_that_exists():
    source = {path: path.read_text(encoding="utf-8") for path in PACKAGE.rglob("*.py")}
    by_hand = [
        str(path) for path, text in source.items() if re.search(r"raise MissingExtraError|[\"'].*pip install", text)
    ]
    assert by_hand == [str(PACKAGE / "files" / "extras.py")]
    named = {extra for text in source.values() for extra in re.findall(r'missing_extra\(.*, "(\w+)"\)', text)}
    assert {"mujoco", "plot", "viser", "browser", "dask"} <= named <= set(PROJECT["optional-dependencies"])
