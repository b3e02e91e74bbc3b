"""Every numbered example runs, and prints what its docstring says it prints."""

import ast
import math
import re
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).resolve().parent.parent / "examples"
NUMBERED = sorted(EXAMPLES.glob("[0-9][0-9]_*.py"))
CHECKED = [path for path in NUMBERED if path.name != "11_design_studies.py"]

RELATIVE = 0.02
"""Between processors: sampled control meets events a tick earlier or later. Everything but numbers agrees exactly."""

LAST_DIGITS = 2.0  # units of the last digit printed

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


def test_ten_lessons_of_forty_to_a_hundred_lines():
    assert [path.name[:2] for path in CHECKED] == [f"{number:02d}" for number in range(1, 11)]
    for path in CHECKED:
        assert 40 <= len(path.read_text(encoding="utf-8").splitlines()) <= 100, path.name


@pytest.mark.slow
@pytest.mark.parametrize("path", CHECKED, ids=lambda path: path.stem)
def test_prints_what_it_says(path, tmp_path):
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
