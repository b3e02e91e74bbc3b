"""One interval of a table of answers, proved from the orbit outwards on tiles of reversals (see `choices`)."""

from dataclasses import dataclass, replace
from functools import cached_property
from math import nextafter
from typing import NamedTuple

from frontal_biped.zero_dynamics.proof.balls import Ball, arb
from frontal_biped.zero_dynamics.proof.basin import ProvedBasin
from frontal_biped.zero_dynamics.proof.families import Family
from frontal_biped.zero_dynamics.proof.half_orbit import HalfOrbit
from frontal_biped.zero_dynamics.proof.half_path import HalfPath, Path
from frontal_biped.zero_dynamics.proof.half_step import NotEnclosedError
from frontal_biped.zero_dynamics.proof.perturbed_steps import (
    ROUGH,
    Controls,
    PathPiece,
    Paths,
    PerturbedSteps,
    at_share,
    on_planned,
)
from frontal_biped.zero_dynamics.proof.reversals import EarlyPath, LatePath, Mismatch, Tapers
from frontal_biped.zero_dynamics.proof.stretched_paths import LowerPart, RescaledPath
from frontal_biped.zero_dynamics.proof.stretched_step import stretched
from frontal_biped.zero_dynamics.proof.theorems import Proof

SLACK = 2e-9
"""Relative speed by which an interval is proved past its ends [-]."""

PAST = 1e-6
"""Reversal by which it is, likewise [rad]."""

FIRST_TILE, WIDENING, LEAST_TILE = 1 / 128, 1.5, 1 / 2048
"""Width of the first tile of an interval, as a share of the range of the planned rising phase; factor to the next one,
until one must be halved; width below which a tile is not halved again.
"""

TILES, HALVINGS = 100, 3
"""Tiles of an interval, at most; bisections of the latest reversal."""


class Choice(NamedTuple):
    """What is answered on an interval of speeds.

    Attributes:
        low: the least of them, relative to the orbit's [-].
        high: the greatest [-].
        stretch: of the rising phase, relative to its range [-].
        tapers: of its continuation.
        rescaled: is the falling phase rescaled, or anchored?
        rejoin: c of an anchored one that begins early; None: it begins late, or is rescaled.
        reversals: at the least and the greatest speed, past the end of the rising phase [rad].
    """

    low: float
    high: float
    stretch: float
    tapers: Tapers
    rescaled: bool
    rejoin: float | None
    reversals: tuple[float, float]

    @property
    def as_planned(self) -> bool:
        """Is it what transitions answer that do not look ahead?"""
        return self.stretch == 0.0 and not self.rescaled


class Reached(NamedTuple):
    """How far an interval was proved.

    Attributes:
        tiles: as `ProvedChoices`; none where nothing was.
        factor: of x in a step, at most [-].
        end: the last speed, from the orbit's outwards [-].
        why: what stood in the way of the rest.
    """

    tiles: tuple[float, ...]
    factor: Ball
    end: float
    why: str


def answered(
    steps: PerturbedSteps, basin: ProvedBasin, choice: Choice, outwards: int, given: tuple[float, ...] | None
) -> Reached:
    """An interval, from its inner end outwards."""
    inner = (choice.low, choice.high)[::outwards][0]
    if choice.as_planned:
        # the table leaves c open where the reversal is the planned one or later: then it is chosen as there
        same = choice.rejoin is None or all(c == choice.rejoin for c in basin.rejoins)
        low, high = (basin.low, basin.high) if same else (1.0, 1.0)
        end = min(choice.high, high) if outwards > 0 else max(choice.low, low)
        return Reached((), basin.factor, end, "that is as far as re-anchored phases are known")
    if given == ():
        return Reached((), basin.factor, inner, "")
    interval = _Interval(steps, basin, choice, _Stretched(steps, choice.stretch))
    try:
        if choice.reversals[1] < 0.0 and outwards < 0:
            return interval.early(given)
        return interval.rescaled_late() if choice.rescaled else interval.late(given)
    except NotEnclosedError as error:
        return Reached((), basin.factor, inner, f"stretched by {choice.stretch:g}: {error}")


class _Stretched:
    """A step whose rising phase is stretched, begun and ended as planned.

    Attributes:
        rising: its path.
        falling: that of an anchored phase.
    """

    def __init__(self, steps: PerturbedSteps, stretch: float) -> None:
        orbit = steps.orbit
        self.orbit, self.sole = orbit, orbit.rising.path.sole
        later = orbit.rising.path.span * arb(stretch)
        self.step = stretched(orbit.step, orbit.gait.begin, orbit.gait.end, later)
        self.rising, self.falling = (HalfPath.of(half, self.sole) for half in (self.step.rising, self.step.falling))

    @cached_property
    def up(self) -> HalfOrbit:
        """The orbit that reverses at its end, rising."""
        return HalfOrbit.of(self.rising, fine=ROUGH)

    @cached_property
    def down(self) -> HalfOrbit:
        """Likewise, falling."""
        return HalfOrbit.of(self.falling, fine=ROUGH)

    def x_before(self, up: HalfOrbit, more: Ball) -> Ball:
        """x of a step that has an energy more at the reversal of a rising orbit [-]."""
        return up.L.exp() * (up.energy + more) / self.orbit.rising.z - 1

    def more(self, x: Ball) -> Ball:
        """The energy at the end of the rising phase of a step that has x [kg^2 m^4/s^2]."""
        return (-self.up.L).exp() * (1 + x) * self.orbit.rising.z - self.up.energy

    def x_after(self, more: Ball) -> Ball:
        """x of the next step where the anchored falling phase has an energy more at its beginning [-]."""
        return self.down.L.exp() * (self.down.energy + more) / self.orbit.falling.z - 1


@dataclass(frozen=True)
class _Interval:
    """An interval of speeds, and the steps on it."""

    steps: PerturbedSteps
    basin: ProvedBasin
    choice: Choice
    paths: _Stretched

    @property
    def _slowest(self) -> Ball:
        return (arb(self.choice.low) * (1 - arb(SLACK))) ** 2 - 1

    @property
    def _fastest(self) -> Ball:
        return (arb(self.choice.high) * (1 + arb(SLACK))) ** 2 - 1

    def _factor(self, x: Ball, x_next: Ball) -> Ball:
        """Of x in a step, at most, where x is known to be at least so large.

        Raises:
            NotEnclosedError: it may grow, or go too far to the other side.
        """
        low, high = ((arb(ratio) ** 2 - 1) for ratio in (self.basin.low, self.basin.high))
        if not (x_next * x >= 0 or (x_next > low and x_next < high)):
            raise NotEnclosedError("the speed may go too far")
        factor = (abs(x_next) / abs(x)).upper()
        if not factor < 1:
            raise NotEnclosedError("the speed may go away from the orbit's")
        return factor

    def _require_kept(self, paths: Paths) -> None:
        for limit in self.steps.limits_along(paths, self.steps.bounds):
            if limit.proved is not Proof.PROVED:
                raise NotEnclosedError(f"{limit.bound.code} {limit.bound.name}")

    # ------------------------------------------------------------------ late
    def late(self, given: tuple[float, ...] | None) -> Reached:
        """Up to the latest reversal that is proved, retraced."""
        first, last = self.choice.reversals
        if given is not None:
            return self._late_up_to(-given[0])
        beyond = last + PAST
        for _ in range(HALVINGS):
            try:
                return self._late_up_to(beyond)
            except NotEnclosedError as error:
                why, beyond = error, 0.5 * (beyond + first)
        raise why

    def _late_up_to(self, beyond: float) -> Reached:
        choice, paths = self.choice, self.paths
        piece = self._continuation(beyond)
        more = piece.L.exp() * piece.M * arb(beyond)
        x, slowest = paths.x_before(paths.up, more), self._slowest
        if not (paths.x_before(paths.up, arb(0)) <= slowest and slowest > 0 and x >= slowest):
            raise NotEnclosedError("late")
        factors = [self._factor(own, paths.x_after(paths.more(own))) for own in (slowest, x)]
        rows = [piece.rows]
        self._require_kept(
            {"rising": [on_planned(paths.up, more), *rows], "falling": [on_planned(paths.down, more), *rows]}
        )
        end = choice.high if x >= self._fastest else _speed(x.lower(), 1 - arb(SLACK), 0.0)
        return Reached((-beyond,), max(factors), min(end, choice.high), "a later one may not keep the limits")

    def _continuation(self, beyond: float) -> PathPiece:
        return PathPiece.of(LatePath.of(self.paths.rising, self.choice.tapers, beyond), at_rest=True)

    def rescaled_late(self) -> Reached:
        """All of it at once: such intervals are short."""
        first, last = self.choice.reversals[0] - PAST, self.choice.reversals[1] + PAST
        if not first > 0.0:
            raise NotEnclosedError("late")
        paths, orbit = self.paths, self.steps.orbit
        pieces = [self._continuation(end) for end in (first, last)]
        mores = [piece.L.exp() * piece.M * arb(end) for piece, end in zip(pieces, (first, last), strict=True)]
        slowest, fastest = (paths.x_before(paths.up, more) for more in mores)
        if not (slowest <= self._slowest and fastest >= self._fastest and slowest > 0):
            raise NotEnclosedError("late")
        x = arb(first).union(arb(last))
        path = RescaledPath.late(
            paths.rising, self.choice.tapers, _half_path(orbit.falling), orbit.gait.end, paths.falling.span, x
        )
        x_next, rows = self._rescaled(path)
        self._require_kept({"rising": [on_planned(paths.up, mores[1]), pieces[1].rows], "falling": [rows]})
        return Reached((-last, -first), self._factor(slowest, x_next), self.choice.high, "")

    def _rescaled(self, path: Path) -> tuple[Ball, Controls]:
        piece = PathPiece.to_impact(path)
        return piece.L.exp() * piece.M * path.span / self.steps.orbit.falling.z - 1, piece.rows

    # ------------------------------------------------------------------ early
    def early(self, given: tuple[float, ...] | None) -> Reached:
        """Tile after tile of earlier reversals."""
        choice, paths = self.choice, self.paths
        nearest, farthest = max(-choice.reversals[1] - PAST, 0.0), -choice.reversals[0] + PAST
        if given is not None:
            nearest, farthest = given[0], given[-1]
        up = HalfOrbit.of(LowerPart.of(paths.rising, nearest), fine=ROUGH)
        x = paths.x_before(up, arb(0))
        if not (x >= self._fastest and x < 0):
            raise NotEnclosedError("early")
        self._require_kept({"rising": [on_planned(up, arb(0))]})
        ends, factor, why = [nearest], arb(0), ""
        range_ = float(self.steps.orbit.rising.path.span.mid())
        width, widening, widths = FIRST_TILE * range_, WIDENING, iter(given[1:] if given else ())
        while ends[-1] < farthest and len(ends) <= TILES and width >= LEAST_TILE * range_:
            end = min(ends[-1] + width, farthest) if given is None else next(widths)
            try:
                factor = max(factor, self._factor(x, self._tile(ends[-1], end)))
            except NotEnclosedError as error:
                if given is not None:
                    raise
                why, width, widening = str(error), 0.5 * width, 1.0
                continue
            ends.append(end)
            width *= widening
            x = self._x_at(up, end - nearest)
        reached = choice.low if x <= self._slowest else _speed(x.upper(), 1 + arb(SLACK), 2.0)
        tiles = tuple(ends) if len(ends) > 1 else ()
        return Reached(tiles, factor, max(reached, choice.low), f"stretched by {choice.stretch:g}: {why}")

    def _x_at(self, up: HalfOrbit, below: float) -> Ball:
        """x of the step that reverses so far below the reversal of a rising orbit [rad]."""
        _, M = at_share(up, arb(below) / up.path.span)
        return self.paths.x_before(up, -M * arb(below))

    def _tile(self, nearest: float, farthest: float) -> Ball:
        """x after all reversals between two before the end of the rising phase [rad]."""
        choice, paths, orbit = self.choice, self.paths, self.steps.orbit
        d = arb(nearest).union(arb(farthest))
        if choice.rescaled:
            planned = _half_path(orbit.falling)
            path = Family.of(
                lambda d: RescaledPath.early(paths.rising, planned, orbit.gait.end, paths.falling.span, d), d
            )
            x_next, rows = self._rescaled(path)
            self._require_kept({"falling": [rows]})
            return x_next
        if choice.rejoin is None:
            raise NotEnclosedError("how the path is rejoined")
        anchored = replace(self.steps, orbit=replace(orbit, step=paths.step, rising=paths.up, falling=paths.down))
        q, own, _ = anchored.rejoined(EarlyPath.of(self._mismatch, d, choice.rejoin))
        self._require_kept({"falling": [*own["falling"], on_planned(paths.down, arb(0))]})
        _, M = at_share(paths.up, d / paths.up.path.span)
        return paths.x_after(-q * M * d)

    @cached_property
    def _mismatch(self) -> Mismatch:
        return Mismatch.of(self.paths.step, self.paths.sole)


def _speed(x: Ball, share: Ball, towards: float) -> float:
    """The speed of x over the orbit's, or a share of it, rounded."""
    return nextafter(float((1 + x).sqrt() * share), towards)


def _half_path(half: HalfOrbit) -> HalfPath:
    path: Path = half.path
    assert isinstance(path, HalfPath)  # the planned one
    return path
