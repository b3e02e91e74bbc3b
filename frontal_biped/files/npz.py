"""NumPy archives (NPZ) opened without trust: nothing is read or allocated because a file says that it is there.

What an entry says of its numbers, and whether its size goes with that, is told by `Npz.head`; the caller judges it
before `Npz.read` reads them. `numpy.load` would evaluate what stands there as Python, warn of what looks old, and
allocate whatever it is told to; only what its own `numpy.savez` writes is taken here: entries as they are or deflated,
of plain numbers or one text.
"""

import io
import math
import re
import zipfile
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from frontal_biped.exceptions import TrajectoryFileError
from frontal_biped.files.reading import MOST_JSON_BYTES, json_value, require_regular

MOST_FILE_BYTES = 4_000_000_000
"""Of an archive, as large as one of entries that are not compressed can be."""

MOST_PIECE = 1 << 20
"""Bytes that are read at a time, and of a directory; that of a run has thirty entries of some sixty bytes."""

_MOST_HEAD = 4096  # bytes before the numbers of an entry; NumPy writes 128
_MAGIC = b"\x93NUMPY"
_SHAPE = r"\((?:(?:\d{1,15}, *)+(?:\d{1,15})?)?\)"
_PART = rf"(?:'descr': *'[ -&(-\[\]-~]{{1,16}}'|'fortran_order': *(?:True|False)|'shape': *{_SHAPE})"
_HEAD = re.compile(rf"\{{{_PART}, *{_PART}, *{_PART},? *\}}\s*")
_NUMBERS = re.compile("[<>|=]?(f[248]|[iu][1248]|b1)")
_TEXT = re.compile(r"[<>]U\d{1,9}")


class Head(NamedTuple):
    """What an entry holds.

    Attributes:
        dtype: as NumPy writes it, for example ``<f8``.
        shape: of the array.
        column_major: in Fortran's order.
        offset: bytes before its numbers.
    """

    dtype: str
    shape: tuple[int, ...]
    column_major: bool
    offset: int

    @property
    def are_numbers(self) -> bool:
        """Real numbers, whole ones or truth values, of at most eight bytes each?"""
        return _NUMBERS.fullmatch(self.dtype) is not None


@contextmanager
def open_npz(path: Path) -> Iterator["Npz"]:
    """An archive, open for reading.

    Raises:
        TrajectoryFileError: it is a folder, a device or a pipe; one line.
        OSError: it is missing, or cannot be read.
        ValueError: it is no archive, or none that NumPy writes.
    """
    require_regular(path, MOST_FILE_BYTES, TrajectoryFileError, ".npz file")
    with _Sparing(path) as stream:
        with _told():
            archive = zipfile.ZipFile(stream)
            entries = archive.infolist()
        for name, count in Counter(entry.filename for entry in entries).items():
            if count > 1:
                raise ValueError(f"the entry {name!r} is there twice")
        yield Npz(archive, {entry.filename: entry for entry in entries})


class Npz:
    """The entries of an open archive; see `open_npz`.

    Args:
        archive: the archive.
        entries: what its directory says, by name.
    """

    def __init__(self, archive: zipfile.ZipFile, entries: dict[str, zipfile.ZipInfo]) -> None:
        self._archive, self._entries = archive, entries

    def header(self) -> dict[str, Any]:
        """The JSON object of the entry ``header``; numbers in it need not be finite.

        Raises:
            ValueError: there is none.
        """
        head = self.head("header")
        if not _TEXT.fullmatch(head.dtype) or head.shape != ():
            raise ValueError("header is no text")
        if self._entry("header").file_size > MOST_JSON_BYTES:
            raise ValueError(f"header is larger than {MOST_JSON_BYTES} bytes")
        text = self._bytes("header", head).tobytes().decode("utf-32-le" if head.dtype[0] == "<" else "utf-32-be")
        try:
            content = json_value(text.rstrip("\0"), finite=False)
        except ValueError as error:
            raise ValueError(f"header is not valid JSON, {error}") from None
        if not isinstance(content, dict):
            raise ValueError("header is no JSON object")
        return content

    def head(self, name: str) -> Head:
        """What the array of a name is said to be, and is as large as.

        Raises:
            ValueError: there is no such array, or none of numbers or text.
        """
        entry = self._entry(name)
        with _told(name), self._archive.open(entry) as stream:
            start = stream.read(_MOST_HEAD)
        if start[:6] != _MAGIC or start[6:8] not in (b"\x01\x00", b"\x02\x00", b"\x03\x00"):
            raise ValueError(f"{name} is no array of NumPy")
        first = 10 if start[6] == 1 else 12
        offset = first + int.from_bytes(start[8:first], "little")
        told = start[first:offset].decode("latin-1")
        if len(start) < offset or not _HEAD.fullmatch(told):
            raise ValueError(f"{name} is no plain array of numbers")
        parts = dict(re.findall(r"'(\w+)': *('.*?'|\w+|\(.*?\))", told))
        if len(parts) < 3:
            raise ValueError(f"{name} is no plain array of numbers")
        dtype, order, shape = parts["descr"].strip("'"), parts["fortran_order"], parts["shape"]
        head = Head(dtype, tuple(map(int, re.findall(r"\d+", shape))), order == "True", offset)
        if not (head.are_numbers or _TEXT.fullmatch(dtype)):
            raise ValueError(f"{name} is {dtype}, not numbers")
        if offset + math.prod(head.shape) * np.dtype(dtype).itemsize != entry.file_size:
            raise ValueError(f"{name} of shape {head.shape} has not as many numbers as it says")
        return head

    def read(self, name: str, head: Head) -> "np.ndarray[Any, np.dtype[np.float64]]":
        """The numbers of an array whose head has been found right.

        Raises:
            ValueError: they are damaged.
        """
        array = self._bytes(name, head).view(head.dtype).reshape(head.shape, order="F" if head.column_major else "C")
        with np.errstate(all="ignore"):
            numbers = np.ascontiguousarray(array, dtype=np.float64)
            numbers *= 1.0  # a signalling NaN becomes a quiet one, of which NumPy does not warn
        return numbers

    def _bytes(self, name: str, head: Head) -> "np.ndarray[Any, np.dtype[np.uint8]]":
        entry = self._entry(name)
        found = np.empty(entry.file_size - head.offset, dtype=np.uint8)
        with _told(name), self._archive.open(entry) as stream:
            stream.read(head.offset)
            at = 0
            while piece := stream.read(MOST_PIECE):
                found[at : at + len(piece)] = np.frombuffer(piece, dtype=np.uint8)
                at += len(piece)
        if at < len(found):
            raise ValueError(f"{name} is cut off")
        return found

    def _entry(self, name: str) -> zipfile.ZipInfo:
        entry = self._entries.get(f"{name}.npy")
        if entry is None:
            raise ValueError(f"{name} is missing")
        if entry.flag_bits & 1:
            raise ValueError(f"{name} is encrypted")
        # others expand without end in one piece
        if entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
            raise ValueError(f"{name} is compressed in a way that NumPy does not use")
        return entry


class _Sparing(io.FileIO):
    """A file that is never read in one large piece: zipfile would read a directory as large as the file says it is."""

    def read(self, size: int | None = -1, /) -> bytes:
        """At most a piece."""
        size = -1 if size is None else size
        asked = size if size >= 0 else self._size() - self.tell()
        if asked > MOST_PIECE:
            raise zipfile.BadZipFile("its directory is too large")
        return super().read(size) or b""

    def _size(self) -> int:
        at = self.tell()
        size = self.seek(0, io.SEEK_END)
        self.seek(at)
        return size


@contextmanager
def _told(name: str = "") -> Iterator[None]:
    """What zipfile and zlib raise is decided by the file: BadZipFile, zlib.error, RuntimeError, struct.error, more."""
    try:
        yield
    except OSError:
        raise
    except Exception as error:
        raise ValueError(f"{name}: {error}" if name else str(error)) from None
