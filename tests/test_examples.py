"""Every numbered example prints what its docstring says, every notebook what is stored in it."""

import ast
import csv
import json
import math
import re
import shutil
import subprocess
import sys
import warnings
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

EXAMPLES = Path(__file__).resolve().parent.parent / "examples"
NUMBERED = sorted(EXAMPLES.glob("[0-9][0-9]_*.py"))
CHECKED = [path for path in NUMBERED if path.name != "11_design_studies.py"]
LESSONS = CHECKED[:10]
IN_SPACE, SIDEWAYS, STANDING = "12_walk_in_space.py", "13_sideways.py", "14_stand_walk_stand.py"

RELATIVE = 0.02
"""Between processors: sampled control meets events a tick earlier or later. Everything but numbers agrees exactly."""

LAST_DIGITS = 2.0  # units of the last digit printed; one for whole numbers

NUMBER = r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?"


def expected_output(path):
    """The indented block after "You should see:"."""
    text = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8")))
    block = re.search(r"You should see:\n\n((?:    [^\n]*\n?)+)", text)
    assert block is not None, f"{path.name} does not say what it prints"
    return re.sub(r"^    ", "", block[1], flags=re.MULTILINE).rstrip()


def assert_same(printed, expected):
    """Words alike; numbers within two units of their last digit, or 2 %."""
    assert len(printed.splitlines()) == len(expected.splitlines()), printed
    for line, wanted in zip(printed.splitlines(), expected.splitlines(), strict=True):
        words, wanted_words = (re.sub(r"\s+", " ", re.sub(NUMBER, "#", text)).strip() for text in (line, wanted))
        assert words == wanted_words
        for number, target in zip(re.findall(NUMBER, line), re.findall(NUMBER, wanted), strict=True):
            digits = len(target.partition("e")[0].partition(".")[2])
            last = LAST_DIGITS * 10.0**-digits * (10.0 ** float(target.partition("e")[2] or 0))
            assert math.isclose(float(number), float(target), rel_tol=RELATIVE, abs_tol=last), (
                f"{line!r}, not {wanted!r}"
            )


def test_ten_lessons_and_three_walks_of_forty_to_a_hundred_lines():
    assert [path.name[:2] for path in LESSONS] == [f"{number:02d}" for number in range(1, 11)]
    assert [path.name for path in CHECKED[10:]] == [IN_SPACE, SIDEWAYS, STANDING]
    for path in CHECKED:
        assert 40 <= len(path.read_text(encoding="utf-8").splitlines()) <= 100, path.name


@pytest.mark.slow
@pytest.mark.parametrize("path", CHECKED, ids=lambda path: path.stem)
def test_prints_what_it_says(path, tmp_path):
    if path.name in (IN_SPACE, STANDING):
        pytest.importorskip("mujoco")
    done = subprocess.run([sys.executable, str(path)], capture_output=True, text=True, check=False, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert_same(done.stdout.rstrip(), expected_output(path))
    assert list(tmp_path.iterdir()) == []  # leaves nothing behind


@pytest.mark.slow
def test_design_studies_write_their_figures(tmp_path):
    command = [sys.executable, str(EXAMPLES / "11_design_studies.py")]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "written to studies: pareto.svg, degrees.svg" in done.stdout


@pytest.mark.parametrize(
    ("printed", "expected", "same"),
    [
        ("J = 210.22 N", "J = 210.22 N", True),
        ("J = 210.23 N", "J = 210.22 N", True),
        ("J = 230.00 N", "J = 210.22 N", False),
        ("walks: True", "walks: False", False),
        ("0 steps", "4 steps", False),
    ],
)
def test_comparison_itself(printed, expected, same):
    if same:
        assert_same(printed, expected)
    else:
        with pytest.raises(AssertionError):
            assert_same(printed, expected)


@pytest.mark.slow
def test_paper_is_reproduced(tmp_path):
    command = [sys.executable, str(EXAMPLES / "reproduce_paper.py"), "--out", str(tmp_path / "paper")]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    table = (tmp_path / "paper" / "comparison.md").read_text(encoding="utf-8")
    assert table in done.stdout
    assert "| J of the optimum | 4749 | 210.2; 405.6 with the pelvis within 5 deg |" in table
    for row in ("legs: mass, inertia | 12.15 kg, 0.400 kg m^2 | 12.15 kg, 0.400 kg m^2 | same", "unpinned | 6 | 7 |"):
        assert row in table
    with (tmp_path / "paper" / "comparison.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.reader(stream))
    assert rows[0] == ["what", "paper", "ours", "why"] and len(rows) == len(table.splitlines()) - 1
    figures = ["conventions", "reversal_bracket", "joint_angles", "snapshots", "reversal_zoom", "sensitivity", "energy"]
    for name in figures:
        assert (tmp_path / "paper" / f"{name}.svg").stat().st_size > 5000
        assert (tmp_path / "paper" / f"{name}.png").stat().st_size > 5000


def test_lesson_covers_the_first_ten_examples_and_keeps_no_output():
    cells = json.loads((EXAMPLES / "lesson.ipynb").read_text(encoding="utf-8"))["cells"]
    run = [name for cell in cells for name in re.findall(r'^lesson\("(.*)"\)$', "".join(cell["source"]), re.MULTILINE)]
    assert run == [path.stem for path in LESSONS]
    assert not any(cell.get("outputs") for cell in cells)


def executed(name, tmp_path):
    """A notebook, run in a copy of the examples' folder."""
    notebook = nbformat.read(EXAMPLES / name, as_version=4)
    shutil.copytree(EXAMPLES, tmp_path / "examples", ignore=shutil.ignore_patterns("images"))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of the kernel's own making
        NotebookClient(notebook, timeout=600, resources={"metadata": {"path": str(tmp_path / "examples")}}).execute()
    return notebook


def printed_by(cell):
    """What a cell printed."""
    return "".join(part.text for part in cell.outputs if part.output_type == "stream").rstrip()


@pytest.mark.slow
def test_lesson_prints_what_the_examples_say(tmp_path):
    notebook = executed("lesson.ipynb", tmp_path)
    printed = {}
    for cell in notebook.cells:
        called = re.match(r'lesson\("(.*)"\)', cell.source)
        if called:
            printed[called[1]] = printed_by(cell)
    for path in LESSONS:
        assert_same(printed[path.stem], expected_output(path))
    assert "image/svg+xml" in notebook.cells[-1].outputs[0].data


def code_cells(notebook):
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


IN_A_NOTEBOOK = "g1_in_a_notebook.ipynb"
PROOFS = "proofs.ipynb"


@pytest.mark.parametrize(("name", "most"), [("reversal.ipynb", 150_000), (PROOFS, 150_000), (IN_A_NOTEBOOK, 300_000)])
def test_outputs_of_a_notebook_are_stored(name, most):
    path = EXAMPLES / name
    assert path.stat().st_size < most
    cells = code_cells(nbformat.read(path, as_version=4))
    assert len(cells) >= 5 and all(cell.outputs for cell in cells)
    stored = json.dumps([cell.outputs for cell in cells])
    assert [word for word in ("/home", "/root", "/tmp", "Traceback", "Warning") if word in stored] == []


def written_lines(cell):
    """Lines of code that are not blank."""
    return [line for line in cell.source.splitlines() if line.strip()]


def test_five_tasks_of_a_new_user_take_at_most_six_lines_each():
    notebook = nbformat.read(EXAMPLES / IN_A_NOTEBOOK, as_version=4)
    first = next(i for i, cell in enumerate(notebook.cells) if cell.source.startswith("## Five things"))
    tasks = [cell for cell in notebook.cells[first:] if cell.cell_type == "code"]
    for cell, call in zip(tasks, ("with_mass", "step_width", "run.torques", "controller=law", "fb.view"), strict=True):
        assert call in cell.source
        assert len(written_lines(cell)) <= 6, cell.source
    assert sum(len(written_lines(cell)) for cell in code_cells(notebook)) <= 50


@pytest.mark.slow
@pytest.mark.parametrize("name", ["reversal.ipynb", PROOFS, IN_A_NOTEBOOK])
def test_a_notebook_prints_what_is_stored(name, tmp_path):
    if name == IN_A_NOTEBOOK:
        pytest.importorskip("mujoco")
    if name == PROOFS:
        pytest.importorskip("flint")
    stored = code_cells(nbformat.read(EXAMPLES / name, as_version=4))
    cells = code_cells(executed(name, tmp_path))
    pages = [part for cell in cells for part in cell.outputs if "srcdoc" in part.get("data", {}).get("text/html", "")]
    assert len(pages) == (3 if name == IN_A_NOTEBOOK else 0)  # they are not stored
    for cell, wanted in zip(cells, stored, strict=True):
        assert_same(printed_by(cell), printed_by(wanted))
        assert [part.output_type for part in cell.outputs if part.output_type != "stream"] == [
            part.output_type for part in wanted.outputs if part.output_type != "stream"
        ]
