"""Read files whole: regular ones only, and none larger than such a file ever is."""

import json
import stat
from pathlib import Path
from typing import Any, NoReturn

from frontal_biped.exceptions import FrontalBipedError

MOST_JSON_BYTES = 20_000_000
"""Of a JSON file; a gait has some ten thousand, a library of a hundred thousand points a few million."""

MOST_DIGITS = 400
"""Of a whole number in a file; the largest double has 309."""


def require_regular(path: Path, most: int, error: type[FrontalBipedError], ending: str) -> None:
    """Refuse what cannot be read to its end: a folder, a device or pipe, and what is larger than ``most`` bytes.

    Args:
        path: of the file, which need not be there.
        most: bytes.
        error: to raise.
        ending: what such a file is called, for example ".toml file".

    Raises:
        FrontalBipedError: ``error``, in one line.
        FileNotFoundError: there is no such file; the caller knows how one comes by it.
        OSError: its folder cannot be read.
    """
    status = path.stat()
    if stat.S_ISDIR(status.st_mode):
        raise error(f"{path}: a directory; name the {ending} in it")
    if not stat.S_ISREG(status.st_mode):  # reading might never end
        raise error(f"{path}: not a file but a device or a pipe; write it to a {ending} first")
    if status.st_size > most:
        raise error(f"{path}: larger than {most} bytes; is it a {ending} written for this program?")


def read_bytes(path: Path, most: int, error: type[FrontalBipedError], ending: str) -> bytes:
    """The content of a file that `require_regular` accepts; raises what that does."""
    require_regular(path, most, error, ending)
    with path.open("rb") as stream:
        content = stream.read(most + 1)
    if len(content) > most:  # it grew in between
        raise error(f"{path}: larger than {most} bytes; is it a {ending} written for this program?")
    return content


def load_json(path: Path, error: type[FrontalBipedError], remedy: str, *, finite: bool = True) -> Any:
    """What a JSON file says, strictly: no key twice, no NaN, no number or text that Python alone can have.

    Args:
        path: of the file.
        error: to raise.
        remedy: the end of every complaint.
        finite: refuse NaN, Infinity and numbers of hundreds of digits; False: leave them, all as floats that are not
            finite, to a reader who names the field in which they stand.

    Raises:
        FrontalBipedError: ``error``: the file is no JSON, in one line.
        FileNotFoundError: there is no such file.
    """
    content = read_bytes(path, MOST_JSON_BYTES, error, ".json file")
    try:
        text = content.decode("utf-8")
        value = json.loads(
            text,
            object_pairs_hook=_no_key_twice,
            parse_constant=_no_constant if finite else None,
            parse_int=_short_whole if finite else _whole_or_infinite,
        )
        if "\\u" in text:  # half of a surrogate pair, which no file and no terminal can show
            json.dumps(value, ensure_ascii=False).encode("utf-8")
        return value
    except RecursionError:
        raise error(f"{path}: not valid JSON, its values are nested too deep; {remedy}") from None
    except ValueError as cause:  # of JSON, of numbers and of UTF-8
        raise error(f"{path}: not valid JSON, {cause}; {remedy}") from None


def _no_key_twice(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    table = dict(pairs)
    if len(table) < len(pairs):
        names = [name for name, _ in pairs]
        raise ValueError(f"the key {next(name for name in names if names.count(name) > 1)!r} is there twice")
    return table


def _no_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is no number of JSON")


def _short_whole(digits: str) -> int:
    if len(digits) > MOST_DIGITS:
        raise ValueError(f"a number of {len(digits)} digits")
    return int(digits)


def _whole_or_infinite(digits: str) -> int | float:
    return int(digits) if len(digits) <= MOST_DIGITS else float(digits)
