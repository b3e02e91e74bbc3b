"""One process at a time builds a library; the system lets go of the lock when that process ends, however it ends."""

import contextlib
import errno
import fcntl
import os
import platform
from collections.abc import Iterator
from pathlib import Path

from frontal_biped.exceptions import LibraryError

LOCK = ".lock"
"""Name of the file in the library's folder, there while it is built; it says who builds it."""

_NO_LOCKS = (errno.ENOLCK, errno.ENOTSUP, errno.ENOSYS, errno.EINVAL)
"""What file systems without locks answer; there two processes design the same gaits twice, and write the same bytes."""


@contextlib.contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Hold the lock of a library's folder, which is made if it is not there.

    Raises:
        LibraryError: another process holds it.
    """
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / LOCK
    handle = _held(folder, path)
    try:
        with contextlib.suppress(OSError):  # on a full disk the lock holds all the same
            os.truncate(handle, 0)
            os.write(handle, f"process {os.getpid()} on {platform.node()}".encode())
        yield
    finally:
        path.unlink(missing_ok=True)
        os.close(handle)


def _held(folder: Path, path: Path) -> int:
    while True:
        handle = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            owner = os.read(handle, 200).decode("utf-8", errors="replace") or "another process"
            os.close(handle)
            raise LibraryError(
                f"{folder}: {owner} is building this library; wait for it, or choose another folder"
            ) from None
        except OSError as error:
            if error.errno not in _NO_LOCKS:
                os.close(handle)
                raise OSError(error.errno, error.strerror, str(path)) from None
        if _is_still_there(handle, path):
            return handle
        os.close(handle)  # its last holder has removed it in between


def _is_still_there(handle: int, path: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(handle), path.stat())
    except FileNotFoundError:
        return False
