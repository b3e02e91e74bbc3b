"""All zeros of S(beta) = E(beta; b(beta)) on the regions on which it is regular: the gaits of some parameters."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

from frontal_biped.zero_dynamics.proof.ball_gait import BallGait
from frontal_biped.zero_dynamics.proof.balls import Ball, is_negative, is_positive
from frontal_biped.zero_dynamics.proof.functions import Imposed
from frontal_biped.zero_dynamics.proof.half_step import NotEnclosedError
from frontal_biped.zero_dynamics.proof.signs import Piece, ProvedCount, count, cut, place_of_zero, sign_at
from frontal_biped.zero_dynamics.proof.surplus import DIAGONAL, Surplus
from frontal_biped.zero_dynamics.proof.theorems import Proof, told

LEAST, MOST = 1e-8, 1000
"""Width of a piece [rad] that is not halved again, and pieces of a region that are looked at."""

PLACE = 1e-6
"""Width of the interval given for a zero [rad], where it can be had."""

Interval = tuple[float, float]
"""Ends [rad]."""


class Partition(NamedTuple):
    """What a count rests on.

    Attributes:
        discs: intervals on which S is one model [rad].
        pieces: of every region, from left to right, with what S is on each.
        places: of the zeros.
    """

    discs: tuple[Interval, ...]
    pieces: tuple[tuple[Piece, ...], ...]
    places: tuple[Interval, ...]


@dataclass(frozen=True)
class ImposedZeros:
    """Zeros of S.

    Attributes:
        regions: on which they are counted [rad].
        found: on each of them their number, and the pieces that show it.
        places: intervals that contain exactly one each, of all regions.
        discs: intervals on which S is one model.
    """

    regions: tuple[Interval, ...]
    found: tuple[ProvedCount, ...]
    places: tuple[Interval, ...]
    discs: tuple[Interval, ...]

    @property
    def counted(self) -> Proof:
        """Is their number known?"""
        return told(bool(self.regions) and all(found.exact for found in self.found), False)

    @property
    def exists(self) -> Proof:
        """Is there one?"""
        return told(bool(self.places), self.counted is Proof.PROVED and not self.places)

    @property
    def unique(self) -> Proof:
        """Is there at most one?"""
        number = len(self.places)
        return told(self.counted is Proof.PROVED and number <= 1, number > 1)

    @property
    def undecided(self) -> tuple[Interval, ...]:
        """Intervals of which it is not known how many they contain."""
        return tuple(interval for found in self.found for interval in found.undecided)

    @property
    def row(self) -> tuple[str, str]:
        """(name, text) for a report."""
        regions = " and ".join(f"[{a:.5f}, {b:.5f}]" for a, b in self.regions) or "nowhere"
        places = ", ".join(f"[{a:.7f}, {b:.7f}]" for a, b in self.places) or "none"
        open_parts = ", ".join(f"[{a:.7f}, {b:.7f}]" for a, b in self.undecided)
        return (
            "zeros of Z, b imposed",
            f"number {self.counted.value}: {len(self.places)} on {regions}, in {places} rad"
            + (f"; undecided on {open_parts}" if open_parts else ""),
        )

    def around(self, reversal: Ball) -> Interval | None:
        """Between the neighbours of a zero, or the ends of the region: S has no other zero there.

        Args:
            reversal: ball of the zero [rad].

        Returns:
            Ends [rad]; None: it is not known to be alone anywhere.
        """
        for (low, high), found in zip(self.regions, self.found, strict=True):
            if not any(_inside(reversal, run) for run in found.zeros):
                continue
            runs_elsewhere = [run for run in found.zeros if not _inside(reversal, run)]
            others = [place for place in self.places if any(a <= place[0] and place[1] <= b for a, b in runs_elsewhere)]
            for a, b in (*others, *found.undecided):
                if is_positive(reversal - b):
                    low = max(low, b)
                elif is_negative(reversal - a):
                    high = min(high, a)
                else:
                    return None
            return low, high
        return None


def imposed_zeros(gait: BallGait, regions: tuple[Interval, ...], partition: Partition | None = None) -> ImposedZeros:
    """Count the zeros of S.

    Args:
        gait: the parameters.
        regions: on which [rad].
        partition: one that is known to do; None: it is sought.
    """
    sharp = Imposed(gait)
    try:
        function = Surplus(gait, DIAGONAL, None if partition is None else partition.discs)
    except NotEnclosedError:
        return ImposedZeros(regions, tuple(ProvedCount((), (), (region,)) for region in regions), (), ())

    def at(beta: float) -> Ball:
        value = function.at(beta)
        return sharp.at(beta) if value.contains(0) else value

    counts = []
    for k, region in enumerate(regions):
        if partition is None:
            pieces = cut(function.on, *region, LEAST, MOST)
        else:
            pieces = tuple(piece for a, b, _ in partition.pieces[k] for piece in cut(function.on, a, b, b - a, 1))
        counts.append(count(pieces, at))
    runs = tuple(run for found in counts for run in found.zeros)
    if partition is None:
        places = tuple(place_of_zero(function.at, *run, PLACE) for run in runs)
    else:
        places = partition.places if _contain_zeros(partition.places, runs, at) else runs
    return ImposedZeros(regions, tuple(counts), places, tuple((disc.low, disc.high) for disc in function.discs))


def _contain_zeros(places: tuple[Interval, ...], runs: tuple[Interval, ...], at: Callable[[float], Ball]) -> bool:
    """Is the zero of each run in its place?"""
    return len(places) == len(runs) and all(
        run[0] <= low < high <= run[1] and sign_at(at, low) * sign_at(at, high) == -1
        for (low, high), run in zip(places, runs, strict=True)
    )


def _inside(ball: Ball, interval: Interval) -> bool:
    return is_positive(ball - interval[0]) and is_negative(ball - interval[1])
