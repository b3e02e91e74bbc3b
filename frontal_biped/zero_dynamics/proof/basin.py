r"""A proved basin on Z: speeds after an impact from which every later step exists, keeps every limit, and converges.

The map is that of re-anchored transitions without looking ahead (`virtual_constraints.anchoring`): a late reversal
retraces the continuation, an early one rejoins the planned path over c times as far. It is one-dimensional. Of a step
write E for e^{-L} zeta at the planned reversal (`half_orbit`): what is left there of the energy after the impact, or
lacks. The orbit through the planned reversal has E = 0 and is periodic: what its falling half brings back of energy is
energy_r / m, energy_r what its rising half takes. So

.. math:: E_{next} = m\, E', \qquad \frac{speed^2}{speed_*^2} = 1 + \frac{E}{energy_r},

where E' is what the falling phase has at the planned reversal, or seems to have, seen from below.

**Late**, E >= 0: retracing loses nothing, E' = E, so E_next = m E exactly.

**Early** by d, E = -d M_r(d): the energy of the rejoining path, e^{L_s} c d M_s, counts at the join, (1 + c) d below
the planned reversal, as E' = -q |E| with

.. math:: q = \frac{(1 + c) M_f - c\, e^{L_s - L_f} M_s}{M_r},

M_r, M_f, M_s means of -e^{-L} drive over d, (1 + c) d and c d. At d = 0 all of them are the drive at the reversal and
q = 1.

**Basin.** *From every speed of the interval given, every later step exists, keeps the limits of the contact and of the
motors at every instant, and |E| shrinks by the factor given, at least.* Proof: the drive is negative on the planned
path, on the continuation and on every rejoining path, so the robot rises to exactly one reversal, falls and lands; 0 <=
m q < 1 on tiles that cover the early side, and m < 1 on the late one, so the next E lies between E and 0; and the
limits, affine in dbeta^2 or a ratio of such, hold at each beta at rest and at the greatest speed of the interval, so
at all between. What the swing foot must do at the impact does not depend on the speed, but for its size.

**Looking ahead.** Within the speeds of `ProvedBasin.looking_ahead` the stabiliser that looks ahead answers as this one
does (`looking_ahead`), so what is proved is proved of it, too.

The transitions are those of exact arithmetic: within 1e-9 rad of the planned reversal the program takes the planned
falling phase as it is. Which c it chooses is proved, not assumed: on every tile its first one keeps enough inertia.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from math import nextafter
from typing import NamedTuple

from frontal_biped.zero_dynamics.proof.balls import Ball, arb
from frontal_biped.zero_dynamics.proof.half_step import NotEnclosedError
from frontal_biped.zero_dynamics.proof.limits import ProvedLimit
from frontal_biped.zero_dynamics.proof.looking_ahead import keeps_reserve, latest_alike
from frontal_biped.zero_dynamics.proof.perturbed_steps import PerturbedSteps
from frontal_biped.zero_dynamics.proof.theorems import Proof, told


@dataclass(frozen=True)
class ProvedBasin:
    """Speeds after the impact that return.

    Attributes:
        low: the least of them, relative to the orbit's [-]; what was rounded is inside.
        high: the greatest [-].
        factor: by which the energy error shrinks in a step, at least [-].
        beyond: the latest reversal, past the planned one [rad].
        tiles: ends of the intervals of early reversals, from 0 on, before the planned one [rad].
        limits: with what room they are kept; no bound is left out.
        low_limited_by: what kept lower speeds from being proved.
        high_limited_by: what kept higher ones.
        looking_ahead: speeds that return when looking ahead, too, relative to the orbit's [-].
        alike: the latest reversal at which that changes nothing, as far as it was asked, past the planned one [rad].
        rejoins: every c over which falling phases rejoin their path after an early reversal.
    """

    low: float
    high: float
    factor: Ball
    beyond: float
    tiles: tuple[float, ...]
    limits: tuple[ProvedLimit, ...]
    low_limited_by: str = ""
    high_limited_by: str = ""
    looking_ahead: tuple[float, float] = (1.0, 1.0)
    alike: float = 0.0
    rejoins: frozenset[float] = frozenset()

    @property
    def proved(self) -> Proof:
        """Is there an interval?"""
        held = all(limit.proved is Proof.PROVED for limit in self.limits)
        return told(held and self.high > self.low and bool(self.factor < 1), False)

    @property
    def width(self) -> float:
        """Of the interval [-]."""
        return self.high - self.low if self.proved is Proof.PROVED else 0.0

    @property
    def rows(self) -> list[tuple[str, str]]:
        """(name, text) for a report."""
        if self.proved is not Proof.PROVED:
            return [("basin on Z", f"{self.proved.value}: not even at the orbit ({self.high_limited_by})")]
        low, high, *ahead = (f"{100.0 * (x - 1.0):+.2f} %" for x in (self.low, self.high, *self.looking_ahead))
        return [
            (
                "basin on Z",
                f"proved: {low} (then not: {self.low_limited_by}) to {high} (then not: {self.high_limited_by}) of the"
                f" speed after the impact; the energy error shrinks to {float(self.factor.upper()):.4f} of it in a"
                f" step, or less; looking ahead, {ahead[0]} to {ahead[1]}",
            )
        ]


LOOKED = "that is as far as was looked"


class BasinTiles(NamedTuple):
    """What a basin rests on.

    Attributes:
        beyond: the latest reversal, past the planned one [rad].
        tiles: ends of the intervals of early reversals, from 0 on, before the planned one [rad].
        limited_by: what kept lower and higher speeds from being proved when they were sought.
        alike: the latest reversal at which looking ahead changes nothing, likewise; 0: none.
    """

    beyond: float
    tiles: tuple[float, ...]
    limited_by: tuple[str, str] = (LOOKED, LOOKED)
    alike: float = 0.0


def no_basin(why: str) -> ProvedBasin:
    """Nothing is known."""
    return ProvedBasin(1.0, 1.0, arb.nan(), 0.0, (0.0,), (), why, why)


FIRST_TILE, WIDENING = 1 / 1024, 1.25
"""Width of the first tile of early reversals, as a share of the rising phase's range; factor to the next, at most."""

LEAST_TILE, TILES = 1 / 8192, 120
"""Width below which a tile is not halved again, likewise, and how many there are at most."""

FIRST_LATE, HALVINGS = 1 / 16, 6
"""The late reversal that is tried first, as a share of the rising phase's range, and bisections of the latest."""


def prove_basin(steps: PerturbedSteps, rests_on: BasinTiles | None = None) -> ProvedBasin:
    """Prove a basin.

    Args:
        steps: the map.
        rests_on: tiles that do; None: they are sought.
    """
    range_ = float(steps.orbit.rising.path.span.mid())
    try:
        late = _latest(steps, range_) if rests_on is None else _Late.of(steps, rests_on.beyond)
        early = _Early((0.0,), steps.orbit.multiplier.upper(), late.limits, LOOKED)
        if rests_on is None:
            early = _earliest(steps, early, range_)
        else:
            for end in rests_on.tiles[1:]:
                early = early.down_to(steps, end)
    except NotEnclosedError as error:
        return no_basin(str(error))
    alike = latest_alike(steps, late.beyond) if rests_on is None else rests_on.alike
    low, high = _rounded_up(steps.early_speed(early.ends[-1])), _late_speed(steps, late.energy)
    why = (early.why, late.why) if rests_on is None else rests_on.limited_by
    ahead = _looking_ahead(steps, alike, (low, high))
    return ProvedBasin(
        low, high, early.factor, late.beyond, early.ends, early.limits, *why, ahead, alike, early.rejoins
    )


def _looking_ahead(steps: PerturbedSteps, alike: float, basin: tuple[float, float]) -> tuple[float, float]:
    """Of the speeds that return those at which looking ahead changes nothing."""
    near, high = steps.reserve.near, 1.0
    if alike > 0.0 and keeps_reserve(steps, alike):
        high = _late_speed(steps, steps.late(alike)[0])
    return max(basin[0], nextafter(1.0 - near, 2.0)), min(basin[1], max(high, nextafter(1.0 + near, 0.0)))


def _rounded_up(speed: Ball) -> float:
    return nextafter(float(speed.upper()), 2.0)


def _late_speed(steps: PerturbedSteps, energy: Ball) -> float:
    """The greatest that has no more than an energy at the planned reversal, rounded down."""
    return nextafter(float((1 + energy / steps.orbit.rising.energy).sqrt().lower()), 0.0)


class _Late(NamedTuple):
    """A late reversal, with all that is slower.

    Attributes:
        beyond: past the planned one [rad].
        energy: that it has [kg^2 m^4/s^2].
        limits: kept up to it.
        why: what stands in the way of later ones.
    """

    beyond: float
    energy: Ball
    limits: tuple[ProvedLimit, ...]
    why: str

    @classmethod
    def of(cls, steps: PerturbedSteps, beyond: float) -> "_Late":
        """The reversal so far past the planned one.

        Raises:
            NotEnclosedError: it does not exist, or a limit is not kept, as far as balls can tell.
        """
        energy, paths = steps.late(beyond)
        limits = steps.limits(paths, steps.bounds)
        _require_kept(limits)
        return cls(beyond, energy, tuple(limits), LOOKED)


def _latest(steps: PerturbedSteps, range_: float) -> _Late:
    found, bad, left = _Late.of(steps, 0.0), None, HALVINGS
    while left:
        if bad is None:
            beyond = max(2.0 * found.beyond, FIRST_LATE * range_)
        else:
            beyond, left = 0.5 * (found.beyond + bad), left - 1
        try:
            found = _Late.of(steps, beyond)._replace(why=found.why)
        except NotEnclosedError as error:
            bad, found = beyond, found._replace(why=str(error))
    return found


class _Early(NamedTuple):
    """Early reversals, down to one of them.

    Attributes:
        ends: of tiles, from 0 on [rad].
        factor: of the energy error in a step, at most [-].
        limits: kept from here to the latest reversal.
        why: what stands in the way of earlier ones.
        rejoins: every c over which the falling phases rejoin their path.
    """

    ends: tuple[float, ...]
    factor: Ball
    limits: tuple[ProvedLimit, ...]
    why: str
    rejoins: frozenset[float] = frozenset()

    def down_to(self, steps: PerturbedSteps, end: float) -> "_Early":
        """With one tile more.

        Raises:
            NotEnclosedError: it does not return, or a limit is not kept, as far as balls can tell.
        """
        q, paths, c = steps.early(self.ends[-1], end)
        shrinks = steps.orbit.multiplier * q
        _require(bool(shrinks >= 0 and shrinks < 1), "the speed may go away from the orbit's")
        own = steps.limits_along(paths, steps.bounds)
        _require_kept(own)
        limits = tuple(_tighter(limit, own) for limit in self.limits)
        return _Early((*self.ends, end), max(self.factor, shrinks.upper()), limits, self.why, self.rejoins | {c})


def _earliest(steps: PerturbedSteps, found: _Early, range_: float) -> _Early:
    width = FIRST_TILE * range_
    while len(found.ends) <= TILES and width >= LEAST_TILE * range_:
        try:
            found = found.down_to(steps, found.ends[-1] + width)
            width *= WIDENING
        except NotEnclosedError as error:
            found = found._replace(why=str(error))
            width *= 0.5
    return found._replace(why=LOOKED) if len(found.ends) > TILES else found


def _require(held: bool, why: str) -> None:
    if not held:
        raise NotEnclosedError(why)


def _require_kept(limits: Iterable[ProvedLimit]) -> None:
    for limit in limits:
        _require(limit.proved is Proof.PROVED, f"{limit.bound.code} {limit.bound.name}")


def _tighter(limit: ProvedLimit, others: Iterable[ProvedLimit]) -> ProvedLimit:
    same = [other for other in others if other.bound == limit.bound]
    return min([limit, *same], key=lambda known: float(known.margin.lower()))
