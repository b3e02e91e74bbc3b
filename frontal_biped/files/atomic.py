"""Write files whole or not at all."""

import contextlib
import errno
import json
import os
import secrets
import shutil
import stat
import tempfile
import time
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from frontal_biped.files.json_values import for_json

READER_PATIENCE = 10.0
"""How long a named pipe waits for somebody who reads it [s]."""


@contextlib.contextmanager
def atomic_path(target: Path) -> Iterator[Path]:
    """A temporary path; what is written there becomes the target only if the block ends without an error.

    A symbolic link stays one: what it names is replaced. What is no regular file, a device or a pipe, stays what it is
    and is written into. A file that is replaced passes on its permissions, a new one has those that the umask leaves.
    File and folder reach the disk before the block is left.

    Raises:
        OSError: it cannot be written, the disk is full say; names the target.
    """
    if _is_special(target):
        with tempfile.TemporaryDirectory(prefix="frontal-biped-") as folder:
            temporary = Path(folder) / target.name
            with _named(target, temporary):
                yield temporary
                _write_through(temporary, target)
        return
    real = _followed(target)
    temporary = real.with_name(f".{real.stem[:40]}.{secrets.token_hex(4)}{real.suffix[:20]}")
    with _named(target, temporary):
        real.parent.mkdir(parents=True, exist_ok=True)
        try:  # from here on, lest Ctrl+C leaves the file between its making and its being known
            os.close(os.open(temporary, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))  # less the umask
            with contextlib.suppress(FileNotFoundError):
                temporary.chmod(stat.S_IMODE(real.stat().st_mode))
            yield temporary
            _to_disk(temporary)
            temporary.replace(real)
            _to_disk(real.parent)
        finally:
            temporary.unlink(missing_ok=True)


@contextlib.contextmanager
def _named(target: Path, temporary: Path) -> Iterator[None]:
    """Errors that name no file, or the temporary one, of which nobody knows, name the target."""
    try:
        yield
    except OSError as error:
        if error.errno is None or error.filename not in (None, temporary, str(temporary)):
            raise
        raise OSError(error.errno, error.strerror, str(target)) from None


def _followed(target: Path) -> Path:
    real = Path(os.path.realpath(target))
    if real.is_symlink():
        raise OSError(errno.ELOOP, os.strerror(errno.ELOOP), str(target))
    return real


def _is_special(target: Path) -> bool:
    """Is it there, and neither a regular file nor a folder?"""
    try:
        mode = target.stat().st_mode
    except OSError:
        return False
    return not stat.S_ISREG(mode) and not stat.S_ISDIR(mode)


def _to_disk(path: Path) -> None:
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    except OSError as error:
        if error.errno not in (errno.EINVAL, errno.ENOTSUP):  # a file system that has no such thing for folders
            raise
    finally:
        os.close(handle)


def _write_through(source: Path, target: Path) -> None:
    deadline = time.monotonic() + READER_PATIENCE
    while True:
        try:
            # without waiting: a pipe that nobody reads is told, not waited for until the end of days
            handle = os.open(target, os.O_WRONLY | os.O_NONBLOCK | os.O_NOCTTY)
            break
        except OSError as error:
            if error.errno != errno.ENXIO:
                raise
            if time.monotonic() > deadline:
                raise OSError(errno.ENXIO, "is a pipe that nobody reads", str(target)) from None
            time.sleep(0.05)
    os.set_blocking(handle, True)
    with source.open("rb") as stream, os.fdopen(handle, "wb") as into:
        shutil.copyfileobj(stream, into)


def require_parent(target: Path) -> None:
    """Raise OSError now if the target could not be written later, before any long work; creates nothing."""
    if target.is_dir():
        raise IsADirectoryError(errno.EISDIR, "is a directory", str(target))
    if not _is_special(target):
        require_folder(_followed(target).parent)
    if target.exists() and not os.access(target, os.W_OK):
        raise PermissionError(errno.EACCES, "the file is not writable", str(target))


def require_folder(folder: Path) -> None:
    """Raise OSError now if the folder could not be made or written to later; creates nothing."""
    existing = folder.absolute()
    while not existing.exists():
        existing = existing.parent
    if not existing.is_dir():
        raise NotADirectoryError(errno.ENOTDIR, "is not a folder", str(existing))
    if not os.access(existing, os.W_OK):
        raise PermissionError(errno.EACCES, "the folder is not writable", str(existing))


def write_text(target: Path, text: str) -> None:
    """Write UTF-8 text to a file, atomically."""
    with atomic_path(target) as temporary:
        temporary.write_text(text, encoding="utf-8")


def write_json(target: Path, content: Mapping[str, Any]) -> None:
    """Write a JSON file, atomically; numbers that are not finite become null, which JSON can say."""
    write_text(target, json.dumps(for_json(content), indent=1, allow_nan=False) + "\n")
