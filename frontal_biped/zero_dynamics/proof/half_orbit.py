r"""Half a step of an orbit through its reversal, in ball arithmetic: forces, speeds, heights and time along it.

With y the share of the way from the reversal, 0, to the impact, 1, and Delta the range of beta, [O] eq. soledo is

.. math:: \zeta = y\, z, \qquad z = \Delta\, e^{L} M, \qquad L(y) = -\Delta \int_0^y rate, \qquad
          M(y) = \frac1y \int_0^y w, \quad w = -e^{-L} drive,

for the rising half as for the falling one, which both move on the same equation. M is a mean, smooth through the
reversal: :math:`M(y) = \int_0^1 w(uy)\,du`, so its k-th Taylor coefficient lies in the hull of those of w from 0 to y,
over k + 1. Of the sole's height over 1 - y, which is the C05 quotient, the same is said from the impact, where the
height vanishes. With v = dbeta^2 = 2 y z / I_P^2 all forces are base + gain v (`zero_dynamics.restricted`, ddbeta
inserted), and as dt = sigma y^{-1/2} dy, sigma = Delta I_P / sqrt(2 z), time is an integral of smooth functions
against moments that are known.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple

from frontal_biped.model.chain import JOINTS
from frontal_biped.zero_dynamics.proof.balls import (
    ORDER,
    Ball,
    arb,
    coefficient,
    series,
)
from frontal_biped.zero_dynamics.proof.chain import BallChain
from frontal_biped.zero_dynamics.proof.half_path import OnZ, Path, Projected, narrowed_series, require_positive
from frontal_biped.zero_dynamics.proof.half_step import NotEnclosedError
from frontal_biped.zero_dynamics.proof.ranges import controls

FINE = 1e-9
"""Remainder on a panel, relative to one more than the size of the function, above which the panel is halved."""

FIRST, DEEPEST = 4, 9
"""Panels a half step begins with, and halvings of each at most."""


Pair = tuple[Ball, Ball]
"""A function on a panel: its series about the centre, and about all points at once."""

Rows = dict[str, list[Ball]]
"""Functions on a panel by name: Taylor coefficients, that of the remainder last."""


class Panel(NamedTuple):
    """The orbit on a panel, as series about its centre and about all of its points.

    Attributes:
        chain: the robot.
        span: Delta [rad].
        low: y nearer to the reversal.
        high: y nearer to the impact.
        path: the path.
        on_Z: the zero dynamics.
        L: int of the rate from the reversal.
        M: mean of w from the reversal [kg^2 m^4/(s^2 rad)].
    """

    chain: BallChain
    span: Ball
    low: Ball
    high: Ball
    path: tuple[Projected, Projected]
    on_Z: tuple[OnZ, OnZ]
    L: Pair
    M: Pair

    @property
    def h(self) -> Ball:
        """Half of its width."""
        return (self.high - self.low) / 2

    @property
    def y(self) -> Pair:
        """The variable itself."""
        return _variable(self.low, self.high)

    @property
    def z(self) -> Pair:
        """zeta / y, zeta / tau^2 of `zero_dynamics.orbit` [kg^2 m^4/s^2]."""
        return self.narrowed(_pairwise(lambda L, M: L.exp() * M * self.span, self.L, self.M))

    def dbeta_squared(self, more: Ball | int = 0) -> Pair:
        """dbeta^2 on the orbit through the reversal, or with more energy there [rad^2/s^2].

        Args:
            more: zeta at the reversal [kg^2 m^4/s^2].
        """
        I_P = [place.I_P for place in self.path]
        left = _pairwise(lambda y, L, M: L.exp() * (M * y * self.span + more) * 2, self.y, self.L, self.M)
        return self.narrowed(_pairwise(lambda left, I: left / I / I, left, I_P))

    def motion_rows(self, dbeta_squared: Pair) -> Rows:
        """What depends on the speed, by its name in `gait.constraints`; of speeds of joints the square.

        Raises:
            NotEnclosedError: the ground may pull.
        """
        chain, forces = self.chain, []
        for k in range(len(self.on_Z[0].base)):
            parts = [(place.base[k], place.gain[k]) for place in self.on_Z]
            forces.append(self.narrowed(_pairwise(lambda part, v: part[0] + part[1] * v, parts, dbeta_squared)))
        F_h, F_v, _, *torques = forces
        require_positive(F_v[1], "F_v")
        weight = chain.mass * chain.gravity
        rows = {
            "F_v / m g": _pairwise(lambda F: F / weight, F_v),
            "F_h / F_v": _pairwise(lambda F_h, F_v: F_h / F_v, F_h, F_v),
        }
        for i, (joint, u) in enumerate(zip(JOINTS, torques, strict=True)):
            slopes = [place.slopes[i] for place in self.path]
            rows[f"{joint} torque"] = u
            rows[f"{joint} speed"] = _pairwise(lambda slope, v: slope * slope * v, slopes, dbeta_squared)
        return {name: self.taylor(self.narrowed(row)) for name, row in rows.items()}

    def pose_rows(self) -> Rows:
        """What depends on the pose alone, likewise."""
        middle, wide = self.path
        rows = {
            "I_P (decoupling)": (middle.I_P, wide.I_P),
            "FRI in the sole": (middle.p_fri, wide.p_fri),
            "pelvis roll": (middle.tilts[0], wide.tilts[0]),
            "swing foot": (middle.tilts[1], wide.tilts[1]),
        }
        for i, joint in enumerate(JOINTS):
            rows[f"{joint} angle"] = (middle.q[i], wide.q[i])
        return {name: self.taylor(row) for name, row in rows.items()}

    def narrowed(self, f: Pair) -> Pair:
        """A function, narrower about all points by what is known about the centre."""
        return f[0], narrowed_series(*f, self.h)

    @staticmethod
    def taylor(f: Pair) -> list[Ball]:
        """Taylor coefficients of a function, the remainder's last."""
        return [*(coefficient(f[0], k) for k in range(ORDER)), coefficient(f[1], ORDER)]


class Passed(NamedTuple):
    """From the reversal to where a panel begins: int of the rate, int of w, and the hull of w's coefficients so far."""

    L: Ball
    W: Ball
    hull: list[Ball] | None


@dataclass(frozen=True)
class HalfOrbit:
    """A half step of the orbit.

    Attributes:
        path: its path.
        panels: from the reversal to the impact.
        rows: what is bounded along it, by name in `gait.constraints`: Bernstein coefficients on each panel
            (`ranges.controls`).
        squares: likewise of quantities of either sign, which are known by their squares.
        L: int of the rate from the reversal to the impact.
        M: mean of w over it [kg^2 m^4/(s^2 rad)].
        on_ground: (2,) heights of the sole's ends at the impact, 0 but for the rounding of the robot's numbers [m].
        duration: [s].
    """

    path: Path
    panels: tuple[Panel, ...]
    rows: dict[str, list[list[Ball]]]
    squares: dict[str, list[list[Ball]]]
    L: Ball
    M: Ball
    on_ground: list[Ball]
    duration: Ball

    @property
    def z(self) -> Ball:
        """zeta at the impact [kg^2 m^4/s^2]."""
        return self.L.exp() * self.energy

    @property
    def energy(self) -> Ball:
        """What the way to the reversal takes, or gives back, of zeta there [kg^2 m^4/s^2]."""
        return self.path.span * self.M

    @property
    def cuts(self) -> list[float]:
        """Ends of the panels, exact numbers."""
        return [0.0, *(float(panel.high) for panel in self.panels)]

    @classmethod
    def of(cls, path: Path, cuts: Sequence[float] | None = None, fine: float = FINE) -> "HalfOrbit":
        """The orbit on a path.

        Args:
            path: the path, from a reversal to an impact.
            cuts: ends of panels that are known to do; None: they are sought.
            fine: as `walk` has it.

        Raises:
            NotEnclosedError: I_P may vanish, the ground pull, or the robot not move, as far as balls can tell.
        """
        rows: dict[str, list[list[Ball]]] = {}
        duration, walked = arb(0), list(walk(path, _orbit_rows, cuts, fine))
        for panel, _, own in walked:
            for name, taylor in own.items():
                rows.setdefault(name, []).append(controls(taylor, panel.h))
            duration = duration + _time(own[TIME], panel)
        panels, at = tuple(panel for panel, _, _ in walked), walked[-1][1]
        rows.pop(TIME)
        squares = {f"{joint} speed": rows.pop(f"{joint} speed") for joint in JOINTS}
        on_ground = path.at(arb(1)).heights
        rows[HEIGHT] = [controls(taylor, h) for taylor, h in lifted(panels, on_ground)]
        return cls(path, panels, rows, squares, at.L, at.W, on_ground, duration)


TIME = "sigma"
"""dt/dy sqrt(y) among the rows [s]."""

HEIGHT = "sole height / (1 - t2)"
"""C05 among the rows [m]."""


def walk(
    path: Path,
    rows_of: Callable[[Panel], Rows],
    cuts: Sequence[float] | None = None,
    fine: float = FINE,
    deepest: int = DEEPEST,
) -> Iterator[tuple[Panel, "Passed", Rows]]:
    """Panels from the reversal to the end of a path, what has been passed at their ends, and functions on them.

    Args:
        path: the path.
        rows_of: the functions.
        cuts: ends of panels that are known to do; None: they are sought.
        fine: remainder, relative to one more than the size of a function, above which a panel is halved.
        deepest: halvings of a panel at most.

    Raises:
        NotEnclosedError: a panel cannot be enclosed.
    """
    ends = [k / FIRST for k in range(FIRST + 1)] if cuts is None else list(cuts)
    if ends[0] != 0.0 or ends[-1] != 1.0 or not all(low < high for low, high in pairwise(ends)):
        raise NotEnclosedError("panels do not cover the way")
    todo = [(low, high, deepest if cuts is None else 0) for low, high in pairwise(ends)][::-1]
    at = NOTHING
    while todo:
        low, high, halvings = todo.pop()
        try:
            panel, end = _panel(path, arb(low), arb(high), at)
            rows = rows_of(panel)
            good = halvings == 0 or all(_is_fine(taylor, panel.h, fine) for taylor in rows.values())
        except NotEnclosedError:
            if halvings == 0:
                raise
            good = False
        if good:
            at = end
            yield panel, end, rows
        else:
            middle = 0.5 * (low + high)
            todo += [(middle, high, halvings - 1), (low, middle, halvings - 1)]


def _orbit_rows(panel: Panel) -> Rows:
    z = panel.z
    require_positive(z[1], "zeta")
    root = _pairwise(lambda z: (z * 2).sqrt(), z)
    require_positive(root[1], "zeta")
    sigma = _pairwise(lambda place, root: place.I_P * panel.span / root, panel.path, root)
    found = {"zeta/tau^2 of the orbit": panel.taylor(z), TIME: panel.taylor(panel.narrowed(sigma))}
    return found | panel.pose_rows() | panel.motion_rows(panel.dbeta_squared())


def _is_fine(taylor: list[Ball], h: Ball, fine: float) -> bool:
    rest = abs(taylor[-1]) * h**ORDER
    return bool(rest < fine * (1 + abs(taylor[0])))


def _time(sigma: list[Ball], panel: Panel) -> Ball:
    """The integral of sigma y^{-1/2} dy over a panel; the moments of (y - c)^k by parts."""
    low, high, c, h = panel.low, panel.high, (panel.low + panel.high) / 2, panel.h
    rest = sigma[-1] * arb(0).union(h**ORDER)
    total, moment, power = arb(0), arb(0), arb(1)
    for k, a in enumerate(sigma[:-1]):
        at_ends = power * (high.sqrt() - (low.sqrt() if k % 2 == 0 else -low.sqrt()))
        moment = (at_ends - k * c * moment) / (k + arb(0.5))
        total = total + (a + rest if k == 0 else a) * moment
        power = power * h
    return total


def lifted(panels: Sequence[Panel], on_ground: list[Ball]) -> Iterator[tuple[list[Ball], Ball]]:
    """The height of either end of the sole over the share of the way from the impact, and halves of the widths.

    Heights are counted from where the ends are at the impact.
    """
    hulls: list[list[Ball]] | None = None
    for panel in reversed(panels):
        middle, wide = panel.path
        own = [[coefficient(lift, k) for k in range(ORDER + 1)] for lift in wide.lifts]
        if hulls is not None:
            own = [[a.union(b) for a, b in zip(*pair, strict=True)] for pair in zip(hulls, own, strict=True)]
        hulls = own
        for height, below, hull in zip(middle.heights, on_ground, hulls, strict=True):
            mean = series([a / (k + 1) for k, a in enumerate(hull)])
            yield panel.taylor(panel.narrowed(((height - below) / (1 - panel.y[0]), mean))), panel.h


NOTHING = Passed(arb(0), arb(0), None)


def _panel(path: Path, low: Ball, high: Ball, at: Passed) -> tuple[Panel, Passed]:
    """A panel, and what has been passed at its end.

    Raises:
        NotEnclosedError: I_P may vanish on it.
    """
    y = _variable(low, high)
    places, on_Z = path.on_panel(y, (high - low) / 2)
    return panel_of(path, low, high, places, on_Z, at)


def panel_of(
    path: Path | Panel,
    low: Ball,
    high: Ball,
    places: tuple[Projected, Projected],
    on_Z: tuple[OnZ, OnZ],
    at: Passed,
) -> tuple[Panel, Passed]:
    """A panel whose places are known, and what has been passed at its end.

    Args:
        path: whose robot and span they are of.
        low: y nearer to the reversal.
        high: y nearer to the impact.
        places: about its centre, and about all points at once.
        on_Z: the zero dynamics, likewise.
        at: what has been passed where it begins.
    """
    h, Delta, y, (middle, wide) = (high - low) / 2, path.span, _variable(low, high), on_Z
    slope = middle.rate * -Delta, wide.rate * -Delta
    L_centre, L_end = _integrals(slope, at.L, h)
    L = slope[0].integral() + L_centre, slope[1].integral() + (at.L + coefficient(slope[1], 0) * arb(0).union(2 * h))
    L = L[0], narrowed_series(*L, h)
    w = -((-L[0]).exp() * middle.drive), -((-L[1]).exp() * wide.drive)
    w = w[0], narrowed_series(*w, h)
    W_centre, W_end = _integrals(w, at.W, h)
    own = [coefficient(w[1], k) for k in range(ORDER + 1)]
    hull = own if at.hull is None else [a.union(b) for a, b in zip(at.hull, own, strict=True)]
    M = (w[0].integral() + W_centre) / y[0], series([a / (k + 1) for k, a in enumerate(hull)])
    M = M[0], narrowed_series(*M, h)
    return Panel(path.chain, Delta, low, high, places, on_Z, L, M), Passed(L_end, W_end, hull)


def _integrals(f: Pair, begin: Ball, h: Ball) -> tuple[Ball, Ball]:
    """An integral up to the centre of a panel and up to its end."""
    taylor = [*(coefficient(f[0], k) for k in range(ORDER)), coefficient(f[1], ORDER)]
    left, right, power = arb(0), arb(0), h
    for k, a in enumerate(taylor):
        part = a * power / (k + 1)
        right, left = right + part, left + (part if k % 2 == 0 else -part)
        power = power * h
    return begin + left, begin + left + right


def _variable(low: Ball, high: Ball) -> Pair:
    return series([(low + high) / 2, arb(1)]), series([low.union(high), arb(1)])


def _pairwise(function: Callable[..., Ball], *parts: Sequence[Any]) -> Pair:
    """A function of functions, about the centre and about all points alike."""
    middle, wide = (function(*arguments) for arguments in zip(*parts, strict=True))
    return middle, wide
