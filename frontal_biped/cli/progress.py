"""Progress on a terminal: one line on standard error, rewritten in place; silent when piped but for what stays."""

import sys
import time
from types import TracebackType


class Progress:
    """A line that says what is going on.

    Args:
        title: what is being done.
        total: number of units, or None if unknown.
    """

    def __init__(self, title: str, total: int | None = None) -> None:
        self.title, self.total = title, total
        self._active = sys.stderr.isatty()
        self._shown = 0.0
        self._width = 0

    def __enter__(self) -> "Progress":
        self.update("")
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._clear()

    def say(self, line: str) -> None:
        """A line that stays, piped or not."""
        self._clear()
        sys.stderr.write(f"frontal-biped: {line}\n")

    def _clear(self) -> None:
        if self._active:
            sys.stderr.write("\r" + " " * self._width + "\r")
            sys.stderr.flush()

    def update(self, detail: str, done: int | None = None) -> None:
        """Show a detail; at most ten times a second."""
        now = time.monotonic()
        if not self._active or (detail and now - self._shown < 0.1):
            return
        self._shown = now
        count = f" {done}/{self.total}" if done is not None and self.total is not None else ""
        line = f"{self.title}{count} {detail}".rstrip()[:110]
        sys.stderr.write("\r" + line.ljust(self._width))
        sys.stderr.flush()
        self._width = len(line)
