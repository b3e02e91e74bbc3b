r"""Certificate of the reversal point: existence, number, uniqueness, and what each verdict rests on.

**Region.** Z is defined where the zero dynamics is: where I_P > 0 on both phases (C03). A zero of I_P is a
singularity, so verdicts are given on the *regular region* of the bracket ]beta_r+, beta_r^max[, where
I_P >= `REGULAR` times its smallest value on the gait's own step, and where the robot would turn back, kappa_2 < 0 at
the reversal (HIP2). Nothing walks outside it: kappa_1 = 1/I_P grows without bound, and a zero of Z with kappa_2 > 0 is
no reversal point. At fixed b the rising phase is one curve for every reversal point, so nothing lies beyond its first
zero of I_P: the region is the interval around the planned reversal. With invariance imposed every reversal point has
a curve of its own, and the region may be several intervals. The certificate names it; all its verdicts are about it.

**Counting.** All zeros of E(beta; b) and of S(beta) = E(beta; b(beta)) (see `reversal.problem`) come from piecewise
Chebyshev interpolation with a measured bound (see `chebyshev`), widened by the measured error of the quadrature. The
zero at the planned reversal is known better than that, from signs beside it (`reversal.planned`), and is one of them.

**Condition (a).** *At fixed b, if kappa_2/kappa_1 < 0 on an interval above beta_r+, a step of given post-impact energy
reverses at most once on it.* Proof. dzeta/dbeta = drive + rate zeta with drive = kappa_2/kappa_1 and
rate = 2 kappa_3/kappa_1. Put w = zeta exp(-int rate). Then dw/dbeta = exp(-int rate) drive < 0: w is strictly
decreasing and vanishes at most once, and so does zeta, which has its sign.

**Condition (b), corrected.** With R' = -exp(-int_{beta_r+}^beta rate_r) drive_r and
F' = -exp(int_beta^{beta_f-} rate_f) drive_f (differentiate the integrals with respect to their end at the reversal),

.. math:: \frac{dE}{d\beta} = g F' - R' = e^{-\int rate_r} |drive_r| \, (m r - 1), \qquad r = drive_f / drive_r,

where m = g exp(int_beta^{beta_f-} rate_f + int_{beta_r+}^beta rate_r) is the multiplier of a step reversing at beta.
So E, not Z itself, has a derivative of the sign of m r - 1: Z = c E with c(beta) > 0 not constant, and dZ/dbeta = c E'
only at the zeros. That suffices: m r < 1 on the whole interval makes E strictly decreasing, so at most one zero of E,
that is of Z. At a gait pose, slope and FRI are continuous, r = 1, and E' < 0 iff m < 1: a stable gait is always a
simple zero of Z. All of this is at fixed b. It says nothing about S, whose zeros are the gaits with invariance
imposed, and on the optimised gaits S does have a second one; S is therefore counted, not argued about.
"""

from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from frontal_biped.exceptions import ReversalError
from frontal_biped.files.json_values import for_json
from frontal_biped.numerics.chebyshev import Fit, Zero, fit
from frontal_biped.numerics.verdict import Verdict, below
from frontal_biped.zero_dynamics.restricted import restrict
from frontal_biped.zero_dynamics.reversal.planned import AT_THE_PLAN, ReversalAnalysis, analyse_reversal
from frontal_biped.zero_dynamics.reversal.problem import BalanceFunction, EnergyBalance, ReversalProblem
from frontal_biped.zero_dynamics.reversal.zeros import REGULAR, ZeroCount, count_zeros


@dataclass(frozen=True)
class Condition:
    """A sufficient condition of the form "this quantity stays below this bound".

    Attributes:
        verdict: certified: it holds on the region; refuted: it fails somewhere; undecided: within the error.
        largest: largest value of the quantity seen.
        bound: it must stay below.
        error: on ``largest``.
        where: beta of the largest value [rad].
    """

    verdict: Verdict
    largest: float
    bound: float
    error: float
    where: float

    def __str__(self) -> str:
        return (
            f"{self.verdict.value}; largest {self.largest:.4g} at {self.where:.5f} rad, must stay below {self.bound:g}"
        )


def told_count(found: ZeroCount) -> str:
    """A count in one line."""
    places = ", ".join(f"{zero.place:.7f}" for zero in found.zeros) or "none"
    region = " and ".join(f"[{a:.5f}, {b:.5f}]" for a, b in found.region) or "nowhere"
    return (
        f"exists: {found.existence.value}, unique: {found.uniqueness.value}; zeros {places} rad"
        f" on {region}, error bound {found.error:.1e}"
    )


@dataclass(frozen=True)
class ReversalCertificate:
    """What is known about the reversal point of a gait.

    Attributes:
        bracket: beta_r+ and beta_r^max [rad].
        planned: beta_r- of the gait [rad].
        fixed: zeros of E(beta; b), the paper's Z.
        self_consistent: zeros of S(beta) = E(beta; b(beta)), the gaits of these parameters.
        condition_a: kappa_2/kappa_1 < 0 on the rising phase, relative to its size at the reversal.
        condition_b: m r < 1.
        contraction: Phi' of the successive approximation at the planned point [-].
        contraction_error: bound on it, from the fit of S.
        multiplier: [-].
        barrier_margin: energy from the orbit's reversal to beta_r^max at the pose of the reversal, over the orbit's
            post-impact energy [-]: what a push may add before the robot tips outwards.
        distance_to_barrier: beta_r^max - beta_r- [rad].
    """

    bracket: tuple[float, float]
    planned: float
    fixed: ZeroCount
    self_consistent: ZeroCount
    condition_a: Condition
    condition_b: Condition
    contraction: float
    contraction_error: float
    multiplier: float
    barrier_margin: float
    distance_to_barrier: float

    @property
    def planned_is_a_zero(self) -> bool:
        """Does an enclosed zero of S lie at the planned reversal, as far as its enclosure tells?"""
        enclosures = (zero.enclosure for zero in self.self_consistent.zeros)
        return any(low - AT_THE_PLAN <= self.planned <= high + AT_THE_PLAN for low, high in enclosures)

    @property
    def successive_approximation_converges(self) -> Verdict:
        """Locally, from |Phi'| < 1."""
        return below(abs(self.contraction), 1.0, self.contraction_error)

    def as_dict(self) -> dict[str, Any]:
        """For JSON; numbers that do not exist are null."""
        table = asdict(self)
        for name in ("fixed", "self_consistent"):
            count: ZeroCount = getattr(self, name)
            table[name] |= {"existence": count.existence, "uniqueness": count.uniqueness}
        table["successive_approximation_converges"] = self.successive_approximation_converges
        return dict(for_json(table))

    def rows(self) -> list[tuple[str, str]]:
        """(name, text) for a report."""
        return [
            ("Z(beta; b), b fixed", told_count(self.fixed)),
            ("Z(beta; b(beta))", told_count(self.self_consistent)),
            ("condition (a) drive < 0", str(self.condition_a)),
            ("condition (b) m r < 1", str(self.condition_b)),
            (
                "successive approximation",
                f"converges: {self.successive_approximation_converges.value}; contraction {self.contraction:.6f}"
                f" +- {self.contraction_error:.0e} an iteration",
            ),
            (
                "energy barrier",
                f"{self.distance_to_barrier:.5f} rad beyond the reversal; {100.0 * self.barrier_margin:.1f} % of the"
                " post-impact energy more would tip the robot in the pose of the reversal",
            ),
        ]


def certify_reversal(problem: ReversalProblem, reversal: ReversalAnalysis | None = None) -> ReversalCertificate:
    """Certify the reversal point of a parameter set.

    Args:
        problem: the parameters; the planned point should be a gait, or the contraction factor has no meaning.
        reversal: the analysis of the same parameters, where it is at hand.

    Raises:
        ReversalError: the bracket does not exist, or no step exists at the planned reversal.
    """
    own = problem.balance(problem.planned)
    if not np.isfinite(own.surplus):
        raise ReversalError(f"no step of the zero dynamics reverses at the planned {problem.planned:.6g} rad")
    floor = REGULAR * own.least_inertia
    low, high = problem.bracket

    fixed = problem.at_fixed_parameters()

    def imposed(beta: float, nodes: int) -> EnergyBalance:
        return ReversalProblem(problem.biped, problem.free, nodes).balance(beta)

    fixed_count, _, fixed_points = count_zeros(fixed, low, high, problem, floor, connected=True)
    found = analyse_reversal(problem) if reversal is None else reversal
    if found.exists:  # by signs beside the plan: that is sharper than any interpolant
        fixed_count = fixed_count.with_zero(Zero(found.beta, found.sign_change, fixed(found.beta, problem.nodes).slope))
    own_count, own_fits, _ = count_zeros(imposed, low, high, problem, floor)
    slope, slope_error = _slope(own_fits, problem.planned)
    contraction = 1.0 - slope / own.slope
    a, b = _conditions(problem, fixed, fixed_count, fixed_points)
    return ReversalCertificate(
        bracket=(low, high),
        planned=problem.planned,
        fixed=fixed_count,
        self_consistent=own_count,
        condition_a=a,
        condition_b=b,
        contraction=contraction,
        contraction_error=abs(slope_error / own.slope),
        multiplier=own.multiplier,
        barrier_margin=_barrier_margin(problem, high, own),
        distance_to_barrier=high - problem.planned,
    )


def _slope(fits: list[Fit], beta: float) -> tuple[float, float]:
    for piece in fits:
        low, high = piece.interval
        if low <= beta <= high:
            return float(piece.polynomial.deriv()(beta)), piece.slope_error
    return float("nan"), float("nan")


def _conditions(
    problem: ReversalProblem, function: BalanceFunction, count: ZeroCount, points: dict[float, EnergyBalance]
) -> tuple[Condition, Condition]:
    """Both sufficient conditions on the region of the fixed parameters."""
    rising, _ = problem.phases(problem.planned)
    scale = abs(float(restrict(problem.biped, rising, np.array([problem.planned])).drive[0]))

    def drive(beta: float) -> float:
        return float(restrict(problem.biped, rising, np.array([beta])).drive[0]) / scale

    def product(beta: float) -> float:
        point = points.get(beta) or function(beta, problem.nodes)
        return point.multiplier * point.drive_ratio

    region = list(count.region)
    # (a) is about the rising phase alone, from its start on
    whole = [(problem.bracket[0], region[-1][1])] if region else []
    return stays_below(drive, whole, 0.0), stays_below(product, region, 1.0)


def stays_below(function: Callable[[float], float], region: list[tuple[float, float]], bound: float) -> Condition:
    """Does a function stay below a bound on intervals?"""
    largest, where, error, complete = -np.inf, float("nan"), 0.0, bool(region)
    for a, b in region:
        pieces, failed = fit(function, a, b, 1e-6)
        complete &= not failed
        for piece in pieces:
            c, d = piece.interval
            grid = np.linspace(c, d, 513)
            values = piece.polynomial(grid)
            # between grid points the polynomial rises by at most half a spacing times its steepest slope
            slack = 0.5 * (d - c) / 512 * float(np.max(np.abs(piece.polynomial.deriv()(grid)))) + piece.error
            error = max(error, slack)
            if float(values.max()) > largest:
                largest, where = float(values.max()), float(grid[int(values.argmax())])
    verdict = below(largest, bound, error)
    if verdict is Verdict.CERTIFIED and not complete:
        verdict = Verdict.UNDECIDED
    return Condition(verdict, largest, bound, error, where)


def _barrier_margin(problem: ReversalProblem, barrier: float, own: EnergyBalance) -> float:
    """Energy from beta_r- to beta_r^max in the pose of the reversal, over the energy that rising takes.

    The robot is frozen in that pose and turns about the FRI target of the reversal: its potential energy rises by
    m g times the rise of the centre of mass minus the work of the ankle, m g p_FRI times the angle's share, which is
    the integral of m g (p_cm_h - p_FRI) dbeta.
    """
    rising, _ = problem.phases(problem.planned)
    end = rising.motion(np.array([problem.planned]))
    pose, p_fri = end.q[0], float(end.p_fri[0])
    nodes, weights = np.polynomial.legendre.leggauss(16)
    angles = problem.planned + 0.5 * (nodes + 1.0) * (barrier - problem.planned)
    energy = 0.0
    for angle, weight in zip(angles, weights, strict=True):
        frozen = pose.copy()
        frozen[0] = angle
        momentum = problem.biped.momentum_map(frozen)[:, 0]
        inertia = float(momentum[2] - p_fri * momentum[1])
        offset = float(problem.biped.com(frozen)[0]) - p_fri
        energy += 0.5 * (barrier - problem.planned) * weight * problem.biped.weight * offset * inertia
    return float(energy / own.required)
