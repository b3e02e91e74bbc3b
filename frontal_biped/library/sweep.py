"""What a gait library holds: a grid over robots and keys of the gait specification, read from a sweep file (TOML).

    robot = "frontal_biped"              # a name or file; a list of them is an axis of the grid like any other
    batch = 20                           # gaits designed one after another by one worker, each from the one before
    [specification]                      # what all gaits share; keys of a gait specification
    friction = 0.5
    [sweep]                              # axes, the last one running fastest: a worker follows it
    step_width = [[0.25, 0.25], [0.30, 0.30]]
    max_pelvis_roll = {from = 0.08, to = 0.20, count = 7}

A range is spaced evenly, both ends included. A key of the specification stands in one of the two sections, not in both.
"""

import itertools
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from frontal_biped.exceptions import FrontalBipedError, SpecificationError
from frontal_biped.files.toml import finite_number, load_toml, reject_unknown_keys
from frontal_biped.gait.specification import GaitSpecification

DEFAULT_BATCH = 20
MAX_POINTS = 1_000_000
_KEYS = ("robot", "batch", "specification", "sweep")
_SPECIFICATION_KEYS = tuple(field.name for field in fields(GaitSpecification))


@dataclass(frozen=True)
class GridPoint:
    """One gait to design.

    Attributes:
        number: place in the grid, from 0.
        robot: name or path.
        swept: the axes' values here.
        specification: the whole specification.
    """

    number: int
    robot: str
    swept: dict[str, Any]
    specification: GaitSpecification


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
        keys = list(self.axes)
        grid = itertools.product(self.robots, *self.axes.values())
        return tuple(
            GridPoint(
                number,
                robot,
                dict(zip(keys, values, strict=True)),
                GaitSpecification.from_dict({**self.shared, **dict(zip(keys, values, strict=True))}, f"point {number}"),
            )
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
    if not isinstance(robots, list) or not robots or not all(isinstance(robot, str) for robot in robots):
        raise SpecificationError(f"{where}: robot = {table.get('robot')!r} is neither a name nor a list of names")
    batch = table.get("batch", DEFAULT_BATCH)
    if isinstance(batch, bool) or not isinstance(batch, int) or batch < 1:
        raise SpecificationError(f"{where}: batch = {batch!r} is not a whole number of at least 1")
    shared = _table(where, table, "specification")
    axes = {key: _axis(f"{where}: sweep.{key}", value) for key, value in _table(where, table, "sweep").items()}
    both = sorted(set(shared) & set(axes))
    if both:
        raise SpecificationError(f"{where}: {both[0]} stands in [specification] and in [sweep]; keep one of them")
    count = len(robots)
    for values in axes.values():
        count *= len(values)
    if count > MAX_POINTS:
        raise SpecificationError(f"{where}: the grid has {count} points, more than {MAX_POINTS}; split the sweep")
    sweep = Sweep(tuple(robots), shared, axes, batch)
    try:
        sweep.points()
    except FrontalBipedError as error:
        raise SpecificationError(f"{where}: {error}") from None
    return sweep


def _table(where: str, table: dict[str, Any], section: str) -> dict[str, Any]:
    part = table.get(section, {})
    if not isinstance(part, dict):
        raise SpecificationError(f"{where}: {section} is not a table; write [{section}]")
    reject_unknown_keys(f"{where}: {section}", part, _SPECIFICATION_KEYS, SpecificationError)
    return dict(part)


def _axis(where: str, value: Any) -> tuple[Any, ...]:
    if isinstance(value, list) and value:
        return tuple(value)
    if not isinstance(value, dict):
        raise SpecificationError(
            f"{where} = {value!r} is no axis; write a list of values or {{from = 0.1, to = 0.2, count = 5}}"
        )
    reject_unknown_keys(where, value, ("from", "to", "count"), SpecificationError)
    for key in ("from", "to", "count"):
        if key not in value:
            raise SpecificationError(f"{where}: {key!r} is missing; write {{from = 0.1, to = 0.2, count = 5}}")
    low, high = (finite_number(f"{where}.{key}", value[key], SpecificationError) for key in ("from", "to"))
    count = value["count"]
    if isinstance(count, bool) or not isinstance(count, int) or count < 1:
        raise SpecificationError(f"{where}.count = {count!r} is not a whole number of at least 1")
    if count == 1:
        return (low,)
    # a fixed number of digits: the grid says 0.1, not 0.09999999999999999
    return tuple(float(f"{low + (high - low) * i / (count - 1):.12g}") for i in range(count))
