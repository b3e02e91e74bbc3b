"""NumPy archives (NPZ) without pickles: named arrays, and one JSON text called ``header``."""

import json
import zipfile
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from frontal_biped.exceptions import TrajectoryFileError
from frontal_biped.files.atomic import atomic_path
from frontal_biped.files.kinds import WORDS, archive_format, named_kind


class ArchiveKind(NamedTuple):
    """What an archive says it is.

    Attributes:
        format: its name, one of `frontal_biped.files.kinds`.
        version: of the format.
        remedy: how to come by such a file, the end of every complaint.
    """

    format: str
    version: int
    remedy: str


def write_archive(path: Path, kind: ArchiveKind, header: Mapping[str, Any], arrays: Mapping[str, Any]) -> None:
    """Write an archive; it appears whole or not at all."""
    told = json.dumps({"format": kind.format, "version": kind.version, **header})
    with atomic_path(path) as temporary, temporary.open("wb") as stream:
        np.savez_compressed(stream, header=np.array(told), **arrays)


def read_archive(path: Path, kind: ArchiveKind, header: Iterable[str], arrays: Iterable[str]) -> dict[str, Any]:
    """Read an archive.

    Args:
        path: of the file.
        kind: what it must be.
        header: keys that the header must have; others are left.
        arrays: names of arrays that must be there; others are left.

    Returns:
        The values of these keys and these arrays, by name.

    Raises:
        TrajectoryFileError: the file is missing, cut off, or of another kind.
    """
    if not path.is_file():
        raise TrajectoryFileError(f"{path}: no such run file; {kind.remedy}")
    if archive_format(path) != kind.format and (other := named_kind(path)) is not None:
        raise TrajectoryFileError(f"{path}: is {other}, not {WORDS[kind.format]}; {kind.remedy}")
    try:
        with np.load(path, allow_pickle=False) as archive:
            told = json.loads(str(archive["header"]))
            if told.get("format") != kind.format or told.get("version") != kind.version:
                raise TrajectoryFileError(f"{path}: not a run file of version {kind.version}; {kind.remedy}")
            return {**{key: told[key] for key in header}, **{name: archive[name] for name in arrays}}
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile, AttributeError) as error:
        raise TrajectoryFileError(f"{path}: not a readable run file ({error}); {kind.remedy}") from None
