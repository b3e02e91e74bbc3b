"""Read tables of a TOML file strictly: unknown keys and wrong types are errors that say what would be right."""

import difflib
import math
import tomllib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from frontal_biped.exceptions import FrontalBipedError
from frontal_biped.files.spelling import respelt

MAX_TOML_BYTES = 1_000_000  # a description or specification has a few thousand


def load_toml(path: Path, error: type[FrontalBipedError]) -> dict[str, Any]:
    """The tables of a TOML file; raises ``error`` in one line when it is missing or malformed."""
    try:
        if path.exists() and not path.is_file() and not path.is_dir():
            raise error(f"{path}: not a file but a device or a pipe; name a .toml file")  # reading would never end
        if path.is_file() and path.stat().st_size > MAX_TOML_BYTES:
            raise error(f"{path}: larger than {MAX_TOML_BYTES} bytes; is this a .toml file written for this program?")
        with path.open("rb") as stream:
            return tomllib.load(stream)
    except FileNotFoundError:
        raise error(f"{path}: no such file; check the path") from None
    except IsADirectoryError:
        raise error(f"{path}: a directory; name a .toml file in it") from None
    except RecursionError:
        raise error(f"{path}: not valid TOML, its values are nested too deep; mend the file there") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as cause:
        raise error(f"{path}: not valid TOML, {cause}; mend the file there") from None


def reject_unknown_keys(
    where: str, table: Mapping[str, Any], known: Iterable[str], error: type[FrontalBipedError]
) -> None:
    """Raise ``error`` for the first key that is not known, with the closest known one as the remedy."""
    names = list(known)
    for key in table:
        if key not in names:
            close = difflib.get_close_matches(key, names, n=1)
            remedy = f"did you mean {close[0]!r}?" if close else f"known keys: {', '.join(names)}"
            raise error(f"{where}: unknown key {key!r}; {remedy}")


def respelt_keys(table: Mapping[str, Any], known: Iterable[str]) -> dict[str, Any]:
    """The table, with every known key that is there only in the other spelling, American or British, under its own."""
    names = {key: respelt(key, known) for key in table}
    return {key if names[key] in table else names[key]: value for key, value in table.items()}


def finite_number(where: str, value: object, error: type[FrontalBipedError]) -> float:
    """A finite float; booleans and strings are refused."""
    number = as_finite(value)
    if number is None:
        raise error(f"{where}: {repr(value)[:40]} is not a finite number; write for example 0.05")
    return number


def as_finite(value: object) -> float | None:
    """The float that a value of a TOML or JSON file is; None if it is no number, or not finite, or too large."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    try:
        number = float(value)
    except OverflowError:  # a whole number beyond the largest double
        return None
    return number if math.isfinite(number) else None
