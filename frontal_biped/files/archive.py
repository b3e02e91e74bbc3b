"""NumPy archives (NPZ) without pickles: named arrays, and one JSON text called ``header``."""

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from frontal_biped.exceptions import TrajectoryFileError
from frontal_biped.files.array_schema import ArraySchema, require_shapes, require_values
from frontal_biped.files.atomic import atomic_path
from frontal_biped.files.header_schema import Entry, require_entries
from frontal_biped.files.kinds import WORDS, archive_format, named_kind
from frontal_biped.files.npz import open_npz

_MOST_SHOWN = 300  # characters of the reason in a complaint


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


def read_archive(
    path: Path,
    kind: ArchiveKind,
    header: Mapping[str, Entry],
    arrays: Callable[[Mapping[str, Any]], Mapping[str, ArraySchema]],
    together: Callable[[Mapping[str, Any]], None],
) -> dict[str, Any]:
    """Read an archive: what it is, its header, what its arrays are said to be, and only then the arrays.

    Args:
        path: of the file.
        kind: what it must be.
        header: what its header must have; more is left.
        arrays: says, by what stands in the header, what arrays must be there; more are left.
        together: raises ValueError where all these values, each of them right, do not go together.

    Returns:
        The values of these keys and these arrays, by name.

    Raises:
        TrajectoryFileError: the file is missing, cut off, of another kind, or not as it must be; one line.
    """
    try:
        if archive_format(path) != kind.format and (other := named_kind(path)) is not None:
            raise TrajectoryFileError(f"{path}: is {other}, not {WORDS[kind.format]}; {kind.remedy}")
        with open_npz(path) as archive:
            told = archive.header()
            version = told.get("version")
            if told.get("format") != kind.format or version != kind.version or isinstance(version, bool):
                raise TrajectoryFileError(f"{path}: not a run file of version {kind.version}; {kind.remedy}")
            found = require_entries(told, header)
            schema = arrays(found)
            heads = {name: archive.head(name) for name in schema}
            require_shapes(heads, schema, path.stat().st_size)
            numbers = {name: archive.read(name, head) for name, head in heads.items()}
        require_values(numbers, schema)
        together(found | numbers)
    except FileNotFoundError:
        raise TrajectoryFileError(f"{path}: no such run file; {kind.remedy}") from None
    except (OSError, ValueError) as error:
        why = str(error.strerror if isinstance(error, OSError) and error.strerror else error)
        if len(why) > _MOST_SHOWN or not why.isprintable():  # zipfile quotes what stands in the file
            why = repr(why[:_MOST_SHOWN])
        raise TrajectoryFileError(f"{path}: not a readable run file ({why}); {kind.remedy}") from None
    return found | numbers
