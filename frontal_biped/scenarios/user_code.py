"""Code that users write: whatever it raises is told in one line, and is never taken for the end of the program."""

import contextlib
import functools
import os
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from frontal_biped.exceptions import FrontalBipedError, ScenarioError, is_interruption

METHODS = ("reset", "tick", "begin", "command")
"""What a controller is asked by."""

MOST_TOLD = 200
"""Letters of somebody's error that are told."""


@contextlib.contextmanager
def users_own(where: str, doing: str, remedy: str) -> Iterator[None]:
    """Run code of the user's; afterwards the current folder is the one that it was.

    Args:
        where: begins the complaint.
        doing: what fails if it fails, for example "importing it".
        remedy: ends the complaint.

    Raises:
        ScenarioError: it raised anything, an exit included, but Ctrl+C or an error of this package's own.
    """
    with folder_kept():
        try:
            yield
        except BaseException as error:
            if not _is_theirs(error):
                raise
            raise _complaint(error, where, doing, remedy) from error


class GuardedController:
    """A user's controller that tells in one line what it raises; see `guarded`."""

    def __init__(self, controller: Any, where: str) -> None:
        self._controller = controller
        for name in METHODS:
            if hasattr(controller, name):
                setattr(self, name, _guarded_method(getattr(controller, name), where, f"its {name}"))

    def __getattr__(self, name: str) -> Any:
        return getattr(self.__dict__["_controller"], name)


def guarded(controller: Any, where: str) -> GuardedController:
    """A user's controller, guarded; of a class of the same name, by which runs name their controller.

    Args:
        controller: the user's.
        where: begins every complaint, a `ScenarioError`.
    """
    kind: type[GuardedController] = type(type(controller).__name__, (GuardedController,), {})
    return kind(controller, where)


def _guarded_method(method: Callable[..., Any], where: str, doing: str) -> Callable[..., Any]:
    @functools.wraps(method, assigned=("__doc__",), updated=())
    def call(*arguments: Any, **named: Any) -> Any:
        try:
            return method(*arguments, **named)
        except BaseException as error:
            if not _is_theirs(error):
                raise
            raise _complaint(error, where, doing, "mend the controller") from error

    return call


def _is_theirs(error: BaseException) -> bool:
    """Is an error the fault of the user's code, rather than told already, or Ctrl+C?"""
    return not (is_interruption(error) or isinstance(error, FrontalBipedError))


def _complaint(error: BaseException, where: str, doing: str, remedy: str) -> ScenarioError:
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if _PACKAGE not in frame.filename]
    place = f" in line {frames[-1].lineno} of {Path(frames[-1].filename).name}" if frames else ""
    return ScenarioError(f"{where}: {doing} fails, {type(error).__name__}: {_message(error)}{place}; {remedy}")


_PACKAGE = str(Path(__file__).parents[1])


def _message(error: BaseException) -> str:
    try:
        return " ".join(str(error).split())[:MOST_TOLD]
    except Exception:
        return "an error that cannot be shown"


@contextlib.contextmanager
def folder_kept() -> Iterator[None]:
    """After the block the current folder is the one that it was."""
    try:
        before = os.getcwd()  # noqa: PTH109
    except FileNotFoundError:  # it is gone
        before = ""
    try:
        yield
    finally:
        with contextlib.suppress(OSError):
            os.chdir(before)
