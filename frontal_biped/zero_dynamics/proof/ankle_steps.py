r"""Steps of the ankle law in balls: where it moves the FRI target, what energy that leaves, and the limits it keeps.

The law (`control.stabilisers.ankle_law`) moves the FRI target of a whole phase by one constant, a shift: when rising by
the one with which the robot reverses as planned, when falling by the one that brings the planned speed after the
impact. A shift is no new path: pose, slope and all that follows from them stay, and of the dynamics only I_P and the
coefficients that hold it or p_FRI are others (`Panel`). So one walk along a path serves every shift.

Two kinds of steps, by the speed after the impact; `ankle_basin` says how they follow each other:

* **shifted**: the rising phase as planned but for the shift; it reverses as planned, and the orbit follows;
* **stretched**: too fast for the sole; shifted as far outwards as may be and stretched until it reverses at its end
  (`stretched_step`), e later; shifted again when falling.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from frontal_biped.zero_dynamics.proof.ball_gait import BallStep
from frontal_biped.zero_dynamics.proof.balls import Ball, arb
from frontal_biped.zero_dynamics.proof.half_orbit import (
    HEIGHT,
    Panel,
    Rows,
    lifted,
    walk,
)
from frontal_biped.zero_dynamics.proof.half_path import (
    HalfPath,
    Path,
    Projected,
    require_positive,
)
from frontal_biped.zero_dynamics.proof.limits import Cuts, ProvedLimit
from frontal_biped.zero_dynamics.proof.perturbed_steps import (
    INNER,
    OUTER,
    ROUGH,
    Controls,
    PerturbedSteps,
)
from frontal_biped.zero_dynamics.proof.ranges import controls
from frontal_biped.zero_dynamics.proof.shift_choice import Room, secants, side
from frontal_biped.zero_dynamics.proof.shifted_way import Moved, Way, shifted
from frontal_biped.zero_dynamics.proof.stretched_step import over_ranges_of, stretched


class AnkleRule(NamedTuple):
    """How the law chooses (`control.stabilisers.ankle_law`, `half_steps.stretch_to_reversal`).

    Attributes:
        margin: distance that a shifted FRI target keeps from the ends of the sole [m].
        looks: points of a phase, evenly spaced in beta, at which that is seen to.
        stretch: by what share of the range of the rising phase its end is moved outwards to bracket a reversal.
        stretches: how often, at most.
    """

    margin: float
    looks: int
    stretch: float
    stretches: int


class Fallen(NamedTuple):
    """What the law makes of a falling phase.

    Attributes:
        shift: that it chooses [m]; of many phases, all that it may choose.
        low: of the next speed after the impact, the square relative to the orbit's, at least [-].
        high: at most [-].
    """

    shift: Ball
    low: Ball
    high: Ball


class Stepped(NamedTuple):
    """Steps of one kind between two ends.

    Attributes:
        starts: squares of the speeds after the impact, relative to the orbit's, that they begin with [-].
        fallen: the falling phase.
        limits: kept along them.
    """

    starts: Ball
    fallen: Fallen
    limits: list[ProvedLimit]


PLANNED = Fallen(arb(0), arb(1), arb(1))
"""From the planned reversal the next speed is the orbit's, without any shift."""


@dataclass(frozen=True)
class AnkleSteps:
    """Steps of the ankle law.

    Attributes:
        steps: those of the transitions that it shifts.
        rule: how it chooses.
    """

    steps: PerturbedSteps
    rule: AnkleRule

    # ------------------------------------------------------------------ shifted
    @cached_property
    def room(self) -> Room:
        """Of the rising phase.

        Raises:
            NotEnclosedError: I_P may vanish in it.
        """
        orbit = self.steps.orbit.rising
        room = self._room(self._looks(orbit.path))
        _require_inertia(orbit.panels, room)
        return room

    def rising(self, shift: Ball) -> Way:
        """The planned rising phase, shifted.

        Raises:
            NotEnclosedError: as `Way.of`.
        """
        orbit = self.steps.orbit.rising
        return Way.of(orbit.panels, self._landed, shift)

    def shifted(self, end: Ball, least: float, most: float) -> Stepped:
        """Steps that are shifted towards an end of the room by a share of the way there between two.

        Raises:
            NotEnclosedError: as `Way.of`, or the ground may pull.
        """
        way = self.rising(end * arb(least).union(arb(most)))
        rows = {"rising": [way.rows() | self._planned_heights], "falling": [self.steps.orbit.falling.rows]}
        return Stepped(self.start(way), PLANNED, self.steps.limits(rows, self.steps.bounds))

    def start(self, rising: Way) -> Ball:
        """Square of the speed after the impact, relative to the orbit's [-], with which such a phase begins."""
        return rising.dbeta_squared / self._planned

    # ------------------------------------------------------------------ stretched
    def stretched(self, least: float, most: float) -> Stepped:
        """Steps that are stretched by something between two numbers [rad].

        Raises:
            NotEnclosedError: as `Way.of`, the ground may pull, or it is not known what is chosen.
        """
        e, sole = arb(least).union(arb(most)), self.steps.orbit.rising.path.sole
        step = self._stretched(e)
        rising = Moved.of(HalfPath.of(step.rising, sole), self.room.low)
        up = self._unshifted(rising)
        path = HalfPath.of(step.falling, sole)
        base = tuple(_panels(path, self._cuts.falling))
        looks = self._looks(path)

        def next_(shift: Ball) -> Ball:
            # the impact, and the slope there, are as planned
            return Way.of(base, self._at_impact, shift, motors=False).dbeta_squared / self._landing

        _require_inertia(base, self._room(looks))
        fallen = self._fallen(next_, looks, path)
        way = Way.of(base, self._at_impact, fallen.shift)
        rows = {"rising": [up.rows() | _lifted(up.panels, rising)], "falling": [way.rows() | _lifted(base, path)]}
        return Stepped(self.start(up), fallen, self.steps.limits(rows, self.steps.bounds))

    def stretched_start(self, least: float, most: float) -> Ball:
        """`Stepped.starts` of steps that are stretched by something between two numbers [rad], and no more of them.

        Raises:
            NotEnclosedError: as `Way.of`.
        """
        step, sole = self._stretched(arb(least).union(arb(most))), self.steps.orbit.rising.path.sole
        return self.start(self._unshifted(Moved.of(HalfPath.of(step.rising, sole), self.room.low)))

    @property
    def panels(self) -> int:
        """Of a stretched step."""
        return sum(len(cuts) - 1 for cuts in self._cuts)

    def _stretched(self, e: Ball) -> BallStep:
        orbit = self.steps.orbit
        return over_ranges_of(orbit.step, stretched(orbit.step, orbit.gait.begin, orbit.gait.end, e))

    def _unshifted(self, path: Moved) -> Way:
        # it begins as planned
        return Way.of(_panels(path, self._cuts.rising), shifted(self._landed, path.shift), arb(0))

    # ------------------------------------------------------------------ the law
    def order(self, dbeta_squared: Ball) -> None:
        """See that, where no shift is enough, the law takes the one that is next to enough.

        It compares what is left of the energy at both ends of the room.

        Args:
            dbeta_squared: after the impact, relative to the orbit's [-].

        Raises:
            NotEnclosedError: it may take the other one.
        """
        low, high = (self.rising(shift).surplus(dbeta_squared * self._planned) for shift in self.room)
        require_positive(high - low, "which end of the sole is taken")

    def _fallen(self, next_: Callable[[Ball], Ball], looks: list[Ball], path: Path) -> Fallen:
        """What the law makes of a falling phase.

        Args:
            next_: square of the next speed, relative to the orbit's [-], by the shift [m].
            looks: FRI targets that it sees to [m].
            path: from the reversal on.
        """
        at = path.at(arb(0))
        leaning = at.G[2] / at.G[1] - at.p_fri
        room = self._room(looks, leaning - arb(self.rule.margin))
        near, radius = secants(next_, float(room.low.lower()), float(room.high.upper()))
        first, low = side(next_, near, -radius, room.low)
        last, high = side(next_, near, radius, room.high)
        # the next speed is the planned one where the signs at both ends say so
        return Fallen(first.union(last), min(low, arb(1)), max(high, arb(1)))

    def _looks(self, path: Path) -> list[Ball]:
        """The FRI target at the points at which the law looks [m]."""
        return [path.shape(arb(k) / (self.rule.looks - 1)).p_fri for k in range(self.rule.looks)]

    def _room(self, looks: list[Ball], most: Ball | None = None) -> Room:
        outer, inner = self.steps.orbit.rising.path.sole
        margin = arb(self.rule.margin)
        low = arb(outer) + margin + _greatest([-p for p in looks])
        high = arb(inner) - margin - _greatest(looks)
        if most is not None:
            high = -_greatest([-high, -most])
        return Room(-_greatest([-low, arb(0)]), _greatest([high, arb(0)]))

    # ------------------------------------------------------------------ what is planned
    @cached_property
    def _landed(self) -> Projected:
        return self.steps.orbit.rising.path.at(arb(1))

    @cached_property
    def _planned(self) -> Ball:
        """dbeta^2 of the orbit after the impact [rad^2/s^2]."""
        return 2 * self.steps.orbit.rising.z / (self._landed.I_P * self._landed.I_P)

    @cached_property
    def _landing(self) -> Ball:
        """dbeta^2 of the orbit before the impact [rad^2/s^2]."""
        I_P = self._at_impact.I_P
        return 2 * self.steps.orbit.falling.z / (I_P * I_P)

    @cached_property
    def _at_impact(self) -> Projected:
        return self.steps.orbit.falling.path.at(arb(1))

    @cached_property
    def _cuts(self) -> Cuts:
        """Of the planned path, as rough as does for what is only bounded; those of the orbit are for its digits."""
        halves = self.steps.orbit.rising.path, self.steps.orbit.falling.path
        return Cuts(*((0.0, *(float(panel.high) for panel in _panels(path))) for path in halves))

    @property
    def _planned_heights(self) -> Controls:
        return {HEIGHT: self.steps.orbit.rising.rows[HEIGHT]}


def _require_inertia(panels: Iterable[Panel], room: Room) -> None:
    """See that I_P is positive along a way with every shift that there is room for.

    Raises:
        NotEnclosedError: it may not be.
    """
    # it is affine in the shift
    for panel in panels:
        for end in room:
            require_positive(shifted(panel.path[1], end).I_P, "I_P with the target at an end of the sole")


def _greatest(balls: Iterable[Ball]) -> Ball:
    known = list(balls)
    return max(x.lower() for x in known).union(max(x.upper() for x in known))


def _panels(path: Path, cuts: Sequence[float] | None = None) -> Iterable[Panel]:
    """Of a path, between cuts that do for one like it; None: so fine that what the limits bound is known on each."""

    def rows_of(panel: Panel) -> Rows:
        return {} if cuts is not None else _heights(panel) | panel.motion_rows(panel.dbeta_squared(0))

    return (panel for panel, _, _ in walk(path, rows_of, cuts, fine=ROUGH))


def _lifted(panels: Sequence[Panel], path: Path) -> Controls:
    """The height of the swing foot: itself where it is positive, near the impact over the share of the way from it."""
    on_ground = path.at(arb(1)).heights
    over = [controls(taylor, h) for taylor, h in lifted(panels, on_ground)]
    itself = [controls(taylor, panel.h) for panel in reversed(panels) for taylor in _heights(panel).values()]
    return {HEIGHT: [b if all(x > 0 for x in b) else a for a, b in zip(over, itself, strict=True)]}


def _heights(panel: Panel) -> Rows:
    """Of the ends of the swing foot's sole."""
    middle, wide = (place.heights for place in panel.path)
    return dict(zip((INNER, OUTER), (panel.taylor(heights) for heights in zip(middle, wide, strict=True)), strict=True))
