"""What the entries of the header of an archive are to be, each said once."""

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

MOST_TEXT = 1000
"""Characters of a text that is shown in one line."""

MOST_NAMES = 1000
"""Of joints."""

MOST_WHOLE = 10**9
"""Of a number of steps."""


class Entry(NamedTuple):
    """What one entry is to be.

    Attributes:
        words: for it, "a list of names" say.
        holds: is a value of JSON such a one?
    """

    words: str
    holds: Callable[[Any], bool]


def _is_line(value: Any) -> bool:
    return isinstance(value, str) and 0 < len(value) <= MOST_TEXT and value.isprintable()


def _are_names(value: Any) -> bool:
    if not isinstance(value, list) or len(value) > MOST_NAMES:
        return False
    return all(_is_line(name) for name in value) and len(set(value)) == len(value)


def _is_count(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value <= MOST_WHOLE


LINE = Entry("a line of text", _is_line)
"""Not empty, without line breaks and what a terminal would obey."""

NAMES = Entry("a list of different names", _are_names)
"""Each of them a `LINE`."""

COUNT = Entry("a whole number of 0 or more", _is_count)

TABLE = Entry("a JSON object", lambda value: isinstance(value, dict))


def words_among(known: frozenset[str]) -> Entry:
    """A list whose entries are all known, in any order and number."""
    return Entry(
        f"a list of words among {', '.join(sorted(known))}",
        lambda value: isinstance(value, list) and all(isinstance(word, str) and word in known for word in value),
    )


def require_entries(header: Mapping[str, Any], schema: Mapping[str, Entry]) -> dict[str, Any]:
    """The entries of a schema; ValueError, saying which is missing or wrong."""
    for key, wanted in schema.items():
        if key not in header:
            raise ValueError(f"header has no {key}")
        if not wanted.holds(header[key]):
            raise ValueError(f"{key} = {repr(header[key])[:40]} is not {wanted.words}")
    return {key: header[key] for key in schema}
