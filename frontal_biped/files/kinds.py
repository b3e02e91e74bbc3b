"""The kinds of files there are, each with the words for it, so that one given for another is named as what it is."""

import json
import zipfile
from pathlib import Path

import numpy as np

GAIT = "frontal-biped-gait"
"""``format`` of a gait file."""

RUN = "frontal-biped-run"
"""``format`` of the run file of a walk in the plane."""

SPACE_RUN = "frontal-biped-space-run"
"""``format`` of the run file of a walk in space."""

WORDS = {GAIT: "a gait", RUN: "a run in the plane", SPACE_RUN: "a run in space"}
"""What files of these formats are called."""

_BY_ENDING = {".urdf": "a URDF", ".toml": "a TOML file", ".html": "a page", ".csv": "a table"}


def archive_format(path: Path) -> str:
    """What a NumPy archive says it is; "" of a file that says nothing, or is none."""
    try:
        with np.load(path, allow_pickle=False) as archive:
            return str(json.loads(str(archive["header"]))["format"])
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile, AttributeError, TypeError):
        return ""


def named_kind(path: Path) -> str | None:
    """What a file is, in words; None: it does not tell."""
    if not path.is_file():
        return None
    if path.suffix in _BY_ENDING:
        return _BY_ENDING[path.suffix]
    return WORDS.get(archive_format(path) or _text_format(path))


def _text_format(path: Path) -> str:
    try:
        table = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return ""
    return str(table.get("format")) if isinstance(table, dict) else ""
