r"""The certificate of the two reversals of two different steps in turn (`pair_problem`).

**At fixed parameters**

.. math:: E_2' = -R_A' \, \bigl(1 - (m_A r_A)(m_B r_B)\bigr),

so that condition (b) is about the product: (m_A r_A)(m_B r_B) < 1 on the whole interval makes E_2 strictly decreasing
and the pair unique; at a gait E_2' < 0 iff m_A m_B < 1: a stable gait is always a simple zero. Condition (a), a
negative drive, is asked of both rising phases.

**With invariance imposed** the pair that `pair_solver` finds is the only one nearby where it is regular. How many pairs
there are elsewhere is left undecided: on the whole region R_B is not known to be monotone once the columns move with
beta_B.
"""

from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from frontal_biped.exceptions import ReversalError
from frontal_biped.files.json_values import for_json
from frontal_biped.numerics.chebyshev import Zero
from frontal_biped.numerics.verdict import Verdict
from frontal_biped.virtual_constraints.phase import Phase
from frontal_biped.zero_dynamics.restricted import restrict
from frontal_biped.zero_dynamics.reversal.certificate import Condition, stays_below, told_count
from frontal_biped.zero_dynamics.reversal.pair_problem import TwoStepReversal
from frontal_biped.zero_dynamics.reversal.pair_solver import (
    PairAnalysis,
    SelfConsistentPair,
    analyse_pair,
    solve_pair,
)
from frontal_biped.zero_dynamics.reversal.zeros import REGULAR, ZeroCount, count_zeros


@dataclass(frozen=True)
class PairCertificate:
    """What is known about the pair of reversals.

    Attributes:
        brackets: where either can lie [rad].
        planned: of the gait [rad].
        fixed: zeros of E_2 at fixed parameters.
        conditions_a: kappa_2/kappa_1 < 0 on the rising phase of A and of B, relative to its size at the reversal.
        condition_b: (m_A r_A)(m_B r_B) < 1.
        self_consistent: the pair with invariance imposed.
        multiplier: m_A m_B [-].
    """

    brackets: tuple[tuple[float, float], tuple[float, float]]
    planned: tuple[float, float]
    fixed: ZeroCount
    conditions_a: tuple[Condition, Condition]
    condition_b: Condition
    self_consistent: SelfConsistentPair
    multiplier: float

    @property
    def uniqueness(self) -> Verdict:
        """At fixed parameters: at most one zero of E_2, and B's reversal a function of A's.

        With invariance imposed it is undecided.
        """
        if self.fixed.uniqueness is Verdict.CERTIFIED and self.conditions_a[1].verdict is not Verdict.CERTIFIED:
            return Verdict.UNDECIDED
        return self.fixed.uniqueness

    def as_dict(self) -> dict[str, Any]:
        """For JSON; numbers that do not exist are null."""
        table = asdict(self)
        table["fixed"] |= {"existence": self.fixed.existence, "uniqueness": self.uniqueness}
        table["self_consistent"]["unique"] = Verdict.UNDECIDED
        return dict(for_json(table))

    def rows(self) -> list[tuple[str, str]]:
        """(name, text) for a report."""
        own = self.self_consistent
        return [
            ("E_2(beta_A), b fixed", told_count(self.fixed)),
            ("condition (a) of step A", str(self.conditions_a[0])),
            ("condition (a) of step B", str(self.conditions_a[1])),
            ("condition (b) of the pair", str(self.condition_b)),
            (
                "invariance imposed",
                f"pair {own.betas[0]:.7f}, {own.betas[1]:.7f} rad, regular: {own.regular.value} (least singular value"
                f" {own.least_singular_value:.4g} +- {own.error:.0e}); other pairs: undecided",
            ),
        ]


def certify_pair(problem: TwoStepReversal, found: PairAnalysis | None = None) -> PairCertificate:
    """Certify the pair of reversals of two parameter sets.

    Args:
        problem: the parameters.
        found: the analysis of the same parameters, where it is at hand.

    Raises:
        ReversalError: a bracket does not exist, or no steps exist at the planned pair.
    """
    own = problem.balance(problem.planned)
    if not np.isfinite(own.surplus):
        raise ReversalError(f"no two steps of the zero dynamics reverse at the planned {problem.planned:.6g} rad")
    (low, high), fixed = problem.brackets[0], problem.fixed
    count, _, points = count_zeros(fixed.balance, low, high, problem, REGULAR * own.least_inertia, connected=True)
    found = analyse_pair(problem) if found is None else found
    if found.existence is Verdict.CERTIFIED:
        slope = fixed.balance(found.betas[0], problem.nodes).slope
        count = count.with_zero(Zero(found.betas[0], found.sign_change, slope))

    def product(beta: float) -> float:
        point = points.get(beta) or fixed.balance(beta, problem.nodes)
        return point.multiplier * point.drive_ratio

    region = list(count.region)
    ends = [(low, region[-1][1])] if region else []
    seconds = [(problem.brackets[1][0], fixed.second(end, problem.nodes)) for _, end in ends]
    return PairCertificate(
        problem.brackets,
        problem.planned_pair,
        count,
        (stays_below(_drive(problem, fixed.a[0]), ends, 0.0), stays_below(_drive(problem, fixed.b[0]), seconds, 0.0)),
        stays_below(product, region, 1.0),
        solve_pair(problem),
        own.multiplier,
    )


def _drive(problem: TwoStepReversal, rising: Phase) -> Callable[[float], float]:
    """kappa_2/kappa_1 along a rising phase, relative to its size at the reversal."""

    def drive(beta: float) -> float:
        return float(restrict(problem.biped, rising, np.array([beta])).drive[0])

    scale = abs(drive(rising.beta_end))
    return lambda beta: drive(beta) / scale
