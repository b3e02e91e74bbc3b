"""Everything the closed form says about a gait that travels sideways, with the residuals it rests on."""

from dataclasses import asdict, dataclass
from typing import Any

from frontal_biped.exceptions import ReversalError
from frontal_biped.files.json_values import for_json
from frontal_biped.files.shown import html_table
from frontal_biped.gait.check import ConstraintReport
from frontal_biped.gait.sideways import SidewaysGait, StepNumbers
from frontal_biped.gait.sideways_verdict import judge_sideways
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.gait.two_step_constraints import NAMES
from frontal_biped.gait.verdict import Objection
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.numerics.verdict import Verdict, together
from frontal_biped.zero_dynamics.reversal.pair_certificate import PairCertificate, certify_pair
from frontal_biped.zero_dynamics.reversal.pair_problem import TwoStepReversal
from frontal_biped.zero_dynamics.reversal.pair_solver import PairAnalysis
from frontal_biped.zero_dynamics.two_steps import AffineMap, TwoStepMap


@dataclass(frozen=True)
class SidewaysAnalysis:
    """Closed-form analysis of a gait of two steps.

    Attributes:
        robot: its name.
        nodes: quadrature nodes a phase.
        quadrature_error: measured by doubling them [-].
        rho_a: map of zeta_f- over step A.
        rho_b: over step B.
        multiplier: m_A m_B [-].
        fixed_points: zeta_f* at the end of A, of B [kg^2 m^4/s^2].
        in_domain: are they in the domain of the map?
        orbit: of both steps, as stored in the gait.
        travel: way sideways in two steps [m].
        speed: mean, sideways [m/s].
        cost: mean of J over the two steps [N^2 m s].
        cost_of_travel: int u'u dt for each metre on the way [N^2 m s].
        reversal: where both steps reverse.
        residuals: of the gait, see `SidewaysGait.residuals`.
        constraints: C01..C09 of both steps on the dense grid.
        open_points: what keeps the gait from being certified, see `gait.sideways_verdict`.
        certificate: of the pair of reversals; None where no steps exist, or not asked.
    """

    robot: str
    nodes: int
    quadrature_error: float
    rho_a: AffineMap
    rho_b: AffineMap
    multiplier: float
    fixed_points: tuple[float, float]
    in_domain: bool
    orbit: StepNumbers
    travel: float
    speed: float
    cost: float
    cost_of_travel: float
    reversal: PairAnalysis
    residuals: dict[str, float]
    constraints: ConstraintReport
    open_points: tuple[Objection, ...]
    certificate: PairCertificate | None

    @property
    def verdict(self) -> Verdict:
        """On the gait."""
        return together(objection.verdict for objection in self.open_points)

    @property
    def certified(self) -> bool:
        """Is it a gait?"""
        return self.verdict is Verdict.CERTIFIED

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        table = {key: value for key, value in asdict(self).items() if key not in ("constraints", "certificate")}
        table |= {
            "rho_a": self.rho_a._asdict(),
            "rho_b": self.rho_b._asdict(),
            "orbit": {name: asdict(step) for name, step in zip(NAMES, self.orbit, strict=True)},
            "verdict": self.verdict,
            "certified": self.certified,
            "constraints": self.constraints.as_dict(),
            "certificate": None if self.certificate is None else self.certificate.as_dict(),
        }
        return dict(for_json(table))

    @property
    def summary(self) -> str:
        """Three lines: what it is, what is tightest, what speaks against it."""
        lines = [
            f"{self.robot}: {self.verdict.value}; {self.travel:.4g} m sideways in two steps, {self.speed:.4g} m/s,"
            f" J = {self.cost:.4f} N^2 m s, multiplier {self.multiplier:.4f}",
            self.constraints.tightest,
        ]
        return "\n".join([*lines, *(objection.reason for objection in self.open_points)])

    def rows(self) -> list[tuple[str, str]]:
        """(name, text) for a report."""
        steps = [
            (
                f"step {name}",
                f"{orbit.step_duration:.6f} s, dbeta_r+ {orbit.beta_dot_after_impact:.6f} rad/s, zeta_f* {zeta:.6f},"
                f" J {orbit.cost:.4f} N^2 m s, rho: {rho.m:.6f} zeta {-rho.c:+.6f}, reversal {beta:.9f} rad",
            )
            for name, orbit, zeta, rho, beta in zip(
                NAMES, self.orbit, self.fixed_points, (self.rho_a, self.rho_b), self.reversal.betas, strict=True
            )
        ]
        worst = max(self.residuals, key=lambda key: self.residuals[key])
        return [
            ("travel", f"{self.travel:.6g} m in two steps, {self.speed:.6g} m/s"),
            ("cost", f"J {self.cost:.4f} N^2 m s, mean; {self.cost_of_travel:.2f} N^2 m s for each metre"),
            *steps,
            ("multiplier m_A m_B", f"{self.multiplier:.9f}"),
            ("existence", self.reversal.existence.value),
            *(self.certificate.rows() if self.certificate is not None else ()),
            ("quadrature", f"{self.nodes} nodes a phase, measured error {self.quadrature_error:.1e}"),
            ("largest residual", f"{self.residuals[worst]:.1e} ({worst})"),
        ]

    def __str__(self) -> str:
        table = "\n".join(f"{name:26} {value}" for name, value in self.rows())
        return f"{self.summary}\n\n{table}\n\n{self.constraints}"

    def __repr__(self) -> str:
        return f"SidewaysAnalysis\n{self.summary}"

    def _repr_html_(self) -> str:
        return html_table(self.rows()) + "\n" + self.constraints._repr_html_()


def analyze_sideways(
    biped: FrontalBiped, gait: SidewaysGait, specification: GaitSpecification | None = None, *, certify: bool = True
) -> SidewaysAnalysis:
    """Analyse a gait of two steps in closed form.

    Args:
        biped: the robot.
        gait: the gait.
        specification: bounds to check against; default: those the gait was designed for.
        certify: count the pairs of reversal points as well? It takes a few seconds.
    """
    judged = judge_sideways(biped, gait, specification)
    closed_form = TwoStepMap(biped, judged.steps)
    widths = gait.a.step_width, gait.b.step_width
    problem = TwoStepReversal.of_phases(biped, gait.phases, widths, judged.nodes)
    try:
        certificate = certify_pair(problem, judged.reversal) if certify else None
    except ReversalError:
        certificate = None
    return SidewaysAnalysis(
        robot=biped.name,
        nodes=judged.nodes,
        quadrature_error=judged.quadrature_error,
        rho_a=closed_form.rho_a,
        rho_b=closed_form.rho_b,
        multiplier=closed_form.multiplier,
        fixed_points=closed_form.fixed_points,
        in_domain=closed_form.in_domain,
        orbit=StepNumbers(gait.a.orbit, gait.b.orbit),
        travel=gait.travel,
        speed=gait.speed,
        cost=gait.cost,
        cost_of_travel=gait.cost_of_travel,
        reversal=judged.reversal,
        residuals=judged.residuals,
        constraints=judged.constraints,
        open_points=judged.objections,
        certificate=certificate,
    )
