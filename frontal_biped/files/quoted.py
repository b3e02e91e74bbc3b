"""Values of a file as a complaint shows them: in one line, short, and with nothing in it that a terminal would obey."""

from collections.abc import Sequence

MOST_SHOWN = 60
"""Characters of a value that are shown."""


def quoted(value: object) -> str:
    """The ``repr`` of a value, cut off where it is long; line breaks and control characters are escaped by it."""
    if isinstance(value, str | bytes | list | tuple):
        value = value[: MOST_SHOWN + 1]  # before it is written out: it may have a million characters
    try:
        text = repr(value)
    except ValueError:  # Python does not write a whole number of more than 4300 digits
        return "a number of thousands of digits"
    return text if len(text) <= MOST_SHOWN else f"{text[: MOST_SHOWN - 3]}..."


def listed(names: Sequence[str], most: int = 20) -> str:
    """Names with commas between them, the first ``most`` of them."""
    shown = ", ".join(name if len(name) <= MOST_SHOWN else f"{name[: MOST_SHOWN - 3]}..." for name in names[:most])
    return shown if len(names) <= most else f"{shown} and {len(names) - most} more"
