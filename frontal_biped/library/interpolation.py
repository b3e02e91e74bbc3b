"""Gaits between the gaits of a library.

The free parameters of the neighbouring gaits are blended multilinearly; hybrid invariance is then completed and the
orbit closed, so a blended gait is invariant and periodic exactly, whatever the distance between its neighbours.
Whether it keeps the blended bounds is measured, not assumed.
"""

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.design.closing import close_step
from frontal_biped.design.optimise import OPTIMISER_NODES
from frontal_biped.design.problem import DesignProblem
from frontal_biped.exceptions import LibraryError, SpecificationError
from frontal_biped.gait.check import ConstraintReport, check_constraints
from frontal_biped.gait.gait import Gait
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.library.store import LibraryStore
from frontal_biped.library.sweep import GridPoint
from frontal_biped.model.biped import FrontalBiped


@dataclass(frozen=True)
class BlendedGait:
    """A gait between the gaits of a library.

    Attributes:
        gait: hybrid invariant and periodic.
        report: its constraints on the dense grid, under the blended bounds.
        neighbours: numbers of the points blended.
        weights: their weights, with sum 1.
    """

    gait: Gait
    report: ConstraintReport
    neighbours: tuple[int, ...]
    weights: tuple[float, ...]


class GaitLibrary:
    """The gaits of a library by the values of its axes.

    Args:
        folder: of the library.

    Raises:
        LibraryError: there is no library, or what says what it holds cannot be read.
    """

    def __init__(self, folder: Path | str) -> None:
        self.store = LibraryStore(Path(folder))
        self.sweep = self.store.sweep()
        self.fingerprints = self.store.fingerprints()
        self.points = self.sweep.points()

    def __len__(self) -> int:
        return len(self.points)

    def gait(self, number: int) -> Gait | None:
        """The gait of a point of the grid, or None if it has none.

        Raises:
            LibraryError: its file cannot be read, or is of another point or robot.
        """
        return self.store.gait(self.points[number], self.fingerprints)

    def blend(self, biped: FrontalBiped, at: Mapping[str, float | tuple[float, ...]]) -> BlendedGait:
        """The gait at values between those of the axes.

        Args:
            biped: the robot, one of the library's.
            at: a value for every axis, within its range; pairs where the axis holds pairs.

        Raises:
            SpecificationError: an axis is missing or unknown, a value lies outside its range, or the robot is not in
                the library, or has another URDF or description there.
            LibraryError: a neighbour has no gait, or its file is not its own.
            UnreachablePoseError, ReversalError: the blend has no step.
        """
        corners = self._corners(biped, at)
        specification = self._specification(corners)
        problem = DesignProblem(biped, specification, OPTIMISER_NODES)
        x = np.zeros(problem.size)
        for point, weight in corners:
            gait = self.gait(point.number)
            if gait is None:
                reason = self.store.failure_path(point.number)
                raise LibraryError(f"point {point.number} of the library has no gait ({reason.name} says why)")
            if gait.robot.fingerprint != biped.fingerprint:
                raise SpecificationError(
                    f"{self.store.folder}: its gaits were designed for another URDF or description of {biped.name!r};"
                    " give the robot they were designed for, or design them again in a new folder"
                )
            x += weight * problem.variables(gait)
        closed = close_step(problem, x)
        report = check_constraints(biped, specification, *closed.phases, closed.step)
        numbers, weights = zip(*((point.number, weight) for point, weight in corners), strict=True)
        return BlendedGait(closed.gait(problem), report, numbers, weights)

    def _corners(
        self, biped: FrontalBiped, at: Mapping[str, float | tuple[float, ...]]
    ) -> list[tuple[GridPoint, float]]:
        """Neighbouring points and their weights; those of weight zero are left out."""
        where = self.store.folder
        for key in at:
            if key not in self.sweep.axes:
                raise SpecificationError(f"{where}: no axis {key!r}; axes: {', '.join(self.sweep.axes)}")
        robots = [i for i, name in enumerate(self.sweep.robots) if name in (biped.name, str(biped.path))]
        if not robots:
            raise SpecificationError(f"{where}: robot {biped.name!r} is not in the library")
        choices = [[(robots[0], 1.0)]]
        for key, values in self.sweep.axes.items():
            if key not in at:
                raise SpecificationError(f"{where}: no value for axis {key!r}; give one within its range")
            choices.append(_between(f"{where}: {key}", np.array(values, dtype=float), np.asarray(at[key], dtype=float)))
        lengths = [len(self.sweep.robots), *(len(values) for values in self.sweep.axes.values())]
        corners = []
        for choice in itertools.product(*choices):
            places, weights = zip(*choice, strict=True)
            number = int(np.ravel_multi_index(places, lengths))
            corners.append((self.points[number], float(np.prod(weights))))
        return corners

    @staticmethod
    def _specification(corners: list[tuple[GridPoint, float]]) -> GaitSpecification:
        table = corners[0][0].specification.as_dict()
        for key in corners[0][0].swept:
            parts = [weight * np.asarray(point.specification.as_dict()[key]) for point, weight in corners]
            table[key] = np.sum(parts, axis=0).tolist()
        return GaitSpecification.from_dict(table)


def _between(where: str, values: FloatArray, at: FloatArray) -> list[tuple[int, float]]:
    """Indices and weights of the one or two entries of an axis that a value lies on or between."""
    first = values.reshape(len(values), -1)[:, 0]  # a range is placed by its lower end ...
    if at.shape != values.shape[1:]:
        raise SpecificationError(f"{where} = {at.tolist()} does not look like the axis, {values[0].tolist()}")
    order = np.argsort(first, kind="stable")
    for low, high in itertools.pairwise(order) if len(order) > 1 else [(order[0], order[0])]:
        span = values[high] - values[low]
        length = float(np.sum(span**2))
        share = float(np.sum((at - values[low]) * span)) / length if length > 0.0 else 0.0
        if -1e-12 <= share <= 1.0 + 1e-12 and np.allclose(values[low] + share * span, at, rtol=0.0, atol=1e-9):
            # ... and must lie on the line between two neighbours
            share = min(max(share, 0.0), 1.0)
            return [(int(i), w) for i, w in ((low, 1.0 - share), (high, share)) if w > 0.0]
    raise SpecificationError(f"{where} = {at.tolist()} is not between two neighbours of the axis {values.tolist()}")
