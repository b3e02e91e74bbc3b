r"""A proved basin on Z of the ankle law: speeds after an impact from which the orbit itself is reached, step by step.

**Basin.** *From every speed of the interval given, every later step under the ankle law exists and keeps the limits of
the contact and of the motors at every instant, and after so many steps as are given, at most, the speed after the
impact is the orbit's, exactly.* The law's own shifts of the FRI target, its stretched phases and what is kept along
them are those of `ankle_steps`. Three facts carry the proof.

**Shifts are ordered.** With v = dbeta^2 the motion on Z is dv/dbeta = 2 ddbeta(beta, v; s), s the shift, and as
N_0 = (p_FRI + s) F_v,

.. math:: \frac{\partial\, ddbeta}{\partial s} = \frac{F_v}{I_P}, \qquad
          F_v\, I_P = A_{N_0} (B_{F_v} v + G_{F_v}) - A_{F_v} (B_{N_0} v + G_{N_0}),

the latter whatever the shift is: at a point of a motion along which the ground pushes it would push with every other
shift that leaves I_P > 0, too. So along that motion the equation of a greater shift is the greater one, of a smaller
shift the smaller one, and motions that begin alike never meet again: a robot that rises from the same speed has more
left at the planned reversal the farther inwards the target, one that falls from the same reversal arrives slower. Where
one shift of the room does exactly what the law wants it is thus the only one, errors have different signs at the two
ends of the room, and the law finds it. I_P is affine in the shift, so its sign is seen to at the ends.

**Shifted.** The speed that reverses as planned with a shift s depends on s continuously, so with s from 0 to an end of
the room it takes every value up to the one there. From the planned reversal the falling phase needs no shift and brings
the orbit's speed: one step is enough.

**Stretched.** Faster than that, all of the room outwards is used (that end leaves less than the other, `order`), and
the phase is stretched by some e with which it reverses at its end, from the intervals of length Delta/7 or so at whose
ends the law looks in turn. Which one does not matter: on tiles that cover [0, E] every e is proved of, and beyond E, up
to the next point at which the law looks, every e takes more than the greatest speed of the interval. Falling from
there the law shifts the target so that the orbit's speed follows, or, where the sole is too short, as far inwards as
may be; then the speed is still greater than the orbit's, and less than all with which a step of that tile begins. So no
tile is met twice, and the last step is one that ends at the orbit's speed.

Slower than with the whole room inwards nothing is proved here. The law is that of exact arithmetic: the program finds
shifts to 1e-9 m, leaves a surplus of energy below 1e-4 kg^2 m^4/s^2 to the transitions, and takes a landing within 1e-9
rad of the planned one for that.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import ceil, nextafter
from typing import NamedTuple

from frontal_biped.zero_dynamics.proof.ankle_steps import AnkleSteps, Stepped
from frontal_biped.zero_dynamics.proof.balls import Ball, arb
from frontal_biped.zero_dynamics.proof.basin import LOOKED
from frontal_biped.zero_dynamics.proof.half_step import NotEnclosedError
from frontal_biped.zero_dynamics.proof.limits import ProvedLimit
from frontal_biped.zero_dynamics.proof.theorems import Proof, told


class AnkleTiles(NamedTuple):
    """What a basin of the ankle law rests on: ends of intervals, from 0 on.

    Attributes:
        outwards: of shifts, as shares of the room on that side [-].
        inwards: likewise.
        stretched: of what phases are stretched by [rad].
        limited_by: what kept lower and higher speeds from being proved when they were sought.
    """

    outwards: tuple[float, ...]
    inwards: tuple[float, ...]
    stretched: tuple[float, ...]
    limited_by: tuple[str, str] = (LOOKED, LOOKED)


@dataclass(frozen=True)
class ProvedAnkleBasin:
    """Speeds after the impact that return under the ankle law.

    Attributes:
        low: the least of them, relative to the orbit's [-]; what was rounded is inside.
        high: the greatest [-].
        at_once: the greatest that one step brings to the orbit's speed; that from `low` on does so, too [-].
        steps: after which the orbit's speed is reached, at most.
        tiles: that show it.
        limits: with what room they are kept; no bound is left out.
    """

    low: float
    high: float
    at_once: float
    steps: int
    tiles: AnkleTiles
    limits: tuple[ProvedLimit, ...]

    @property
    def proved(self) -> Proof:
        """Is there an interval?"""
        held = bool(self.limits) and all(limit.proved is Proof.PROVED for limit in self.limits)
        return told(held and self.high > self.low, False)

    @property
    def width(self) -> float:
        """Of the interval [-]."""
        return self.high - self.low if self.proved is Proof.PROVED else 0.0

    @property
    def rows(self) -> list[tuple[str, str]]:
        """(name, text) for a report."""
        name, (below, above) = "basin on Z, ankle law", self.tiles.limited_by
        if self.proved is not Proof.PROVED:
            return [(name, f"{self.proved.value}: not even at the orbit ({above})")]
        low, high, at_once = (f"{100.0 * (x - 1.0):+.2f} %" for x in (self.low, self.high, self.at_once))
        later = f", from up to {at_once} in one" if self.steps > 1 else ""
        return [
            (
                name,
                f"proved: {low} (then not: {below}) to {high} (then not: {above}) of the speed after the impact; the"
                f" orbit is reached in {self.steps} step{'s' if self.steps > 1 else ''} or less{later}",
            )
        ]


def no_ankle_basin(why: str) -> ProvedAnkleBasin:
    """Nothing is known."""
    return ProvedAnkleBasin(1.0, 1.0, 1.0, 0, AnkleTiles((0.0,), (0.0,), (0.0,), (why, why)), ())


SOLE = "the sole is too short"
"""What limits shifts where nothing else does."""

FIRST_SHARE, MOST_SHARES = 0.25, 24
"""Width of the first tile of shifts, as a share of the room, and tiles on either side at most."""

FIRST_STRETCH, MOST_STRETCHES = 1 / 128, 64
"""Width of the first tile of stretched phases, as a share of the rising phase's range, and how many at most."""

MOST_PANELS = 2432
"""Of all of these at most, where a step takes more panels than those of the Table I gaits."""

WIDENING, NARROWING, LEAST = 1.1, 0.7, 1 / 32
"""Factors from one width to the next, where a tile does and where not; share of the first below which none is tried."""


def prove_ankle_basin(steps: AnkleSteps, rests_on: AnkleTiles | None = None) -> ProvedAnkleBasin:
    """Prove a basin of the ankle law.

    Args:
        steps: its steps.
        rests_on: tiles that do; None: they are sought.
    """
    given = rests_on or AnkleTiles((), (), ())
    try:
        outer, inner = steps.room
        outwards = _shifted(steps, outer, given.outwards)
        inwards = _shifted(steps, inner, given.inwards)
        stretched = _NONE
        if outwards.ends[-1] == 1.0:
            stretched = _stretched(steps, given.stretched)
        high = _highest(steps, outer * arb(outwards.ends[-1]), stretched)
        low = steps.start(steps.rising(inner * arb(inwards.ends[-1])))
    except NotEnclosedError as error:
        return no_ankle_basin(str(error))
    limits: tuple[ProvedLimit, ...] = ()
    for found in (outwards, inwards, stretched):
        limits = _tightest(limits, found.limits)
    later = [tile.start for tile in stretched.tiles if tile.next_ > 1]
    why = inwards.why, outwards.why if outwards.ends[-1] < 1.0 else stretched.why
    tiles = AnkleTiles(outwards.ends, inwards.ends, stretched.ends, why if rests_on is None else rests_on.limited_by)
    # rounded inwards
    return ProvedAnkleBasin(
        nextafter(float(low.sqrt().upper()), 2.0),
        _below(high),
        _below(min([high, *later])),
        _steps(stretched.tiles),
        tiles,
        limits,
    )


def _below(squared: Ball) -> float:
    return nextafter(float(squared.sqrt().lower()), 0.0)


class _Tile(NamedTuple):
    """Stretched steps.

    Attributes:
        start: square of the least speed they begin with, relative to the orbit's [-].
        next_: square of the greatest that follows [-].
    """

    start: Ball
    next_: Ball


class _Found(NamedTuple):
    """Tiles of one kind.

    Attributes:
        ends: of the tiles, from 0 on.
        tiles: what is known of each.
        limits: kept on all of them.
        why: what stands in the way of more.
    """

    ends: tuple[float, ...]
    tiles: tuple[_Tile, ...]
    limits: tuple[ProvedLimit, ...]
    why: str

    def up_to(self, end: float, stepped: Stepped) -> "_Found":
        """With one tile more.

        Raises:
            NotEnclosedError: its steps may lead away from the orbit, or not keep a limit, as far as balls can tell.
        """
        for limit in stepped.limits:
            if limit.proved is not Proof.PROVED:
                raise NotEnclosedError(f"{limit.bound.code} {limit.bound.name}")
        start, (_, slowest, fastest) = stepped.starts.lower(), stepped.fallen
        if slowest < 1 or not (fastest == 1 or fastest < start):
            raise NotEnclosedError("the speed may go away from the orbit's")
        tile, limits = _Tile(start, fastest), _tightest(self.limits, stepped.limits)
        return _Found((*self.ends, end), (*self.tiles, tile), limits, self.why)


_NONE = _Found((0.0,), (), (), LOOKED)


def _shifted(steps: AnkleSteps, end: Ball, given: Sequence[float]) -> _Found:
    found = _tiled(lambda a, b: steps.shifted(end, a, b), given, Widths(FIRST_SHARE, 1.0, MOST_SHARES))
    return found._replace(why=SOLE) if found.ends[-1] == 1.0 else found


def _stretched(steps: AnkleSteps, given: Sequence[float]) -> _Found:
    range_ = float(steps.steps.orbit.rising.path.span.mid())
    most = steps.rule.stretch * steps.rule.stretches * range_
    number = min(MOST_STRETCHES, MOST_PANELS // steps.panels)
    return _tiled(steps.stretched, given, Widths(FIRST_STRETCH * range_, most, number))


class Widths(NamedTuple):
    """How tiles are sought.

    Attributes:
        first: width of the first.
        whole: where the last one ends at most.
        number: of tiles, at most.
    """

    first: float
    whole: float
    number: int


def _tiled(step: Callable[[float, float], Stepped], given: Sequence[float], widths: Widths) -> _Found:
    """Tiles from 0 on.

    Args:
        step: the steps of a tile.
        given: ends of tiles that do; empty: they are sought.
        widths: how.

    Raises:
        NotEnclosedError: a given tile does not do, or no first one is found.
    """
    found = _NONE
    for end in given[1:]:
        if not found.ends[-1] < end <= widths.whole:
            raise NotEnclosedError("tiles that cover nothing")
        found = found.up_to(end, step(found.ends[-1], end))
    if given:
        return found
    width = widths.first
    while found.ends[-1] < widths.whole and len(found.tiles) < widths.number and width >= LEAST * widths.first:
        end = min(found.ends[-1] + width, widths.whole)
        try:
            found = found.up_to(end, step(found.ends[-1], end))._replace(why=LOOKED)
            width *= WIDENING
        except NotEnclosedError as error:
            found = found._replace(why=str(error))
            width *= NARROWING
    return found


def _highest(steps: AnkleSteps, shift: Ball, found: _Found) -> Ball:
    """Square of the greatest speed proved, relative to the orbit's [-].

    Args:
        steps: its steps.
        shift: the farthest outwards [m].
        found: stretched steps beyond.

    Raises:
        NotEnclosedError: it is not known which reversal is found, or what is taken of the room.
    """
    shifted = steps.start(steps.rising(shift)).lower()
    if not found.tiles:
        return shifted
    least, low = steps.stretched_start(found.ends[-1], found.ends[-1]).lower(), found.ends[-1]
    width = low - found.ends[-2]
    # the law looks for a reversal up to the next of evenly spaced points
    apart = steps.rule.stretch * steps.steps.orbit.rising.path.span
    last = float((apart * ceil(low / float(apart.lower()))).upper())
    while low < last:
        least, low = min(least, steps.stretched_start(low, low + width).lower()), low + width
    steps.order(least)
    return max(least, shifted)


def _steps(tiles: Sequence[_Tile]) -> int:
    """Steps until the orbit's speed is reached, at most, from wherever the tiles begin."""
    most = 1
    needed: list[tuple[Ball, int]] = []
    for tile in sorted(tiles, key=lambda tile: tile.start):
        number = 1
        if tile.next_ > 1:
            # a tile that may be met from this one begins with a speed that may follow, and is in the list by then
            number = 1 + max([1, *(count for start, count in needed if start <= tile.next_)])
        needed.append((tile.start, number))
        most = max(most, number)
    return most


def _tightest(limits: Sequence[ProvedLimit], others: Sequence[ProvedLimit]) -> tuple[ProvedLimit, ...]:
    if not limits or not others:
        return tuple(limits or others)
    return tuple(min(pair, key=lambda known: float(known.margin.lower())) for pair in zip(limits, others, strict=True))
