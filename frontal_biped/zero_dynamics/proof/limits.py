r"""C01 to C09 on the whole periodic orbit, between the points of every grid too.

**Limits.** *On the periodic orbit through the zero of S that `theorems` proves, every quantity that the specification
bounds keeps its bound, within the tolerance that the measured check allows* (`gait.check`). Proof: along either half
step the quantities are enclosed by Taylor polynomials with remainders (`half_orbit`), at the ball of the zero, so at
the zero itself; their least and greatest values by Bernstein's basis (`ranges`). A bound is refuted where a point of
the orbit misses it.

The orbit is that of columns which hybrid invariance determines in exact arithmetic. The swing foot's height in C05
counts from where its ends are at the impact: mirrored legs whose numbers differ by rounding leave them within 1e-16 m
of the ground, which C04 allows and no quotient by a share of the way does.

What a bound says is data, `Bound`: the numbers are those of the specification and of the robot, taken as exact; names
are those of `gait.constraints`. A bound on a quantity that has no enclosure here is undecided.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from frontal_biped.zero_dynamics.proof.ball_gait import BallGait, BallStep
from frontal_biped.zero_dynamics.proof.balls import Ball, arb
from frontal_biped.zero_dynamics.proof.half_orbit import HalfOrbit
from frontal_biped.zero_dynamics.proof.half_path import HalfPath
from frontal_biped.zero_dynamics.proof.half_step import NotEnclosedError
from frontal_biped.zero_dynamics.proof.ranges import Enclosed, least
from frontal_biped.zero_dynamics.proof.theorems import NearestZero, Proof, told

PERCENT = 0.02
"""Share of the energy that 1 % of speed is (`gait.constraints.reversal_shift`)."""


class Bound(NamedTuple):
    """lower <= quantity <= upper along the orbit, or one of them.

    Attributes:
        code: C01 to C09, or as in `gait.constraints`.
        name: of the quantity.
        unit: of quantity and bounds.
        lower: bound, or None.
        upper: bound, or None.
        strict: must the bound itself be excluded?
        tolerance: by which the measured check allows it to be missed; 0 where it is strict.
    """

    code: str
    name: str
    unit: str
    lower: float | None
    upper: float | None
    strict: bool
    tolerance: float


@dataclass(frozen=True)
class ProvedLimit:
    """What is proved of a bound.

    Attributes:
        bound: the bound.
        margin: ball of the least distance to it on the orbit, negative outside; nan where it is not enclosed.
    """

    bound: Bound
    margin: Ball

    @property
    def proved(self) -> Proof:
        """Does it hold, within its tolerance?"""
        return self._held(-self.bound.tolerance)

    @property
    def exactly(self) -> Proof:
        """Does it hold without?"""
        return self._held(0.0)

    def _held(self, least_margin: float) -> Proof:
        beyond = self.margin - arb(least_margin)
        if self.bound.strict:
            return told(bool(beyond > 0), bool(beyond <= 0))
        return told(bool(beyond >= 0), bool(beyond < 0))

    @property
    def row(self) -> tuple[str, str]:
        """(name, text) for a report."""
        exactly = "" if self.exactly is self.proved else f", without tolerance {self.exactly.value}"
        return (
            f"{self.bound.code} {self.bound.name}",
            f"{self.proved.value}{exactly}: margin {self.margin} {self.bound.unit}",
        )


class Cuts(NamedTuple):
    """Ends of the panels on which a verifier need not search: shares of the way from the reversal to the impact.

    Attributes:
        rising: of the rising half.
        falling: of the falling half.
    """

    rising: tuple[float, ...]
    falling: tuple[float, ...]


@dataclass(frozen=True)
class ProvedLimits:
    """C01 to C09 on the periodic orbit.

    Attributes:
        limits: one a bound.
        cuts: panels that do; None where there is no enclosure at all.
    """

    limits: tuple[ProvedLimit, ...]
    cuts: Cuts | None

    @property
    def proved(self) -> Proof:
        """Do all of them hold?"""
        verdicts = [limit.proved for limit in self.limits]
        return told(all(v is Proof.PROVED for v in verdicts), Proof.REFUTED in verdicts)

    @property
    def left(self) -> tuple[ProvedLimit, ...]:
        """Those that are not proved."""
        return tuple(limit for limit in self.limits if limit.proved is not Proof.PROVED)

    @property
    def rows(self) -> list[tuple[str, str]]:
        """(name, text) for a report: what is proved together, and one by one what is not."""
        number = len(self.limits) - len(self.left)
        exact = sum(limit.exactly is Proof.PROVED for limit in self.limits)
        text = (
            f"{self.proved.value}: {number} of {len(self.limits)} on the whole orbit, {exact} of them without tolerance"
        )
        return [("C01 to C09", text), *(limit.row for limit in self.left)]


@dataclass(frozen=True)
class BallOrbit:
    """The periodic orbit, enclosed.

    Attributes:
        gait: the parameters.
        step: with invariance imposed at the zero's ball.
        rising: from the reversal back to the impact it began with.
        falling: from the reversal to the impact.
    """

    gait: BallGait
    step: BallStep
    rising: HalfOrbit
    falling: HalfOrbit

    @classmethod
    def of(cls, gait: BallGait, reversal: Ball, sole: tuple[float, float], cuts: Cuts | None = None) -> "BallOrbit":
        """The orbit that reverses at a point or nearly one.

        Args:
            gait: the parameters.
            reversal: where [rad].
            sole: ends of the stance sole on the h axis, (outer < 0, inner > 0) [m].
            cuts: panels that do; None: they are sought.

        Raises:
            NotEnclosedError: the orbit may not exist, as far as balls can tell.
        """
        step = gait.imposed(reversal)
        halves = [
            HalfOrbit.of(HalfPath.of(half, sole), None if cuts is None else own)
            for half, own in zip((step.rising, step.falling), cuts or (None, None), strict=True)
        ]
        return cls(gait, step, *halves)

    @property
    def cuts(self) -> Cuts:
        """Its panels."""
        return Cuts(tuple(self.rising.cuts), tuple(self.falling.cuts))

    @cached_property
    def multiplier(self) -> Ball:
        """delta_f^2 delta_r^2 delta_z^2 [-]."""
        landed, landing = (half.path.at(arb(1)).I_P for half in (self.rising, self.falling))
        jump = self.step.speed_ratio * landed / landing
        return jump * jump * (self.falling.L - self.rising.L).exp()

    def enclosed(self, bound: Bound) -> Enclosed | None:
        """The least distance of a quantity to its bounds; None: there is no enclosure of it."""
        sides = []
        for limit, sign in ((bound.lower, 1), (bound.upper, -1)):
            if limit is None:
                continue
            found = self._least(bound.name, sign, bound.tolerance)
            if found is None:
                return None
            sides.append([value - sign * arb(limit) for value in found])
        lows, highs = zip(*sides, strict=True)
        return Enclosed(min(x.lower() for x in lows), min(x.upper() for x in highs))

    def _least(self, name: str, sign: int, accuracy: float) -> Enclosed | None:
        """The least value of a quantity, or of its negative."""
        if name in self._single:
            values = [sign * value for value in self._single[name]]
            if not all(value.is_finite() for value in values):
                return None
            return Enclosed(min(v.lower() for v in values), min(v.upper() for v in values))
        row, _, phase = name.rpartition(", ")
        half = {"rising": self.rising, "falling": self.falling}.get(phase)
        if half is None:
            return None
        if row in half.squares:
            # of both signs, as far as the bounds go: the greatest square tells
            found = least(([-a for a in panel] for panel in half.squares[row]), accuracy)
            return Enclosed(-(-found.low).sqrt(), -(-min(found.high, arb(0))).sqrt())
        if row not in half.rows:
            return None
        return least(([sign * a for a in panel] for panel in half.rows[row]), accuracy)

    @cached_property
    def _single(self) -> dict[str, list[Ball]]:
        """Quantities of the reversal, of the impact and of the whole step, by their names in `gait.constraints`."""
        up, down, chain = self.rising, self.falling, self.gait.chain
        reversal, landing = up.path.at(arb(0)), down.path.at(arb(1))
        kappa_2 = reversal.p_fri * reversal.G[1] - reversal.G[2]
        dbeta = -(2 * down.z).sqrt() / landing.I_P
        impact = chain.impact(self.gait.q_minus, landing.slopes)
        L_h, L_v, moment = (impulse * dbeta for impulse in impact.impulse)
        _, foot_v, foot_turn = impact.foot
        barrier = reversal.I_P * kappa_2 * kappa_2 / (-2 * chain.gravity * reversal.A[0])
        return {
            "multiplier delta_f^2 delta_r^2 delta_z^2": [self.multiplier],
            "zeta_f* at the impact, about the FRI": [down.z],
            "range of beta, rising": [up.path.span],
            "range of beta, falling": [down.path.span],
            "kappa_2 at the reversal (HIP2)": [kappa_2],
            "both sole ends on the ground at impact": [abs(x) for x in (*up.on_ground, *down.on_ground)],
            "touchdown speed of both sole ends": [-lift / down.path.span * dbeta for lift in landing.lifts],
            "normal impulse / m": [L_v / chain.mass],
            "L_h / L_v": [L_h / L_v],
            "impulse in the sole": [moment / L_v],
            "lift-off speed of the old stance sole": [(foot_v + foot_turn * arb(end)) * dbeta for end in up.path.sole],
            "step duration": [up.duration + down.duration],
            "step width": [arb(self.gait.free.step_width)],
            "energy to spare before tipping": [barrier / up.energy],
            "reversal shift by 1 % of speed": [up.energy * arb(PERCENT) / -(kappa_2 * reversal.I_P)],
        }


def without_panels(bounds: Sequence[Bound]) -> ProvedLimits:
    """Nothing is known of these."""
    return ProvedLimits(tuple(ProvedLimit(bound, arb.nan()) for bound in bounds), None)


def prove_limits(
    gait: BallGait,
    zero: NearestZero,
    bounds: Sequence[Bound],
    sole: tuple[float, float],
    cuts: Cuts | None = None,
) -> ProvedLimits:
    """Prove of the periodic orbit what is asked of it.

    Args:
        gait: the parameters.
        zero: the reversal of the orbit.
        bounds: what is asked.
        sole: ends of the stance sole on the h axis, (outer < 0, inner > 0) [m].
        cuts: panels that are known to do; None: they are sought.
    """
    try:
        if zero.proved is not Proof.PROVED:
            raise NotEnclosedError("orbit")
        orbit = BallOrbit.of(gait, zero.reversal, sole, cuts)
    except NotEnclosedError:
        return without_panels(bounds)
    limits = []
    for bound in bounds:
        margin = orbit.enclosed(bound)
        limits.append(ProvedLimit(bound, arb.nan() if margin is None else margin.low.union(margin.high)))
    return ProvedLimits(tuple(limits), orbit.cuts)
