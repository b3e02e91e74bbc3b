"""What libraries in C++ write to the standard error, kept from the terminal: told in a complaint, or not at all."""

import contextlib
import os
import re
import sys
import tempfile
import threading
from collections.abc import Iterator

_LONGEST = 200
"""Characters of what was written that are told."""

_ONE_AT_A_TIME = threading.Lock()


class Kept:
    """What was written.

    Attributes:
        text: in one line, the beginning of it; "" of nothing.
    """

    text = ""


@contextlib.contextmanager
def kept_from_terminal() -> Iterator[Kept]:
    """Keep what is written to the process's standard error, below Python; `Kept.text` has it after the block."""
    kept = Kept()
    with contextlib.ExitStack() as stack:
        stack.enter_context(_ONE_AT_A_TIME)
        try:
            terminal = os.dup(2)
        except OSError:  # the process has no standard error
            yield kept
            return
        stack.callback(os.close, terminal)
        stream = stack.enter_context(tempfile.TemporaryFile())
        if sys.stderr is not None:
            sys.stderr.flush()
        os.dup2(stream.fileno(), 2)
        try:
            yield kept
        finally:
            os.dup2(terminal, 2)
            stream.seek(0)
            kept.text = _in_one_line(stream.read(4096).decode("utf-8", errors="replace"))


def _in_one_line(text: str) -> str:
    """Without the lines of the library's source, and with nothing that a terminal would obey."""
    told = " ".join(re.sub(r"\s+at line \d+ in \S+", "", text).split()).removeprefix("Error: ")
    return "".join(letter if letter.isprintable() else "?" for letter in told)[:_LONGEST]
