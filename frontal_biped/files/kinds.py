"""The kinds of files there are, each with the words for it, so that one given for another is named as what it is."""

from pathlib import Path

from frontal_biped.exceptions import FrontalBipedError
from frontal_biped.files.npz import open_npz
from frontal_biped.files.reading import load_json

GAIT = "frontal-biped-gait"
"""``format`` of a gait file."""

RUN = "frontal-biped-run"
"""``format`` of the run file of a walk in the plane."""

SPACE_RUN = "frontal-biped-space-run"
"""``format`` of the run file of a walk in space."""

PROOF = "frontal-biped-proof"
"""``format`` of a certificate in ball arithmetic."""

WORDS = {GAIT: "a gait", RUN: "a run in the plane", SPACE_RUN: "a run in space", PROOF: "a certificate"}
"""What files of these formats are called."""

_BY_ENDING = {".urdf": "a URDF", ".toml": "a TOML file", ".html": "a page", ".csv": "a table"}


def archive_format(path: Path) -> str:
    """What a NumPy archive says it is; "" of a file that says nothing, or is none. Never raises, never reads much."""
    try:
        with open_npz(path) as archive:
            return str(archive.header().get("format", ""))
    except (OSError, ValueError, FrontalBipedError):
        return ""


def named_kind(path: Path) -> str | None:
    """What a file is, in words; None: it does not tell. Never raises, never reads much."""
    try:
        if not path.is_file():
            return None
    except (OSError, ValueError):  # a name too long, a folder that must not be looked into
        return None
    if path.suffix in _BY_ENDING:
        return _BY_ENDING[path.suffix]
    return WORDS.get(archive_format(path) or _text_format(path))


def _text_format(path: Path) -> str:
    try:
        table = load_json(path, FrontalBipedError, "", finite=False)
    except (OSError, FrontalBipedError):
        return ""
    return str(table.get("format")) if isinstance(table, dict) else ""
