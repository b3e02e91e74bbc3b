r"""The words of a path: ``stand 1; forward 2 m; left 1 m at 0.05; turn 90; stop``.

Commands are separated by semicolons, and each is one of

=====================  =============================================================================================
``stand T [s]``        stand on both feet for T seconds; a robot that walks stops first
``forward X [m]``      walk X metres forwards; ``back X`` backwards
``left X [m]``         walk X metres sideways; ``right X`` to the other side
``turn A [degrees]``   turn on the spot by A degrees, to the left; -A, to the right
``stop``               come to a stand
=====================  =============================================================================================

A walk may say how fast: ``forward 2 m at 0.3`` (m/s), ``turn 90 at 10`` (degrees per second). Every command begins
where the one before was to end, in the direction in which that one was to look: an error is not carried on,

.. math:: (p, \psi) \mapsto (p + R(\psi)\, d,\; \psi + \delta).

A path ends in a stand, whether it says so or not.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from math import isfinite, radians

from frontal_biped.control.path.pose import ORIGIN, Pose
from frontal_biped.exceptions import SimulationError


class PathError(SimulationError):
    """The words of a path make no path; one line that says where, and what to write."""


class Verb(Enum):
    """What a command asks for."""

    STAND = "stand"
    FORWARD = "forward"
    BACK = "back"
    LEFT = "left"
    RIGHT = "right"
    TURN = "turn"
    STOP = "stop"


@dataclass(frozen=True)
class Leg:
    """One command of a path, as the robot follows it.

    Attributes:
        verb: what is asked for.
        target: where its end is, of the middle between the feet.
        duration: of a stand [s]; 0 for all others.
        rate: how fast, m/s or rad/s; None: as fast as the walker's settings say.
    """

    verb: Verb
    target: Pose
    duration: float = 0.0
    rate: float | None = None

    @property
    def standing(self) -> bool:
        """Does the robot stand on both feet?"""
        return self.verb in (Verb.STAND, Verb.STOP)


EXAMPLE = "stand 1; forward 2 m; left 1 m; turn 90; stop"

_UNITS = {
    Verb.STAND: ("s",),
    Verb.FORWARD: ("m",),
    Verb.BACK: ("m",),
    Verb.LEFT: ("m",),
    Verb.RIGHT: ("m",),
    Verb.TURN: ("degrees", "degree", "deg"),
}
_RATE_UNITS = {Verb.TURN: ("degrees/s", "deg/s")}

MOST = {Verb.STAND: 3600.0, Verb.TURN: 36000.0}
"""Largest number of a command; of all others `FARTHEST`."""

FARTHEST = 1000.0
"""Longest way of one command [m]."""

FASTEST = {Verb.TURN: 180.0}
"""Largest rate, in degrees a second; of all others 3 m/s."""

_AHEAD = {Verb.FORWARD: (1.0, 0.0), Verb.BACK: (-1.0, 0.0), Verb.LEFT: (0.0, 1.0), Verb.RIGHT: (0.0, -1.0)}
_WORD = re.compile(r"\S+")
_GLUED = re.compile(r"([-+]?[0-9.]+(?:[eE][-+]?[0-9]+)?)([A-Za-z]+(?:/s)?)")


def parse_path(text: str, start: Pose = ORIGIN) -> tuple[Leg, ...]:
    """The legs of a path.

    Args:
        text: its words.
        start: where the robot stands.

    Returns:
        At least one leg, the last of them a stand.

    Raises:
        PathError: the words make no path; the message names the command, counted from 1, and what to write.
    """
    legs: list[Leg] = []
    at, count = start, 0
    for count, words in _commands(text):
        leg = _Reader(count, words).leg(at)
        legs.append(leg)
        at = leg.target
    if not legs:
        raise PathError(f"path {text!r} says nothing; write for example {EXAMPLE!r}")
    if not legs[-1].standing:
        legs.append(Leg(Verb.STOP, at))
    return tuple(legs)


def _commands(text: str) -> Iterator[tuple[int, list[str]]]:
    for count, command in enumerate(text.split(";"), 1):
        words = _WORD.findall(command)
        if words:  # a semicolon too many asks for nothing
            yield count, words


class _Reader:
    """Reads the words of one command."""

    def __init__(self, count: int, words: list[str]) -> None:
        self._where = f"path, command {count} ({' '.join(words)!r})"
        self._words: list[str] = []
        for word in words:  # "2m" is "2 m"
            glued = _GLUED.fullmatch(word)
            self._words.extend(glued.groups() if glued else (word,))

    def leg(self, at: Pose) -> Leg:
        word = self._words.pop(0)
        try:
            verb = Verb(word.lower())
        except ValueError:
            known = ", ".join(verb.value for verb in Verb)
            raise self._wrong(f"no command {word!r}; known: {known}") from None
        if verb is Verb.STOP:
            self._finish(verb)
            return Leg(verb, at)
        value = self._number(verb, verb.value, MOST.get(verb, FARTHEST), _UNITS[verb])
        if verb is Verb.STAND:
            self._finish(verb)
            return Leg(verb, at, duration=value)
        rate = None
        if self._words and self._words[0].lower() == "at":
            self._words.pop(0)
            rate = self._number(verb, "at", FASTEST.get(verb, 3.0), _RATE_UNITS.get(verb, ("m/s",)))
            if rate == 0.0:
                raise self._wrong("a rate of 0 never arrives; leave it out")
        self._finish(verb)
        if verb is Verb.TURN:
            return Leg(verb, at.moved(0.0, 0.0, radians(value)), rate=None if rate is None else radians(rate))
        x, y = _AHEAD[verb]
        return Leg(verb, at.moved(x * value, y * value, 0.0), rate=rate)

    def _number(self, verb: Verb, after: str, most: float, units: tuple[str, ...]) -> float:
        if not self._words:
            raise self._wrong(f"a number is missing after {after!r}; write for example '{after} 1 {units[0]}'")
        word = self._words.pop(0)
        try:
            value = float(word)
        except ValueError:
            raise self._wrong(f"{word!r} is no number; write for example '{after} 1 {units[0]}'") from None
        if not isfinite(value) or abs(value) > most:
            raise self._wrong(f"{word} is too much; at most {most:g} {units[0]}")
        if value < 0.0 and (verb is not Verb.TURN or after == "at"):
            raise self._wrong(f"{word} is below 0; write {_OTHER_WAY.get(verb, 'a number of at least 0')}")
        if self._words and self._words[0].lower() != "at":
            unit = self._words[0]
            if unit.lower() not in units:
                raise self._wrong(f"{unit!r} is not the unit; it is {units[0]}, and may be left out")
            self._words.pop(0)
        return value

    def _finish(self, verb: Verb) -> None:
        if self._words:
            raise self._wrong(f"{' '.join(self._words)!r} is too much after {verb.value!r}; separate commands by ';'")

    def _wrong(self, what: str) -> PathError:
        return PathError(f"{self._where}: {what}")


_OTHER_WAY = {Verb.FORWARD: "'back'", Verb.BACK: "'forward'", Verb.LEFT: "'right'", Verb.RIGHT: "'left'"}
