"""What all commands share: endings of what is written, both spellings, names for files."""

import argparse

import pytest

from frontal_biped.cli.main import main, make_parser

FILES = {"-o": ["design", "simulate", "walk", "export", "robots"], "--html": ["walk", "view"], "--junit": ["trial"]}
FOLDERS = [("plot", "-o"), ("library", "-o"), ("demo", "--out"), ("trial", "--save"), ("walk", "--figures"),
           ("studio", "-o")]  # fmt: skip
NEEDED = {"simulate": ["g.json"], "walk": ["g1"], "export": ["g.json"], "view": ["g.json"], "trial": ["s.toml"],
          "plot": ["g.json"], "library": ["s.toml"]}  # fmt: skip


def commands():
    (sub,) = (action for action in make_parser()._actions if isinstance(action, argparse._SubParsersAction))
    return sub.choices


def test_tables_above_name_every_option_that_writes():
    """A new one must be added there, and so be checked below."""
    written = {
        (name, option)
        for name, parser in commands().items()
        for action in parser._actions
        for option in action.option_strings
        if str(action.metavar).startswith(("DIR", "FILE", "PAGE")) or option == "-o"
    }
    told = {(name, option) for option, names in FILES.items() for name in names} | set(FOLDERS)
    assert {pair for pair in written if not pair[1].startswith("--output")} == told


@pytest.mark.parametrize(
    ("command", "option", "right"),
    [
        ("design", "-o", ".json"),
        ("simulate", "-o", ".npz"),
        ("walk", "-o", ".npz"),
        ("walk", "--html", ".html"),
        ("view", "--html", ".html"),
        ("trial", "--junit", ".xml"),
    ],
)
def test_a_wrong_ending_is_refused_with_the_right_one(command, option, right, tmp_path, capsys):
    for name, remedy in (("run.txt", f"write {tmp_path / 'run'}{right}"), ("run", "write"), ("", "is a directory")):
        assert main([command, *NEEDED.get(command, []), option, str(tmp_path / name)]) == 2
        error = capsys.readouterr().err
        assert error.count("\n") == 1 and remedy in error and right in error
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("command", "option"), FOLDERS)
def test_a_folder_that_ends_as_a_file_is_refused(command, option, tmp_path, capsys):
    assert main([command, *NEEDED.get(command, []), option, str(tmp_path / "figure.png")]) == 2
    assert f"write the folder, {tmp_path / 'figure'}" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_options_and_commands_in_both_spellings(capsys):
    for words in (["--stabilizer", "nix"], ["--stabilizer=nix"], ["--stabiliser=nix"]):
        assert main(["simulate", "g1", *words]) == 2
        assert "no stabiliser 'nix'" in capsys.readouterr().err
    for command in ("analyse", "analyze"):
        assert main([command, "gg1"]) == 2
        assert "did you mean 'g1'" in capsys.readouterr().err
    assert main(["--debug", "analyse"]) == 2  # still a usage error, told in one line
    assert capsys.readouterr().err.count("\n") == 1


def test_what_follows_an_option_is_not_respelt():
    """A robot may be called as it likes."""
    assert make_parser().parse_args(["simulate", "--robot", "stabilizer", "analyse"]).robot == "stabilizer"
    assert str(make_parser().parse_args(["analyze", "analyse"]).gait) == "analyse"


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (["simulate", "g1", "--steps", "1000000000000"], "is more than 1000000, the most"),
        (["simulate", "g1", "--steps", "9" * 5000], "is more than 1000000, the most"),
        (["simulate", "g1", "--steps", "0"], "'0' is not a positive whole number"),
        (["simulate", "g1", "--steps", "1_0"], "'1_0' is not a positive whole number"),
        (["simulate", "g1", "--steps", "\u0663"], "is not a positive whole number"),
        (["simulate", "g1", "--seed", "9223372036854775808"], "is more than 9223372036854775807"),
        (["simulate", "g1", "--seed", "-1"], "'-1' is not a whole number"),
        (["simulate", "g1", "--rate", "x" * 5000], "is not a finite number"),
        (["design", "--attempts", "1000001"], "is more than 1000000"),
        (["trial", "s.toml", "--repeat", "1000001"], "is more than 1000000"),
        (["trial", "s.toml", "--jobs", "1000000"], "is more than 1000, the most"),
        (["library", "s.toml", "-o", "l", "--jobs", "1001"], "is more than 1000, the most"),
        (["analyze", "g1", "--jobs", "1001"], "is more than 1000, the most"),
        (["export", "g1", "-o", "a.png", "--size", "100000000x100000000"], "from 100 to 10000 pixels"),
        (["export", "g1", "-o", "a.png", "--size", f"{'9' * 5000}x100"], "from 100 to 10000 pixels"),
        (["design", "-o", f"{'x' * 5000}.txt"], "does not end in .json"),
        (["plot", "g1", "-o", f"{'x' * 5000}.png"], "ends as a file does"),
    ],
)
def test_numbers_that_nobody_means_are_refused_in_one_line(words, complaint, capsys):
    assert main(words) == 2
    out, error = capsys.readouterr()
    assert out == ""
    assert error.count("\n") == 1 and complaint in error


def test_the_largest_numbers_are_allowed():
    parsed = make_parser().parse_args(["trial", "s.toml", "--repeat", "1000000", "--jobs", "+1000", "--seed", "007"])
    assert (parsed.repeat, parsed.jobs, parsed.seed) == (1_000_000, 1000, 7)
