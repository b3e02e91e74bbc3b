"""British and American spellings of one word: what is asked for in either is found."""

import re
from collections.abc import Iterable

_SAME = (("our", "or"), ("yze", "yse"), ("iz", "is"), ("tre", "ter"))
"""Letters that the two spellings exchange: colour, analyse, stabiliser, centre."""


def respelt(word: str, known: Iterable[str]) -> str:
    """The known word that a word is in the other spelling; the word itself where it is known, or none is."""
    names = list(known)
    if word in names:
        return word
    return next((name for name in names if _plain(name) == _plain(word)), word)


def _plain(word: str) -> str:
    for british, american in _SAME:
        word = re.sub(british, american, word)
    return word
