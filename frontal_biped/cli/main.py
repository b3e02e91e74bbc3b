"""Entry point of `frontal-biped`: the commands, and errors in one line."""

import argparse
import os
import sys
from collections.abc import Sequence
from typing import Any, NoReturn, Protocol

from frontal_biped.cli import analyze, demo, design, export, library, plot, robots, simulate, studio, trial, view, walk
from frontal_biped.cli.exit_status import TASK_FAILED, USAGE
from frontal_biped.exceptions import FrontalBipedError
from frontal_biped.files.names import require_utf8_name
from frontal_biped.files.spelling import respelt
from frontal_biped.version import __version__


class Command(Protocol):
    """What the module of a command holds; the command is called as the module is."""

    __name__: str
    SUMMARY: str
    EXAMPLE: str

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        """Say what the command takes."""

    def run(self, arguments: argparse.Namespace) -> int:
        """Do it; returns the exit status."""


COMMANDS: tuple[Command, ...] = (
    demo, design, library, analyze, simulate, walk, trial, view, export, plot, studio, robots,
)  # fmt: skip
"""In the order of the help."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command line.

    Args:
        argv: arguments after the program's name; default: those of the process.

    Returns:
        0 on success, 1 if the task failed (no gait found, not certified, the robot fell), 2 on bad input.
    """
    parser = make_parser()
    try:
        words = sys.argv[1:] if argv is None else argv
        for word in words:
            require_utf8_name(word, FrontalBipedError)
    except FrontalBipedError as error:
        return _complain(str(error))
    try:
        arguments = parser.parse_args(_respelt_command(words))
    except SystemExit as stop:  # argparse: --help, --version, or a usage error it has printed
        return int(stop.code or 0)
    if arguments.command is None:
        parser.print_help()
        return USAGE
    if arguments.debug:
        return int(arguments.run(arguments))
    try:
        status = int(arguments.run(arguments))
        sys.stdout.flush()  # what cannot be written is told here, not by the interpreter at its end
        return status
    except FrontalBipedError as error:
        return _complain(str(error))
    except BrokenPipeError:
        # the reader of our output has gone; leave quietly, as other tools do
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return TASK_FAILED
    except OSError as error:
        return _complain(f"{error.filename or 'file system'}: {error.strerror or error}; choose another path")
    except KeyboardInterrupt:
        return _complain("interrupted; nothing was left half-written")


def _respelt_command(words: Sequence[str]) -> list[str]:
    """The command line, its command spelt the way it is listed: `analyse` is `analyze`."""
    names = [_name(command) for command in COMMANDS]
    first = next((i for i, word in enumerate(words) if not word.startswith("-")), len(words))
    return [respelt(word, names) if i == first else word for i, word in enumerate(words)]


def _name(command: Command) -> str:
    return command.__name__.rpartition(".")[2]


def _complain(message: str) -> int:
    sys.stderr.write(f"frontal-biped: error: {' '.join(message.split())}\n")
    return USAGE


class _Parser(argparse.ArgumentParser):
    """A parser whose complaint is one line; argparse would print the usage before it, up to eight lines."""

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Options may be spelt the British or the American way."""
        known = [option for option in self._option_string_actions if option.startswith("--")]
        words = [self._respelt(word, known) for word in (sys.argv[1:] if args is None else args)]
        return super().parse_known_args(words, namespace)

    @staticmethod
    def _respelt(word: str, known: list[str]) -> str:
        name, equals, value = word.partition("=")
        return f"{respelt(name, known)}{equals}{value}" if name.startswith("--") else word

    def error(self, message: str) -> NoReturn:
        """Say what is wrong and where the arguments are listed."""
        self.exit(USAGE, f"{self.prog}: error: {message}; see `{self.prog} --help`\n")


class _Version(argparse.Action):
    """`--version` with the versions of the solvers, looked up only when asked for."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        from frontal_biped.files.provenance import software_versions

        versions = software_versions()
        sys.stdout.write("".join(f"{name} {version}\n" for name, version in versions.items()))
        parser.exit()


def make_parser() -> argparse.ArgumentParser:
    """The parser of every command."""
    parser = _Parser(
        prog="frontal-biped",
        description=f"Frontal-plane bipedal hybrid zero dynamics, version {__version__}.",
        epilog=f"example: {demo.EXAMPLE}",
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="print versions and exit")
    common = _Parser(add_help=False)
    common.add_argument("--debug", action="store_true", help="show the traceback of an error")
    subparsers = parser.add_subparsers(dest="command", metavar="COMMAND")
    for command in COMMANDS:
        own = subparsers.add_parser(
            _name(command),
            help=command.SUMMARY,
            description=command.SUMMARY,
            epilog=f"example: {command.EXAMPLE}",
            parents=[common],
        )
        command.add_arguments(own)
        own.set_defaults(run=command.run)
    return parser
