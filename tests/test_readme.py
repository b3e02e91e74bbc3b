"""What the README and its sisters say is what is there and what happens."""

import ast
import re
import shlex
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from frontal_biped.cli import main
from frontal_biped.model import models_dir

ROOT = Path(__file__).resolve().parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")
PAGES = ["README.md", ".github/CONTRIBUTING.md", ".github/CHANGELOG.md", "examples/scenarios/README.md"]
PACKAGE = ROOT / "frontal_biped"
MOST_LINES = 200
LARGEST_PICTURE, ALL_PICTURES = 1_500_000, 2_500_000  # [bytes]
WORD = r"(?<![\w-]){}(?![\w-])"


def marked(name: str) -> str:
    block = re.search(rf"<!-- {name} -->\n```\n(.*?)\n```\n<!-- end -->", README, re.DOTALL)
    assert block is not None
    return block[1]


def section(title: str) -> str:
    return re.search(rf"^## {title}\n(.*?)(?=^## |\Z)", README, re.DOTALL | re.MULTILINE)[1]


def quoted(text: str, program: str) -> list[list[str]]:
    """Command lines of a program in a text: in backquotes, in code, after &&; without the program."""
    found = re.findall(rf"(?:`|^ *|&& \S*|/){program} ([^`\n#]*)", text, re.MULTILINE)
    return [shlex.split(line.partition("&&")[0]) for line in found]


def rows(text: str) -> list[list[str]]:
    """Cells of a table, without its head."""
    lines = [line for line in text.splitlines() if line.startswith("|")][2:]
    return [[cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]] for line in lines]


def test_fits_two_hundred_lines():
    assert len(README.splitlines()) <= MOST_LINES


def test_commands_are_single_lines():
    for name in ("demo-command", "test-command"):
        assert "\n" not in marked(name)
    assert marked("demo-command").endswith("frontal-biped demo")
    assert marked("test-command").endswith("pytest")


def test_continuous_integration_runs_the_readme_command():
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    assert "<!-- test-command -->" in script and "README.md" in script
    assert "bash .ci/run" in (ROOT / ".github" / "workflows" / "checks.yml").read_text(encoding="utf-8")


@pytest.mark.parametrize("page", PAGES)
def test_every_command_and_its_options_exist(page, capsys):
    commands = quoted((ROOT / page).read_text(encoding="utf-8").replace("\\|", "|"), "frontal-biped")
    for name in {words[0] for words in commands}:
        assert main([name, "--help"]) == 0
        text = capsys.readouterr().out
        for option in [word.strip("[]") for words in commands if words[0] == name for word in words]:
            assert not re.match(r"--?[a-z]", option) or re.search(WORD.format(re.escape(option)), text), option


def test_the_table_of_commands_is_complete(capsys):
    assert main(["--help"]) == 0
    known = set(re.findall(r"^    (\w+) ", capsys.readouterr().out, re.MULTILINE))
    assert {cells[0].split()[1].strip("`") for cells in rows(section("Commands"))} == known


@pytest.mark.parametrize("page", PAGES)
def test_every_script_and_extra_exists(page):
    text = (ROOT / page).read_text(encoding="utf-8")
    for script, *arguments in quoted(text, "python3?"):
        if not script.startswith("-"):
            assert (ROOT / script).is_file(), script
            for option in [word for word in arguments if word.startswith("--")]:
                assert option in (ROOT / script).read_text(encoding="utf-8")
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]
    named = set(re.findall(r"'\.\[(\w+)\]'", text))
    assert named <= set(extras)
    if page == "README.md":
        assert set(re.findall(r"`(\w+)`", re.search(r"^Extras:.*?\n\n", text, re.DOTALL | re.MULTILINE)[0])) == set(
            extras
        )


@pytest.mark.slow
def test_python_prints_what_it_says():
    script, printed = re.search(r"```python\n(.*?)```\n\n((?:    [^\n]*\n)+)", README, re.DOTALL).groups()
    out = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout
    assert out == re.sub(r"^    ", "", printed, flags=re.MULTILINE)


@pytest.mark.slow
def test_your_humanoid_in_four_commands(tmp_path, monkeypatch):
    (tmp_path / "my_robot.urdf").write_text((models_dir() / "frontal_biped.urdf").read_text(), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    commands = quoted(section("Your humanoid in four commands").partition("\n```\n\n")[0], "frontal-biped")
    assert len(commands) == 4
    for words in commands:
        assert main(words) == 0, words
    assert (tmp_path / "page.html").stat().st_size > 100_000


def test_results_have_a_command_each():
    results = rows(section("Results, and the command that shows each"))
    assert len(results) == 10
    for what, number, command in results:
        assert re.search(r"\d", number), what
        assert re.fullmatch(r"`(?:python|frontal-biped) [^`]+`", command), what


def test_results_are_what_the_examples_say():
    """A number of the table that an example prints stands in its docstring, which is checked against its output."""
    for _, numbers, command in rows(section("Results, and the command that shows each")):
        script = re.search(r"examples/\w+\.py", command)
        if script:
            said = ast.get_docstring(ast.parse((ROOT / script[0]).read_text(encoding="utf-8")))
            found = set(re.findall(r"\d+(?:\.\d+)?", said))
            for number in re.findall(r"\d+(?:\.\d+)?", numbers):
                near = [float(other) for other in found if abs(float(other) - float(number)) < 0.051]
                assert near, f"{script[0]} does not say {number}"


def anchors(text: str) -> set[str]:
    """GitHub's names of the headings."""
    titles = re.findall(r"^#+ (.*)$", re.sub(r"^```.*?^```", "", text, flags=re.DOTALL | re.MULTILINE), re.MULTILINE)
    return {re.sub(r"[^\w -]", "", title.strip().lower()).replace(" ", "-") for title in titles}


@pytest.mark.parametrize("page", PAGES)
def test_links_and_pictures_exist(page):
    text = (ROOT / page).read_text(encoding="utf-8")
    for target in re.findall(r"\]\((?!https?:)([^)]+)\)", text):
        name, _, anchor = target.partition("#")
        file = (ROOT / page).parent / name if name else ROOT / page
        assert file.exists(), target
        assert not anchor or anchor in anchors(file.read_text(encoding="utf-8")), target
    prose = re.sub(r"```.*?```|`[^`]*`|^    .*?$", "", text, flags=re.DOTALL | re.MULTILINE)
    for label in set(re.findall(r"\[(\w+)\](?![(:\w])", prose)):
        assert re.search(rf"^\[{label}\]: https?://", text, re.MULTILINE), label


def test_the_check_of_anchors_can_fail():
    assert anchors("# A b\n## C, d\n```\n# no heading\n```\n") == {"a-b", "c-d"}


def test_pictures_are_few_and_small():
    pictures = sorted((ROOT / "examples" / "images").iterdir())
    sizes = [path.stat().st_size for path in pictures]
    assert max(sizes) <= LARGEST_PICTURE and sum(sizes) <= ALL_PICTURES
    assert {path.name for path in pictures} == set(re.findall(r"examples/images/([\w.]+)", README))


def test_notation_is_that_of_the_code():
    code = "\n".join(path.read_text(encoding="utf-8") for path in PACKAGE.rglob("*.py"))
    for _, names, *_ in rows(section("Notation")):
        for name in re.findall(r"`(\w+)`", names):
            assert re.search(rf"\b{name}\b", code), name


def test_every_room_is_named():
    rooms = {path.stem for path in PACKAGE.iterdir() if path.suffix == ".py" or any(path.glob("*.py"))}
    tree = section("Modules, one direction only")
    assert [room for room in sorted(rooms - {"__init__", "__main__"}) if not re.search(rf"\b{room}\b", tree)] == []


def test_modules_that_moved_are_where_it_is_said():
    text = (ROOT / ".github" / "CHANGELOG.md").read_text(encoding="utf-8")
    moved = 0
    for was, now in rows(text):
        same = re.match(r"`([\w.]+\.)` the same", now)
        names = [same[1] + name.rpartition(".")[2] for name in re.findall(r"`([\w.]+)`", was)] if same else [
            name for name in re.findall(r"`([\w.]+)`", now) if "." in name
        ]  # fmt: skip
        moved += len(names)
        for name in names:
            assert (PACKAGE / name.replace(".", "/")).with_suffix(".py").is_file(), name
    assert moved > 70


def test_claims_name_tests_that_exist():
    text = ast.get_docstring(ast.parse((ROOT / "tests" / "conftest.py").read_text(encoding="utf-8")))
    claims = text.split("\n* ")[1:]
    assert len(claims) > 20
    for claim in claims:
        files = re.findall(r"[\w/]+\.py", claim)
        assert files, claim
        assert all((ROOT / "tests" / file).is_file() for file in files), claim
