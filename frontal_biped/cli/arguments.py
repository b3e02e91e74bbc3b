"""Types of arguments, and the arguments that several commands take."""

import argparse
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

from frontal_biped.files.quoted import quoted

MOST_COUNTED = 1_000_000
"""Of what a number on the command line counts: steps, trials, starts; more is never meant, and would not end."""

MOST_PROCESSES = 1000
"""That ``--jobs`` may ask for."""

LARGEST_SEED = 2**63 - 1

LARGEST_SIDE = 10_000
"""Of a picture, in pixels."""

Arguments = argparse._ActionsContainer
"""A parser, or a group of its arguments."""


_SHIPPED = "the name of a packaged gait"


# ------------------------------------------------------------- shared arguments
def add_value(to: Arguments, option: str, metavar: str, kind: Callable[[str], Any], default: str, meaning: str) -> None:
    """An option with a default, written as on the command line and told by the help."""
    to.add_argument(option, metavar=metavar, type=kind, default=default, help=f"{meaning}; default: %(default)s")


def add_gait(to: Arguments) -> None:
    """The gait file to work on."""
    to.add_argument("gait", metavar="G.json", type=Path, help=f"gait file, or {_SHIPPED}")


def add_source(to: Arguments, robot: bool = False) -> None:
    """The gait or run file to show, or also a robot."""
    also = "; or a robot, by name or file" if robot else f", or {_SHIPPED}"
    to.add_argument("source", metavar="G.json|RUN.npz", type=Path, help=f"gait or run file{also}")


def add_robot(to: Arguments, default: str | None = None) -> None:
    """``--robot``; without a default the robot is the one that a file names."""
    meaning = "a name from `robots`, or a description (.toml) or URDF file"
    shown = default or "the robot the gait names"
    to.add_argument("--robot", metavar="R", default=default, help=f"{meaning}; default: {shown}")


def add_jobs(to: Arguments) -> None:
    """``--jobs``, by default as many as there are processors for this one; see `workers`."""
    to.add_argument(
        "--jobs",
        metavar="N",
        type=processes,
        default=len(os.sched_getaffinity(0)),
        help="worker processes, each on one thread; default: one for each processor, here %(default)s",
    )


def add_json(to: Arguments) -> None:
    """``--json``; see `emit`."""
    to.add_argument("--json", action="store_true", help="print the report as JSON")


def add_verbose(to: Arguments) -> None:
    """``--verbose``: the tables behind the first lines of a report."""
    to.add_argument("-v", "--verbose", action="store_true", help="add the tables")


def add_output(to: Arguments, metavar: str, meaning: str) -> None:
    """``-o`` of one file, whose ending is the one of ``metavar``."""
    to.add_argument("-o", "--output", metavar=metavar, type=file_ending(Path(metavar).suffix), help=meaning)


def add_page(to: Arguments, meaning: str) -> None:
    """``--html``."""
    to.add_argument("--html", metavar="PAGE.html", type=file_ending(".html"), help=meaning)


def add_no_open(to: Arguments) -> None:
    """``--no-open``, of what is shown in a browser."""
    to.add_argument("--no-open", action="store_true", help="do not open a browser, only print the address")


# ------------------------------------------------------------------------ types
def file_ending(ending: str) -> Callable[[str], Path]:
    """The type of a file to write whose name must end as its content does."""

    def file(text: str) -> Path:
        path = Path(text)
        if _is_folder(path) or text.endswith(("/", os.sep)):
            raise argparse.ArgumentTypeError(f"{text!r} is a directory; name a file in it that ends in {ending}")
        if path.suffix.lower() != ending:
            raise argparse.ArgumentTypeError(f"{text!r} does not end in {ending}; write {path.with_suffix(ending)}")
        return path

    return file


def folder(text: str) -> Path:
    """A folder to write into; a name that ends as a file does is taken for a mistake."""
    path = Path(text)
    if path.suffix.lower() in _FILE_ENDINGS and not _is_folder(path):
        raise argparse.ArgumentTypeError(f"{text!r} ends as a file does; write the folder, {path.with_suffix('')}")
    return path


def _is_folder(path: Path) -> bool:
    """Is it there, and a folder? A name that is too long for the file system is none."""
    try:
        return path.is_dir()
    except OSError:
        return False


_FILE_ENDINGS = (".npz", ".json", ".csv", ".html", ".svg", ".pdf", ".png", ".gif", ".toml", ".urdf", ".txt", ".xml")


def positive_int(text: str) -> int:
    """1, 2, ... up to `MOST_COUNTED`."""
    return _whole(text, "a positive whole number", 1, MOST_COUNTED)


def processes(text: str) -> int:
    """Worker processes, up to `MOST_PROCESSES`."""
    return _whole(text, "a positive whole number", 1, MOST_PROCESSES)


def whole_number(text: str) -> int:
    """0, 1, ... up to `LARGEST_SEED`."""
    return _whole(text, "a whole number", 0, LARGEST_SEED)


def _whole(text: str, what: str, low: int, high: int) -> int:
    digits = text.removeprefix("+")
    if not (digits.isascii() and digits.isdecimal()):
        raise argparse.ArgumentTypeError(f"{quoted(text)} is not {what}")
    value = int(digits) if len(digits) <= len(str(high)) else high + 1
    if value < low:
        raise argparse.ArgumentTypeError(f"{quoted(text)} is not {what}")
    if value > high:
        raise argparse.ArgumentTypeError(f"{quoted(text)} is more than {high}, the most there may be")
    return value


def port(text: str) -> int:
    """A port, 1 to 65535; 0: the first free one."""
    if not (text.isascii() and text.isdecimal() and len(text) <= 5 and int(text) <= 65535):
        raise argparse.ArgumentTypeError(f"{text[:20]!r} is not a port from 1 to 65535, or 0 for the first free one")
    return int(text)


def finite_float(text: str) -> float:
    """A number, neither infinite nor NaN."""
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not abs(value) < float("inf"):
        raise argparse.ArgumentTypeError(f"{quoted(text)} is not a finite number")
    return value


def positive_float(text: str) -> float:
    """A finite number above 0."""
    value = finite_float(text)
    if value <= 0.0:
        raise argparse.ArgumentTypeError(f"{quoted(text)} is not positive")
    return value


def not_negative_float(text: str) -> float:
    """A finite number, 0 or more."""
    value = finite_float(text)
    if value < 0.0:
        raise argparse.ArgumentTypeError(f"{quoted(text)} is negative")
    return value


def figure_formats(text: str) -> tuple[str, ...]:
    """Formats of figures, with commas between them."""
    formats = tuple(part.strip().lower() for part in text.split(","))
    wrong = [part for part in formats if part not in ("svg", "pdf", "png")]
    if wrong:
        raise argparse.ArgumentTypeError(f"{wrong[0]!r} is none of svg, pdf, png")
    return formats


def size(text: str) -> tuple[int, int]:
    """Width and height in pixels, as in 1280x800."""
    sides = text.split("x")
    if len(sides) != 2 or not all(
        side.isascii() and side.isdecimal() and len(side) <= 9 and 100 <= int(side) <= LARGEST_SIDE for side in sides
    ):
        raise argparse.ArgumentTypeError(
            f"{quoted(text)} is not a size like 1280x800, from 100 to {LARGEST_SIDE} pixels either way"
        )
    return int(sides[0]), int(sides[1])
