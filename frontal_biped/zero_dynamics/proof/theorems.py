r"""What is proved of a gait, and under which hypotheses.

All of it is about the zero dynamics in exact arithmetic, of the planar robot that follows from the decimal numbers of
URDF and description (`decimals`), for free parameters (`FreeParameters`) that are exactly the doubles of the gait file;
columns that hybrid invariance determines follow from those exactly, not as the file rounded them. The regions are those
of the measured certificate (`reversal.certificate`), their ends taken as exact numbers.

**Fixed parameters.** *With the columns imposed at the planned reversal, E(beta; b), and so Z(beta; b), is defined on
the region, the drive of the rising phase is negative at each of its points, and Z has exactly so many zeros on it, one
in each of the intervals given.* Proof: on every piece of a partition E has one sign, or E' has; neighbouring monotone
pieces are one run, and signs at its ends tell 0 or 1.

**Imposed invariance.** *S(beta) = E(beta; b(beta)) has exactly one zero within `NEARBY` of the planned reversal, it
lies in the ball given, and S' < 0 throughout.* Proof: Newton's step with the ball of S' over that interval, applied to
S at its middle, maps the interval into itself.

**All of them** (`imposed_zeros`). *S is defined on the regions given, the drive is negative at each reversal, and S has
exactly so many zeros there, one in each of the intervals given; where the number is undecided, this holds but for the
intervals named.* Proof: as for fixed parameters, with S and S' from models on discs that cover the regions (`surplus`,
`taylor_model`). Models are polynomials of doubles: their bounds rest on sums, products and quotients that are rounded
to nearest, as IEEE 754 has it, and on matrix products that are sums of products, in whatever order.

**Stability.** *0 < m < 1 for the multiplier m of the step that reverses at that zero*, so it is a periodic orbit of the
hybrid zero dynamics and its return map contracts. Proof: the ball of m at the ball of the zero.

**Successive approximation.** *From every start within the radius given of that zero the algorithm of [O] Sec. III-D
converges to it, each distance at most kappa times the one before.* Proof: Phi'(x) = -E_x / E_beta at (Phi(x), x); with
kappa the largest ratio for beta and x in the interval, |E(beta*; b(x))| <= max|E_x| |x - beta*|, and E_beta has one
sign: so E(.; b(x)) has its only zero of the interval within kappa |x - beta*| of beta*.

**From far** (`attraction`, with the proof). *From every start in the interval given successive approximation converges
to that zero, where it takes the zero of E(.; b(x)) that is met first from x on, downwards where S(x) < 0, upwards where
S(x) > 0.*

**Limits** (`limits`, with the proof). *On the whole periodic orbit through that zero C01 to C09 are kept, between the
points of every grid too.*

**Basin** (`basin`, with the proof). *From every speed after the impact in the interval given, re-anchored transitions
return to that orbit; every step on the way exists and keeps the limits of contact and motors.*

**Looked up** (`choices`, with the proof). *So it is of transitions that look ahead, from every speed of another
interval, where they answer as the gait's table has it.*

**Ankle law** (`ankle_basin`, with the proof). *From every speed after the impact in the interval given, the ankle law
reaches that orbit in so many steps, at most; every step on the way exists and keeps those limits.*
"""

from dataclasses import dataclass
from enum import Enum

from frontal_biped.zero_dynamics.proof.ball_gait import BallGait
from frontal_biped.zero_dynamics.proof.balls import Ball, arb, is_negative, is_positive
from frontal_biped.zero_dynamics.proof.functions import Fixed, Imposed
from frontal_biped.zero_dynamics.proof.half_step import NotEnclosedError
from frontal_biped.zero_dynamics.proof.signs import Piece, ProvedCount, count, cut

NEARBY = 1e-8
"""Half of the interval on which the zero with invariance imposed is sought [rad]."""

RADII = (1e-4, 3e-5, 1e-5, 3e-6, 1e-6, 3e-7, 1e-7)
"""Radii tried about the zero, for successive approximation [rad]."""

LEAST, MOST = 1e-10, 4000
"""Width of a piece [rad] that is not halved again, and pieces that are looked at."""


class Proof(Enum):
    """What a proof says of a statement."""

    PROVED = "proved"
    REFUTED = "refuted"
    UNDECIDED = "undecided"


def told(holds: bool, fails: bool) -> Proof:
    """By what is known to hold and what is known not to."""
    return Proof.PROVED if holds else Proof.REFUTED if fails else Proof.UNDECIDED


@dataclass(frozen=True)
class FixedZeros:
    """Zeros of Z at fixed parameters.

    Attributes:
        region: on which they are counted [rad].
        found: their number, and the partition that shows it.
    """

    region: tuple[float, float]
    found: ProvedCount

    @property
    def counted(self) -> Proof:
        """Is their number known?"""
        return told(self.found.exact, False)

    @property
    def exists(self) -> Proof:
        """Is there one?"""
        return told(bool(self.found.zeros), self.found.exact and not self.found.zeros)

    @property
    def unique(self) -> Proof:
        """Is there at most one?"""
        number = len(self.found.zeros)
        return told(self.found.exact and number <= 1, number > 1)


@dataclass(frozen=True)
class NearestZero:
    """The zero of S near the planned reversal.

    Attributes:
        planned: reversal [rad].
        reversal: ball of the zero [rad].
        slope: ball of S' within `NEARBY` [kg^2 m^4/(s^2 rad)].
        multiplier: ball of m there [-].
        proved: does it exist, and alone?
    """

    planned: float
    reversal: Ball
    slope: Ball
    multiplier: Ball
    proved: Proof

    @property
    def stable(self) -> Proof:
        """Is 0 < m < 1?"""
        m = self.multiplier
        held = self.proved is Proof.PROVED
        return told(held and is_positive(m) and is_positive(1 - m), held and (is_negative(m) or is_negative(1 - m)))


@dataclass(frozen=True)
class Convergence:
    """Successive approximation near the zero.

    Attributes:
        radius: of the starts [rad]; 0 where none was shown to converge.
        factor: ball of Phi' on them [-].
        proved: does it converge from all of them?
    """

    radius: float
    factor: Ball
    proved: Proof


def fixed_zeros(gait: BallGait, region: tuple[float, float], pieces: tuple[Piece, ...] | None = None) -> FixedZeros:
    """Count the zeros of Z at fixed parameters.

    Args:
        gait: the parameters.
        region: on which [rad].
        pieces: a partition that is known to do; None: one is sought.
    """
    low, high = region
    try:
        function = Fixed(gait, low)
    except NotEnclosedError:
        return FixedZeros(region, ProvedCount((), (), (region,)))
    if pieces is None:
        pieces = cut(function.on, low, high, LEAST, MOST)
    else:
        pieces = tuple(piece for a, b, _ in pieces for piece in cut(function.on, a, b, b - a, 1))
    return FixedZeros(region, count(pieces, function.at))


def nearest_zero(gait: BallGait) -> NearestZero:
    """The zero of S near the planned reversal."""
    function, planned = Imposed(gait), gait.free.beta_reversal
    nothing = arb.nan()
    try:
        slope = function.on(planned - NEARBY, planned + NEARBY).slope
        step = function.at(planned) / slope
        reversal = planned - step
        inside = is_positive(NEARBY - abs(step))
        proved = told(inside and is_negative(slope), False)
        whole, rising, falling = function.halves(reversal)
        multiplier = whole.jump() * (rising.K - falling.K).exp()
    except NotEnclosedError:
        return NearestZero(planned, nothing, nothing, nothing, Proof.UNDECIDED)
    return NearestZero(planned, reversal, slope, multiplier, proved)


def convergence(gait: BallGait, zero: NearestZero, radii: tuple[float, ...] = RADII) -> Convergence:
    """Whence successive approximation converges to the zero: the largest of some radii."""
    function = Imposed(gait)
    if zero.proved is Proof.PROVED:
        for radius in radii:
            # a little wider than the radius, for the zero is not exactly the planned one
            low, high = zero.planned - 1.01 * radius, zero.planned + 1.01 * radius
            try:
                steep, moved = function.partials(low, high)
                factor = -moved / steep
            except NotEnclosedError:
                continue
            if is_positive(1 - abs(factor)) and is_positive(0.01 * radius - abs(zero.reversal - zero.planned)):
                return Convergence(radius, factor, Proof.PROVED)
    return Convergence(0.0, arb.nan(), Proof.UNDECIDED)
