r"""Steps that reverse later or earlier than planned, in balls: the energy they keep, and the limits they keep to.

The words are those of `basin`: E is e^{-L} zeta at the planned reversal. Limits are asked of all motions at once that
are not faster than one: at given beta the forces are affine in dbeta^2, and ratios of them monotone, so they lie
between what they are at rest and at the greatest speed.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from frontal_biped.zero_dynamics.proof.balls import Ball, arb, coefficient, is_negative, is_positive
from frontal_biped.zero_dynamics.proof.half_orbit import DEEPEST, HEIGHT, HalfOrbit, Panel, Passed, Rows, lifted, walk
from frontal_biped.zero_dynamics.proof.half_path import Path
from frontal_biped.zero_dynamics.proof.half_step import NotEnclosedError
from frontal_biped.zero_dynamics.proof.limits import BallOrbit, Bound, ProvedLimit
from frontal_biped.zero_dynamics.proof.ranges import Enclosed, controls, least
from frontal_biped.zero_dynamics.proof.reversals import EarlyPath, LatePath, Mismatch, Tapers

ROUGH = 1e-4
"""Remainder on a panel, relative to one more than the size of a function, above which the panel is halved."""

SHORT = 1
"""Halvings of a panel of a rejoining path, at most: what is open there is mostly which of many reversals it is."""

PANELS = 32
"""Into which a whole falling path is cut, a power of two."""

ACCURACY = 1e-6
"""To which least values are sought, in the units of the quantities."""

Controls = dict[str, list[list[Ball]]]
"""Bernstein coefficients on panels, by name."""

Paths = dict[str, list[Controls]]
"""What is bounded along the pieces of a phase's path, by the name of the phase."""


class Rejoining(NamedTuple):
    """How the transitions choose c (`control.stabilisers.transitions`).

    Attributes:
        c: what they try, in turn; the first that keeps enough inertia is taken.
        enough: share of the least I_P of the planned falling phase that is enough.
        looks: points of a falling phase, evenly spaced in beta, at which they look.
    """

    c: tuple[float, ...]
    enough: float
    looks: int


class Rejoined(NamedTuple):
    """Early reversals.

    Attributes:
        q: of all of them [-].
        paths: what is bounded on the falling phases until they rejoin the path.
        c: over which they do.
    """

    q: Ball
    paths: Paths
    c: float


class Reserve(NamedTuple):
    """When transitions that look ahead answer as those that do not (`looking_ahead`).

    Attributes:
        near: relative error of the speed up to which they do not look [-].
        bounds: limits with the reserve that they keep of each.
    """

    near: float
    bounds: Sequence[Bound]


@dataclass(frozen=True)
class PathPiece:
    """A path below a reversal, with what is bounded along it.

    Attributes:
        rows: of the limits.
        L: int of the rate over it.
        M: mean of -e^{-L} drive over it.
    """

    rows: Controls
    L: Ball
    M: Ball

    @classmethod
    def of(cls, path: Path, at_rest: bool, deepest: int = DEEPEST) -> "PathPiece":
        """A path that is not the planned one.

        Args:
            path: the path.
            at_rest: is any motion on it that is not faster than the one from its reversal, or only that?
            deepest: halvings of a panel at most.

        Raises:
            NotEnclosedError: the robot may not move along it, as far as balls can tell.
        """

        def rows_of(panel: Panel) -> Rows:
            rows = _contact_rows(panel, 0, at_rest)
            middle, wide = (place.heights for place in panel.path)
            rows[INNER], rows[OUTER] = (panel.taylor(heights) for heights in zip(middle, wide, strict=True))
            return rows

        rows: Controls = {}
        at: Passed | None = None
        for panel, end, own in walk(path, rows_of, fine=ROUGH, deepest=deepest):
            at = end
            for name, taylor in own.items():
                rows.setdefault(name, []).append(controls(taylor, panel.h))
        assert at is not None
        rows[HEIGHT] = rows.pop(INNER) + rows.pop(OUTER)
        return cls(rows, at.L, at.W)

    @classmethod
    def to_impact(cls, path: Path) -> "PathPiece":
        """A whole falling path, walked from rest at its reversal.

        Args:
            path: the path.

        Raises:
            NotEnclosedError: as `of`.
        """
        cuts = [k / PANELS for k in range(PANELS + 1)]
        walked = list(walk(path, lambda panel: _contact_rows(panel, 0, False), cuts))
        rows: Controls = {}
        for panel, _, own in walked:
            for name, taylor in own.items():
                rows.setdefault(name, []).append(controls(taylor, panel.h))
        on_ground, at = path.at(arb(1)).heights, walked[-1][1]
        rows[HEIGHT] = [controls(taylor, h) for taylor, h in lifted([panel for panel, _, _ in walked], on_ground)]
        return cls(rows, at.L, at.W)


INNER, OUTER = "height of the inner end", "height of the outer end"
"""Rows of a path on which the sole does not come down [m]."""

AT_REST = " at rest"
"""Ends the names of rows of a robot that has just stopped."""


def _contact_rows(panel: Panel, more: Ball | int, at_rest: bool) -> Rows:
    """What the limits of contact and motors bound on a panel, at the speed of an energy more and at rest.

    Raises:
        NotEnclosedError: the drive may not be negative, or the ground may pull.
    """
    if not all(is_positive(-coefficient(place.drive, 0)) for place in panel.on_Z):
        raise NotEnclosedError("drive")
    fri = "FRI in the sole"
    rows = {fri: panel.pose_rows()[fri]} | panel.motion_rows(panel.dbeta_squared(more))
    if at_rest:
        nothing = panel.y[0] * 0
        rows |= {name + AT_REST: row for name, row in panel.motion_rows((nothing, nothing)).items()}
    return rows


def on_planned(orbit: HalfOrbit, more: Ball) -> Controls:
    """Rows of the planned path, for all motions with at most so much more energy.

    Raises:
        NotEnclosedError: as `_contact_rows`.
    """
    rows: Controls = {HEIGHT: orbit.rows[HEIGHT]}
    for panel in orbit.panels:
        for name, taylor in _contact_rows(panel, more, at_rest=True).items():
            rows.setdefault(name, []).append(controls(taylor, panel.h))
    return rows


def at_share(orbit: HalfOrbit, y: Ball) -> tuple[Ball, Ball]:
    """L and M of a half step at a share of its way, or at many.

    Raises:
        NotEnclosedError: it is no share of the way.
    """
    found: tuple[Ball, Ball] | None = None
    for panel in orbit.panels:
        if panel.high < y or panel.low > y:
            continue
        t = panel.low.union(panel.high).intersection(y) - (panel.low + panel.high) / 2
        values = []
        for function in (panel.L, panel.M):
            total = arb(0)
            for a in reversed(panel.taylor(function)):
                total = total * t + a
            values.append(total)
        found = (values[0], values[1]) if found is None else (found[0].union(values[0]), found[1].union(values[1]))
    if found is None:
        raise NotEnclosedError("share")
    return found


@dataclass(frozen=True)
class PerturbedSteps:
    """Steps of re-anchored transitions that do not look ahead.

    Attributes:
        orbit: the periodic orbit.
        tapers: of the continuation beyond the planned reversal.
        rejoining: how an early falling phase rejoins its path.
        bounds: limits of contact and motors, C04 to C08 without the reserves of a plan.
        reserve: when those that look ahead are no others.
    """

    orbit: BallOrbit
    tapers: Tapers
    rejoining: Rejoining
    bounds: Sequence[Bound]
    reserve: Reserve

    # ------------------------------------------------------------------ late
    def late(self, beyond: float) -> tuple[Ball, Paths]:
        """The energy of the latest reversal [kg^2 m^4/s^2], and what is bounded on all motions that are not faster.

        Args:
            beyond: where, past the planned one [rad]; 0: nowhere later.

        Raises:
            NotEnclosedError: as `PathPiece.of`.
        """
        up, down = self.orbit.rising, self.orbit.falling
        more, pieces = arb(0), []
        if beyond > 0.0:
            piece = PathPiece.of(LatePath.of(self._mismatch.rising, self.tapers, beyond), at_rest=True)
            more = piece.L.exp() * piece.M * arb(beyond)
            pieces = [piece.rows]
        return more, {"rising": [on_planned(up, more), *pieces], "falling": [on_planned(down, more), *pieces]}

    # ------------------------------------------------------------------ early
    def early(self, nearest: float, farthest: float) -> Rejoined:
        """All reversals between two.

        Args:
            nearest: to the planned reversal, before it [rad].
            farthest: from it [rad].

        Raises:
            NotEnclosedError: as `rejoined`, or it is not known which c is chosen.
        """
        return self.rejoined(self.chosen(arb(nearest).union(arb(farthest))))

    def rejoined(self, path: EarlyPath) -> Rejoined:
        """All reversals of a path.

        Raises:
            NotEnclosedError: as `PathPiece.of`.
        """
        up, down, c = self.orbit.rising, self.orbit.falling, path.c
        piece = PathPiece.of(path, at_rest=False, deepest=SHORT)
        _, M_r = at_share(up, path.d / up.path.span)
        L_f, M_f = at_share(down, path.share(arb(1)))
        q = ((1 + arb(c)) * M_f - arb(c) * (piece.L - L_f).exp() * piece.M) / M_r
        return Rejoined(q, {"falling": [piece.rows]}, c)

    def early_speed(self, d: float) -> Ball:
        """The speed after the impact that reverses so early [rad], relative to the orbit's."""
        orbit = self.orbit.rising
        _, M = at_share(orbit, arb(d) / orbit.path.span)
        return (1 - M * arb(d) / orbit.energy).sqrt()

    @cached_property
    def _mismatch(self) -> Mismatch:
        return Mismatch.of(self.orbit.step, self.orbit.rising.path.sole)

    def chosen(self, d: Ball) -> EarlyPath:
        """The path that the transitions choose for all reversals so early.

        Raises:
            NotEnclosedError: it is not known which, or it ends in the impact.
        """
        low, high = self._enough_inertia
        for c in self.rejoining.c:
            path = EarlyPath.of(self._mismatch, d, c)
            seen = [self._inertia(path, k) for k in range(self.rejoining.looks)]
            if all(is_positive(I_P - high) for I_P in seen):
                return path
            if not any(is_negative(I_P - low) for I_P in seen):
                break
        raise NotEnclosedError("how the path is rejoined")

    def _inertia(self, path: EarlyPath, look: int) -> Ball:
        """I_P at one of the points at which the transitions look [kg m^2]."""
        falling, d = path.falling, path.d
        way = (falling.span - d) * arb(look) / (self.rejoining.looks - 1)
        found = []
        if not way > path.span:
            y = arb(0) if look == 0 else (way / path.span).intersection(arb(0).union(1))
            found.append(path.at(y).I_P)
        if not way < path.span:
            found.append(falling.at((d + way) / falling.span).I_P)
        return found[0] if len(found) == 1 else found[0].union(found[1])

    @cached_property
    def _enough_inertia(self) -> Enclosed:
        """What is enough I_P [kg m^2]."""
        falling, last = self.orbit.falling.path, self.rejoining.looks - 1
        seen = [falling.at(arb(k) / last).I_P * arb(self.rejoining.enough) for k in range(last + 1)]
        return Enclosed(min(I_P.lower() for I_P in seen), min(I_P.upper() for I_P in seen))

    # ------------------------------------------------------------------ limits
    def limits(self, paths: Paths, bounds: Sequence[Bound]) -> list[ProvedLimit]:
        """What is kept along paths of both phases, and at the impact.

        Args:
            paths: of `late`.
            bounds: what is asked; a lower one other than 0 on C05, or on what grows with the speed of the impact, is
                told of late reversals only.
        """
        return [
            _limit(bound, paths) if _phase(bound) in paths else ProvedLimit(bound, self._at_impact(bound))
            for bound in bounds
        ]

    def limits_along(self, paths: Paths, bounds: Sequence[Bound]) -> list[ProvedLimit]:
        """What is kept along the paths of `early`."""
        return [_limit(bound, paths) for bound in bounds if _phase(bound) in paths]

    def _at_impact(self, bound: Bound) -> Ball:
        """The margin at the impact of the orbit, where its sign is the same at every speed."""
        proportional = bound.name not in ("L_h / L_v", "impulse in the sole", "both sole ends on the ground at impact")
        found = self.orbit.enclosed(bound)
        if found is None or (proportional and not _is_least(bound)):
            return arb.nan()
        return found.low.union(found.high)


def _phase(bound: Bound) -> str:
    return bound.name.rpartition(", ")[2]


def _is_least(bound: Bound) -> bool:
    """Is it a lower one, not below 0, alone?"""
    return bound.upper is None and bound.lower is not None and bound.lower >= 0.0


def _limit(bound: Bound, paths: Paths) -> ProvedLimit:
    row, _, phase = bound.name.rpartition(", ")
    lows = []
    for rows in paths[phase]:
        found = [rows[name] for name in (row, row + AT_REST) if name in rows]
        # off the planned path the height itself stands for C05: the share of the way by which it is divided is below 1
        if not found or (row == HEIGHT and not _is_least(bound)):
            return ProvedLimit(bound, arb.nan())
        for panels in found:
            if bound.lower is not None:
                lows.append(least(panels, ACCURACY).low - arb(bound.lower))
            if bound.upper is not None:
                negative = ([-a for a in panel] for panel in panels)
                lows.append(least(negative, ACCURACY).low + arb(bound.upper))
    # what is not kept at the bounds of all motions may be kept on those that there are
    worst = min(low.lower() for low in lows)
    return ProvedLimit(bound, worst if worst >= 0 else arb.nan())
