"""The verdict on a gait. One function decides, and everything that accepts, analyses or shows a gait asks it.

A gait is *certified* if all of this holds, *refuted* if something of it does not, and *undecided* if something of it is
within the errors of the numbers:

    invariance, energy balance, stored orbit    residuals below `RESIDUAL_BOUND`
    stable                                      multiplier below 1, by more than the error of the quadrature
    domain                                      the fixed point exists, both phases move on, the robot turns back
    reversal                                    Z has a zero within `AT_THE_PLAN` of the planned reversal (HIP1, HIP2)
    C01 to C09                                  kept on the dense grid of `gait.check`

How many other reversal points there are does not count for it; `reversal.certificate` tells.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from frontal_biped.gait.check import ConstraintReport, check_constraints
from frontal_biped.gait.gait import QUADRATURE_ACCURACY, Gait, Quadrature, converged_quadrature
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.numerics.verdict import Verdict, below, together
from frontal_biped.zero_dynamics.poincare import HybridZeroDynamics, StepOrbit, step_orbit
from frontal_biped.zero_dynamics.reversal.planned import ReversalAnalysis, analyse_reversal
from frontal_biped.zero_dynamics.reversal.problem import ReversalProblem

RESIDUAL_BOUND = 1e-9
"""Largest residual of a certified gait: invariance, energy balance, stored orbit."""


@dataclass(frozen=True)
class Objection:
    """What keeps a gait from being certified.

    Attributes:
        verdict: refuted, or undecided.
        reason: one line.
    """

    verdict: Verdict
    reason: str


@dataclass(frozen=True)
class GaitVerdict:
    """The verdict on a gait, and what it rests on.

    Attributes:
        nodes: quadrature nodes a phase.
        quadrature_error: measured by doubling them [-].
        step: the step on those nodes.
        residuals: of the gait, see `Gait.residuals`.
        reversal: where it reverses.
        constraints: C01 to C09 on the dense grid.
        objections: whatever does not hold, or may not.
    """

    nodes: int
    quadrature_error: float
    step: StepOrbit
    residuals: dict[str, float]
    reversal: ReversalAnalysis
    constraints: ConstraintReport
    objections: tuple[Objection, ...]

    @property
    def verdict(self) -> Verdict:
        """On the gait."""
        return together(objection.verdict for objection in self.objections)


def judge(
    biped: FrontalBiped,
    gait: Gait,
    specification: GaitSpecification | None = None,
    *,
    checked: tuple[StepOrbit, ConstraintReport] | None = None,
    quadrature: Quadrature | None = None,
) -> GaitVerdict:
    """Decide whether a gait is one.

    Args:
        biped: the robot.
        gait: the gait.
        specification: bounds to check against; default: those the gait was designed for.
        checked: a step of the gait's phases, and the report on it; used instead of new ones if the step is on the
            quadrature nodes that the gait needs.
        quadrature: how many that are, and their error, as measured on the gait or on one next to it;
            default: measured.
    """
    spec = specification or gait.specification
    phases = gait.rising, gait.falling
    nodes, error = quadrature or converged_quadrature(biped, *phases, gait.step_width)
    if checked is not None and len(checked[0].rising.tau) == nodes:
        step, report = checked
    else:
        step = step_orbit(biped, *phases, gait.step_width, nodes)
        report = check_constraints(biped, spec, *phases, step)
    residuals = gait.residuals(biped, step)
    reversal = analyse_reversal(ReversalProblem.of_phases(biped, *phases, gait.step_width, nodes))
    hzd = HybridZeroDynamics(biped, step)
    objections = (
        *residuals_missed(residuals),
        *orbit_missed(hzd.multiplier, error, in_domain=hzd.in_domain),
        *_reversal(reversal),
        *constraints_missed(report),
    )
    return GaitVerdict(nodes, error, step, residuals, reversal, report, objections)


def residuals_missed(residuals: dict[str, float]) -> Iterator[Objection]:
    """Objections to residuals."""
    for name, value in residuals.items():
        verdict = below(value, RESIDUAL_BOUND)
        if verdict is not Verdict.CERTIFIED:
            yield Objection(verdict, f"residual {name} is {value:.3g}, not below {RESIDUAL_BOUND:g}")


def orbit_missed(slope: float, error: float, *, in_domain: bool) -> Iterator[Objection]:
    """Objections to an orbit: its multiplier, known to a relative error, and whether its map is defined there."""
    error = max(error, QUADRATURE_ACCURACY)
    stable = below(slope, 1.0, slope * error)
    if stable is Verdict.REFUTED:
        yield Objection(stable, f"the multiplier {slope:.6g} is not below 1: the gait is not stable")
    elif stable is Verdict.UNDECIDED:
        yield Objection(stable, f"the multiplier {slope:.9g} is 1 within its error of {slope * error:.1g}")
    if not in_domain:
        yield Objection(Verdict.REFUTED, "the fixed point is outside the domain of the Poincare map")


def _reversal(reversal: ReversalAnalysis) -> Iterator[Objection]:
    if reversal.existence is Verdict.REFUTED:
        yield Objection(Verdict.REFUTED, "no reversal point exists around the planned one (HIP1)")
    elif reversal.existence is Verdict.UNDECIDED:
        yield Objection(Verdict.UNDECIDED, "whether a reversal point exists is within the error of Z (HIP1)")
    elif not reversal.is_reversal:
        yield Objection(
            Verdict.REFUTED,
            f"the robot does not turn back at {reversal.beta:.9g} rad (HIP1, HIP2): zeta {reversal.zeta_residual:.1e}"
            f" (relative), ddbeta {reversal.acceleration:.3g} rad/s^2",
        )
    elif reversal.at_the_plan is not Verdict.CERTIFIED:
        sure = "is not" if reversal.at_the_plan is Verdict.REFUTED else "may not be"
        yield Objection(
            reversal.at_the_plan,
            f"the reversal point {reversal.beta:.9g} rad {sure} the planned {reversal.planned:.9g} rad",
        )


def constraints_missed(report: ConstraintReport) -> Iterator[Objection]:
    """Objections to constraints."""
    for check in report.violated:
        reason = f"{check.code} {check.name} = {check.value:.6g} {check.unit}, bound {check.bound:.6g}"
        yield Objection(Verdict.REFUTED, reason)
