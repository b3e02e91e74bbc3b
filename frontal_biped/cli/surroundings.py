"""What a command finds around it: standard streams, folders, memory; and what is wrong there, in one line."""

import contextlib
import errno
import logging
import os
import sys
from pathlib import Path
from typing import TextIO

from frontal_biped.exceptions import FrontalBipedError

_REMEDIES = {
    errno.ENOSPC: "make room there, or choose another path",
    errno.EDQUOT: "make room there, or choose another path",
    errno.EFBIG: "allow larger files, see `ulimit -f`, or choose another path",
    errno.EMFILE: "allow more open files, see `ulimit -n`",
    errno.ENFILE: "close some of the files that are open on this machine",
    errno.ENOMEM: "free some memory, or allow more, see `ulimit -v`",
    errno.EAGAIN: "allow more processes, see `ulimit -u`",
}
"""Of errors that no other path would help against."""

FORESEEN = (OSError, MemoryError, RecursionError, ImportError)
"""Errors that `told` has a line for."""


def open_streams() -> None:
    """Give the process the standard streams it was started without.

    A file that is opened would take their numbers, and get whatever a library prints there.

    Raises:
        FrontalBipedError: standard output is closed: what was asked for could not be told.
    """
    closed = [number for number in (0, 1, 2) if not _is_open(number)]
    for _ in closed:
        os.open(os.devnull, os.O_RDWR)  # takes the lowest free number
    if sys.stderr is None:
        sys.stderr = _nowhere()
    if sys.stdout is None:
        sys.stdout = _nowhere()
        raise FrontalBipedError("standard output: is closed; send it to a file, or to /dev/null")
    with contextlib.suppress(AttributeError, ValueError):  # of a stream that is no file's
        sys.stdout.reconfigure(errors="backslashreplace")  # type: ignore[union-attr]


def quieten_libraries() -> None:
    """Matplotlib would say where it keeps its cache when HOME cannot be written; nobody asked."""
    logging.getLogger("matplotlib").setLevel(logging.ERROR)


def _nowhere() -> TextIO:
    return Path(os.devnull).open("w", encoding="utf-8")


def _is_open(number: int) -> bool:
    try:
        os.fstat(number)
    except OSError:
        return False
    return True


def write_out(text: str) -> None:
    """Write to standard output, at once, so that it is known here and not at the end of the process that it cannot be.

    Raises:
        OSError: it cannot be written; names standard output.
    """
    try:
        sys.stdout.write(text)
        sys.stdout.flush()
    except OSError as error:
        raise OSError(error.errno, error.strerror, "standard output") from None


def silence() -> None:
    """What is still to be written to standard streams that take nothing more is dropped, without a word at the end."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except OSError:
            with contextlib.suppress(OSError, ValueError):
                os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def told(error: BaseException, asked: str = "") -> str:
    """One of the `FORESEEN` errors in one line, with a remedy.

    Args:
        error: the error.
        asked: what was being done, for an error that knows no file.
    """
    if isinstance(error, OSError):
        return _told_by_system(error)
    if isinstance(error, MemoryError):
        used_up = _said(error, "the memory is used up")
        place = f"{asked}: " if asked else ""
        return f"{place}{used_up}; free some, allow more, see `ulimit -v`, or ask for less"
    if isinstance(error, RecursionError):
        return f"{_said(error, 'nested too deep')}; name a file that is nested less deep"
    return f"{_said(error, 'a package cannot be loaded')}; install frontal-biped again, or allow it more memory"


def _said(error: BaseException, otherwise: str) -> str:
    return str(error) or otherwise


def _told_by_system(error: OSError) -> str:
    reason = error.strerror or str(error)
    if error.filename is None and error.errno == errno.ENOENT:
        if "temporary directory" in reason:
            return f"TMPDIR: {reason}; set it to a folder that can be written to and has room"
        if _is_current_folder_gone():
            return "the current folder: is not there any more; change to another one"
    name = error.filename
    place = "the operating system" if name is None else os.fsdecode(name) if isinstance(name, bytes) else str(name)
    return f"{place}: {reason}; {_REMEDIES.get(error.errno or 0, 'choose another path')}"


def _is_current_folder_gone() -> bool:
    try:
        os.getcwd()  # noqa: PTH109
    except OSError:
        return True
    return False
