"""When a push begins, as scenario files say it, and the tables in which they say so."""

import re
from typing import Any

from frontal_biped.files.table import Table
from frontal_biped.scenarios.scenario import Moment

_AT = re.compile(
    r"(?:(?P<event>impact|reversal)"
    r"|(?P<percent>[0-9]{1,9}(?:\.[0-9]{1,30})?) ?% of the (?P<phase>rising|falling) phase)"
    r" of step (?P<step>[0-9]{1,9})"
)


def read_moment(section: Table) -> Moment:
    """The moment that ``at`` or ``time`` of a push names."""
    if ("at" in section) == ("time" in section):
        remedy = 'write either at = "reversal of step 5" or time = 1.2 (s)'
        section.refuse("at", f"missing; {remedy}" if "at" not in section else f"given beside time; {remedy}")
    if "time" in section:
        return Moment(time=section.value("time", 0.0, 0.0, 1e5, "s"))
    text = section.text("at", "")
    found = _AT.fullmatch(text)
    if found is None or int(found["step"]) < 1:
        section.refuse(
            "at", 'not understood; write "impact of step 5", "reversal of step 5" (steps from 1) or "30 % of the rising'
            ' phase of step 5"'
        )  # fmt: skip
    percent = float(found["percent"] or 0.0)
    if percent > 100.0:
        section.refuse("at", "more than 100 % of a phase; name the phase after it")
    phase = found["phase"] or ("falling" if found["event"] == "reversal" else "rising")
    return Moment(step=int(found["step"]), phase=phase, fraction=percent / 100.0)


def tables_of(table: Table, key: str) -> list[Any]:
    """The tables that ``[[key]]`` begins, one or many."""
    content = table.content.get(key, [])
    if isinstance(content, dict):
        return [content]
    if not isinstance(content, list):
        table.refuse(key, f"not a table; begin each {key} with [[{key}]]")
    return content
