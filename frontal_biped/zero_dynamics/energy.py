r"""The energy of the zero dynamics along one phase from a given start, for all energies at once.

With Gamma = int 2 kappa_3/kappa_1 and R = -int e^{-Gamma} kappa_2/kappa_1, both from the start of the phase,

.. math:: \zeta(\beta) = e^{\Gamma(\beta)} (\zeta^+ - R(\beta)).

R depends on the path alone. It is integrated from Chebyshev interpolants on panels that end where the virtual
constraints change form. A rising robot reverses where R reaches zeta+.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from scipy.optimize import brentq

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import ReversalError
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.numerics.chebyshev_series import PLACES, Series, integral
from frontal_biped.virtual_constraints.contract import VirtualConstraints
from frontal_biped.virtual_constraints.phase import ConstrainedMotion
from frontal_biped.zero_dynamics.restricted import ProjectedDynamics, RestrictedDynamics, on_constraints, restrict

LARGEST_EXPONENT = 200.0
"""Bound on the change of Gamma over a panel; a gait's is below 1."""

BARRIER = "the centre of mass is over the FRI there, the energy barrier"


@dataclass(frozen=True)
class Panel:
    """One piece of a phase, beta from ``start`` to ``end`` in the sense of the motion.

    Attributes:
        start: beta where it begins [rad].
        end: beta where it ends [rad].
        motion: the virtual constraints at its Chebyshev points, in the order of the motion.
        restricted: the scalar dynamics there.
        growth: Gamma over [start, end].
        spent: R over [start, end] [kg^2 m^4/s^2].
        spent_at: (n,) R at the Chebyshev points, in the order of the motion [kg^2 m^4/s^2].
    """

    start: float
    end: float
    motion: ConstrainedMotion
    restricted: RestrictedDynamics
    growth: Series
    spent: Series
    spent_at: FloatArray

    @cached_property
    def gained(self) -> FloatArray:
        """(n,) exp(Gamma) at the Chebyshev points [-]."""
        return np.exp(self.growth.at_places(self.end - self.start))

    def left(self, zeta: float) -> FloatArray:
        """(n,) what is left of zeta at the start of the phase [kg^2 m^4/s^2]; negative past a reversal."""
        return self.gained * (zeta - self.spent_at)

    def forces(self, left: FloatArray) -> FloatArray:
        """(7, n) rows F_h, F_v [N], N_0, u_1..u_4 [N m] where zeta is ``left`` (n,) [kg^2 m^4/s^2]."""
        return self.restricted.forces(2.0 * np.maximum(left, 0.0) / self.restricted.I_P**2)


@dataclass(frozen=True)
class PhaseEnergy:
    """Gamma and R of one phase.

    Attributes:
        panels: in the order of the motion.
        complete: was the asked end reached?
        reaches_barrier: did it stop at the top of the energy barrier?
        why: what stopped it otherwise.
    """

    panels: tuple[Panel, ...]
    complete: bool
    reaches_barrier: bool
    why: str

    @property
    def start_inertia(self) -> float:
        """I_P where the phase begins [kg m^2]."""
        return float(self.panels[0].restricted.I_P[0])

    @property
    def end(self) -> float:
        """Beta where the panels end [rad]."""
        return self.panels[-1].end

    @cached_property
    def highest(self) -> float:
        """Largest R, the energy barrier as far as it was followed [kg^2 m^4/s^2]."""
        return max(panel.spent_at.item(-1) for panel in self.panels)

    def at(self, beta: float) -> tuple[float, float]:
        """Gamma and R at beta."""
        for panel in self.panels:
            low, high = sorted((panel.start, panel.end))
            if low <= beta <= high:
                return panel.growth.at(beta), panel.spent.at(beta)
        raise ReversalError(f"beta = {beta:.6g} rad is outside the phase")

    def shifted(self, shift: float) -> "PhaseEnergy":
        """The same path with its FRI target moved by a constant [m]; no dynamics is evaluated anew.

        Raises:
            ReversalError: I_P is not positive somewhere.
        """
        panels: list[Panel] = []
        gamma = energy = 0.0
        for panel in self.panels:
            old = panel.restricted
            restricted = RestrictedDynamics(old.projected, old.p_fri + shift, old.dp_fri)
            if np.any(restricted.I_P <= 0.0):
                raise ReversalError("I_P vanishes there")
            new = _panel(panel.start, panel.end, panel.motion, restricted, gamma, energy)
            if new is None:
                raise ReversalError("I_P all but vanishes there")
            panels.append(new)
            gamma, energy = new.growth.at(panel.end), new.spent_at.item(-1)
        return PhaseEnergy(tuple(panels), self.complete, self.reaches_barrier, self.why)

    def reversal(self, dbeta: float) -> float:
        """Where a rising phase begun with dbeta [rad/s] reverses [rad].

        Raises:
            ReversalError: it does not rise, or not reverse where R is defined.
        """
        if dbeta <= 0.0:
            raise ReversalError("the robot does not rise after the impact")
        zeta = 0.5 * (self.start_inertia * dbeta) ** 2
        for panel in self.panels:
            if panel.spent_at.item(-1) >= zeta:

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

    Raises:
        ReversalError: I_P is not positive at the start.
    """
    sense = 1.0 if end > start else -1.0
    inner = sorted(
        {b for b in breaks if min(start, end) + 1e-13 < b < max(start, end) - 1e-13}, key=lambda b: sense * b
    )
    edges = [start, *inner, end]
    panels: list[Panel] = []
    gamma = energy = 0.0
    # where nothing stops it the phase goes through all panels, one that rises through those up to its planned end
    together = sum(sense * edge < sense * phase.beta_end for edge in edges[:-1]) if to_barrier else len(edges) - 1
    for (a, b), (motion, restricted) in zip(pairwise(edges), _samples(biped, phase, edges, together), strict=False):
        bad = restricted.I_P <= 0.0
        over = restricted.drive >= 0.0 if to_barrier else np.zeros_like(bad)
        why = "I_P vanishes there" if np.any(bad) else BARRIER
        if np.any(bad | over):
            reached = _last_good(biped, phase, a, b, to_barrier)
            if abs(reached - a) < 1e-9:
                return _finish(panels, why)
            motion, restricted = _sample(biped, phase, a, reached)
            if np.any(restricted.I_P <= 0.0):
                return _finish(panels, why)
        else:
            reached = b
        panel = _panel(a, reached, motion, restricted, gamma, energy)
        if panel is None:  # I_P is so small that the exponential overflows
            return _finish(panels, why)
        panels.append(panel)
        gamma, energy = panel.growth.at(reached), panel.spent_at.item(-1)
        if reached != b:
            return _finish(panels, why)
        if energy >= 0.5 * (panels[0].restricted.I_P[0] * dbeta) ** 2:
            break
    return PhaseEnergy(tuple(panels), panels[-1].end == end, False, "that is as far as was looked")


def _panel(
    start: float, end: float, motion: ConstrainedMotion, restricted: RestrictedDynamics, gamma: float, energy: float
) -> Panel | None:
    """A panel that goes on from Gamma and R so far; None where they overflow."""
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        rate = restricted.rate
        if not np.all(np.isfinite(rate)) or np.max(np.abs(rate)) * abs(end - start) > LARGEST_EXPONENT:
            return None
        growth = integral(rate, start, end) + gamma
        weighted = np.exp(-growth.at_places(end - start)) * restricted.drive
        if not np.all(np.isfinite(weighted)):
            return None
        spent = -integral(weighted, start, end) + energy
    return Panel(start, end, motion, restricted, growth, spent, spent.at_places(end - start))


def _finish(panels: list[Panel], why: str) -> PhaseEnergy:
    if not panels:
        raise ReversalError("I_P is not positive, or the centre of mass is over the FRI, where the phase begins")
    return PhaseEnergy(tuple(panels), False, why == BARRIER, why)


def _samples(
    biped: FrontalBiped, phase: VirtualConstraints, edges: Sequence[float], together: int
) -> Iterator[tuple[ConstrainedMotion, RestrictedDynamics]]:
    """Panel after panel between edges, the first of them evaluated together."""
    if together > 1:
        beta = np.concatenate([_places(a, b) for a, b in pairwise(edges[: together + 1])])
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            motion, restricted = on_constraints(biped, phase, beta)
        for begin in range(0, len(beta), len(PLACES)):
            part = slice(begin, begin + len(PLACES))
            own = ProjectedDynamics(*(rows[:, part] for rows in restricted.projected))
            yield (
                ConstrainedMotion(*(values[part] for values in motion)),
                RestrictedDynamics(own, restricted.p_fri[part], restricted.dp_fri[part]),
            )
        edges = edges[together:]
    for a, b in pairwise(edges):
        yield _sample(biped, phase, a, b)


def _sample(
    biped: FrontalBiped, phase: VirtualConstraints, a: float, b: float
) -> tuple[ConstrainedMotion, RestrictedDynamics]:
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        return on_constraints(biped, phase, _places(a, b))


def _places(a: float, b: float) -> FloatArray:
    """Chebyshev points of a panel from a to b, its ends a hair inside, so that a break belongs to it."""
    beta: FloatArray = 0.5 * (a + b) + 0.5 * (b - a) * PLACES
    beta[0], beta[-1] = a + 1e-12 * (b - a), b - 1e-12 * (b - a)
    return beta


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
