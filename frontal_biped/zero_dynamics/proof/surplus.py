r"""E with invariance imposed, on discs of imposed reversals: S, and what successive approximation asks of E.

`functions` encloses E on intervals of a ten-thousandth of a radian, with first derivatives. Here an interval of a
hundredth is enclosed at once, as a `TaylorModel` in y, with x = centre + reach y the reversal that invariance is
imposed at: the same formulas (`ball_gait`, `half_step`, `chain`), with models for numbers. Where E is asked for may
depend on x,

.. math:: E(\beta(x); b(x)), \qquad \beta(x) = pivot + share\,(x - pivot),

a *ray* of the plane of beta and x: share 1 is the diagonal, S; share 0 asks at a fixed reversal, whatever is imposed.
A half step is cut into panels, s = centre + h t on each; both integrals of `passage` are those of models.
"""

from typing import NamedTuple

import numpy as np

from frontal_biped.zero_dynamics.proof.ball_gait import BallGait
from frontal_biped.zero_dynamics.proof.balls import Ball, Number, arb, is_negative
from frontal_biped.zero_dynamics.proof.half_step import NotEnclosedError
from frontal_biped.zero_dynamics.proof.panels import work
from frontal_biped.zero_dynamics.proof.signs import Known
from frontal_biped.zero_dynamics.proof.taylor_model import TaylorModel

CORE = 0.9
"""Share of a disc's real diameter that is used: there slopes are known to ten times the radius of the values."""

NEAREST = 0.36
"""Reach of a disc over its distance from where the rising phase is empty, at most: S has a pole there."""

FINE = 3e-6
"""Share of its energy that a panel's radius may be, on a disc whose reach is its distance from there."""

FINEST = 1e-9
"""The same, at least: far enough from the rounding of doubles."""

ACCURATE = 1e-3
"""Radius of E over its norm, at most: what is wider tells neither signs nor slopes."""

SMALLEST = 1 / 16
"""Width of a piece over that of its disc, below which a disc of its own is made where the old one does not decide."""

MOST_DISCS = 60
"""Tried for one function, those that are too wide among them."""


class Disc(NamedTuple):
    """E on an interval of imposed reversals.

    Attributes:
        low: left end [rad].
        high: right end.
        surplus: model of E, in y.
        drive: model of the rising phase's drive where E is asked.
    """

    low: float
    high: float
    surplus: TaylorModel
    drive: TaylorModel

    @property
    def reach(self) -> Ball:
        """x by y [rad]."""
        return (arb(self.high) - arb(self.low)) / (2 * arb(CORE))

    def y(self, low: float, high: float) -> Ball:
        """Of an interval [rad]."""
        return (arb(low).union(arb(high)) - (arb(self.low) + arb(self.high)) / 2) / self.reach

    def known(self, low: float, high: float) -> Known:
        """E and its slope by x on an interval [rad].

        Raises:
            NotEnclosedError: the drive may not turn the robot back.
        """
        y = self.y(low, high)
        if not is_negative(self.drive.value(y)):
            raise NotEnclosedError("drive")
        return Known(self.surplus.value(y), self.surplus.slope(y) / self.reach)


class Ray(NamedTuple):
    """Where E is asked.

    Attributes:
        pivot: ball of a reversal [rad].
        share: of the way from there to the reversal that is imposed.
    """

    pivot: Ball
    share: float


DIAGONAL = Ray(arb(0), 1.0)
"""E(x; b(x)) = S(x)."""


class Surplus:
    """E along a ray, as a function of the reversal that invariance is imposed at.

    Args:
        gait: the parameters.
        ray: where E is asked.
        discs: intervals that are known to do; None: they are sought.
    """

    def __init__(
        self, gait: BallGait, ray: Ray = DIAGONAL, discs: tuple[tuple[float, float], ...] | None = None
    ) -> None:
        self.gait, self.ray = gait, ray
        self._sought = discs is None
        self._tried = 0
        self.discs = [self.disc(*ends) for ends in discs or ()]

    def disc(self, low: float, high: float) -> Disc:
        """E on an interval [rad].

        Raises:
            NotEnclosedError: I_P may vanish at a complex point of the disc, or the model is too wide.
        """
        centre, begin = (arb(low) + arb(high)) / 2, self.gait.begin
        reach = (arb(high) - arb(low)) / (2 * arb(CORE))
        size = reach / (centre - begin)
        if not size < NEAREST:
            raise NotEnclosedError("rising phase")
        with np.errstate(all="ignore"):  # radii are infinite, or nan, where nothing is known
            x = TaylorModel.parameter(centre, reach)
            step = self.gait.imposed(x)
            ratios: tuple[Number, Number] = (1, 1)
            if self.ray != DIAGONAL:
                beta = self.ray.pivot + self.ray.share * (x - self.ray.pivot)
                ratios = (beta - begin) / (x - begin), (beta - self.gait.end) / (x - self.gait.end)
            share = max(FINE * float(size.mid()), FINEST)  # on a small disc E changes little
            rising, falling = (work(*own, share) for own in zip((step.rising, step.falling), ratios, strict=True))
            surplus = step.jump() * falling - rising
            if not surplus.radius[0] <= ACCURATE * surplus.norm[0]:
                raise NotEnclosedError("E")
            return Disc(low, high, surplus, step.rising.at(ratios[0]).drive)

    def on(self, low: float, high: float) -> Known:
        """E and its slope along the ray, on an interval [rad].

        Raises:
            NotEnclosedError: it is not enclosed, or the robot may not turn back there.
        """
        around = [disc for disc in self.discs if disc.low <= low and high <= disc.high]
        if around:
            disc = min(around, key=lambda disc: disc.high - disc.low)
            known = disc.known(low, high)
            if known.kind.decided or not self._sought or high - low > SMALLEST * (disc.high - disc.low):
                return known
        if not self._sought or self._tried >= MOST_DISCS:
            raise NotEnclosedError("E")
        self._tried += 1
        self.discs.append(self.disc(low, high))
        return self.discs[-1].known(low, high)

    def at(self, x: float) -> Ball:
        """E along the ray, at a reversal [rad].

        Raises:
            NotEnclosedError: it is on none of the discs.
        """
        around = [disc for disc in self.discs if disc.low <= x <= disc.high]
        if not around:
            raise NotEnclosedError("E")
        disc = min(around, key=lambda disc: disc.high - disc.low)
        return disc.surplus.value(disc.y(x, x))
