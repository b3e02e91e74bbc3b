"""Every zero of Z on the regular region of the bracket; what that region is: `reversal.certificate`."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq

from frontal_biped.exceptions import ReversalError
from frontal_biped.numerics.chebyshev import Fit, Zero, fit, zeros
from frontal_biped.numerics.verdict import Verdict
from frontal_biped.zero_dynamics.reversal.problem import (
    BalancedProblem,
    BalanceFunction,
    EnergyBalance,
    ReversalProblem,
)

REGULAR = 0.02
"""Share of the smallest I_P of the gait's own step below which a step counts as outside the region."""

TURNING_BACK = 1e-3
"""Share of the drive at the gait's own reversal that counts as turning back."""

FIT_TOLERANCE = 1e-9
"""Measured error of a Chebyshev piece, relative to the largest value on it."""

ENERGY_SCALE = 1e-2
"""E is a difference of energies; errors below `FIT_TOLERANCE` times this share of them are rounding."""

CLOSER_EVALUATIONS = 400
"""Most evaluations that a second look at one undecided part may take."""

REGION_POINTS = 96
"""Points at which the bracket is searched for the region; its edges are then found by bisection."""


@dataclass(frozen=True)
class ZeroCount:
    """All zeros of one function on the regular region.

    Attributes:
        region: intervals on which the function was interpolated [rad].
        zeros: simple zeros, each enclosed [rad].
        undecided: parts on which neither absence nor uniqueness could be shown [rad]: near-double zeros, and a zero
            within the error of an end of the region.
        error: largest bound on the interpolation error, quadrature included [kg^2 m^4/s^2].
        quadrature_error: its share from the quadrature, by doubling the nodes [kg^2 m^4/s^2].
        evaluations: of the function.
    """

    region: tuple[tuple[float, float], ...]
    zeros: tuple[Zero, ...]
    undecided: tuple[tuple[float, float], ...]
    error: float
    quadrature_error: float
    evaluations: int

    @property
    def existence(self) -> Verdict:
        """Is there a zero?"""
        if self.zeros:
            return Verdict.CERTIFIED
        return Verdict.UNDECIDED if self.undecided or not self.region else Verdict.REFUTED

    @property
    def uniqueness(self) -> Verdict:
        """Is there at most one zero?"""
        if len(self.zeros) > 1:
            return Verdict.REFUTED
        return Verdict.UNDECIDED if self.undecided or not self.region else Verdict.CERTIFIED

    def with_zero(self, zero: Zero) -> "ZeroCount":
        """The count, told of a zero that was enclosed by other means: among those found, or else in an open part."""
        if any(
            near.enclosure[0] <= zero.enclosure[1] and zero.enclosure[0] <= near.enclosure[1] for near in self.zeros
        ):
            return self
        return replace(self, zeros=tuple(sorted((*self.zeros, zero), key=lambda found: found.place)))


def count_gaits(problem: ReversalProblem) -> ZeroCount:
    """All reversal points with invariance imposed, whether or not the planned one is among them.

    Raises:
        ReversalError: the bracket does not exist.
    """
    low, high = problem.bracket

    def imposed(beta: float, nodes: int) -> EnergyBalance:
        return ReversalProblem(problem.biped, problem.free, nodes).balance(beta)

    inertia = problem.balance(problem.planned).least_inertia
    return count_zeros(imposed, low, high, problem, REGULAR * max(inertia, 1.0))[0]


def count_zeros(
    function: BalanceFunction, low: float, high: float, problem: BalancedProblem, floor: float, connected: bool = False
) -> tuple[ZeroCount, list[Fit], dict[float, EnergyBalance]]:
    """Count the zeros of E on the regular region.

    Args:
        function: E at a beta [rad] with a number of quadrature nodes.
        low: lower end of the bracket [rad].
        high: upper end [rad].
        problem: the parameters.
        floor: smallest I_P of the region [kg m^2].
        connected: only the interval that contains the planned reversal?

    Returns:
        The count, the interpolants it rests on, and E where it was evaluated.
    """
    points: dict[float, EnergyBalance] = {}

    def balance(beta: float) -> EnergyBalance:
        if beta not in points:
            points[beta] = function(beta, problem.nodes)
        return points[beta]

    scale = ENERGY_SCALE * abs(problem.balance(problem.planned).required)
    region = _regular_region(_margin(balance, problem, floor), low, high, problem, connected)
    fits: list[Fit] = []
    found: list[Zero] = []
    undecided: list[tuple[float, float]] = []
    worst = 0.0

    def look(a: float, b: float, **effort: int) -> tuple[list[Fit], list[tuple[float, float]]]:
        nonlocal worst
        pieces, failed = fit(lambda beta: balance(beta).surplus, a, b, FIT_TOLERANCE, scale, **effort)
        usable = []
        for piece in pieces:
            c, d = piece.interval
            # more nodes at the ends and the middle of the piece: the quadrature's own error
            finer = [(function(x, 2 * problem.nodes), balance(x)) for x in (c, 0.5 * (c + d), d)]
            if not min(fine.least_inertia for fine, _ in finer) >= 0.5 * floor:
                failed.append((c, d))  # the nodes jump over a zero of I_P
                continue
            quadrature = max(abs(fine.surplus - coarse.surplus) for fine, coarse in finer)
            worst = max(worst, quadrature)
            usable.append(piece.widened(quadrature))
        return usable, failed

    for a, b in region:
        pieces, failed = look(a, b)
        fits += pieces
        undecided += failed
        new, open_parts = zeros(pieces)
        found += new
        for c, d in open_parts:
            # near a double zero E is small, and so is the error of an interpolant of that neighbourhood alone
            closer, failed = look(
                max(a, 1.5 * c - 0.5 * d), min(b, 1.5 * d - 0.5 * c), max_evaluations=CLOSER_EVALUATIONS
            )
            again, still_open = zeros(closer)
            found += _others(again, found)
            undecided += [*failed, *still_open]
    error = max((piece.error for piece in fits), default=float("nan"))
    found.sort(key=lambda zero: zero.place)
    return ZeroCount(tuple(region), tuple(found), tuple(undecided), error, worst, len(points)), fits, points


def regular_region(problem: ReversalProblem) -> tuple[float, float]:
    """The interval around the planned reversal on which Z at fixed parameters is regular [rad].

    Raises:
        ReversalError: the bracket does not exist, or no step exists at the planned reversal.
    """
    own, fixed = problem.balance(problem.planned), problem.at_fixed_parameters()
    if not np.isfinite(own.surplus):
        raise ReversalError(f"no step of the zero dynamics reverses at the planned {problem.planned:.6g} rad")
    margin = _margin(lambda beta: fixed(beta, problem.nodes), problem, REGULAR * own.least_inertia)
    return _regular_region(margin, *problem.bracket, problem, connected=True)[0]


def imposed_regions(problem: ReversalProblem) -> tuple[tuple[float, float], ...]:
    """Intervals on which Z with invariance imposed is regular [rad], those of the measured certificate.

    Raises:
        ReversalError: the bracket does not exist.
    """
    floor = REGULAR * problem.balance(problem.planned).least_inertia
    return tuple(_regular_region(_margin(problem.balance, problem, floor), *problem.bracket, problem))


def _margin(
    balance: Callable[[float], EnergyBalance], problem: BalancedProblem, floor: float
) -> Callable[[float], float]:
    """By beta [rad], positive on the regular region: I_P above its floor, and a drive that turns the robot back."""
    own_drive = abs(problem.balance(problem.planned).drive)

    def margin(beta: float) -> float:
        point = balance(beta)
        turning_back = -point.drive / own_drive - TURNING_BACK
        return min(point.least_inertia / floor - 1.0, turning_back) if point.least_inertia > 0.0 else -1.0

    return margin


def _others(zeros_: list[Zero], known: list[Zero]) -> list[Zero]:
    """Those of some zeros that are not among the known ones."""
    return [zero for zero in zeros_ if not any(near.enclosure[0] <= zero.place <= near.enclosure[1] for near in known)]


def _regular_region(
    margin: Callable[[float], float], low: float, high: float, problem: BalancedProblem, connected: bool = False
) -> list[tuple[float, float]]:
    """Intervals of the bracket on which the margin is not negative; its ends are left out by a hair.

    Where only the one around the planned reversal is asked for, nothing beyond it is looked at.
    """
    steps = np.linspace(0.0, 1.0, REGION_POINTS + 2)[1:-1]
    reach = 3.0 * problem.length
    grid = np.unique(
        np.concatenate([low + (high - low) * steps, low + reach * steps, [problem.planned, high - 1e-6 * (high - low)]])
    )
    grid = grid[(grid > low) & (grid < high)]
    if connected:
        first = last = int(np.searchsorted(grid, problem.planned))
        while first > 0 and margin(float(grid[first])) >= 0.0:
            first -= 1
        while last < len(grid) - 1 and margin(float(grid[last])) >= 0.0:
            last += 1
        grid = grid[first : last + 1]
    inside = np.array([margin(float(beta)) >= 0.0 for beta in grid])
    region: list[tuple[float, float]] = []
    start: float | None = float(grid[0]) if inside[0] else None
    for i in range(len(grid) - 1):
        if inside[i] == inside[i + 1]:
            continue
        edge = float(brentq(lambda x: _bounded(margin(x)), grid[i], grid[i + 1], xtol=1e-13))
        if inside[i + 1]:
            start = edge + 1e-12
        elif start is not None:
            region.append((start, edge - 1e-12))
            start = None
    if start is not None:
        region.append((start, float(grid[-1])))
    return [(a, b) for a, b in region if b > a]


def _bounded(value: float) -> float:
    return float(np.clip(np.nan_to_num(value, nan=-1e3), -1e3, 1e3))
