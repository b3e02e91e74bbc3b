r"""The energy of the zero dynamics along one phase from a given start, for all energies at once.

With Gamma = int 2 kappa_3/kappa_1 and R = -int e^{-Gamma} kappa_2/kappa_1, both from the start of the phase,

.. math:: \zeta(\beta) = e^{\Gamma(\beta)} (\zeta^+ - R(\beta)).

R depends on the path alone. It is integrated from Chebyshev interpolants on panels that end where the virtual
constraints change form. A rising robot reverses where R reaches zeta+.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import ReversalError
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.numerics.chebyshev_series import PLACES, Series, at_places, integrals
from frontal_biped.virtual_constraints.contract import VirtualConstraints
from frontal_biped.virtual_constraints.phase import ConstrainedMotion
from frontal_biped.zero_dynamics.restricted import ProjectedDynamics, RestrictedDynamics, on_constraints, restrict

Kind = TypeVar("Kind", np.float64, np.bool_)

LARGEST_EXPONENT = 200.0
"""Bound on the change of Gamma over a panel; a gait's is below 1."""

BARRIER = "the centre of mass is over the FRI there, the energy barrier"

_SHARES = 0.5 + 0.5 * PLACES
_SHARES[[0, -1]] = 1e-12, 1.0 - 1e-12


@dataclass(frozen=True)
class Panel:
    """One piece of a phase, beta from ``start`` to ``end`` in the sense of the motion.

    Attributes:
        start: beta where it begins [rad].
        end: beta where it ends [rad].
        growth: Gamma over [start, end].
        spent: R over [start, end] [kg^2 m^4/s^2].
    """

    start: float
    end: float
    growth: Series
    spent: Series


class Integrals(NamedTuple):
    """Gamma and R on panels that follow one another.

    Attributes:
        growth: (p, DEGREE + 2) Chebyshev series of Gamma.
        spent: (p, DEGREE + 2) of R [kg^2 m^4/s^2].
        growth_at: (p, DEGREE + 1) Gamma at the Chebyshev points, in the order of the motion.
        spent_at: (p, DEGREE + 1) R there [kg^2 m^4/s^2].
    """

    growth: FloatArray
    spent: FloatArray
    growth_at: FloatArray
    spent_at: FloatArray


@dataclass(frozen=True)
class PhaseEnergy:
    """Gamma and R of one phase, on p panels in the order of the motion.

    Attributes:
        edges: (p + 1,) beta where the panels end [rad].
        motion: the virtual constraints at the Chebyshev points of the panels, (p (DEGREE + 1), ..).
        restricted: the scalar dynamics there.
        integrals: Gamma and R.
        complete: was the asked end reached?
        reaches_barrier: did it stop at the top of the energy barrier?
        why: what stopped it otherwise.
    """

    edges: list[float]
    motion: ConstrainedMotion
    restricted: RestrictedDynamics
    integrals: Integrals
    complete: bool
    reaches_barrier: bool
    why: str

    @property
    def start(self) -> float:
        """Beta where the phase begins [rad]."""
        return self.edges[0]

    @property
    def end(self) -> float:
        """Beta where the panels end [rad]."""
        return self.edges[-1]

    @property
    def start_inertia(self) -> float:
        """I_P where the phase begins [kg m^2]."""
        return self.restricted.I_P.item(0)

    @property
    def highest(self) -> float:
        """Largest R, the energy barrier as far as it was followed [kg^2 m^4/s^2]."""
        return self.integrals.spent_at[:, -1].max().item()

    @property
    def spent(self) -> float:
        """R at the end [kg^2 m^4/s^2]."""
        return self.integrals.spent_at.item(-1)

    @cached_property
    def gained(self) -> FloatArray:
        """(n,) exp(Gamma) at the Chebyshev points [-]."""
        return np.exp(self.integrals.growth_at.ravel())

    def left(self, zeta: float) -> FloatArray:
        """(n,) what is left of zeta at the start of the phase [kg^2 m^4/s^2]; negative past a reversal."""
        return self.gained * (zeta - self.integrals.spent_at.ravel())

    def forces(self, left: FloatArray) -> FloatArray:
        """(7, n) rows F_h, F_v [N], N_0, u_1..u_4 [N m] where zeta is ``left`` (n,) [kg^2 m^4/s^2]."""
        return self.restricted.forces(2.0 * np.maximum(left, 0.0) / self.restricted.I_P**2)

    @property
    def panels(self) -> tuple[Panel, ...]:
        """In the order of the motion."""
        return tuple(self._panel(k) for k in range(len(self.edges) - 1))

    def _panel(self, k: int) -> Panel:
        start, end = self.edges[k : k + 2]
        on = 0.5 * (start + end), 0.5 * abs(end - start)
        return Panel(start, end, Series(self.integrals.growth[k], *on), Series(self.integrals.spent[k], *on))

    def at(self, beta: float) -> tuple[float, float]:
        """Gamma and R at beta."""
        for k, ends in enumerate(pairwise(self.edges)):
            if min(ends) <= beta <= max(ends):
                panel = self._panel(k)
                return panel.growth.at(beta), panel.spent.at(beta)
        raise ReversalError(f"beta = {beta:.6g} rad is outside the phase")

    def shifted(self, shift: float) -> "PhaseEnergy":
        """The same path with its FRI target moved by a constant [m]; no dynamics is evaluated anew.

        Raises:
            ReversalError: I_P is not positive somewhere.
        """
        old = self.restricted
        restricted = RestrictedDynamics(old.projected, old.p_fri + shift, old.dp_fri)
        if not restricted.I_P.min() > 0.0:
            raise ReversalError("I_P vanishes there")
        moved = _integrals(self.edges, restricted)
        if len(moved.spent) + 1 < len(self.edges):
            raise ReversalError("I_P all but vanishes there")
        return replace(self, restricted=restricted, integrals=moved)

    def reversal(self, dbeta: float) -> float:
        """Where a rising phase begun with dbeta [rad/s] reverses [rad].

        Raises:
            ReversalError: it does not rise, or not reverse where R is defined.
        """
        if dbeta <= 0.0:
            raise ReversalError("the robot does not rise after the impact")
        zeta = 0.5 * (self.start_inertia * dbeta) ** 2
        for k, spent in enumerate(self.integrals.spent_at[:, -1].tolist()):
            if spent >= zeta:
                panel = self._panel(k)

                def left(x: float, panel: Panel = panel) -> float:
                    return panel.spent.at(x) - zeta

                if left(panel.start) >= 0.0:
                    return panel.start
                return float(brentq(left, panel.start, panel.end, xtol=1e-15, rtol=8.9e-16))
        raise ReversalError(f"no reversal before beta = {self.end:.5f} rad: {self.why}")

    def speed(self, beta: float) -> float:
        """The speed at the start that reverses at beta [rad/s], inverse of `reversal`."""
        return float(np.sqrt(2.0 * max(self.at(beta)[1], 0.0)) / self.start_inertia)


def phase_energy(
    biped: FrontalBiped,
    phase: VirtualConstraints,
    start: float,
    end: float,
    breaks: Sequence[float] = (),
    to_barrier: bool = False,
    dbeta: float = np.inf,
    whole: bool = False,
) -> PhaseEnergy:
    """Integrate Gamma and R of a phase from ``start`` to ``end``.

    Args:
        biped: the robot.
        phase: virtual constraints.
        start: beta at the start [rad].
        end: beta at the end [rad].
        breaks: beta at which panels end besides [rad].
        to_barrier: stop where the drive vanishes: the top of the energy barrier.
        dbeta: speed at the start [rad/s]; the panel on which it reverses is the last one.
        whole: is less than all of it of no use? Then how far it goes is not looked for.

    Raises:
        ReversalError: I_P is not positive at the start, or, where the whole is asked for, anywhere.
    """
    sense = 1.0 if end > start else -1.0
    inner = sorted(
        {b for b in breaks if min(start, end) + 1e-13 < b < max(start, end) - 1e-13}, key=lambda b: sense * b
    )
    edges = [start, *inner, end]
    # where nothing stops it a phase goes through all panels, one that rises through those up to its planned end
    together = sum(sense * edge < sense * phase.beta_end for edge in edges[:-1]) if to_barrier else len(edges) - 1
    groups = [edges[a : b + 1] for a, b in pairwise(sorted({0, together, len(edges) - 1}))]
    why, pieces = "", list[_Piece]()
    for piece, why in _pieces(biped, phase, groups, to_barrier, whole):
        if piece is not None:
            pieces.append(piece)
            enough = piece.integrals.spent_at[:, -1] >= 0.5 * (pieces[0].restricted.I_P[0] * dbeta) ** 2
            if not why and enough.any():
                pieces[-1] = piece.first(int(enough.argmax()) + 1)
                break
    if whole and why:
        raise ReversalError(why)
    if not pieces:
        raise ReversalError("I_P is not positive, or the centre of mass is over the FRI, where the phase begins")
    joined = _joined(pieces)
    complete = not why and joined.edges[-1] == end
    return PhaseEnergy(*joined, complete, why == BARRIER, why or "that is as far as was looked")


class _Piece(NamedTuple):
    """Panels that follow one another: fields as of `PhaseEnergy`."""

    edges: list[float]
    motion: ConstrainedMotion
    restricted: RestrictedDynamics
    integrals: Integrals

    def first(self, count: int) -> "_Piece":
        """The first panels."""
        integrals = Integrals(*(rows[:count] for rows in self.integrals))
        return _Piece(self.edges[: count + 1], *_first(count, self.motion, self.restricted), integrals)


def _joined(pieces: list[_Piece]) -> _Piece:
    if len(pieces) == 1:
        return pieces[0]
    edges = [pieces[0].edges[0], *(edge for piece in pieces for edge in piece.edges[1:])]
    motion = ConstrainedMotion(*map(np.concatenate, zip(*(piece.motion for piece in pieces), strict=True)))
    parts = [piece.restricted.projected for piece in pieces]
    projected = ProjectedDynamics(*(np.concatenate(part, axis=1) for part in zip(*parts, strict=True)))
    integrals = Integrals(*map(np.concatenate, zip(*(piece.integrals for piece in pieces), strict=True)))
    return _Piece(edges, motion, RestrictedDynamics(projected, motion.p_fri, motion.dp_fri), integrals)


def _first(
    count: int, motion: ConstrainedMotion, restricted: RestrictedDynamics
) -> tuple[ConstrainedMotion, RestrictedDynamics]:
    """At the points of the first panels."""
    some = slice(count * len(PLACES))
    projected = ProjectedDynamics(*(rows[:, some] for rows in restricted.projected))
    return (
        ConstrainedMotion(*(values[some] for values in motion)),
        RestrictedDynamics(projected, restricted.p_fri[some], restricted.dp_fri[some]),
    )


def _pieces(
    biped: FrontalBiped, phase: VirtualConstraints, groups: Sequence[list[float]], to_barrier: bool, whole: bool
) -> Iterator[tuple[_Piece | None, str]]:
    """Panels between edges, group after group, each evaluated together; and why it ends there, if that is early.

    Of a group that ends early there are no panels where the whole is asked for.
    """
    before: Integrals | None = None
    for edges in groups:
        motion, restricted = _sample(biped, phase, edges)
        bad = restricted.I_P <= 0.0
        over = bad | (restricted.drive >= 0.0) if to_barrier else bad
        free = _panelwise(over).any(axis=1).argmax().item() if over.any() else len(edges) - 1
        why = "I_P vanishes there" if over.any() and _panelwise(bad)[free].any() else BARRIER
        if whole and free < len(edges) - 1:
            yield None, why
            return
        if free:
            piece = _piece(edges[: free + 1], motion, restricted, before)
            yield piece, ""
            if piece is None or len(piece.edges) <= free:  # I_P is so small that the exponential overflows
                yield None, BARRIER
                return
            before = piece.integrals
        if free < len(edges) - 1:
            begin = edges[free]
            reached = _last_good(biped, phase, begin, edges[free + 1], to_barrier)
            last = None
            if abs(reached - begin) >= 1e-9:
                motion, restricted = _sample(biped, phase, [begin, reached])
                if not np.any(restricted.I_P <= 0.0):
                    last = _piece([begin, reached], motion, restricted, before)
            yield last, why
            return


def _piece(
    edges: list[float], motion: ConstrainedMotion, restricted: RestrictedDynamics, before: Integrals | None
) -> _Piece | None:
    """Panels between edges, given at their points and perhaps further ones; as many as do not overflow."""
    integrals = _integrals(edges, restricted, before)
    count = len(integrals.spent)
    if not count:
        return None
    if len(restricted.p_fri) > count * len(PLACES):
        motion, restricted = _first(count, motion, restricted)
    return _Piece(edges[: count + 1], motion, restricted, integrals)


def _integrals(edges: list[float], restricted: RestrictedDynamics, before: Integrals | None = None) -> Integrals:
    """Gamma and R on panels that go on from others; on the first of them only where they overflow."""
    count = len(edges) - 1
    lengths = np.abs(np.diff(edges))[:, None]
    half, upwards = 0.5 * lengths, edges[-1] > edges[0]
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        rate, drive = (_panelwise(values)[:count] for values in (restricted.rate, restricted.drive))
        growth = integrals(rate, upwards)
        growth *= half
        growth_at = _follow(growth, upwards, None if before is None else before.growth_at)
        weighted = np.exp(-growth_at) * drive
        fine = (np.abs(rate) * lengths <= LARGEST_EXPONENT) & np.isfinite(weighted)
        spent = integrals(weighted, upwards)
        spent *= -half
        spent_at = _follow(spent, upwards, None if before is None else before.spent_at)
    found = Integrals(growth, spent, growth_at, spent_at)
    return found if fine.all() else Integrals(*(rows[: fine.all(axis=1).argmin()] for rows in found))


def _follow(series: FloatArray, upwards: bool, before: FloatArray | None) -> FloatArray:
    """Let each integral begin where the last one ended; their values."""
    values = at_places(series, upwards)
    begin = np.cumsum(values[:, -1])
    begin -= values[:, -1]
    if before is not None:
        begin += before[-1, -1]
    series[:, 0] += begin
    values += begin[:, None]
    return values


def _panelwise(values: npt.NDArray[Kind]) -> npt.NDArray[Kind]:
    """(p, DEGREE + 1) values along a phase (n,)."""
    return values.reshape(-1, len(PLACES))


def _sample(
    biped: FrontalBiped, phase: VirtualConstraints, edges: list[float]
) -> tuple[ConstrainedMotion, RestrictedDynamics]:
    """The phase at the points of panels between edges, their ends a hair inside: a break belongs to its panel."""
    ends = np.array(edges)
    start, length = ends[:-1, None], np.diff(ends)[:, None]
    beta = start + length * _SHARES
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        return on_constraints(biped, phase, beta.ravel())


def _last_good(biped: FrontalBiped, phase: VirtualConstraints, a: float, b: float, to_barrier: bool) -> float:
    """How far from a towards b the zero dynamics is defined, and the drive negative where asked."""
    good, bad = a, b
    for _ in range(4):
        grid = np.linspace(good, bad, 9)
        restricted = restrict(biped, phase, grid)
        ok = restricted.I_P > 0.0
        if to_barrier:
            ok &= restricted.drive < 0.0
        first = int(np.argmin(ok)) if not np.all(ok) else len(grid) - 1
        if first == 0:
            return good
        good, bad = float(grid[first - 1]), float(grid[first])
    return good
