"""One table of a scenario file, read key by key; every complaint names file, field, value and remedy."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NoReturn

import numpy as np

from frontal_biped.exceptions import ScenarioError
from frontal_biped.files.quoted import MOST_SHOWN, quoted
from frontal_biped.files.toml import as_finite, reject_unknown_keys, respelt_keys

LONGEST_TEXT = 1000
"""Characters of a text in a scenario file."""


@dataclass(frozen=True)
class Range:
    """A number drawn for every trial, uniform from ``low`` to ``high``.

    Attributes:
        low: smallest value.
        high: largest value.
    """

    low: float
    high: float

    def __str__(self) -> str:
        return f"{self.low:g}..{self.high:g}"


Value = float | Range
"""A number, or a range to draw it from."""


def draw(value: Value, generator: np.random.Generator) -> float:
    """The number itself, or one drawn from its range."""
    return float(generator.uniform(value.low, value.high)) if isinstance(value, Range) else value


class Table:
    """A table and where it stands.

    Args:
        where: begins every complaint, for example "push.toml: [controller]".
        content: keys and values.
        known: the keys that may be there; None: any.
    """

    def __init__(self, where: str, content: Any, known: tuple[str, ...] | None) -> None:
        self.where = where
        if not isinstance(content, dict):
            raise ScenarioError(f"{where} = {quoted(content)} is not a table; write its keys below {where.split()[-1]}")
        if known is not None:
            content = respelt_keys(content, known)
            reject_unknown_keys(where.rstrip(":"), content, known, ScenarioError)
        self.content: Mapping[str, Any] = content

    def __contains__(self, key: str) -> bool:
        return key in self.content

    def refuse(self, key: str, remedy: str) -> NoReturn:
        """Raise the complaint about a key."""
        value = f" = {quoted(self.content[key])}" if key in self.content else ""
        name = key if key.isprintable() and len(key) <= MOST_SHOWN else quoted(key)
        raise ScenarioError(f"{self.where} {name}{value}: {remedy}")

    def text(self, key: str, default: str, choices: tuple[str, ...] | None = None) -> str:
        """A string, perhaps one of a few."""
        value = self.content.get(key, default)
        listed = f"write one of {', '.join(choices)}" if choices else f'write {key} = "..."'
        if not isinstance(value, str) or not (value.isprintable() and 0 < len(value) <= LONGEST_TEXT):
            self.refuse(key, f"not text; {listed}")
        if choices and value not in choices:
            self.refuse(key, f"unknown; {listed}")
        return value

    def flag(self, key: str, default: bool) -> bool:
        """True or false."""
        value = self.content.get(key, default)
        if not isinstance(value, bool):
            self.refuse(key, f"neither true nor false; write {key} = true")
        return value

    def whole(self, key: str, default: int, low: int, high: int = 2**63 - 1) -> int:
        """A whole number in a range."""
        value = self.content.get(key, default)
        if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
            up_to = f"from {low} to {high}" if high < 2**63 - 1 else f"of at least {low}"
            self.refuse(key, f"not a whole number {up_to}; write for example {key} = {max(low, default)}")
        return value

    def number(self, key: str, default: float, low: float, high: float, unit: str) -> float:
        """A number in a range."""
        return self._within(key, self.content.get(key, default), low, high, unit)

    def value(self, key: str, default: float, low: float, high: float, unit: str) -> Value:
        """A number in a range, or a range within that one to draw it from."""
        given = self.content.get(key, default)
        if not isinstance(given, dict):
            return self._within(key, given, low, high, unit)
        if set(given) == {"within"}:
            bound = self._within(key, given["within"], 0.0, high, unit)
            if -bound < low:
                self.refuse(key, f"-{bound:g} is below the least value {low:g} {unit}; write {{from = ..., to = ...}}")
            return Range(-bound, bound)
        if set(given) != {"from", "to"}:
            self.refuse(key, "no number and no range; write {from = 0.3, to = 0.9} or {within = 0.2}")
        ends = [self._within(key, given[end], low, high, unit) for end in ("from", "to")]
        if ends[0] > ends[1]:
            self.refuse(key, "from is above to; exchange them")
        return Range(*ends)

    def numbers(self, key: str, count: int | None, low: float, high: float, unit: str) -> tuple[float, ...]:
        """A list of numbers in a range."""
        value = self.content[key]
        if not isinstance(value, list) or (count is not None and len(value) != count):
            self.refuse(key, f"not a list of {count or 'numbers'}{' numbers' if count else ''} in {unit}")
        return tuple(self._within(key, part, low, high, unit) for part in value)

    def _within(self, key: str, value: object, low: float, high: float, unit: str) -> float:
        number = as_finite(value)
        example = f"write for example {key} = {_example(low, high):g}"
        if number is None:
            self.refuse(key, f"{quoted(value)} is not a finite number; {example}")
        if not low <= number <= high:
            bounds = f"below {low:g}" if number < low else f"above {high:g}"
            self.refuse(key, f"{number:g} is {bounds} {unit}; {example}")
        return number


def _example(low: float, high: float) -> float:
    return low if low > 0.0 else (0.0 if high <= 0.0 else min(high, 0.01) if low == 0.0 else 0.5 * high)
