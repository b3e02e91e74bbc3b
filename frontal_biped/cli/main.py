"""Entry point of `frontal-biped`: the commands, and errors in one line."""

import argparse
import contextlib
import gc
import shlex
import signal
import sys
from collections.abc import Mapping, Sequence
from typing import Any, NoReturn, Protocol

from frontal_biped.cli import (
    analyze,
    demo,
    design,
    export,
    library,
    plot,
    robots,
    simulate,
    studio,
    trial,
    verify,
    view,
    walk,
)
from frontal_biped.cli.exit_status import TASK_FAILED, USAGE
from frontal_biped.cli.interruption import interruptible
from frontal_biped.cli.surroundings import FORESEEN, open_streams, quieten_libraries, silence, told, write_out
from frontal_biped.exceptions import FrontalBipedError, Interruption
from frontal_biped.files.names import require_utf8_name
from frontal_biped.files.spelling import respelt
from frontal_biped.numerics.threads import one_thread
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
    demo, design, library, analyze, verify, simulate, walk, trial, view, export, plot, studio, robots,
)  # fmt: skip
"""In the order of the help."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command line.

    Args:
        argv: arguments after the program's name; default: those of the process, which ends when they are done.

    Returns:
        0 on success, 1 if the task failed (no gait found, not certified, the robot fell), 2 on bad input or where the
        computer stands in the way; 128 and the signal's number, 130 for Ctrl+C, if it was interrupted.
    """
    try:
        with interruptible(to_the_end=argv is None):
            status = _run(sys.argv[1:] if argv is None else argv)
    except KeyboardInterrupt as stop:  # between two lines of this function
        status = _interrupted(stop)
    silence()
    if argv is None:
        gc.freeze()  # memory goes with the process; to look for garbage in all of it first takes up to half a second
    return status


def _run(words: Sequence[str]) -> int:
    """What `main` returns; every error in one line."""
    debug = "--debug" in words
    try:
        open_streams()
        quieten_libraries()
        one_thread()
        return _status(words)
    except KeyboardInterrupt as stop:
        return _interrupted(stop)
    except BrokenPipeError:  # the reader of our output has gone; leave quietly, as other tools do
        return TASK_FAILED
    except FrontalBipedError as error:
        if debug:
            raise
        return _complain(str(error))
    except FORESEEN as error:
        if debug:
            raise
        return _complain(told(error, asked=shlex.join(words)))


def _status(words: Sequence[str]) -> int:
    for word in words:
        require_utf8_name(word, FrontalBipedError)
    parser = make_parser()
    try:
        arguments, unknown = parser.parse_known_args(_respelt_command(words))
        if unknown:
            parser.of_command(arguments.command).error(f"unrecognized arguments: {' '.join(unknown)}")
    except SystemExit as stop:  # argparse: --help, --version, or a usage error it has printed
        return int(stop.code or 0)
    if arguments.command is None:
        parser.print_help()
        return USAGE
    return int(arguments.run(arguments))


def _interrupted(stop: KeyboardInterrupt) -> int:
    """One line, with what the command has to say about it, and the status that shells know."""
    notes = getattr(stop, "__notes__", ["nothing was left half-written"])
    _complain("; ".join(["interrupted", *notes]))
    return stop.exit_status if isinstance(stop, Interruption) else Interruption(signal.SIGINT).exit_status


def _respelt_command(words: Sequence[str]) -> list[str]:
    """The command line, its command spelt the way it is listed: `analyse` is `analyze`."""
    names = [_name(command) for command in COMMANDS]
    first = next((i for i, word in enumerate(words) if not word.startswith("-")), len(words))
    return [respelt(word, names) if i == first else word for i, word in enumerate(words)]


def _name(command: Command) -> str:
    return command.__name__.rpartition(".")[2]


def _complain(message: str) -> int:
    with contextlib.suppress(OSError):  # the status still tells
        sys.stderr.write(f"frontal-biped: error: {' '.join(message.split())}\n")
    return USAGE


class _Parser(argparse.ArgumentParser):
    """A parser whose complaint is one line; argparse would print the usage before it, up to eight lines."""

    commands: "Mapping[str, _Parser] | None" = None
    """Of the whole program: the parsers of its commands."""

    def of_command(self, name: str | None) -> "_Parser":
        """The parser of a command; the program's own where none is given."""
        return self if self.commands is None or name is None else self.commands[name]

    def _print_message(self, message: str, file: Any = None) -> None:
        """Help goes out as everything else does; argparse would not say that it could not be written."""
        if message and file in (None, sys.stdout):
            write_out(message)
        else:
            super()._print_message(message, file)

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
        told = " ".join(message.split())  # words of the command line may hold line breaks
        self.exit(USAGE, f"{self.prog}: error: {told}; see `{self.prog} --help`\n")


class _Version(argparse.Action):
    """`--version` with the versions of the solvers, looked up only when asked for."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        from frontal_biped.files.provenance import software_versions

        versions = software_versions()
        write_out("".join(f"{name} {version}\n" for name, version in versions.items()))
        parser.exit()


def make_parser() -> _Parser:
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
    parser.commands = subparsers.choices
    return parser
