"""Read tables of a TOML file strictly: unknown keys and wrong types are errors that say what would be right."""

import codecs
import difflib
import math
import re
import tomllib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from frontal_biped.exceptions import FrontalBipedError
from frontal_biped.files.quoted import quoted
from frontal_biped.files.reading import read_bytes
from frontal_biped.files.spelling import respelt

MAX_TOML_BYTES = 1_000_000  # a description or specification has a few thousand

MOST_DOTS = 50
"""Of a key; the parser's time grows with their square, and a scenario has two."""

_DOTTED = re.compile(rf"""(?<![\w-])(?:(?:[\w-]+|"[^"\n]*"|'[^'\n]*')[ \t]*\.[ \t]*){{{MOST_DOTS}}}""")

LONGEST_KEY = 60
"""Characters of a key that may be known in another spelling."""


def load_toml(path: Path, error: type[FrontalBipedError]) -> dict[str, Any]:
    """The tables of a TOML file; raises ``error`` in one line when it is missing or malformed."""
    try:
        content = read_bytes(path, MAX_TOML_BYTES, error, ".toml file")
    except FileNotFoundError:
        raise error(f"{path}: no such file; check the path") from None
    try:
        text = content.removeprefix(codecs.BOM_UTF8).decode("utf-8")
        if _DOTTED.search(text):
            raise ValueError(f"a key has more than {MOST_DOTS} dots")
        return tomllib.loads(text)
    except RecursionError:
        raise error(f"{path}: not valid TOML, its values are nested too deep; mend the file there") from None
    except ValueError as cause:  # of TOML, of UTF-8, and of whole numbers, whose words are about Python
        told = "a whole number has thousands of digits" if "set_int_max_str_digits" in str(cause) else str(cause)
        raise error(f"{path}: not valid TOML, {told}; mend the file there") from None


def reject_unknown_keys(
    where: str, table: Mapping[str, Any], known: Iterable[str], error: type[FrontalBipedError]
) -> None:
    """Raise ``error`` for the first key that is not known, with the closest known one as the remedy."""
    names = list(known)
    for key in table:
        if key not in names:
            close = difflib.get_close_matches(key[:LONGEST_KEY], names, n=1)
            remedy = f"did you mean {close[0]!r}?" if close else f"known keys: {', '.join(names)}"
            raise error(f"{where}: unknown key {quoted(key)}; {remedy}")


def respelt_keys(table: Mapping[str, Any], known: Iterable[str]) -> dict[str, Any]:
    """The table, with every known key that is there only in the other spelling, American or British, under its own."""
    known = list(known)
    if len(table) > 2 * len(known):  # more than all there are in either spelling: some are unknown as they are
        return dict(table)
    names = {key: respelt(key, known) if len(key) <= LONGEST_KEY else key for key in table}
    return {key if names[key] in table else names[key]: value for key, value in table.items()}


def finite_number(where: str, value: object, error: type[FrontalBipedError]) -> float:
    """A finite float; booleans and strings are refused."""
    number = as_finite(value)
    if number is None:
        raise error(f"{where}: {quoted(value)} is not a finite number; write for example 0.05")
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
