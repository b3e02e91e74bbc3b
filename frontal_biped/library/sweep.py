"""What a gait library holds: a grid over robots and keys of the gait specification, read from a sweep file (TOML).

    robot = "frontal_biped"              # a name or file; a list of them is an axis of the grid like any other
    batch = 20                           # gaits designed one after another by one worker, each from the one before
    [specification]                      # what all gaits share; keys of a gait specification
    friction = 0.5
    [sweep]                              # axes, the last one running fastest: a worker follows it
    step_width = [[0.25, 0.25], [0.30, 0.30]]
    max_pelvis_roll = {from = 0.08, to = 0.20, count = 7}

A range is spaced evenly, both ends included. A key of the specification stands in one of the two sections, not in both.
A specification's keys are checked one by one, so an axis is checked by itself, and the grid is not built for it.
"""

import itertools
from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cached_property
from pathlib import Path
from typing import Any

from frontal_biped.exceptions import SpecificationError
from frontal_biped.files.quoted import quoted
from frontal_biped.files.toml import finite_number, load_toml, reject_unknown_keys
from frontal_biped.gait.specification import GaitSpecification

DEFAULT_BATCH = 20
MAX_POINTS = 100_000  # days of designing
_KEYS = ("robot", "batch", "specification", "sweep")
_SPECIFICATION_KEYS = tuple(field.name for field in fields(GaitSpecification))
_OTHER_GAITS = ("travel", "double_support")
"""Keys of a specification that ask for gaits of another kind."""


@dataclass(frozen=True)
class GridPoint:
    """One gait to design.

    Attributes:
        number: place in the grid, from 0.
        robot: name or path.
        swept: the axes' values here.
        shared: specification keys that all points share.
    """

    number: int
    robot: str
    swept: Mapping[str, Any]
    shared: Mapping[str, Any]

    @property
    def specification(self) -> GaitSpecification:
        """The whole specification, made when it is asked for: a large grid is listed long before."""
        return GaitSpecification.from_dict({**self.shared, **self.swept}, f"point {self.number}")


@dataclass(frozen=True)
class Sweep:
    """A grid of specifications.

    Attributes:
        robots: names or paths.
        shared: specification keys that all gaits share.
        axes: specification key to its values; the last one runs fastest.
        batch: longest run of gaits that one worker designs one after another.
    """

    robots: tuple[str, ...]
    shared: dict[str, Any]
    axes: dict[str, tuple[Any, ...]]
    batch: int = DEFAULT_BATCH

    def points(self) -> tuple[GridPoint, ...]:
        """The grid, in order."""
        return self._grid

    @cached_property
    def _grid(self) -> tuple[GridPoint, ...]:
        keys = list(self.axes)
        grid = itertools.product(self.robots, *self.axes.values())
        return tuple(
            GridPoint(number, robot, dict(zip(keys, values, strict=True)), self.shared)
            for number, (robot, *values) in enumerate(grid)
        )

    def batches(self) -> tuple[tuple[GridPoint, ...], ...]:
        """Runs of neighbours along the last axis, at most ``batch`` long; no run depends on another one."""
        points = self.points()
        length = len(next(reversed(self.axes.values()))) if self.axes else 1
        runs = []
        for begin in range(0, len(points), length):
            line = points[begin : begin + length]
            runs += [line[i : i + self.batch] for i in range(0, length, self.batch)]
        return tuple(runs)

    def as_dict(self) -> dict[str, Any]:
        """Content of a sweep file, every range written out."""
        axes = {key: list(values) for key, values in self.axes.items()}
        return {"robot": list(self.robots), "batch": self.batch, "specification": self.shared, "sweep": axes}


def read_sweep(path: Path) -> Sweep:
    """Read a sweep file (TOML).

    Raises:
        SpecificationError: the file is missing or malformed, a key is unknown, an axis is empty, or a point of the
            grid is no valid specification.
    """
    return sweep_from_dict(load_toml(path, SpecificationError), str(path))


def sweep_from_dict(table: dict[str, Any], where: str) -> Sweep:
    """Sweep from the content of a sweep file; ``where`` begins every complaint.

    Raises:
        SpecificationError: as `read_sweep`.
    """
    reject_unknown_keys(where, table, _KEYS, SpecificationError)
    robots = table.get("robot", "frontal_biped")
    robots = [robots] if isinstance(robots, str) else robots
    if not isinstance(robots, list) or not robots or not all(map(_is_name, robots)):
        raise SpecificationError(f"{where}: robot = {quoted(table['robot'])} is neither a name nor a list of names")
    batch = table.get("batch", DEFAULT_BATCH)
    if isinstance(batch, bool) or not isinstance(batch, int) or not 1 <= batch <= MAX_POINTS:
        raise SpecificationError(f"{where}: batch = {quoted(batch)} is not a whole number from 1 to {MAX_POINTS}")
    shared = _table(where, table, "specification")
    GaitSpecification.from_dict(shared, f"{where}: specification")
    swept = _table(where, table, "sweep")
    both = sorted(set(shared) & set(swept))
    if both:
        raise SpecificationError(f"{where}: {both[0]} stands in [specification] and in [sweep]; keep one of them")
    count = len(robots)
    for key, value in swept.items():  # counted before any range is written out
        count *= _length(f"{where}: sweep.{key}", value)
    if count > MAX_POINTS:
        raise SpecificationError(f"{where}: the grid has {count} points, more than {MAX_POINTS}; split the sweep")
    _reject_twins(f"{where}: robot", robots)
    for key, value in swept.items():
        if isinstance(value, list):
            _reject_twins(f"{where}: sweep.{key}", value)
    axes = {key: _axis(f"{where}: sweep.{key}", value) for key, value in swept.items()}
    for key, values in axes.items():
        # what a specification allows of a number is an interval: of an even range its ends tell
        for value in values if isinstance(swept[key], list) else (values[0], values[-1]):
            GaitSpecification.from_dict({key: value}, f"{where}: sweep")
    return Sweep(tuple(robots), shared, axes, batch)


def _reject_twins(where: str, values: list[Any]) -> None:
    """A value that stands twice would have every gait designed twice."""
    seen = set()
    for value in values:
        told = repr(value)
        if told in seen:
            raise SpecificationError(f"{where}: {quoted(value)} stands twice; keep one of them")
        seen.add(told)


def _is_name(robot: object) -> bool:
    return isinstance(robot, str) and robot.isprintable() and robot != ""


def _table(where: str, table: dict[str, Any], section: str) -> dict[str, Any]:
    part = table.get(section, {})
    if not isinstance(part, dict):
        raise SpecificationError(f"{where}: {section} is not a table; write [{section}]")
    reject_unknown_keys(f"{where}: {section}", part, _SPECIFICATION_KEYS, SpecificationError)
    for key in _OTHER_GAITS:
        if key in part:
            raise SpecificationError(
                f"{where}: {section}.{key}: a library holds gaits of equal steps whose double support is an instant;"
                " leave it out, and design such gaits one by one"
            )
    return dict(part)


def _length(where: str, axis: Any) -> int:
    """How many values an axis has."""
    if isinstance(axis, list) and axis:
        return len(axis)
    if not isinstance(axis, dict):
        raise SpecificationError(
            f"{where} = {quoted(axis)} is no axis; write a list of values or {{from = 0.1, to = 0.2, count = 5}}"
        )
    reject_unknown_keys(where, axis, ("from", "to", "count"), SpecificationError)
    for key in ("from", "to", "count"):
        if key not in axis:
            raise SpecificationError(f"{where}: {key!r} is missing; write {{from = 0.1, to = 0.2, count = 5}}")
    count = axis["count"]
    if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= MAX_POINTS:
        raise SpecificationError(
            f"{where}.count = {quoted(count)} is not a whole number from 1 to {MAX_POINTS}; split the sweep"
        )
    return count


def _axis(where: str, value: Any) -> tuple[Any, ...]:
    if isinstance(value, list):
        return tuple(value)
    low, high = (finite_number(f"{where}.{key}", value[key], SpecificationError) for key in ("from", "to"))
    count = value["count"]
    if count == 1:
        return (low,)
    # a fixed number of digits: the grid says 0.1, not 0.09999999999999999
    return tuple(float(f"{low + (high - low) * i / (count - 1):.12g}") for i in range(count))
