"""The verdict on a gait that travels sideways: `verdict`, asked of two steps together.

invariance, energy balance, travel, stored orbit    residuals below `RESIDUAL_BOUND`
stable                                              m_A m_B below 1, by more than the error of the quadrature
domain                                              the fixed points exist, all phases move on
reversals                                           a pair of reversals within `AT_THE_PLAN` of the planned ones
C01 to C09                                          kept by both steps on the dense grid of `gait.check`
"""

from collections.abc import Iterator
from dataclasses import dataclass

from frontal_biped.gait.check import ConstraintReport
from frontal_biped.gait.sideways import SidewaysGait, quadrature_of
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.gait.two_step_constraints import check_two_steps
from frontal_biped.gait.verdict import Objection, constraints_missed, orbit_missed, residuals_missed
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.numerics.verdict import Verdict, together
from frontal_biped.zero_dynamics.reversal.pair_problem import TwoStepReversal
from frontal_biped.zero_dynamics.reversal.pair_solver import PairAnalysis, analyse_pair
from frontal_biped.zero_dynamics.two_steps import TwoStepMap, TwoSteps


@dataclass(frozen=True)
class SidewaysVerdict:
    """The verdict on a gait of two steps, and what it rests on.

    Attributes:
        nodes: quadrature nodes a phase.
        quadrature_error: measured by doubling them [-].
        steps: both on those nodes.
        residuals: of the gait, see `SidewaysGait.residuals`.
        reversal: of either step.
        constraints: C01 to C09 on the dense grid.
        objections: whatever does not hold, or may not.
    """

    nodes: int
    quadrature_error: float
    steps: TwoSteps
    residuals: dict[str, float]
    reversal: PairAnalysis
    constraints: ConstraintReport
    objections: tuple[Objection, ...]

    @property
    def verdict(self) -> Verdict:
        """On the gait."""
        return together(objection.verdict for objection in self.objections)


def judge_sideways(
    biped: FrontalBiped, gait: SidewaysGait, specification: GaitSpecification | None = None
) -> SidewaysVerdict:
    """Decide whether a gait of two steps is one.

    Args:
        biped: the robot.
        gait: the gait.
        specification: bounds to check against; default: those the gait was designed for.
    """
    spec = specification or gait.specification
    nodes, error = quadrature_of(biped, gait.phases, (gait.a.step_width, gait.b.step_width))
    steps = gait.two_steps(biped, nodes)
    report = check_two_steps(biped, spec, gait.phases, steps)
    residuals = gait.residuals(biped, steps)
    closed_form = TwoStepMap(biped, steps)
    reversal = analyse_pair(
        TwoStepReversal.of_phases(biped, gait.phases, (gait.a.step_width, gait.b.step_width), nodes)
    )
    objections = (
        *residuals_missed(residuals),
        *orbit_missed(closed_form.multiplier, error, in_domain=closed_form.in_domain),
        *_reversal(reversal),
        *constraints_missed(report),
    )
    return SidewaysVerdict(nodes, error, steps, residuals, reversal, report, objections)


def _reversal(found: PairAnalysis) -> Iterator[Objection]:
    if found.existence is not Verdict.CERTIFIED:
        yield Objection(found.existence, "no pair of reversal points was found around the planned one (HIP1)")
    elif not found.is_reversal:
        yield Objection(
            Verdict.REFUTED,
            f"the robot does not turn back (HIP1, HIP2): ddbeta {found.accelerations[0]:.3g} and"
            f" {found.accelerations[1]:.3g} rad/s^2",
        )
    elif found.at_the_plan is not Verdict.CERTIFIED:
        sure = "is not" if found.at_the_plan is Verdict.REFUTED else "may not be"
        yield Objection(found.at_the_plan, f"the pair of reversal points {sure} the planned one")
