r"""From which starts successive approximation converges to a gait, far from it.

Invariance is imposed at x; Phi(x) is the zero of E(.; b(x)) that is met first from x on in the direction in which the
surplus S(x) = E(x; b(x)) tells: downwards where it is negative and the robot turns back before x, upwards where it is
positive. Let beta* be the only zero of S on [low, high], S > 0 to the left of it and S < 0 to the right; 0 <= k < 1,
and the *middle* an interval about beta*, such that d, k times the distance of its farther end, is less than that of the
nearer one.

**Claim.** If E(beta* - k (x - beta*); b(x)) has the sign of x - beta* on the middle, and E(beta* - d; b(x)) > 0 to the
right of it, E(beta* + d; b(x)) < 0 to the left, then from every start in [low, high] the iteration x -> Phi(x) is
defined and converges to beta*.

**Proof.** On the middle, where E has the one sign at beta* - k (x - beta*), S(x) has the other: a zero lies between,
Phi(x) - beta* is in ]-k, 1[ times x - beta*, and the distance shrinks. To the right of the middle, Phi(x) lies in
]beta* - d, x[ likewise, so iterates fall until they are on the middle: a limit behind it would be a zero of S, since E
is continuous. To the left they rise. On the middle the distances shrink to a limit r. Were r > 0, iterates would have a
limit point x at a distance r of beta*, and their images likewise; these cannot be beyond beta*, nearer by the factor k,
so they tend to x too, and S(x) = E(x; b(x)) = 0: a second zero.

It is about this Phi. One that looks for its zero by other means, as `reversal.solver` does by Newton's method, may find
another one, or none where E is flat.

Both functions are `Surplus` along rays, so their signs are those of models on discs of x. That I_P > 0 up to wherever E
is asked is in them: to the right of beta* on the curves of S, to the left on those of the rays, which reach further.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

from frontal_biped.zero_dynamics.proof.ball_gait import BallGait
from frontal_biped.zero_dynamics.proof.balls import Ball, arb, is_positive
from frontal_biped.zero_dynamics.proof.half_step import NotEnclosedError
from frontal_biped.zero_dynamics.proof.imposed_zeros import ImposedZeros, Interval
from frontal_biped.zero_dynamics.proof.signs import cut, sign_throughout
from frontal_biped.zero_dynamics.proof.surplus import Ray, Surplus
from frontal_biped.zero_dynamics.proof.theorems import Convergence, NearestZero, Proof, told

SHARES = (0.0, 0.25, 0.5, 0.75, 0.9)
"""k that are tried."""

SHARE_MARGIN = 0.2
"""k + Phi'(beta*), at least: the slope of E(beta* - k (x - beta*); b(x)) at beta* is that times -E_beta."""

WIDTHS = (1e-3, 2.5e-4, 6e-5, 1.5e-5, 4e-6, 1e-6)
"""Half of the width of the tile about beta*, that are tried [rad]."""

GROWTH = 4.0
"""Width of a tile over that of the one before it."""

WIDEST = 0.4
"""Width of a tile over its distance from where the rising phase is empty, at most."""

SMALLEST_TILE = 1 / 8
"""Width of the tile over the distance from beta*, at which the search ends."""


class Tiles(NamedTuple):
    """What the claim rests on: intervals of starts, from left to right, each beginning where the one before it ends.

    Attributes:
        share: k.
        left: to the left of the middle [rad].
        middle: among them one about beta*.
        right: to the right.
    """

    share: float
    left: tuple[Interval, ...]
    middle: tuple[Interval, ...]
    right: tuple[Interval, ...]

    @property
    def all(self) -> tuple[Interval, ...]:
        """From left to right."""
        return (*self.left, *self.middle, *self.right)

    @property
    def reach(self) -> Interval:
        """Starts that converge [rad]."""
        return self.all[0][0], self.all[-1][1]


class Rays(NamedTuple):
    """Where E is asked.

    Attributes:
        left: for starts to the left of the middle.
        middle: on it.
        right: to the right.
    """

    left: Ray
    middle: Ray
    right: Ray

    @classmethod
    def of(cls, reversal: Ball, share: float, middle: Interval) -> "Rays":
        """Those of the claim.

        Args:
            reversal: ball of beta* [rad].
            share: k.
            middle: its ends [rad].

        Raises:
            NotEnclosedError: d may be larger than the claim wants it.
        """
        below, above = reversal - arb(middle[0]), arb(middle[1]) - reversal
        d = share * below.max(above)
        if not (is_positive(below - d) and is_positive(above - d)):
            raise NotEnclosedError("middle")
        return cls(Ray(reversal + d, 0.0), Ray(reversal, -share), Ray(reversal - d, 0.0))


@dataclass(frozen=True)
class Attraction:
    """Starts from which successive approximation is proved to converge.

    Attributes:
        tiles: what that rests on; None: nothing was found.
        proved: does it converge from all of their reach?
    """

    tiles: Tiles | None
    proved: Proof

    @property
    def row(self) -> tuple[str, str]:
        """(name, text) for a report."""
        where = (
            "nowhere" if self.tiles is None else "from every start in [{:.7f}, {:.7f}] rad".format(*self.tiles.reach)
        )
        return "successive approximation, far", f"{self.proved.value}: {where}"

    def converges_from(self, start: float) -> Proof:
        """Does it converge from a start [rad]?"""
        if self.proved is not Proof.PROVED or self.tiles is None:
            return Proof.UNDECIDED
        low, high = self.tiles.reach
        return told(low <= start <= high, False)


def attraction(
    gait: BallGait, zero: NearestZero, near: Convergence, zeros: ImposedZeros, tiles: Tiles | None = None
) -> Attraction:
    """Prove from which starts it converges.

    Args:
        gait: the parameters.
        zero: beta*.
        near: convergence near it.
        zeros: all zeros of S.
        tiles: some that are known to do; None: they are sought.
    """
    within = zeros.around(zero.reversal) if zero.proved is Proof.PROVED else None
    if within is None:
        return Attraction(None, Proof.UNDECIDED)
    if tiles is None:
        found = None
        if near.proved is Proof.PROVED:
            found = sought(gait, zero.reversal, float(near.factor.mid()), within)
        return Attraction(found, told(found is not None, False))
    low, high = tiles.reach
    return Attraction(tiles, told(within[0] <= low and high <= within[1] and hold(gait, zero.reversal, tiles), False))


def sought(gait: BallGait, reversal: Ball, contraction: float, within: Interval) -> Tiles | None:
    """Tiles that do, as far out as they are found; None: not even one about beta*.

    Args:
        gait: the parameters.
        reversal: ball of beta* [rad].
        contraction: Phi' there, about.
        within: between the neighbouring zeros of S [rad].
    """
    share = next((k for k in SHARES if k + contraction > SHARE_MARGIN), None)
    if share is None:
        return None
    planned = gait.free.beta_reversal
    ray = Ray(reversal, -share)
    about = ((planned - w, planned + w) for w in WIDTHS)
    fitting = ((low, high) for low, high in about if within[0] <= low and high <= within[1])
    centre = next((ends for ends in fitting if _holds(gait, ray, ends, reversal)), None)
    if centre is None:
        return None
    middle = [centre]
    if share > 0.0:  # as wide as it can be, and even, for its rays grow with it
        middle = [*reversed(list(_outwards(gait, ray, reversal, centre[0], within[0]))), centre]
        mirrored = min(within[1], 2.0 * planned - middle[0][0])
        middle += _outwards(gait, ray, reversal, centre[1], mirrored)
    rays = Rays.of(reversal, share, (middle[0][0], middle[-1][1]))
    left = reversed(list(_outwards(gait, rays.left, reversal, middle[0][0], within[0])))
    right = _outwards(gait, rays.right, reversal, middle[-1][1], within[1])
    return Tiles(share, tuple(left), tuple(middle), tuple(right))


def hold(gait: BallGait, reversal: Ball, tiles: Tiles) -> bool:
    """Do these tiles show the claim, with their reach for [low, high]?

    Args:
        gait: the parameters.
        reversal: ball of beta* [rad].
        tiles: some.
    """
    if not (0.0 <= tiles.share < 1.0 and tiles.middle and all(a[1] == b[0] for a, b in pairwise(tiles.all))):
        return False
    try:
        rays = Rays.of(reversal, tiles.share, (tiles.middle[0][0], tiles.middle[-1][1]))
    except NotEnclosedError:
        return False
    parts = ((rays.left, tiles.left), (rays.middle, tiles.middle), (rays.right, tiles.right))
    return all(_holds(gait, ray, tile, reversal) for ray, part in parts for tile in part)


def _holds(gait: BallGait, ray: Ray, tile: Interval, reversal: Ball) -> bool:
    """Has E along a ray the sign of x - beta* on a tile? About beta*, where it is 0: does it increase there?"""
    sign = 1 if is_positive(arb(tile[0]) - reversal) else -1 if is_positive(reversal - arb(tile[1])) else 0
    try:
        function = Surplus(gait, ray, (tile,))
        if sign == 0:
            return is_positive(function.on(*tile).slope)
    except NotEnclosedError:
        return False
    pieces = cut(function.on, *tile, least=(tile[1] - tile[0]) / 64, most=200)
    return sign_throughout(pieces, function.at) == sign


def _outwards(gait: BallGait, ray: Ray, reversal: Ball, begin: float, end: float) -> Iterator[Interval]:
    """Tiles from one point towards another, away from beta*, as far as they do."""
    planned, empty = gait.free.beta_reversal, float(gait.begin.mid())
    at, width = begin, GROWTH * abs(begin - planned)
    while at != end and width >= SMALLEST_TILE * abs(at - planned):
        width = min(width, WIDEST * (at - empty))
        following = max(end, at - width) if end < at else min(end, at + width)
        tile = min(at, following), max(at, following)
        if _holds(gait, ray, tile, reversal):
            yield tile
            at, width = following, GROWTH * width
        else:
            width /= GROWTH
